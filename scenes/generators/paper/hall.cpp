#include "scenes/base/portable_math.h"
#include "scenes/generators/families.h"
#include "scenes/generators/paper/mesh_builder.h"

namespace raymeter {
namespace {

// After the mosque of Cordoba. Metres; rows of arches run along x, one behind the other along z. These
// numbers, and the numbers of stones in an arch, were chosen for the sum of triangles.
constexpr int rows = 8, bays = 8;
constexpr double spacing = 3.4;  // between the columns of a row
constexpr double row_spacing = 4.25;
constexpr int tiles = 37;  // of the floor, both ways
constexpr double tile = 0.85;
constexpr std::uint32_t column_sides = 12, fountain_sides = 21;

/// A band of wedge-shaped stones in turns of two colours about a horizontal axis along z.
struct Arch {
  Vec3d centre;
  double inner_radius, outer_radius, depth;
  double below;  ///< how far it goes on below its centre, in turns: above 0 it is a horseshoe
  int stones, parts_of_a_stone;
};

void add_arch(MeshBuilder& mesh, const Arch& arch, std::uint32_t white, std::uint32_t red) {
  const int parts = arch.stones * arch.parts_of_a_stone;
  for (int part = 0; part < parts; ++part) {
    mesh.use_material(part / arch.parts_of_a_stone % 2 ? red : white);
    const auto outward = [&](int joint) {
      const auto [sine, cosine] = sine_cosine_of_turns((0.5 + 2 * arch.below) * joint / parts - arch.below);
      return Vec3d{cosine, sine, 0};
    };
    const Vec3d from = outward(part), to = outward(part + 1), front{0, 0, arch.depth / 2};
    const auto at = [&](const Vec3d& direction, double radius, int side) {
      return arch.centre + radius * direction + double(side) * front;
    };
    const double in = arch.inner_radius, out = arch.outer_radius;
    mesh.add_quad(at(from, in, 1), at(from, out, 1), at(to, out, 1), at(to, in, 1));
    mesh.add_quad(at(from, out, -1), at(from, in, -1), at(to, in, -1), at(to, out, -1));
    mesh.add_smooth_quad({at(from, out, 1), at(from, out, -1), at(to, out, -1), at(to, out, 1)},
                         {from, from, to, to});
    mesh.add_smooth_quad({at(from, in, -1), at(from, in, 1), at(to, in, 1), at(to, in, -1)},
                         {-from, -from, -to, -to});
  }
}

void add_column(MeshBuilder& mesh, const Vec3d& foot, std::uint32_t shaft, std::uint32_t stone) {
  static constexpr OutlinePoint base[] = {{0.40, 0.00, true}, {0.40, 0.12, true}, {0.36, 0.15},
                                          {0.38, 0.22},       {0.33, 0.30},       {0.26, 0.36, true}};
  static constexpr OutlinePoint middle[] = {
      {0.245, 0.36, true}, {0.250, 0.8}, {0.248, 1.3}, {0.240, 1.8}, {0.225, 2.3, true}};
  static constexpr OutlinePoint capital[] = {{0.28, 2.3, true}, {0.29, 2.36},       {0.24, 2.40, true},
                                             {0.27, 2.55},      {0.36, 2.72, true}, {0.32, 2.74, true},
                                             {0.36, 2.88},      {0.48, 3.04, true}};
  mesh.use_material(stone);
  mesh.add_lathe(foot, base, column_sides);
  mesh.use_material(shaft);
  mesh.add_lathe(foot, middle, column_sides);
  mesh.use_material(stone);
  mesh.add_lathe(foot, capital, column_sides);
  mesh.add_box(foot + Vec3d{-0.50, 3.04, -0.50}, foot + Vec3d{0.50, 3.22, 0.50});
  mesh.add_box(foot + Vec3d{-0.30, 3.22, -0.30}, foot + Vec3d{0.30, 5.00, 0.30});
  mesh.add_box(foot + Vec3d{-0.38, 5.00, -0.45}, foot + Vec3d{0.38, 5.20, 0.45});
}

/// A basin and, on a stem, a bowl, both full of water.
void add_fountain(MeshBuilder& mesh, const Vec3d& foot, std::uint32_t stone, std::uint32_t water) {
  static constexpr OutlinePoint basin[] = {
      {1.10, 0.00, true}, {1.00, 0.10}, {1.05, 0.40, true}, {0.92, 0.40, true}, {0.88, 0.30, true}};
  static constexpr OutlinePoint pool[] = {{0.88, 0.32, true}, {0.08, 0.32, true}};
  static constexpr OutlinePoint bowl[] = {{0.12, 0.30, true}, {0.09, 0.60},       {0.10, 0.85, true},
                                          {0.30, 0.92},       {0.48, 1.08, true}, {0.44, 1.08, true},
                                          {0.40, 1.03, true}};
  static constexpr OutlinePoint brim[] = {{0.41, 1.04, true}, {0, 1.06}};
  mesh.use_material(stone);
  mesh.add_lathe(foot, basin, fountain_sides);
  mesh.add_lathe(foot, bowl, fountain_sides);
  mesh.use_material(water);
  mesh.add_lathe(foot, pool, fountain_sides);
  mesh.add_lathe(foot, brim, fountain_sides);
}

SceneData make_hall(const Arguments&) {
  SceneData data;
  MeshBuilder mesh(data);
  const auto stone = mesh.add_material({.colour = {0.93f, 0.85f, 0.70f}, .specular = 0});
  const auto white = mesh.add_material({.colour = {0.96f, 0.90f, 0.78f}, .specular = 0});
  const auto red = mesh.add_material({.colour = {0.72f, 0.24f, 0.16f}, .specular = 0});
  const auto light_marble = mesh.add_material({.colour = {0.90f, 0.86f, 0.78f}, .specular = 0.1f});
  const auto dark_marble = mesh.add_material({.colour = {0.45f, 0.40f, 0.40f}, .specular = 0.1f});
  const auto water = mesh.add_material({.colour = {0.20f, 0.45f, 0.55f}, .specular = 0.4f, .shine = 60});
  const std::uint32_t shafts[] = {
      mesh.add_material({.colour = {0.55f, 0.60f, 0.68f}, .specular = 0.3f, .shine = 40}),
      mesh.add_material({.colour = {0.78f, 0.52f, 0.45f}, .specular = 0.3f, .shine = 40}),
      mesh.add_material({.colour = {0.42f, 0.55f, 0.48f}, .specular = 0.3f, .shine = 40})};

  for (int row = 0; row < rows; ++row)
    for (int column = 0; column <= bays; ++column) {
      const Vec3d foot{column * spacing, 0, -row * row_spacing};
      add_column(mesh, foot, shafts[(row + 2 * column) % 3], stone);
      if (column == bays) continue;
      const Vec3d middle = foot + Vec3d{spacing / 2, 0, 0};
      add_arch(mesh, {middle + Vec3d{0, 3.95, 0}, 1.4, 1.84, 0.5, 0.087, 15, 2}, white, red);
      add_arch(mesh, {middle + Vec3d{0, 5.2, 0}, 1.36, 1.7, 0.8, 0, 19, 1}, white, red);
    }
  // Columns stand in the middle of tiles.
  for (int i = 0; i < tiles; ++i)
    for (int j = 0; j < tiles; ++j) {
      mesh.use_material((i + j) % 2 ? dark_marble : light_marble);
      const double x = (i - 2.5) * tile, z = (1.5 - j) * tile;
      mesh.add_quad({x, 0, z}, {x + tile, 0, z}, {x + tile, 0, z - tile}, {x, 0, z - tile});
    }
  add_fountain(mesh, {2.5 * spacing, 0, -0.6}, stone, water);

  data.camera = Camera{.from = {8.5f, 2.3f, 7.6f}, .at = {9.9f, 4.1f, -9}, .angle = 61};
  data.background = {0.16f, 0.33f, 0.62f};
  data.lights = {{{-25, 50, 60}, {1.35f, 1.22f, 1}}};
  return data;
}

}  // namespace

SceneGenerator paper_hall_generator() {
  return {"paper/2",
          "58,549 triangles, as many as in the paper's second scene, evenly spread: a hall of columns and "
          "striped arches under the open sky",
          {},
          make_hall};
}

}  // namespace raymeter
