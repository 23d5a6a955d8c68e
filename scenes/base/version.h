#pragma once

/// MAJOR.MINOR.PATCH. CMakeLists.txt reads it from here. While MAJOR is 0, another MINOR is another
/// interface.
#define RAYMETER_VERSION "0.1.0"
