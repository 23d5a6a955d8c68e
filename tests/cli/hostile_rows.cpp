#include "tests/cli/hostile_rows.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <fstream>

namespace raymeter {
namespace {

using Path = std::filesystem::path;

auto written(const std::function<std::string()>& content) {
  return [content](const Path& path) {
    const std::string bytes = content();
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  };
}
auto text(const std::string& content) {
  return written([content] { return content; });
}

std::string repeated(std::string_view part, std::size_t times) {
  std::string all;
  all.reserve(part.size() * times);
  for (std::size_t i = 0; i < times; ++i) all += part;
  return all;
}

const std::string view =
    "b 0.1 0.1 0.2\nv\nfrom 0 -5 2\nat 0 0 0\nup 0 0 1\nangle 40\nhither 0.01\nresolution 64 64\n"
    "l 5 -5 5\nf 0.8 0.7 0.6 0.8 0.2 20 0 1\n";
const std::string cube =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n";
const std::string ply_head =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n";

/// A sheet of 9801 triangles of 1e-6, above a floor of 2e6.
std::string mixed_scale() {
  std::string s = cube + "f 1 2 3\nf 1 3 4\n";
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) s += fmt::format("v {:g} {:g} 1\n", x * 1e-6, y * 1e-6);
  for (int y = 0; y < 99; ++y)
    for (int x = 0; x < 99; ++x) {
      const int corner = 9 + 100 * y + x;
      s += fmt::format("f {} {} {}\n", corner, corner + 1, corner + 100);
    }
  return s + "v -1e6 -1e6 -2\nv 1e6 -1e6 -2\nv 0 1e6 -2\nf -3 -2 -1\n";
}

/// Buffer, accessor and asset of so many vertices, 12 bytes each, given in base64.
std::string gltf_triangles(const std::string& base64, std::size_t vertices) {
  return fmt::format(R"("buffers":[{{"byteLength":{0},"uri":"data:application/octet-stream;base64,{1}"}}],)"
                     R"("bufferViews":[{{"buffer":0,"byteLength":{0}}}],)"
                     R"("accessors":[{{"bufferView":0,"componentType":5126,"count":{2},"type":"VEC3"}}],)"
                     R"("asset":{{"version":"2.0"}})",
                     12 * vertices, base64, vertices);
}
const std::string gltf_triangle = gltf_triangles("AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA", 3);
const std::string gltf_mesh = R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)";

/// Every node but the last has one child, and the last the mesh.
std::string node_chain(int nodes) {
  std::string s = "{" + gltf_mesh + R"("nodes":[)";
  for (int i = 1; i < nodes; ++i) s += fmt::format(R"({{"children":[{}],"scale":[1,1,1]}},)", i);
  return s + R"({"mesh":0}],"scenes":[{"nodes":[0]}],)" + gltf_triangle + "}";
}

std::string stl_of(std::uint32_t counted, std::size_t bytes) {
  std::string s(84 + bytes, '\0');
  for (std::size_t i = 0; i < 4; ++i) s[80 + i] = static_cast<char>((counted >> (8 * i)) & 0xffu);
  return s;
}

void make_fifo(const Path& path) {
  mkfifo(path.c_str(), 0600);
}
auto link_to(const char* target) {
  return [target](const Path& path) { std::filesystem::create_symlink(target, path); };
}

/// The set that came with the project's task.
std::vector<HostileRow> given_rows() {
  return {
      {.file = "n01_empty.nff", .refused = "1: no view"},
      {.file = "n02_no_objects.nff"},
      {.file = "n03_nan_sphere.nff", .refused = "11: .* found .nan"},
      {.file = "n04_inf_values.nff", .refused = "11: .* found .inf"},
      {.file = "n05_radius_zero_negative.nff", .primitives = 2, .primary_hits = 69, .random_hits = 90},
      {.file = "n06_cone_coincident_ends.nff", .primitives = 1, .primary_hits = 14, .random_hits = 85},
      {.file = "n07_cone_apex_larger.nff", .primitives = 2, .primary_hits = 66, .random_hits = 71},
      {.file = "n08_polygon_truncated.nff", .refused = "11: a polygon of 5 vertices, but the file has only"},
      {.file = "n09_polygon_bad_counts.nff", .refused = "11: a polygon of 2 vertices"},
      {.file = "n10_polygon_huge_count.nff", .refused = "11: a polygon of 2147483647 vertices"},
      {.file = "n11_polygon_degenerate.nff", .primitives = 5, .primary_hits = 32, .random_hits = 25},
      {.file = "n12_view_degenerate.nff", .refused = "2: the view's from and at are the same point"},
      {.file = "n13_view_up_parallel.nff", .refused = "2: the view's up is zero or parallel"},
      // Its picture is too large for `render`; rays here have a size of their own.
      {.file = "n14_resolution_huge.nff", .primitives = 1, .primary_hits = 52, .random_hits = 85},
      {.file = "n16_unknown_directive.nff", .refused = "12: unknown entity .box"},
      {.file = "n17_coords_1e30.nff",
       .primitives = 2,
       .primary_hits = 110,
       .random_hits = 65,
       .embree_refuses = "coordinates beyond 1.844e+18"},
      {.file = "n18_coords_1e-40.nff", .primitives = 1, .primary_hits = 52, .random_hits = 85},
      {.file = "n19_syntax_zoo_valid.nff", .primitives = 4, .primary_hits = 66, .random_hits = 95},
      {.file = "n21_garbage.nff", .refused = "1: unknown entity"},
      {.file = "n22_long_line.nff",
       .primitives = 1,
       .primary_hits = 56,
       .random_hits = 85,
       .make = written([] { return view + "s " + repeated("0", 1'000'000) + "1 0 0 1\n"; })},
      {.file = "n23_coincident_spheres.nff",
       .primitives = 5000,
       .primary_hits = 52,
       .random_hits = 85,
       .make = written([] { return view + repeated("s 0 0 0 1\n", 5000); })},
      {.file = "n24_flat_plane.nff", .primitives = 3600, .primary_hits = 94, .random_hits = 36},
      {.file = "n25_mirror_room.nff", .primitives = 3, .primary_hits = 256, .random_hits = 85},
      {.file = "o01_index_out_of_range.obj", .refused = "10: vertex 99999999, but there are 8"},
      {.file = "o02_index_overflow.obj", .refused = "9: vertex: .* is beyond the range of integers"},
      {.file = "o03_nan_inf_vertices.obj", .refused = "9: .* found .nan"},
      {.file = "o04_all_same_point.obj", .primitives = 1000},
      {.file = "o05_dup_triangles.obj",
       .primitives = 20000,
       .primary_hits = 7,
       .random_hits = 41,
       .make = written([] { return cube + repeated("f 1 2 7\n", 20000); })},
      {.file = "o07_ngon_concave_valid.obj", .primitives = 5, .primary_hits = 24, .random_hits = 55},
      {.file = "o08_mixed_scale.obj",
       .primitives = 9804,
       .primary_hits = 256,
       .random_hits = 46,
       .camera = "from=5e-5x5e-5x1.0005:at=5e-5x5e-5x1:angle=20",  // at the dust
       .make = written(mixed_scale)},
      {.file = "p01_truncated_binary.ply", .refused = "at byte 0: the header counts 194908"},
      {.file = "p02_header_counts_lie.ply", .refused = "at byte 0: the header counts 4294967295"},
      {.file = "p04_face_index_oob.ply", .refused = "at byte 227: vertex 2147483647 of 3"},
      {.file = "p05_list_longer_than_file.ply", .refused = "at byte 204: a list of 4000000000 items"},
      {.file = "p06_big_endian_valid.ply", .primitives = 1, .primary_hits = 16, .random_hits = 43},
      {.file = "s01_count_lies.stl", .refused = "at byte 80: the header counts 4000000000 facets"},
      {.file = "s02_binary_named_solid_valid.stl", .primitives = 1, .primary_hits = 16, .random_hits = 43},
      {.file = "g01_missing_buffer.gltf", .refused = "/buffers/0/uri: there is no file"},
      {.file = "g02_accessor_past_end_node_cycle.gltf", .refused = "/accessors/0: 1000000 elements"},
      {.file = "t01_trimesh_busted.stl", .primitives = 3878, .primary_hits = 34, .random_hits = 83},
  };
}

/// Kinds of trouble that the set lacks.
std::vector<HostileRow> further_rows() {
  return {
      // A million comments, and entities that nest nothing but look as if they would.
      {.file = "x01_comments.nff",
       .primitives = 1,
       .primary_hits = 52,
       .random_hits = 85,
       .make = written([] { return repeated("# # v { ( \r\n", 1'000'000) + view + "s 0 0 0 1 #"; })},
      {.file = "x02_open_brackets.gltf", .refused = "at byte 1000000: ", .make = written([] {
                                                                           return repeated("[", 1'000'000);
                                                                         })},
      {.file = "x03_nested_arrays.gltf", .refused = "/: it has no asset", .make = written([] {
                                                                            return R"({"extras":)" +
                                                                                   repeated("[", 1'000'000) +
                                                                                   repeated("]", 1'000'000) +
                                                                                   "}";
                                                                          })},
      {.file = "x04_nested_objects_valid.gltf",
       .primitives = 1,
       .primary_hits = 16,
       .random_hits = 43,
       .make = written([] {
         return R"({"extras":)" + repeated(R"({"a":)", 300'000) + "1" + repeated("}", 300'000) + "," +
                node_chain(1).substr(1);
       })},
      {.file = "x05_node_chain_valid.gltf",
       .primitives = 1,
       .primary_hits = 16,
       .random_hits = 43,
       .make = written([] { return node_chain(20'000); })},
      // One mesh of 10,000 triangles in 2,000 nodes: 500 kB that mean 20 million triangles.
      {.file = "x06_multiplied.gltf",
       .refused = "/meshes/0/primitives/0: with it the scene has more than 16777216",
       .make = written([] {
         return "{" + gltf_mesh + R"("nodes":[)" + repeated(R"({"mesh":0},)", 1'999) + R"({"mesh":0}],)" +
                gltf_triangles(std::string(480'000, 'A'), 30'000) + "}";
       })},
      {.file = "x07_negative_list.ply",
       .refused = "13: a list of -3 items",
       .make = text("ply\nformat ascii 1.0\n" + ply_head +
                    "property list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n")},
      {.file = "x08_negative_list_binary.ply",
       .refused = "at byte [0-9]+: a list of -3 items",
       .make = written([] {
         return "ply\nformat binary_little_endian 1.0\n" + ply_head +
                "property list char int vertex_indices\nend_header\n" + std::string(36, '\0') + "\xfd" +
                std::string(12, '\0');
       })},
      {.file = "x09_many_empty_elements.ply",
       .refused = "at byte [0-9]+: the file has no faces",
       .make =
           text("ply\nformat binary_little_endian 1.0\nelement nothing 9223372036854775807\nend_header\n")},
      {.file = "x10_long_face.obj",
       .refused = "10: a concave polygon of 5000004 corners",
       .make = written([] { return cube + "v 0.5 0 -1\nf 2 9 3 4" + repeated(" 1", 5'000'000) + "\n"; })},
      {.file = "x11_long_comment_valid.obj",
       .primitives = 1,
       .primary_hits = 7,
       .random_hits = 41,
       .make = written([] { return cube + "f 1 2 7 #" + repeated(" f 1 2", 1'700'000) + "\n"; })},
      {.file = "x12_truncated.stl",
       .refused = "at byte 80: the header counts 3 facets, which take 234 bytes, but the file has 200",
       .make = written([] { return stl_of(3, 116); })},
      {.file = "x13_truncated_header.stl",
       .refused = "at byte 40: the file ends in the header",
       .make = written([] { return std::string(40, '\0'); })},
      {.file = "x14_truncated_ascii.stl",
       .refused = "4: expected a coordinate of a vertex, found the end of the file",
       .make = text("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0")},
      {.file = "x15_empty.obj", .refused = "1: the file has no faces", .make = text("")},
      {.file = "x16_empty.ply", .refused = "1: not a PLY file", .make = text("")},
      {.file = "x17_empty.stl", .refused = "1: the file has no facets", .make = text("")},
      {.file = "x18_empty.gltf", .refused = "at byte 0: ", .make = text("")},
      {.file = "x19_empty.glb", .refused = "at byte 0: ", .make = text("")},
      {.file = "x20_unknown.xyz", .refused = "unknown kind of file", .make = text("0 0 0\n")},
      {.file = "x21_folder.obj",
       .refused = "a folder",
       .make = [](const Path& path) { std::filesystem::create_directory(path); }},
      {.file = "x22_fifo.ply", .refused = "not a file", .make = make_fifo},
      {.file = "x23_zeros.stl", .refused = "not a file", .make = link_to("/dev/zero")},
      {.file = "x24_dangling.nff", .refused = "no such file", .make = link_to("nowhere")},
      {.file = "x25_itself.nff", .refused = "no such file", .make = link_to("x25_itself.nff")},
      {.file = "x26_terabyte.obj",
       .refused = "1099511627776 bytes; the limit is 8 GiB",
       .make =
           [](const Path& path) {
             const std::ofstream created(path);
             std::filesystem::resize_file(path, std::uintmax_t{1} << 40u);  // takes no room on the disk
           }},
      {.file = "x27_unreadable.obj",
       .refused = "can't be read",
       .unreadable = true,
       .make =
           [](const Path& path) {
             std::ofstream(path) << cube << "f 1 2 7\n";
             std::filesystem::permissions(path, std::filesystem::perms::none);
           }},
      {.file = "x28_fifo_as_buffer.gltf",
       .refused = "/buffers/0/uri: there is no file",
       .make =
           [](const Path& path) {
             make_fifo(path.parent_path() / "fifo");
             std::string document = node_chain(1);
             const std::size_t uri = document.find("data:"), end = document.find('"', uri);
             std::ofstream(path) << document.replace(uri, end - uri, "fifo");
           }},
  };
}

}  // namespace

std::vector<HostileRow> hostile_rows() {
  std::vector<HostileRow> rows = given_rows();
  for (HostileRow& row : further_rows()) rows.push_back(std::move(row));
  return rows;
}

}  // namespace raymeter
