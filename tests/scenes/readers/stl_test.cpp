#include "tests/scenes/readers/reader_testing.h"

namespace raymeter {
namespace {

SceneData read(std::string_view content) {
  return read_text(read_stl, content);
}

const std::string ascii =
    "solid a square of two\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 2 0 0\n   vertex 2 "
    "2 0\n"
    "  endloop\n endfacet\n facet normal nan nan nan\n  outer loop\n   vertex 0 -0 0\n   vertex 2 2 0\n"
    "   vertex 0 2 0\n  endloop\n endfacet\nendsolid a square\n";

TEST(Stl, reads_ascii_and_joins_equal_corners) {
  const SceneData data = read(ascii);
  EXPECT_EQ(data.vertices.size(), 4u);
  EXPECT_THAT(data.triangles, testing::ElementsAre(std::array{0u, 1u, 2u}, std::array{0u, 2u, 3u}));
  EXPECT_EQ(doubled_area(data), 8);
  EXPECT_EQ(read(ascii + ascii).triangles.size(), 4u) << "two solids";
}

TEST(Stl, line_ends) {
  const std::uint64_t hash = scene_of(read(ascii)).hash();
  for (const char* end : {"\r\n", "\r"}) {
    std::string changed;
    for (const char c : ascii) changed += c == '\n' ? std::string(end) : std::string(1, c);
    EXPECT_EQ(scene_of(read(changed)).hash(), hash);
  }
}

TEST(Stl, refuses_with_the_place) {
  const auto what = [](const std::string& text) { return complaint_about_text(read_stl, text); };
  EXPECT_THAT(what(""), testing::HasSubstr(":1: the file has no facets"));
  EXPECT_THAT(what("solid x\nendsolid x\n"), testing::HasSubstr(":3: the file has no facets"));
  EXPECT_THAT(what("liquid\n"), testing::HasSubstr(":1: expected solid, found \"liquid\""));
  EXPECT_THAT(what("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1e39\n"),
              testing::HasSubstr(":4: a coordinate of a vertex: \"1e39\" is beyond"));
  EXPECT_THAT(what("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nendloop"),
              testing::HasSubstr(":5: expected a coordinate"));
  EXPECT_THAT(what("solid\nfacet normal 0 0 1\nouter loop\n"),
              testing::HasSubstr(":4: expected vertex, found the end of the file"));
  EXPECT_THAT(what(std::string(84, '\0')), testing::HasSubstr("at byte 84: the file has no facets"));
  EXPECT_THAT(what(std::string(83, '\0')), testing::HasSubstr("at byte 83: the file ends in the header"));
  std::string infinite(134, '\0');
  infinite[80] = 1;
  infinite[84 + 12 + 2] = '\x80';
  infinite[84 + 12 + 3] = '\x7f';
  EXPECT_THAT(what(infinite), testing::HasSubstr("at byte 96: a coordinate is not finite"));
}

TEST(Stl, hostile_files) {
  for (const HostileCase& expected : std::vector<HostileCase>{
           {"s01_count_lies.stl", 0, "at byte 80: the header counts [0-9]+ facets"},
           {"s02_binary_named_solid_valid.stl", 1},
           {"t01_trimesh_busted.stl", 3878},
       })
    expect_treated_as(read_stl, expected);
}

TEST(Stl, survives_damage) {
  survive_damage(read_stl, ascii, 1500);
  survive_damage(read_stl, bytes_of(hostile_file("s02_binary_named_solid_valid.stl")), 1500);
}

TEST(Stl, reads_real_meshes) {
  if (!std::filesystem::exists(shared_file("scenes/meshes"))) GTEST_SKIP() << "no shared data";
  expect_mesh(read_stl, {"snake_river.stl", 20520, 0, 20520});
  expect_mesh(read_stl, {"ultimaker_robot.stl", 187974, 0, 187974});
}

}  // namespace
}  // namespace raymeter
