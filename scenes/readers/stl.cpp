#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "scenes/base/error.h"
#include "scenes/readers/byte_cursor.h"
#include "scenes/readers/file_bytes.h"
#include "scenes/readers/readers.h"
#include "scenes/readers/text_cursor.h"

namespace raymeter {
namespace {

constexpr std::size_t header_bytes = 80, preamble_bytes = header_bytes + 4, facet_bytes = 50;

/// Joins the corners of facets that are the same point. The facets' normals are not kept: they are the
/// triangles' own.
class FacetCollector {
 public:
  void add(const Vec3& a, const Vec3& b, const Vec3& c) {
    data_.triangles.push_back({index_of(a), index_of(b), index_of(c)});
  }
  SceneData take() { return std::move(data_); }
  bool empty() const { return data_.triangles.empty(); }

 private:
  struct Hash {
    std::size_t operator()(const Vec3& v) const {
      std::uint64_t hash = 0;
      for (int axis = 0; axis < 3; ++axis) {
        // Steele, Lea & Flood 2014 (SplitMix); adding 0 makes -0 and 0, which are equal, hash alike.
        hash += std::bit_cast<std::uint32_t>(v[axis] + 0.0f) + 0x9e3779b97f4a7c15u;
        hash = (hash ^ (hash >> 30u)) * 0xbf58476d1ce4e5b9u;
        hash = (hash ^ (hash >> 27u)) * 0x94d049bb133111ebu;
        hash ^= hash >> 31u;
      }
      return hash;
    }
  };

  std::uint32_t index_of(const Vec3& point) {
    const auto [entry, is_new] =
        indices_.try_emplace(point, static_cast<std::uint32_t>(data_.vertices.size()));
    if (is_new) data_.vertices.push_back(point);
    return entry->second;
  }

  SceneData data_;
  std::unordered_map<Vec3, std::uint32_t, Hash> indices_;
};

/// How many facets the file counts in itself, as a binary one; its size is then known.
std::uint64_t counted_facets(const std::string& file, std::string_view bytes) {
  return ByteCursor(file, bytes, std::endian::little, header_bytes).read<std::uint32_t>();
}

SceneData read_binary(const std::string& file, std::string_view bytes) {
  ByteCursor cursor(file, bytes, std::endian::little, preamble_bytes);
  FacetCollector facets;
  while (cursor.bytes_left() >= facet_bytes) {
    cursor.skip(3 * sizeof(float));  // the normal
    std::array<Vec3, 3> corners;
    for (Vec3& corner : corners)
      for (int axis = 0; axis < 3; ++axis) {
        const std::size_t offset = cursor.offset();
        corner[axis] = cursor.read<float>();
        if (!std::isfinite(corner[axis])) cursor.fail_at(offset, "a coordinate is not finite");
      }
    cursor.skip(2);  // attributes
    facets.add(corners[0], corners[1], corners[2]);
  }
  if (facets.empty()) cursor.fail("the file has no facets");
  return facets.take();
}

/// solid [name] / facet normal x y z / outer loop / vertex x y z, three times / endloop / endfacet / ... /
/// endsolid [name]; one solid or more. Normals are skipped: exporters write nan for facets without area.
SceneData read_ascii(const std::string& file, std::string_view text) {
  TextCursor cursor(file, text);
  FacetCollector facets;
  const auto expect = [&](std::string_view keyword, std::string_view word) {
    if (word != keyword)
      cursor.fail(word.empty() ? fmt::format("expected {}, found the end of the file", keyword)
                               : fmt::format("expected {}, found {}", keyword, in_quotes(word)));
  };
  for (std::string_view word = cursor.word(); !word.empty(); word = cursor.word()) {
    expect("solid", word);
    cursor.skip_line();
    for (word = cursor.word(); word != "endsolid"; word = cursor.word()) {
      expect("facet", word);
      cursor.skip_line();
      expect("outer", cursor.word());
      expect("loop", cursor.word());
      std::array<Vec3, 3> corners;
      for (Vec3& corner : corners) {
        expect("vertex", cursor.word());
        corner = cursor.next_vector("a coordinate of a vertex");
      }
      expect("endloop", cursor.word());
      expect("endfacet", cursor.word());
      facets.add(corners[0], corners[1], corners[2]);
    }
    cursor.skip_line();
  }
  if (facets.empty()) cursor.fail("the file has no facets");
  return facets.take();
}

}  // namespace

SceneData read_stl(const std::filesystem::path& file) {
  const std::string bytes = read_file_bytes(file), name = file.string();
  // Binary files may begin with "solid" too; their size doesn't lie.
  const bool has_preamble = bytes.size() >= preamble_bytes;
  if (has_preamble && bytes.size() == preamble_bytes + facet_bytes * counted_facets(name, bytes))
    return read_binary(name, bytes);
  const bool is_text = bytes.find('\0') == std::string::npos;
  if (is_text) return read_ascii(name, bytes);
  if (!has_preamble) throw error_at_byte(name, bytes.size(), "the file ends in the header of a binary STL");
  throw error_at_byte(name, header_bytes,
                      fmt::format("the header counts {} facets, which take {} bytes, but the file has {}",
                                  counted_facets(name, bytes),
                                  preamble_bytes + facet_bytes * counted_facets(name, bytes), bytes.size()));
}

}  // namespace raymeter
