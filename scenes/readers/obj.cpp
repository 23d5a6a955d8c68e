#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "scenes/base/error.h"
#include "scenes/readers/file_bytes.h"
#include "scenes/readers/readers.h"
#include "scenes/readers/text_cursor.h"
#include "scenes/scene_builder.h"

namespace raymeter {
namespace {

/// What OBJ has besides v, vn and f: texture coordinates, groups, materials, display attributes.
constexpr std::array<std::string_view, 26> no_geometry{
    "vt",        "g",        "s",        "mg",     "o",     "usemtl", "mtllib", "usemap", "maplib",
    "bevel",     "c_interp", "d_interp", "lod",    "ctech", "stech",  "csh",    "call",   "shadow_obj",
    "trace_obj", "vp",       "deg",      "cstype", "bmat",  "step",   "con",    "res"};

/// Points, lines and free-form curves and surfaces, which aren't read.
constexpr std::array<std::string_view, 17> other_geometry{"p",    "l",    "curv", "curv2", "surf", "parm",
                                                          "trim", "hole", "scrv", "sp",    "end",  "bzp",
                                                          "bsp",  "cdc",  "cdp",  "bsp",   "cdb"};

/// Wavefront OBJ, of which polygons and their normals are read. A face may name only vertices above it.
/// Further numbers of a vertex (weight, colour) are ignored; so are texture coordinates. Faces of fewer than
/// three corners and other geometry are dropped with a warning; an unknown keyword is an error.
class ObjReader {
 public:
  ObjReader(const std::filesystem::path& file, std::string_view text)
      : cursor_(file.string(), text, {.comment = '#', .continuation = true}) {}

  SceneData read() {
    for (std::string_view word = cursor_.word(); !word.empty(); word = cursor_.word()) {
      if (word == "v")
        data_.vertices.push_back(read_vector("a coordinate of a vertex (v)"));
      else if (word == "vn")
        data_.normals.push_back(read_vector("a component of a normal (vn)"));
      else if (word == "f")
        read_face();
      else if (std::ranges::find(other_geometry, word) != other_geometry.end())
        ++ignored_;
      else if (std::ranges::find(no_geometry, word) == no_geometry.end())
        cursor_.fail(fmt::format("unknown keyword {}", in_quotes(word)));
      cursor_.skip_line();
    }
    if (data_.triangles.empty()) cursor_.fail("the file has no faces (f)");
    if (dropped_)
      data_.warnings.push_back(fmt::format("dropped {} faces of fewer than three corners", dropped_));
    if (ignored_)
      data_.warnings.push_back(
          fmt::format("ignored {} statements of points, lines and free-form geometry", ignored_));
    return std::move(data_);
  }

 private:
  Vec3 read_vector(std::string_view what) {
    Vec3 v;
    for (int axis = 0; axis < 3; ++axis) v[axis] = cursor_.to_float(cursor_.word_on_line(), what);
    return v;
  }

  /// A one-based index, or a negative one that counts back from the latest, as a zero-based one.
  std::uint32_t resolve(std::string_view word, std::size_t count, std::string_view what) const {
    const std::int64_t given = cursor_.to_integer(word, what), size = static_cast<std::int64_t>(count);
    if (given == 0 || given > size || given < -size)
      cursor_.fail(fmt::format("{} {}, but there are {} so far", what, given, count));
    return static_cast<std::uint32_t>(given > 0 ? given - 1 : size + given);
  }

  /// A corner is v, v/vt, v//vn or v/vt/vn.
  void read_corner(std::string_view word) {
    const std::size_t first = std::min(word.find('/'), word.size()),
                      second = std::min(word.find('/', first + 1), word.size());
    corners_.push_back(resolve(word.substr(0, first), data_.vertices.size(), "vertex"));
    const bool has_texture = second > first + 1;
    if (has_texture) cursor_.to_integer(word.substr(first + 1, second - first - 1), "texture vertex");
    if (second < word.size())
      corner_normals_.push_back(resolve(word.substr(second + 1), data_.normals.size(), "normal"));
  }

  void read_face() {
    corners_.clear();
    corner_normals_.clear();
    for (std::string_view word = cursor_.word_on_line(); !word.empty(); word = cursor_.word_on_line())
      read_corner(word);
    if (corners_.size() < 3) {
      ++dropped_;
      return;
    }
    // A face some of whose corners have no normal has none.
    if (corner_normals_.size() != corners_.size()) corner_normals_.clear();
    if (!builder_.add_polygon(corners_, corner_normals_))
      cursor_.fail(SceneBuilder::too_large(corners_.size()));
    ++data_.shapes;
  }

  TextCursor cursor_;
  SceneData data_;
  SceneBuilder builder_{data_};
  std::vector<std::uint32_t> corners_, corner_normals_;
  std::size_t dropped_ = 0, ignored_ = 0;
};

}  // namespace

SceneData read_obj(const std::filesystem::path& file) {
  const std::string text = read_file_bytes(file);
  return ObjReader(file, text).read();
}

}  // namespace raymeter
