#include "cli/batch_options.h"

#include "cli/arguments.h"

namespace raymeter {

BatchSettings batch_settings(const BatchOptions& options) {
  BatchSettings settings;
  settings.order = options.order == "scanline"   ? RayOrder::scanline
                   : options.order == "shuffled" ? RayOrder::shuffled
                                                 : RayOrder::tiled;
  settings.size = parse_size(options.size);
  settings.size.pixel_corners = options.pixels == "corners";
  settings.seed = options.seed;
  if (!options.camera.empty()) settings.camera = parse_camera(options.camera);
  return settings;
}

}  // namespace raymeter
