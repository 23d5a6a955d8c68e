#include "scenes/generators/spd/rotation.h"
#include "scenes/generators/spd/spd.h"

namespace raymeter {
namespace {

constexpr double taper = 0.67;  ///< of a branch's diameter, from end to end

/// How a child stands on the tip of its parent, in the parent's frame.
Rotation child_frame(double branch_degrees, double divergence_degrees, double contraction) {
  return contraction * (Rotation::about_z(sine_cosine_of_turns((divergence_degrees + 90) / 360)) *
                        Rotation::about_x(sine_cosine_of_turns(branch_degrees / 360)));
}

class Tree {
 public:
  explicit Tree(SpdScene& scene) : scene_(scene) {}

  void grow(int depth, const Vec3d& base, const Rotation& frame, double radius) {
    const Vec3d tip = base + frame({0, 0, 1});
    const double tip_radius = taper * radius;
    scene_.cone(base, radius, tip, tip_radius);
    scene_.sphere(tip, tip_radius);
    if (depth == 0) return;
    for (const Rotation& child : children_) grow(depth - 1, tip, frame * child, tip_radius);
  }

 private:
  SpdScene& scene_;
  const Rotation children_[2] = {child_frame(40, 0, 0.65), child_frame(25, 140, 0.7)};
};

SceneData make_tree(int size) {
  SpdScene scene({.from = {4.5f, 0.4f, 2},
                  .at = {0, 0, 1.5f},
                  .up = {0, 0, 1},
                  .angle = 45,
                  .width = 512,
                  .height = 512},
                 {{-5, 5, 50},
                  {30, -30, 30},
                  {-40, -30, 20},
                  {10, 30, 40},
                  {-30, 40, 10},
                  {50, 25, 20},
                  {-10, -60, 30}});
  scene.fill(spd_matte({0.2f, 0.7f, 0.2f}));
  scene.polygon({{50, 50, 0}, {-50, 50, 0}, {-50, -50, 0}, {50, -50, 0}});
  scene.fill(spd_matte({0.55f, 0.4f, 0.2f}));
  Tree(scene).grow(size, {0, 0, 0}, Rotation(), 0.15);
  return scene.take();
}

}  // namespace

SceneGenerator spd_tree_generator() {
  return spd_generator({"tree", "a bare tree on a wide field (after Aono & Kunii 1984)",
                        "forks on the way to a twig: 2^(size+1) - 1 cones and as many spheres, one square",
                        11, 23, make_tree});
}

}  // namespace raymeter
