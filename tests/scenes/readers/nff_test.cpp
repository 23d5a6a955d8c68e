#include "tests/scenes/readers/reader_testing.h"

namespace raymeter {
namespace {

const std::string view = "v\nfrom 0 -5 2\nat 0 0 0\nup 0 0 1\nangle 40\nhither 1\nresolution 64 48\n";

SceneData read(std::string_view content) {
  return read_text(read_nff, content);
}

TEST(Nff, reads_every_entity) {
  const SceneData data =
      read("b 0.1 0.2 0.3\n" + view +
           "l 1 2 3\nl 4 5 6 1 .5 .25\ns 0 0 0 2\nf 1 .5 0 .8 .2 20 .5 0\ns 1 2 3 -4\nc\n0 0 0 1\n0 0 1 .5\n"
           "f 0 1 0 1 0 0 0 1.5\nc 0 0 0 1 0 0 1 1\np 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
           "pp 3 0 0 0 0 0 1  1 0 0 0 0 1  0 1 0 0 1 1 # end");
  EXPECT_EQ(data.background, (Vec3{0.1f, 0.2f, 0.3f}));
  ASSERT_TRUE(data.camera);
  EXPECT_EQ(data.camera->from, (Vec3{0, -5, 2}));
  EXPECT_EQ(data.camera->up, (Vec3{0, 0, 1}));
  EXPECT_EQ(data.camera->angle, 40);
  EXPECT_EQ(data.camera->width, 64u);
  EXPECT_EQ(data.camera->height, 48u);
  ASSERT_EQ(data.lights.size(), 2u);
  EXPECT_EQ(data.lights[0].colour, (Vec3{1, 1, 1}));
  EXPECT_EQ(data.lights[1].position, (Vec3{4, 5, 6}));
  EXPECT_EQ(data.lights[1].colour, (Vec3{1, .5f, .25f}));

  ASSERT_EQ(data.quadrics.size(), 4u);
  EXPECT_EQ(data.quadrics[0].kind, QuadricKind::sphere);
  EXPECT_EQ(data.quadrics[1].base, (Vec3{1, 2, 3}));
  EXPECT_EQ(data.quadrics[1].base_radius, 4);
  EXPECT_EQ(data.quadrics[2].kind, QuadricKind::cone);
  EXPECT_EQ(data.quadrics[2].apex, (Vec3{0, 0, 1}));
  EXPECT_EQ(data.quadrics[2].apex_radius, .5f);
  EXPECT_EQ(data.quadrics[3].kind, QuadricKind::cylinder);
  EXPECT_EQ(data.shapes, 6u);

  // Material 0 is the default one of the sphere before the first fill.
  ASSERT_EQ(data.materials.size(), 3u);
  EXPECT_EQ(data.materials[1].colour, (Vec3{1, .5f, 0}));
  EXPECT_EQ(data.materials[1].diffuse, .8f);
  EXPECT_EQ(data.materials[1].specular, .2f);
  EXPECT_EQ(data.materials[1].shine, 20);
  EXPECT_EQ(data.materials[1].transmittance, .5f);
  EXPECT_EQ(data.materials[1].refraction_index, 0);
  EXPECT_THAT(data.quadric_materials, testing::ElementsAre(0, 1, 1, 2));

  ASSERT_EQ(data.triangles.size(), 3u);
  EXPECT_EQ(doubled_area(data), 3);
  EXPECT_THAT(data.triangle_materials, testing::ElementsAre(2, 2, 2));
  ASSERT_EQ(data.triangle_normals.size(), 3u);
  EXPECT_EQ(data.triangle_normals[0][0], SceneData::no_normal);
  EXPECT_EQ(data.normals[data.triangle_normals[2][2]], (Vec3{0, 1, 1}));
}

TEST(Nff, white_space_is_free) {
  const std::string plain =
      view + "b 1 1 1\nl 1 2 3 1 1 1\nf 1 1 1 1 0 0 0 1\nc\n0 0 0 1\n0 0 1 1\np 3\n0 0 0\n1 0 0\n0 1 0\n";
  const std::uint64_t hash = scene_of(read(plain)).hash();
  for (const auto& [from, to] : {std::pair("\n", "\r\n"), std::pair("\n", "\r"), std::pair(" ", "\t"),
                                 std::pair(" ", " \n "), std::pair("\n", " # comment v s p\n")}) {
    std::string changed;
    for (const char c : plain)
      changed += std::string_view(from)[0] == c ? std::string(to) : std::string(1, c);
    EXPECT_EQ(scene_of(read(changed)).hash(), hash) << changed;
    changed.resize(changed.find_last_of('0') + 1);
    EXPECT_EQ(scene_of(read(changed)).hash(), hash) << "without a line end";
  }
}

TEST(Nff, refuses_with_the_line) {
  EXPECT_THAT(complaint_about_text(read_nff, view + "c 0 0 0 1 0 0 1 -1\n"),
              testing::HasSubstr(":8: radii of opposite sign"));
  EXPECT_THAT(complaint_about_text(read_nff, view + view), testing::HasSubstr(":8: a second view"));
  EXPECT_THAT(complaint_about_text(read_nff, "\nv\nfrom 0 0 0\nat 0 0 1\nup 0 1 0\nangle 40\n"),
              testing::HasSubstr(":2: the view (v) has no resolution"));
  EXPECT_THAT(complaint_about_text(read_nff, view + "l 1 2 3 1 1\ns 0 0 0 1"),
              testing::HasSubstr(":9: expected a number of a light's colour"));
  EXPECT_THAT(complaint_about_text(read_nff, "v angle 180"), testing::HasSubstr(":1: angle 180"));
  EXPECT_THAT(complaint_about_text(read_nff, "v resolution 64 0"), testing::HasSubstr(":1: resolution 0"));
  EXPECT_THAT(complaint_about_text(read_nff, "v resolution 64 6.5"),
              testing::HasSubstr("expected the view's resolution, found \"6.5\""));
  EXPECT_THAT(complaint_about_text(read_nff, "v from 0 0 0 from 0 0 0"),
              testing::HasSubstr(":1: \"from\" twice"));
  EXPECT_THAT(complaint(read_nff, std::filesystem::path("/no/such.nff")), testing::HasSubstr("no such file"));
}

TEST(Nff, hostile_files) {
  for (const HostileCase& expected : std::vector<HostileCase>{
           {"n01_empty.nff", 0, "1: no view"},
           {"n02_no_objects.nff", 0},
           {"n03_nan_sphere.nff", 0, "11: expected a coordinate of a sphere's centre .s., found .nan"},
           {"n04_inf_values.nff", 0, "11: expected a sphere's radius, found .inf"},
           {"n05_radius_zero_negative.nff", 3},
           {"n06_cone_coincident_ends.nff", 2},
           {"n07_cone_apex_larger.nff", 2},
           {"n08_polygon_truncated.nff", 0, "11: a polygon of 5 vertices, but the file has only"},
           {"n09_polygon_bad_counts.nff", 0, "11: a polygon of 2 vertices"},
           {"n10_polygon_huge_count.nff", 0, "11: a polygon of 2147483647 vertices"},
           {"n11_polygon_degenerate.nff", 5},
           {"n12_view_degenerate.nff", 0, "2: the view's from and at"},
           {"n13_view_up_parallel.nff", 0, "2: the view's up"},
           {"n14_resolution_huge.nff", 1},
           {"n16_unknown_directive.nff", 0, "12: unknown entity .box"},
           {"n17_coords_1e30.nff", 2},
           {"n18_coords_1e-40.nff", 2},
           {"n19_syntax_zoo_valid.nff", 4},
           {"n21_garbage.nff", 0, "1: unknown entity"},
           {"n22_long_line.nff", 1},
           {"n23_coincident_spheres.nff", 5000},
           {"n24_flat_plane.nff", 3600},
           {"n25_mirror_room.nff", 3},
       })
    expect_treated_as(read_nff, expected);
}

TEST(Nff, hostile_files_in_detail) {
  const Scene zero_radius = scene_of(read_nff(hostile_file("n05_radius_zero_negative.nff")));
  EXPECT_EQ(zero_radius.primitive_count(), 2u);
  EXPECT_THAT(zero_radius.warnings(), testing::ElementsAre(testing::HasSubstr("dropped 1 quadrics")));
  EXPECT_EQ(scene_of(read_nff(hostile_file("n06_cone_coincident_ends.nff"))).primitive_count(), 1u);
  EXPECT_EQ(scene_of(read_nff(hostile_file("n18_coords_1e-40.nff"))).primitive_count(), 1u);
  // The quad whose first three vertices are on a line has an area of 2.
  const SceneData quad = read_nff(hostile_file("n11_polygon_degenerate.nff"));
  EXPECT_EQ(doubled_area(quad), 4);
  const SceneData zoo = read_nff(hostile_file("n19_syntax_zoo_valid.nff"));
  ASSERT_EQ(zoo.lights.size(), 1u);
  EXPECT_EQ(zoo.lights[0].colour, (Vec3{1, .9f, .8f}));
}

TEST(Nff, survives_damage) {
  survive_damage(read_nff, bytes_of(hostile_file("n19_syntax_zoo_valid.nff")), 2000);
  survive_damage(read_nff, bytes_of(hostile_file("n11_polygon_degenerate.nff")), 1000);
}

TEST(Nff, reads_the_standard_procedural_databases) {
  if (!std::filesystem::exists(shared_file("scenes/spd"))) GTEST_SKIP() << "no shared data";
  for (const SharedCase& expected : std::vector<SharedCase>{
           {"spd/small/balls3.nff", 2, 820, 821},
           {"spd/small/gears2.nff", 1153 * 2 + 16 * 142, 0, 1169},
           {"spd/small/jacks3.nff", 0, 657, 657},
           {"spd/small/lattice6.nff", 0, 1225, 1225},
           {"spd/small/mount4.nff", 512, 4, 516},
           {"spd/small/nurbtst.nff", 1500, 0, 1500},
           {"spd/small/rings3.nff", 2, 840, 841},
           {"spd/small/sample.nff", 0, 1, 881},
           {"spd/small/sombrero1.nff", 1922, 0, 1922},
           {"spd/small/teapot4.nff", 0, 0, 1008},
           {"spd/small/tetra5.nff", 1024, 0, 1024},
           {"spd/small/tree8.nff", 2, 1022, 1023},
           {"spd/standard/balls4.nff", 2, 7381, 7382},
           {"spd/standard/gears4.nff", 9217 * 2 + 128 * 142, 0, 9345},
           {"spd/standard/jacks4.nff", 0, 5265, 5265},
           {"spd/standard/lattice12.nff", 0, 8281, 8281},
           {"spd/standard/mount6.nff", 8192, 4, 8196},
           {"spd/standard/rings7.nff", 2, 8400, 8401},
           {"spd/standard/sombrero2.nff", 7938, 0, 7938},
           {"spd/standard/teapot12.nff", 0, 0, 9264},
           {"spd/standard/tetra6.nff", 4096, 0, 4096},
           {"spd/standard/tree11.nff", 2, 8190, 8191},
           {"quadrics/il2_ballstick.nff", 0, 4719, 4719},
           {"quadrics/teapot12_stadium500.nff", 0, 0, 9264},
           {"quadrics/waterbox_ballstick.nff", 0, 1427, 1427},
       }) {
    SCOPED_TRACE(expected.file);
    const SceneData data = read_nff(shared_file(std::string("scenes/") + expected.file));
    EXPECT_EQ(data.quadrics.size(), expected.quadrics);
    EXPECT_EQ(data.shapes, expected.shapes);
    if (expected.triangles) {
      EXPECT_EQ(data.triangles.size(), expected.triangles);
    } else if (!data.triangles.empty()) {  // patches of three corners and the floor's quads
      EXPECT_EQ(data.vertices.size() - 2 * (data.shapes - expected.quadrics), data.triangles.size());
    }
    EXPECT_NO_THROW(scene_of(data));
  }
}

}  // namespace
}  // namespace raymeter
