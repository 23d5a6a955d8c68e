#include "harness/ray_kinds.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scenes/base/error.h"

namespace raymeter {

std::span<const RayKind> ray_kinds() {
  static const Parameter samples{"samples", ParameterType::integer, "1", "rays from each primary hit", 1,
                                 4096};
  static const std::vector<RayKind> kinds{
      {"primary", "from the camera, one for each pixel", QueryKind::closest, {}},
      {"shadow", "from every primary hit to every light", QueryKind::any, {}},
      {"reflection", "from every primary hit, mirrored at the surface", QueryKind::closest, {}},
      {"diffuse", "from every primary hit, cosine-weighted about the normal", QueryKind::closest, {samples}},
      {"ao",
       "ambient occlusion: the directions of diffuse, of bounded length",
       QueryKind::any,
       {{"length", ParameterType::number, "0.05", "as a part of the scene's diagonal", 1e-6, 1e6}, samples}},
      {"random",
       "uniform random chords of the sphere about the scene",
       QueryKind::closest,
       {{"count", ParameterType::integer, "0", "how many; 0: as many as primary rays", 0, 0x1p28}}},
      {"whitted",
       "those of a recursive ray tracer, by generation and together",
       {},
       {{"depth", ParameterType::integer, "5", "deepest generation; eye rays are the first", 1, 64},
        {"rays", ParameterType::text, "all",
         "all, or one generation: primary, shadow-1, reflection-2, refraction-2, shadow-2, ..."}}},
  };
  return kinds;
}

const RayKind& find_ray_kind(std::string_view name) {
  std::vector<std::string_view> names;
  for (const RayKind& kind : ray_kinds()) {
    if (kind.name == name) return kind;
    names.push_back(kind.name);
  }
  throw Error(fmt::format("no rays '{}'; there are: {}", name, fmt::join(names, ", ")));
}

Arguments ray_arguments(const Spec& spec) {
  return Arguments(spec, find_ray_kind(spec.name).parameters);
}

}  // namespace raymeter
