#include "tests/scenes/readers/reader_testing.h"

namespace raymeter {
namespace {

SceneData read(std::string_view content) {
  return read_text(read_obj, content);
}

TEST(Obj, reads_faces_of_every_form) {
  const SceneData data = read(
      "# a comment\nmtllib none.mtl\no thing\nv 0 0 0\nv 2 0 0 0.5 0.5 0.5\nv 2 2 0 1.0\nvt 0 0\nvn 0 0 "
      "1\nvn 0 0 0\n"
      "g a\nusemtl b\ns off\nf 1 2 3\nf 1/1 2/1 3/1 # here\nf 1//1 2//1 3//1\nf 1/1/1 2/1/1 3/1/-2\n"
      "f 1//1 2//1 3//2\nf 1//1 2 3\nv 0 2 0\nf -4 -3 \\\n -2 -1\nl 1 2\nf 1 2\n");
  EXPECT_EQ(data.vertices.size(), 4u);
  ASSERT_EQ(data.triangles.size(), 8u);
  EXPECT_EQ(data.shapes, 7u);
  EXPECT_EQ(doubled_area(data), 6 * 4 + 8);
  constexpr std::array with{0u, 0u, 0u},
      without{SceneData::no_normal, SceneData::no_normal, SceneData::no_normal};
  EXPECT_THAT(data.triangle_normals,
              testing::ElementsAre(without, without, with, with, without, without, without, without));
  EXPECT_THAT(data.warnings, testing::ElementsAre(testing::HasSubstr("dropped 1 faces"),
                                                  testing::HasSubstr("ignored 1 statements")));
  EXPECT_NO_THROW(scene_of(data));
}

TEST(Obj, line_ends) {
  const std::string unix_lines = bytes_of(hostile_file("o07_ngon_concave_valid.obj"));
  const std::uint64_t hash = scene_of(read(unix_lines)).hash();
  for (const char* end : {"\r\n", "\r"}) {
    std::string changed;
    for (const char c : unix_lines) changed += c == '\n' ? std::string(end) : std::string(1, c);
    EXPECT_EQ(scene_of(read(changed)).hash(), hash);
  }
}

TEST(Obj, refuses_with_the_line) {
  EXPECT_THAT(complaint_about_text(read_obj, "v 0 0\nv 0 0 0\n"),
              testing::HasSubstr(":1: expected a coordinate of a vertex (v), found the end of the line"));
  EXPECT_THAT(complaint_about_text(read_obj, "v 0 0 0\nf 1 1/x 1\n"),
              testing::HasSubstr(":2: expected texture vertex, found \"x\""));
  EXPECT_THAT(complaint_about_text(read_obj, "v 0 0 0\nf 1 1//1 1\n"),
              testing::HasSubstr(":2: normal 1, but there are 0 so far"));
  EXPECT_THAT(complaint_about_text(read_obj, "v 0 0 0\nf 1 1/1/1/1 1\n"), testing::HasSubstr(":2: "));
  EXPECT_THAT(complaint_about_text(read_obj, "v 0 0 0\nvolume 1\n"),
              testing::HasSubstr(":2: unknown keyword"));
  EXPECT_THAT(complaint_about_text(read_obj, "v 0 0 0\n"), testing::HasSubstr(":2: the file has no faces"));
  EXPECT_THAT(complaint_about_text(read_obj, ""), testing::HasSubstr(":1: the file has no faces"));
}

TEST(Obj, hostile_files) {
  for (const HostileCase& expected : std::vector<HostileCase>{
           {"o01_index_out_of_range.obj", 0, "10: vertex 99999999, but there are 8"},
           {"o02_index_overflow.obj", 0, "[0-9]+: vertex.* is beyond the range of integers"},
           {"o03_nan_inf_vertices.obj", 0, "9: expected a coordinate of a vertex .v., found .nan"},
           {"o04_all_same_point.obj", 1000},
           {"o05_dup_triangles.obj", 20000},
           {"o07_ngon_concave_valid.obj", 5},
           {"o08_mixed_scale.obj", 9804},
       })
    expect_treated_as(read_obj, expected);
  EXPECT_EQ(doubled_area(read_obj(hostile_file("o07_ngon_concave_valid.obj"))), 6 + 2);
}

TEST(Obj, survives_damage) {
  survive_damage(read_obj, bytes_of(hostile_file("o07_ngon_concave_valid.obj")), 3000);
}

TEST(Obj, reads_real_meshes) {
  if (!std::filesystem::exists(shared_file("scenes/meshes"))) GTEST_SKIP() << "no shared data";
  for (const MeshCase& expected : std::vector<MeshCase>{
           {"buildings.obj", 400020, 200062, 400020},
           {"bush.obj", 40292, 26710, 20972},
           {"ficustree.obj", 118876, 74813, 87438},
           {"oa_dm1.obj", 7532, 8284, 7532},
           {"oa_minia.obj", 35385, 30591, 35385},
           {"peterbilt.obj", 116501, 57967, 52453},
           {"spot.obj", 5856, 2930, 5856},
       })
    expect_mesh(read_obj, expected);
}

}  // namespace
}  // namespace raymeter
