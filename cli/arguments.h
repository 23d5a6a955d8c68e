#pragma once
// Arguments that several subcommands have. All throw Error.
#include <string>
#include <vector>

#include "accel/registry.h"
#include "harness/pixel_order.h"
#include "scenes/scene.h"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's name
class App;
}

namespace raymeter {

/// --plugin.
void add_plugins(CLI::App& command, std::vector<std::string>& plugins);
/// All structures of Raymeter, and those of the plug-ins.
Registry registry_with(const std::vector<std::string>& plugins);

/// "320x240".
PictureSize parse_size(const std::string& text);

/// "from=0x-5x2:at=0x0x0:up=0x0x1:angle=45".
Camera parse_camera(const std::string& text);

}  // namespace raymeter
