#include <array>

#include "scenes/generators/spd/spd.h"

namespace raymeter {
namespace {

/// The corners of a cube that are a tetrahedron's.
constexpr Vec3d tetrahedron[] = {{-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}, {1, 1, 1}};

void add_tetrahedra(SpdScene& scene, int depth, const Vec3d& centre, double half) {
  if (depth > 1) {
    for (const Vec3d& corner : tetrahedron)
      add_tetrahedra(scene, depth - 1, centre + (half / 2) * corner, half / 2);
    return;
  }
  std::uint32_t corners[4];
  for (int i = 0; i < 4; ++i) corners[i] = scene.vertex(centre + half * tetrahedron[i]);
  for (const auto& [a, b, c] : {std::array{0, 1, 2}, {3, 2, 1}, {2, 3, 0}, {1, 0, 3}})
    scene.polygon(std::array{corners[a], corners[b], corners[c]});
}

SceneData make_tetra(int size) {
  SpdScene scene({.from = {1.022846f, -3.177154f, -2.174512f},
                  .at = {-0.004103f, -0.004103f, 0.216539f},
                  .up = {-0.816497f, -0.816497f, 0.816497f},
                  .angle = 45,
                  .width = 512,
                  .height = 512},
                 {{2, -18, -5}});
  scene.fill(spd_matte({1, 0.2f, 0.2f}));
  add_tetrahedra(scene, size, {0, 0, 0}, 1);
  return scene.take();
}

}  // namespace

SceneGenerator spd_tetra_generator() {
  return spd_generator({"tetra",
                        "a tetrahedron of tetrahedra of tetrahedra (after Glassner 1984, Kay & Kajiya 1986)",
                        "depth of the recursion: 4^size triangles", 6, 12, make_tetra});
}

}  // namespace raymeter
