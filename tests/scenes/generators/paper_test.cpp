#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "scenes/base/portable_math.h"
#include "scenes/generators/paper/mesh_builder.h"
#include "scenes/open_scene.h"

namespace raymeter {
namespace {

/// What the paper says of a scene, and what ours is.
struct PaperScene {
  const char* name;
  std::uint64_t shapes;
  bool triangles;
  std::uint64_t hash;
};

constexpr PaperScene paper_scenes[] = {
    {"paper/1", 70, false, 10248321169207798459u},
    {"paper/2", 58549, true, 7018572378139220535u},
    {"paper/3", 13856, true, 7810543438673043509u},
};

TEST(PaperScenes, AreTheSameOnEveryMachine) {
  for (const PaperScene& paper : paper_scenes)
    EXPECT_EQ(open_scene(paper.name).hash(), paper.hash) << paper.name;
}

TEST(PaperScenes, HaveThePapersNumberOfShapes) {
  for (const PaperScene& paper : paper_scenes) {
    const Scene scene = open_scene(paper.name);
    EXPECT_EQ(scene.primitive_count(), paper.shapes) << paper.name;
    EXPECT_EQ(scene.shape_count(), paper.shapes) << paper.name;
    EXPECT_EQ(scene.triangle_count(), paper.triangles ? paper.shapes : 0) << paper.name;
    EXPECT_THAT(scene.warnings(), testing::IsEmpty()) << paper.name;
  }
}

TEST(PaperScenes, TheFirstMixesKindsOfQuadrics) {
  const Scene scene = open_scene("paper/1");
  std::map<QuadricKind, int> kinds;
  for (const Quadric& quadric : scene.quadrics()) ++kinds[quadric.kind];
  EXPECT_GE(kinds[QuadricKind::sphere], 10);
  EXPECT_GE(kinds[QuadricKind::cylinder], 5);
  EXPECT_GE(kinds[QuadricKind::cone], 5);
  EXPECT_GE(scene.general_quadrics().size(), 30u);
}

/// Of the triangles that are the only ones to have two corners in this order.
std::size_t open_edges(const SceneData& data) {
  std::map<std::pair<std::array<float, 3>, std::array<float, 3>>, int> edges;
  const auto position = [&](std::uint32_t vertex) {
    const Vec3& v = data.vertices[vertex];
    return std::array{v.x, v.y, v.z};
  };
  for (const auto& corners : data.triangles)
    for (std::size_t i = 0; i < 3; ++i) ++edges[{position(corners[i]), position(corners[(i + 1) % 3])}];
  std::size_t open = 0;
  for (const auto& [edge, count] : edges) {
    const auto opposite = edges.find({edge.second, edge.first});
    open += opposite == edges.end() || opposite->second != count;
  }
  return open;
}

/// Six times the volume, positive when triangles are counter-clockwise seen from outside.
double volume(const SceneData& data) {
  double sum = 0;
  for (const auto& [a, b, c] : data.triangles)
    sum += dot(to_double(data.vertices[a]), cross(to_double(data.vertices[b]), to_double(data.vertices[c])));
  return sum / 6;
}

TEST(MeshBuilder, BodiesAreClosedAndFaceOutward) {
  SceneData box;
  MeshBuilder(box).add_box({1, 2, 3}, {2, 4, 6});
  EXPECT_EQ(box.triangles.size(), 12u);
  EXPECT_EQ(open_edges(box), 0u);
  EXPECT_DOUBLE_EQ(volume(box), 6);

  SceneData spindle;  // a cylinder between two cones
  static constexpr OutlinePoint outline[] = {{0, 0}, {1, 1, true}, {1, 3, true}, {0, 4}};
  MeshBuilder(spindle).add_lathe({5, 0, 0}, outline, 200);
  EXPECT_EQ(spindle.triangles.size(), 200u * (1 + 2 + 1));
  EXPECT_EQ(open_edges(spindle), 0u);
  EXPECT_NEAR(volume(spindle), pi * (2 + 2.0 / 3), 0.01);
}

TEST(MeshBuilder, NormalsAreSmoothButForSharpRings) {
  SceneData data;
  static constexpr OutlinePoint outline[] = {{1, 0}, {1, 1}, {1, 2, true}, {0, 2}};
  MeshBuilder(data).add_lathe({0, 0, 0}, outline, 400);
  for (std::size_t i = 0; i < data.triangles.size(); ++i)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const Vec3d point = to_double(data.vertices[data.triangles[i][corner]]);
      const Vec3d normal = to_double(data.normals[data.triangle_normals[i][corner]]);
      const Vec3d expected = i < 1600 ? Vec3d{point.x, 0, point.z} : Vec3d{0, 1, 0};
      EXPECT_NEAR(dot(normal, expected), 1, 1e-4) << i;
    }
}

}  // namespace
}  // namespace raymeter
