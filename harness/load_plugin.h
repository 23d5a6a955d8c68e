#pragma once
#include <filesystem>

#include "accel/registry.h"

namespace raymeter {

/// Loads a plug-in (accel/plugin.h) and registers its structures. It stays loaded until the program ends.
///
/// Throws Error, one line that names the file, and leaves the registry as it was, when the file is missing or
/// no shared library, when it is no plug-in or one for another Raymeter (found before any function of it is
/// called, but for the initialisers of its own globals), and when its registration throws, registers nothing,
/// or takes a name that is taken. Records of its structures know it by its content (Record::build_id).
void load_plugin(const std::filesystem::path& file, Registry& registry);

}  // namespace raymeter
