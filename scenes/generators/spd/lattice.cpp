#include "scenes/generators/spd/spd.h"

namespace raymeter {
namespace {

SceneData make_lattice(int size) {
  const double cell = 1.0 / size;
  const int middle_cell = size / 2;
  const auto middle = static_cast<float>((middle_cell + 0.5) * cell);
  const auto half_cell = static_cast<float>(1 / (2.0 * size));
  SpdScene scene({.from = {middle, 1, 1 - half_cell},
                  .at = {middle, -1, -1 - half_cell},
                  .up = {0.2f, 1, 0},
                  .angle = 60,
                  .width = 512,
                  .height = 512},
                 {{2, 0.5f, 0.5f},
                  {-1, 0.5f, 0.5f},
                  {0.5f, 2, 0.5f},
                  {0.5f, -1, 0.5f},
                  {0.5f, 0.5f, 2},
                  {0.5f, 0.5f, -1}});
  const double radius = cell / 4, rod_radius = cell / 16;
  // The rods begin a little inside the spheres.
  const double inset = radius * (1 - 0.5) * 0.99;
  for (int x = 0; x <= size; ++x)
    for (int y = 0; y <= size; ++y)
      for (int z = 0; z <= size; ++z) {
        const Vec3d centre{double(x) / size, double(y) / size, double(z) / size};
        scene.fill({{0.9f, 0.9f, 0.9f}, 0.5f, 0.5f, 3.0827f, 0, 0});
        scene.sphere(centre, radius);
        const int place[] = {x, y, z};
        for (int axis = 0; axis < 3; ++axis) {
          if (place[axis] == size) continue;
          Material rod{{0.1f, 0.1f, 0.1f}, 0.99f, 0, spd_no_highlight, 0, 0};
          rod.colour[axis] = 0.9f;
          scene.fill(rod);
          Vec3d from = centre, to = centre;
          from[axis] += inset;
          to[axis] += cell - inset;
          scene.cylinder(from, to, rod_radius);
        }
      }
  return scene.take();
}

}  // namespace

SceneGenerator spd_lattice_generator() {
  return spd_generator(
      {"lattice", "a cubic lattice of mirroring spheres joined by rods, seen from inside (A. Costa)",
       "cells along each side: (size+1)^3 spheres, 3 size (size+1)^2 cylinders", 12, 231, make_lattice});
}

}  // namespace raymeter
