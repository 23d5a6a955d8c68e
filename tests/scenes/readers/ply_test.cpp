#include "tests/scenes/readers/reader_testing.h"

namespace raymeter {
namespace {

SceneData read(std::string_view content) {
  return read_text(read_ply, content);
}

const std::string ascii =
    "ply\nformat ascii 1.0\ncomment made by hand\nobj_info none\nelement vertex 6\nproperty float x\n"
    "property double y\nproperty uchar red\nproperty list uchar short tags\nproperty float32 z\n"
    "element camera 1\nproperty float fov\nproperty list int8 float64 numbers\n"
    "element face 4\nproperty uchar flags\nproperty list uchar int vertex_index\nproperty list uint8 uint8 "
    "more\n"
    "end_header\n"
    "0 0 255 0 0\n2 0 255 1 7 0\n2 1 255 2 7 8 0\n1 1 255 0 0\n1 2 255 0 0\n0 2 255 0 0\n"
    "45 2 1.5 2.5\n"
    "0 6 2 3 4 5 0 1 0\n1 3 0 1 2 2 9 9\n0 2 0 1 0\n0 4 0 1 2 5 0";

/// A binary file of a square as two triangles or one quad, with normals.
class Binary {
 public:
  explicit Binary(bool big_endian) : big_endian_(big_endian) {
    bytes_ = std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
             "_endian 1.0\nelement vertex 4\nproperty float x\nproperty short y\nproperty double z\n"
             "property char nx\nproperty float ny\nproperty float nz\nproperty list ushort double extra\n"
             "element face 2\nproperty list uint ushort vertex_indices\nproperty uint id\nend_header\n";
    for (const auto& [x, y] : std::vector<std::array<int, 2>>{{0, 0}, {3, 0}, {3, 2}, {0, 2}}) {
      put(static_cast<float>(x));
      put(static_cast<std::int16_t>(y));
      put(5.0);
      put(std::int8_t{0});
      put(0.0f);
      put(1.0f);
      put(static_cast<std::uint16_t>(x));
      for (int i = 0; i < x; ++i) put(1e300);
    }
    put(4u);
    for (std::uint16_t i = 0; i < 4; ++i) put(i);
    put(1u);
    put(3u);
    for (const int i : {0, 2, 3}) put(static_cast<std::uint16_t>(i));
    put(2u);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  template <class T>
  void put(T value) {
    std::array<char, sizeof(T)> raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (big_endian_ != (std::endian::native == std::endian::big)) std::ranges::reverse(raw);
    bytes_.append(raw.data(), raw.size());
  }

  bool big_endian_;
  std::string bytes_;
};

TEST(Ply, reads_ascii) {
  const SceneData data = read(ascii);
  EXPECT_EQ(data.vertices.size(), 6u);
  EXPECT_EQ(data.vertices[2], (Vec3{2, 1, 0}));
  EXPECT_EQ(data.shapes, 3u);
  ASSERT_EQ(data.triangles.size(), 4u + 1 + 2);
  EXPECT_EQ(doubled_area(data), 6 + 2 + 6);
  EXPECT_TRUE(data.triangle_normals.empty());
  EXPECT_THAT(data.warnings, testing::ElementsAre(testing::HasSubstr("dropped 1 faces")));
}

TEST(Ply, line_ends) {
  const std::uint64_t hash = scene_of(read(ascii)).hash();
  for (const char* end : {"\r\n", "\r"}) {
    std::string changed;
    for (const char c : ascii) changed += c == '\n' ? std::string(end) : std::string(1, c);
    EXPECT_EQ(scene_of(read(changed)).hash(), hash);
  }
}

TEST(Ply, reads_binary) {
  const Scene little = scene_of(read(Binary(false).bytes())), big = scene_of(read(Binary(true).bytes()));
  EXPECT_EQ(little.hash(), big.hash());
  EXPECT_EQ(little.triangle_count(), 3u);
  EXPECT_EQ(little.shape_count(), 2u);
  EXPECT_EQ(little.triangle(1).c, (Vec3{0, 2, 5}));
  ASSERT_EQ(little.triangle_normals().size(), 3u);
  EXPECT_EQ(little.normals()[little.triangle_normals()[0][0]], (Vec3{0, 0, 1}));
}

TEST(Ply, refuses_with_the_place) {
  const std::string head = "ply\nformat ascii 1.0\n",
                    vertex = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n",
                    face = "element face 1\nproperty list uchar int vertex_indices\n",
                    points = "0 0 0 1 0 0 0 1 0\n";
  const auto what = [&](const std::string& text) { return complaint_about_text(read_ply, text); };
  EXPECT_THAT(what(""), testing::HasSubstr(":1: not a PLY file"));
  EXPECT_THAT(what("ply\n"), testing::HasSubstr(":2: the file ends in its header"));
  EXPECT_THAT(what("ply\nformat ascii 2.0\n"), testing::HasSubstr(":2: version"));
  EXPECT_THAT(what("ply\nproperty int x\n"), testing::HasSubstr(":2: a property before"));
  EXPECT_THAT(what("ply\nend_header\n"), testing::HasSubstr("names no format"));
  EXPECT_THAT(what(head + vertex + "property long w\n"), testing::HasSubstr(":7: unknown type \"long\""));
  EXPECT_THAT(what(head + vertex + "property list float int w\n"), testing::HasSubstr(":7: a list's length"));
  EXPECT_THAT(what(head + vertex + vertex), testing::HasSubstr(":7: a second element \"vertex\""));
  EXPECT_THAT(what(head + vertex + "end_header\n" + points), testing::HasSubstr("no faces"));
  EXPECT_THAT(what(head + face + vertex + "end_header\n3 0 1 2 " + points),
              testing::HasSubstr("before the vertices"));
  EXPECT_THAT(what(head + vertex + face + "end_header\n" + points + "3 0 1 3\n"),
              testing::HasSubstr(":11: vertex 3 of 3"));
  EXPECT_THAT(what(head + vertex + face + "end_header\n" + points + "3 0 1 -1\n"),
              testing::HasSubstr(":11: vertex -1 of 3"));
  EXPECT_THAT(what(head + vertex + face + "end_header\n" + points + "-3 0 1 1\n"),
              testing::HasSubstr(":11: a list of -3 items"));
  EXPECT_THAT(what(head + vertex + face + "end_header\n0 0 0 1 0 nan 0 1 0\n3 0 1 2\n"),
              testing::HasSubstr(":10: expected a number, found \"nan\""));
  EXPECT_THAT(
      what(
          head +
          "element vertex 1000000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n"),
      testing::HasSubstr("the header counts 1000000000000 of element"));
  EXPECT_THAT(what(head + vertex + "element nothing 1000000000000000\n" + face + "end_header\n" + points +
                   "3 0 1 2\n"),
              "");
}

TEST(Ply, hostile_files) {
  for (const HostileCase& expected : std::vector<HostileCase>{
           {"p01_truncated_binary.ply", 0, "at byte [0-9]+: the header counts 194908 of element .vertex"},
           {"p02_header_counts_lie.ply", 0, "at byte [0-9]+: the header counts 4294967295"},
           {"p04_face_index_oob.ply", 0, "at byte 227: vertex 2147483647 of 3"},
           {"p05_list_longer_than_file.ply", 0, "at byte [0-9]+: a list of 4000000000 items"},
           {"p06_big_endian_valid.ply", 1},
       })
    expect_treated_as(read_ply, expected);
}

TEST(Ply, survives_damage) {
  survive_damage(read_ply, ascii, 1500);
  survive_damage(read_ply, Binary(false).bytes(), 1000);
  survive_damage(read_ply, Binary(true).bytes(), 1000);
}

TEST(Ply, reads_real_meshes) {
  if (!std::filesystem::exists(shared_file("scenes/meshes"))) GTEST_SKIP() << "no shared data";
  for (const MeshCase& expected : std::vector<MeshCase>{
           {"bunny.ply", 69451, 35947, 69451},
           {"furniture_hall_a.ply", 1229109, 675360, 1229109},
           {"igbt_module.ply", 194708, 194908, 194708},
           {"jacksboro_dem.ply", 275772, 138632, 275772},
       })
    expect_mesh(read_ply, expected);
}

}  // namespace
}  // namespace raymeter
