#include <array>
#include <span>
#include <vector>

#include "scenes/generators/spd/spd.h"

namespace raymeter {
namespace {

// Martin Newell's teapot of 1975, with the bottom that Frank Crow added (F. Crow, "The Origins of the
// Teapot", IEEE CG&A 7(1), 1987): 32 bicubic Bezier patches. Most are quarters of round parts, which their
// outlines give.

/// A row of control points a quarter of the way round: radius, length of the tangents, height.
struct RoundRow {
  double radius, tangent, z;
};
constexpr RoundRow rim[] = {
    {1.4, 0.784, 2.4}, {1.3375, 0.749, 2.53125}, {1.4375, 0.805, 2.53125}, {1.5, 0.84, 2.4}};
constexpr RoundRow body[] = {{1.5, 0.84, 2.4}, {1.75, 0.98, 1.875}, {2, 1.12, 1.35},  {2, 1.12, 0.9},
                             {2, 1.12, 0.45},  {1.5, 0.84, 0.225},  {1.5, 0.84, 0.15}};
constexpr RoundRow lid[] = {{0, 0, 3.15},       {0.8, 0.45, 3.15},  {0, 0, 2.85},     {0.2, 0.112, 2.7},
                            {0.4, 0.224, 2.55}, {1.3, 0.728, 2.55}, {1.3, 0.728, 2.4}};
constexpr RoundRow bottom[] = {{0, 0, 0}, {1.425, 0.798, 0}, {1.5, 0.84, 0.075}, {1.5, 0.84, 0.15}};

/// A row of control points half way round a tube in the plane y = 0: where it is nearest to the body's axis
/// and farthest from it, and half its width.
struct TubeRow {
  double near_x, near_z, far_x, far_z, half_width;
};
constexpr TubeRow handle[] = {{-1.6, 2.025, -1.5, 2.25, 0.3}, {-2.3, 2.025, -2.5, 2.25, 0.3},
                              {-2.7, 2.025, -3, 2.25, 0.3},   {-2.7, 1.8, -3, 1.8, 0.3},
                              {-2.7, 1.575, -3, 1.35, 0.3},   {-2.5, 1.125, -2.65, 0.9375, 0.3},
                              {-2, 0.9, -1.9, 0.6, 0.3}};
constexpr TubeRow spout[] = {{1.7, 1.425, 1.7, 0.6, 0.66},       {2.6, 1.425, 3.1, 0.825, 0.66},
                             {2.3, 2.1, 2.4, 2.025, 0.25},       {2.7, 2.4, 3.3, 2.4, 0.25},
                             {2.8, 2.475, 3.525, 2.49375, 0.25}, {2.9, 2.475, 3.45, 2.5125, 0.15},
                             {2.8, 2.4, 3.2, 2.4, 0.15}};

using ControlRow = std::array<Vec3d, 4>;

/// Quarter turns clockwise, seen from above.
Vec3d quarter_turns(Vec3d point, int count) {
  for (; count > 0; --count) point = {point.y, -point.x, point.z};
  return point;
}

/// A patch for each quarter of each three rows on from the next; `sense` is -1 to go round clockwise.
void add_round(std::vector<std::array<ControlRow, 4>>& patches, std::span<const RoundRow> rows, int sense) {
  for (std::size_t first = 0; first + 3 < rows.size(); first += 3)
    for (int quarter = 0; quarter < 4; ++quarter) {
      auto& patch = patches.emplace_back();
      for (std::size_t i = 0; i < 4; ++i) {
        const auto& [radius, tangent, z] = rows[first + i];
        const Vec3d points[] = {{radius, 0, z},
                                {radius, sense * tangent, z},
                                {tangent, sense * radius, z},
                                {0, sense * radius, z}};
        for (std::size_t k = 0; k < 4; ++k)
          patch[i][k] = quarter_turns(points[k], sense < 0 ? quarter : 4 - quarter);
      }
    }
}

void add_tube(std::vector<std::array<ControlRow, 4>>& patches, std::span<const TubeRow> rows) {
  for (std::size_t first = 0; first + 3 < rows.size(); first += 3) {
    std::array<ControlRow, 4> there, back;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto& [near_x, near_z, far_x, far_z, w] = rows[first + i];
      there[i] = {{{near_x, 0, near_z}, {near_x, -w, near_z}, {far_x, -w, far_z}, {far_x, 0, far_z}}};
      back[i] = {{{far_x, 0, far_z}, {far_x, w, far_z}, {near_x, w, near_z}, {near_x, 0, near_z}}};
    }
    patches.insert(patches.end(), {there, back});
  }
}

std::vector<std::array<ControlRow, 4>> teapot_patches() {
  std::vector<std::array<ControlRow, 4>> patches;
  add_round(patches, rim, -1);
  add_round(patches, body, -1);
  add_tube(patches, handle);
  add_tube(patches, spout);
  add_round(patches, lid, -1);
  add_round(patches, bottom, 1);
  return patches;
}

/// A cubic Bezier curve's point and derivative.
struct CurvePoint {
  Vec3d position, derivative;
};
CurvePoint on_curve(const ControlRow& c, double t) {
  const double s = 1 - t;
  return {(s * s * s) * c[0] + (3 * s * s * t) * c[1] + (3 * s * t * t) * c[2] + (t * t * t) * c[3],
          (3 * s * s) * (c[1] - c[0]) + (6 * s * t) * (c[2] - c[1]) + (3 * t * t) * (c[3] - c[2])};
}

/// Cuts a patch into size x size quadrilaterals of two triangles each, with normals.
void add_patch(SpdScene& scene, const std::array<ControlRow, 4>& patch, int size) {
  // The lid's top and the middle of the bottom are single points, which all columns share; of the triangles
  // there one has no area.
  const bool begins_in_a_point = patch[0][0] == patch[0][3];
  std::vector<std::uint32_t> vertices, normals;
  for (int i = 0; i <= size; ++i)
    for (int j = 0; j <= size; ++j) {
      ControlRow across, slopes;
      for (std::size_t k = 0; k < 4; ++k) {
        const auto column = on_curve({patch[0][k], patch[1][k], patch[2][k], patch[3][k]}, double(i) / size);
        across[k] = column.position;
        slopes[k] = column.derivative;
      }
      const auto [position, tangent] = on_curve(across, double(j) / size);
      const Vec3d other_tangent = on_curve(slopes, double(j) / size).position;
      vertices.push_back(scene.vertex(position));
      normals.push_back(scene.normal(begins_in_a_point && i == 0
                                         ? Vec3d{0, 0, position.z > 1.5 ? 1.0 : -1.0}
                                         : normalized(cross(tangent, other_tangent))));
    }
  const auto triangle = [&](std::size_t a, std::size_t b, std::size_t c) {
    scene.polygon(std::array{vertices[a], vertices[b], vertices[c]},
                  std::array{normals[a], normals[b], normals[c]});
  };
  const auto row = static_cast<std::size_t>(size) + 1;
  for (std::size_t i = 0; i + 1 < row; ++i)
    for (std::size_t j = 0; j + 1 < row; ++j) {
      const std::size_t corner = i * row + j, next = corner + row;
      if (!(begins_in_a_point && i == 0)) triangle(corner, corner + 1, next + 1);
      triangle(next + 1, next, corner);
    }
}

/// The squares of one colour, of size x size that cover [-4, 4]^2.
void add_squares(SpdScene& scene, int size, int colour) {
  const auto place = [&](int i) { return 4 * (2.0 * i / size - 1); };
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j)
      if ((i + j) % 2 == colour)
        scene.polygon({{place(i), place(j), 0},
                       {place(i + 1), place(j), 0},
                       {place(i + 1), place(j + 1), 0},
                       {place(i), place(j + 1), 0}});
}

SceneData make_teapot(int size) {
  SpdScene scene({.from = {4.86f, 7.2f, 5.4f},
                  .at = {0, 0, 0},
                  .up = {0, 0, 1},
                  .angle = 45,
                  .width = 512,
                  .height = 512},
                 {{-3.1f, 9.8f, 12.1f}, {11.3f, 5.1f, 8.8f}});
  scene.fill({{1, 1, 1}, 0.5f, 0.5f, 4.81884f, 0, 0});
  add_squares(scene, size, 1);
  scene.fill({{0.5f, 0.5f, 0.5f}, 0.5f, 0.5f, 4.81884f, 0, 0});
  add_squares(scene, size, 0);
  scene.fill({{1, 0.5f, 0.1f}, 0.75f, 0.25f, 3.0827f, 0, 0});
  for (const auto& patch : teapot_patches()) add_patch(scene, patch, size);
  return scene.take();
}

}  // namespace

SceneGenerator spd_teapot_generator() {
  // From 2 on: uncut, some patches have triangles without area.
  return spd_generator({"teapot", "Newell's teapot with shading normals, on a mirroring checkerboard",
                        "cuts of each of 32 patches: 64 size^2 - 8 size triangles, size^2 squares", 12, 870,
                        make_teapot, 2});
}

}  // namespace raymeter
