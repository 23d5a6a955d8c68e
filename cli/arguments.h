#pragma once
// Arguments that several subcommands have. All throw Error.
#include <string>

#include "harness/pixel_order.h"
#include "scenes/scene.h"

namespace raymeter {

/// "320x240".
PictureSize parse_size(const std::string& text);

/// "from=0x-5x2:at=0x0x0:up=0x0x1:angle=45".
Camera parse_camera(const std::string& text);

}  // namespace raymeter
