#include "cli/batch_options.h"

#include <CLI/CLI.hpp>

#include "cli/arguments.h"

namespace raymeter {

void add_batch_options(CLI::App& command, BatchOptions& o) {
  command.add_option("--size", o.size, "Picture, in pixels")->type_name("WxH")->capture_default_str();
  command.add_option("--order", o.order, "Order of the rays in a batch")
      ->check(CLI::IsMember({"tiled", "scanline", "shuffled"}))
      ->capture_default_str();
  command
      .add_option("--pixels", o.pixels,
                  "Rays through pixel centres, or through the (W+1)x(H+1) corners\n"
                  "as the SPD counts them")
      ->check(CLI::IsMember({"centres", "corners"}))
      ->capture_default_str();
  command
      .add_option("--camera", o.camera,
                  "As from=0x-5x2:at=0x0x0:up=0x0x1:angle=45 (degrees, horizontal)\n"
                  "[the scene's]")
      ->type_name("CAMERA");
  command.add_option("--seed", o.seed, "Seed of rays and samples")
      ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{1} << 53u))
      ->capture_default_str();
}

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
