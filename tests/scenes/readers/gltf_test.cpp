#include "tests/scenes/readers/reader_testing.h"

namespace raymeter {
namespace {

SceneData read(std::string_view content) {
  return read_text(read_gltf, content);
}
std::string what(const std::string& content) {
  return complaint_about_text(read_gltf, content);
}

template <class T>
void put(std::string& bytes, std::initializer_list<T> values) {
  for (const T value : values) bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8u | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (unsigned k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63u];
  }
  return text;
}

/// Four corners of a square of side 2 with normals, interleaved, then indices of one, two and four bytes.
std::string square_bytes() {
  std::string bytes;
  for (const auto& [x, y] : std::vector<std::array<float, 2>>{{0, 0}, {2, 0}, {2, 2}, {0, 2}})
    put<float>(bytes, {x, y, 0, 0, 0, 1});
  put<std::uint8_t>(bytes, {0, 1, 2, 0, 2, 3, 0, 0});
  put<std::uint16_t>(bytes, {0, 1, 3, 2});
  put<std::uint32_t>(bytes, {0, 1, 2, 3});
  return bytes;
}

const std::string views =
    R"("bufferViews": [{"buffer": 0, "byteLength": 96, "byteStride": 24}, {"buffer": 0, "byteOffset": 96, "byteLength": 32}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
 {"bufferView": 0, "byteOffset": 12, "componentType": 5126, "count": 4, "type": "VEC3"},
 {"bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR"},
 {"bufferView": 1, "byteOffset": 8, "componentType": 5123, "count": 4, "type": "SCALAR"},
 {"bufferView": 1, "byteOffset": 16, "componentType": 5125, "count": 4, "type": "SCALAR"}])";

std::string document(const std::string& buffer, const std::string& rest) {
  return R"({"asset": {"version": "2.0"}, "buffers": [{)" + buffer + R"("byteLength": 128}], )" + views +
         ", " + rest + "}";
}
std::string embedded(const std::string& rest) {
  return document(R"("uri": "data:application/octet-stream;base64,)" + base64(square_bytes()) + R"(", )",
                  rest);
}
const std::string one_mesh =
    R"("meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}]}])";
const std::string square = R"("scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], )" + one_mesh;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(Gltf, reads_indexed_triangles_strips_and_fans) {
  const SceneData data = read(embedded(
      R"("nodes": [{"mesh": 0}], "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1]},
 "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.75}}}], "meshes": [{"primitives": [
 {"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}, {"attributes": {"POSITION": 0}, "indices": 3, "mode": 5},
 {"attributes": {"POSITION": 0}, "indices": 4, "mode": 6, "material": 0}, {"attributes": {"POSITION": 0}, "mode": 6},
 {"attributes": {"POSITION": 0}, "mode": 1}]}])"));
  ASSERT_EQ(data.triangles.size(), 8u);
  EXPECT_EQ(doubled_area(data), 4 * 8);
  EXPECT_THAT(data.triangle_materials, testing::ElementsAre(0, 0, 0, 0, 1, 1, 0, 0));
  EXPECT_EQ(data.materials[1].colour, (Vec3{1, .5f, 0}));
  EXPECT_EQ(data.materials[1].transmittance, .75f);
  EXPECT_EQ(data.normals[data.triangle_normals[0][2]], (Vec3{0, 0, 1}));
  EXPECT_EQ(data.triangle_normals[2][0], SceneData::no_normal);
  EXPECT_THAT(data.warnings, testing::ElementsAre(testing::HasSubstr("dropped 1 mesh primitives")));
  // A strip keeps its sense of rotation.
  for (std::size_t i = 2; i < 4; ++i) {
    const auto& [a, b, c] = data.triangles[i];
    EXPECT_GT(cross(data.vertices[b] - data.vertices[a], data.vertices[c] - data.vertices[a]).z, 0);
  }
}

TEST(Gltf, places_meshes_by_their_nodes) {
  // A quarter turn about z, scaled and moved, below a node with a matrix that mirrors x.
  const SceneData data = read(embedded(
      R"("scene": 1, "scenes": [{"nodes": []}, {"nodes": [2, 0]}], "nodes": [{"children": [1],
 "matrix": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 10,20,30,1]}, {"mesh": 0, "translation": [1, 2, 3], "rotation": [0, 0, 1, 1],
 "scale": [2, 3, 4]}, {"mesh": 0}, {"mesh": 7}], )" +
      one_mesh));
  ASSERT_EQ(data.triangles.size(), 4u);
  EXPECT_EQ(data.vertices[1], (Vec3{2, 0, 0}));
  // (2, 2, 0) -> scaled (4, 6, 0) -> turned (-6, 4, 0) -> moved (-5, 6, 3) -> (15, 26, 33)
  EXPECT_EQ(data.vertices[6], (Vec3{15, 26, 33}));
  EXPECT_EQ(data.normals[6], (Vec3{0, 0, 1}));
}

TEST(Gltf, reads_files_beside_it_and_binary_ones) {
  const std::uint64_t hash = scene_of(read(embedded(square))).hash();
  const TemporaryFile buffer("a buffer.bin", square_bytes());
  std::string uri = buffer.path().filename().string();
  uri = replaced(uri, " ", "%20");
  EXPECT_EQ(scene_of(read(document(R"("uri": ")" + uri + R"(", )", square))).hash(), hash);

  const auto binary = [](std::string json, const std::string& chunk) {
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string bytes = "glTF";
    put<std::uint32_t>(bytes, {2, static_cast<std::uint32_t>(28 + json.size() + chunk.size()),
                               static_cast<std::uint32_t>(json.size()), 0x4E4F534A});
    bytes += json;
    put<std::uint32_t>(bytes, {static_cast<std::uint32_t>(chunk.size()), 0x004E4942});
    return bytes + chunk;
  };
  const std::string glb = binary(document("", square), square_bytes());
  EXPECT_EQ(scene_of(read(glb)).hash(), hash);
  EXPECT_THAT(what(glb.substr(0, glb.size() - 1)), testing::HasSubstr("at byte 8: the header counts"));
  EXPECT_THAT(what(binary("{", "")), testing::ContainsRegex("at byte 2[0-9]: parse error"));
  survive_damage(read_gltf, glb, 1500);
}

TEST(Gltf, refuses_with_the_place) {
  const std::string good = embedded(square);
  EXPECT_EQ(what(good), "");
  EXPECT_THAT(what(""), testing::HasSubstr("at byte 0: parse error"));
  EXPECT_THAT(what("[1, 2"), testing::HasSubstr("at byte 5: parse error"));
  EXPECT_THAT(what("{\"asset\": {\"version\": 1e999}}"), testing::HasSubstr("overflow"));
  EXPECT_THAT(what("[]"), testing::HasSubstr(": /: it is no object"));
  EXPECT_THAT(what("{}"), testing::HasSubstr(": /: it has no asset"));
  const auto changed = [&](const std::string& from, const std::string& to) {
    return what(replaced(good, from, to));
  };
  EXPECT_THAT(changed("2.0", "1.0"), testing::HasSubstr("/asset/version: version \"1.0\""));
  EXPECT_THAT(changed("\"asset\"", "\"extensionsRequired\": [\"KHR_draco_mesh_compression\"], \"asset\""),
              testing::HasSubstr("/extensionsRequired/0: the extension"));
  EXPECT_THAT(changed("\"scene\": 0", "\"scene\": 1"),
              testing::HasSubstr("/scene: it names number 1 of 1 scenes"));
  EXPECT_THAT(changed("\"nodes\": [0]", "\"nodes\": [0, 0]"),
              testing::HasSubstr("/scenes/0/nodes/1: node 0 is in the graph twice"));
  EXPECT_THAT(changed("\"nodes\": [0]", "\"nodes\": [-1]"),
              testing::HasSubstr("/scenes/0/nodes/0: it is no whole number"));
  EXPECT_THAT(changed("{\"mesh\": 0}", "{\"children\": [0]}"),
              testing::HasSubstr("/nodes/0/children/0: node 0 is in the graph twice"));
  EXPECT_THAT(changed("{\"mesh\": 0}", "{\"scale\": [1, 1], \"mesh\": 0}"),
              testing::HasSubstr("/nodes/0/scale: it has 2 numbers"));
  EXPECT_THAT(changed("{\"mesh\": 0}", "{\"rotation\": [0, 0, 0, 0], \"mesh\": 0}"),
              testing::HasSubstr("/nodes/0/rotation: the quaternion"));
  EXPECT_THAT(changed("{\"mesh\": 0}", "{\"scale\": [1e39, 1, 1], \"mesh\": 0}"),
              testing::HasSubstr("/nodes/0: vertex 1 of its mesh is not finite"));
  EXPECT_THAT(changed("\"count\": 4", "\"count\": 5"),
              testing::HasSubstr("/accessors/0: 5 elements of 12 bytes"));
  EXPECT_THAT(changed("\"count\": 4", "\"count\": 18446744073709551615"),
              testing::HasSubstr("/accessors/0: 18446744073709551615 elements"));
  EXPECT_THAT(changed("\"byteOffset\": 12", "\"byteOffset\": 18446744073709551615"),
              testing::HasSubstr("/accessors/1: 4 elements"));
  EXPECT_THAT(changed("\"count\": 4", "\"sparse\": {}, \"count\": 4"),
              testing::HasSubstr("/accessors/0: sparse"));
  EXPECT_THAT(changed("\"byteStride\": 24", "\"byteStride\": 8"),
              testing::HasSubstr("/bufferViews/0: byteStride 8"));
  EXPECT_THAT(changed("\"byteLength\": 96", "\"byteLength\": 18446744073709551615"),
              testing::HasSubstr("/bufferViews/0: "));
  EXPECT_THAT(changed("\"byteLength\": 128", "\"byteLength\": 129"),
              testing::HasSubstr("/buffers/0: the buffer should have 129 bytes but has 128"));
  EXPECT_THAT(changed(";base64,", ";base64,*"),
              testing::HasSubstr("/buffers/0/uri: the data URI is malformed"));
  EXPECT_THAT(changed("\"count\": 6", "\"count\": 7"),
              testing::HasSubstr("/meshes/0/primitives/0: 7 corners"));
  EXPECT_THAT(changed("\"indices\": 2", "\"indices\": 0"), testing::HasSubstr("/accessors/0: its type"));
  EXPECT_THAT(changed("\"indices\": 2", "\"mode\": 5, \"material\": 0"),
              testing::HasSubstr("/meshes/0/primitives/0/material: it names number 0 of 0 materials"));
  for (const char* uri :
       {"../x.bin", "/etc/passwd", "http://example.org/x.bin", "a/../../x.bin", "%2e%2e/x.bin"})
    EXPECT_THAT(what(document("\"uri\": \"" + std::string(uri) + "\", ", square)),
                testing::HasSubstr("/buffers/0/uri: \"" + std::string(uri) + "\" is no file in the folder"));
  // Indices beyond the vertices.
  std::string bytes = square_bytes();
  bytes[97] = 4;
  EXPECT_THAT(what(document("\"uri\": \"data:;base64," + base64(bytes) + "\", ", square)),
              testing::HasSubstr("/meshes/0/primitives/0/indices: index 1 names vertex 4 of 4"));
}

TEST(Gltf, many_nodes) {
  // A chain, deep enough to overflow a stack, and more copies of a mesh than are accepted.
  std::string chain = R"("scenes": [{"nodes": [0]}], "nodes": [)";
  for (int i = 1; i < 100000; ++i) chain += "{\"children\": [" + std::to_string(i) + "]}, ";
  EXPECT_EQ(read(embedded(chain + "{\"mesh\": 0}], " + one_mesh)).triangles.size(), 2u);
  EXPECT_THAT(what(std::string(1000000, '[')), testing::HasSubstr("at byte "));

  std::string lines = R"({"asset": {"version": "2.0"}, "buffers": [{"uri": "data:;base64,)" +
                      base64(std::string(60000, '\0')) +
                      R"(", "byteLength": 60000}], "bufferViews": [{"buffer": 0, "byteLength": 60000}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 1, "type": "VEC3"},
 {"bufferView": 0, "componentType": 5121, "count": 60000, "type": "SCALAR"}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 5}]}], "nodes": [{"mesh": 0})";
  for (int i = 0; i < 1000; ++i) lines += ", {\"mesh\": 0}";
  EXPECT_THAT(what(lines + "]}"),
              testing::HasSubstr("/meshes/0/primitives/0: with it the scene has more than 16777216"));
}

TEST(Gltf, hostile_files) {
  for (const HostileCase& expected : std::vector<HostileCase>{
           {"g01_missing_buffer.gltf", 0, "/buffers/0/uri: there is no file .does_not_exist.bin"},
           {"g02_accessor_past_end_node_cycle.gltf", 0, "/accessors/0: [0-9]+ elements"},
       })
    expect_treated_as(read_gltf, expected);
}

TEST(Gltf, survives_damage) {
  survive_damage(read_gltf, embedded(square), 2000);
}

TEST(Gltf, reads_real_meshes) {
  if (!std::filesystem::exists(shared_file("scenes/meshes"))) GTEST_SKIP() << "no shared data";
  expect_mesh(read_gltf, {"terrarium-robots/scene.gltf", 55682, 44381, 55682});
}

}  // namespace
}  // namespace raymeter
