#pragma once
// The Standard Procedural Databases of Eric Haines ("A Proposal for Standard Graphics Environments", IEEE
// Computer Graphics & Applications 7(11), 1987) in their version 3.14, as his program writes them as NFF: the
// same shapes in the same order, the same fills, lights and camera. A family a file; each has one parameter,
// the size.
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "scenes/generators/generators.h"
#include "scenes/scene_builder.h"

namespace raymeter {

SceneGenerator spd_balls_generator();
SceneGenerator spd_gears_generator();
SceneGenerator spd_jacks_generator();
SceneGenerator spd_lattice_generator();
SceneGenerator spd_mount_generator();
SceneGenerator spd_rings_generator();
SceneGenerator spd_sombrero_generator();
SceneGenerator spd_teapot_generator();
SceneGenerator spd_tetra_generator();
SceneGenerator spd_tree_generator();

/// No family grows beyond so many primitives: the range of its size ends before.
inline constexpr std::uint64_t spd_most_primitives = 50'000'000;

struct SpdFamily {
  std::string name;          ///< without the "spd/" that all have in front
  std::string summary;       ///< what is seen
  std::string size_meaning;  ///< how many shapes a size makes
  int default_size;          ///< of the standard set: about 10,000 primitives
  int largest_size;          ///< the largest with at most spd_most_primitives
  SceneData (*make)(int size);
  int smallest_size = 1;
};

SceneGenerator spd_generator(const SpdFamily& family);

/// The fill of a surface that only scatters.
Material spd_matte(const Vec3& colour);

/// The Phong exponent that stands for no highlight.
inline constexpr float spd_no_highlight = 100000;

/// A scene that is written like an NFF file, from top to bottom.
class SpdScene {
 public:
  static constexpr Vec3 sky{0.078f, 0.361f, 0.753f};

  SpdScene(const Camera& camera, std::initializer_list<Vec3> lights, const Vec3& background = sky);
  SpdScene(const SpdScene&) = delete;
  SpdScene& operator=(const SpdScene&) = delete;

  /// Of the shapes that follow.
  void fill(const Material& material);

  void sphere(const Vec3d& centre, double radius);
  void cone(const Vec3d& base, double base_radius, const Vec3d& apex, double apex_radius);
  void cylinder(const Vec3d& base, const Vec3d& apex, double radius) { cone(base, radius, apex, radius); }
  void polygon(std::initializer_list<Vec3d> corners);

  /// Vertices and normals that several polygons share; both return the index of the new one.
  std::uint32_t vertex(const Vec3d& position);
  std::uint32_t normal(const Vec3d& direction);
  void polygon(std::span<const std::uint32_t> vertices, std::span<const std::uint32_t> normals = {});

  SceneData take() { return std::move(data_); }

 private:
  SceneData data_;
  SceneBuilder builder_{data_};
  std::uint32_t material_ = 0;
  std::vector<std::uint32_t> corners_;
};

}  // namespace raymeter
