#include "cli/arguments.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <system_error>
#include <vector>

#include "baselines/register_baselines.h"
#include "harness/load_plugin.h"
#include "scenes/base/error.h"
#include "scenes/base/spec.h"

namespace raymeter {

void add_plugins(CLI::App& command, std::vector<std::string>& plugins) {
  command
      .add_option("--plugin", plugins,
                  "Shared library with more structures, as ./libmine.so; may be given\n"
                  "several times")
      ->type_name("FILE")
      ->allow_extra_args(false);
}

Registry registry_with(const std::vector<std::string>& plugins) {
  Registry registry;
  register_accel(registry);
  register_baselines(registry);
  for (const std::string& plugin : plugins) load_plugin(plugin, registry);
  return registry;
}

constexpr std::uint32_t max_side = 65536;

PictureSize parse_size(const std::string& text) {
  PictureSize size;
  const char* end = text.data() + text.size();
  const auto [after_width, width_status] = std::from_chars(text.data(), end, size.width);
  if (width_status == std::errc() && after_width != end && *after_width == 'x') {
    const auto [after_height, height_status] = std::from_chars(after_width + 1, end, size.height);
    if (height_status == std::errc() && after_height == end && size.width > 0 && size.height > 0 &&
        size.width <= max_side && size.height <= max_side)
      return size;
  }
  throw Error(fmt::format("--size {}: expected WIDTHxHEIGHT in pixels, each 1..{}", text, max_side));
}

Camera parse_camera(const std::string& text) {
  const std::vector<Parameter> table{
      {"from", ParameterType::vector, "", "", -3e38, 3e38},
      {"at", ParameterType::vector, "", "", -3e38, 3e38},
      {"up", ParameterType::vector, "0x1x0", "", -3e38, 3e38},
      {"angle", ParameterType::number, "45", "", 0.001, 179.9},
  };
  const Arguments arguments(parse_spec("camera:" + text), table);
  const auto vector = [&](const char* name) {
    if (arguments.text(name).empty()) throw Error(fmt::format("--camera {}: '{}' is missing", text, name));
    const auto v = arguments.vector(name);
    if (v.size() != 3)
      throw Error(fmt::format("--camera {}: '{}' needs three numbers, as 0x-5x2", text, name));
    return to_float({v[0], v[1], v[2]});
  };
  Camera camera{vector("from"), vector("at"), vector("up"), static_cast<float>(arguments.number("angle"))};
  return camera;
}

}  // namespace raymeter
