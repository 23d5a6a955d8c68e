#pragma once
// The one door to OpenImageIO: a module of its own, loaded when the first picture is written, so that nothing
// else pays for its 260 libraries. No header of OpenImageIO is included outside of picture_module.cpp (it
// would also set up fmt in another way than ours).
#include <string>

#include "reports/picture_file.h"

namespace raymeter {

/// What the module exports, by the names raymeter_write_png and raymeter_write_exr. They say what went wrong
/// in `failure`, which stays empty when nothing did.
using WritePng = void(const std::string& file, const Canvas& picture, const PictureMetadata& metadata,
                      std::string& failure);
using WriteExr = void(const std::string& file, const LayeredPicture& picture, std::string& failure);

}  // namespace raymeter
