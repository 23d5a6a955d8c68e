#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "scenes/base/error.h"
#include "scenes/readers/byte_cursor.h"
#include "scenes/readers/file_bytes.h"
#include "scenes/readers/readers.h"
#include "scenes/readers/text_cursor.h"
#include "scenes/scene_builder.h"

namespace raymeter {
namespace {

// PLY 1.0 (Turk 1994): a header that declares elements and their properties, then the elements. Read are x,
// y, z and, when all three are there, nx, ny, nz of `vertex`, and the list vertex_indices (or vertex_index)
// of `face`, polygons of any size; the rest is skipped. Faces of fewer than three corners are dropped with a
// warning.

enum class Scalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct ScalarName {
  std::string_view name;
  Scalar scalar;
};
constexpr std::array scalar_names{
    ScalarName{"char", Scalar::int8},      ScalarName{"int8", Scalar::int8},
    ScalarName{"uchar", Scalar::uint8},    ScalarName{"uint8", Scalar::uint8},
    ScalarName{"short", Scalar::int16},    ScalarName{"int16", Scalar::int16},
    ScalarName{"ushort", Scalar::uint16},  ScalarName{"uint16", Scalar::uint16},
    ScalarName{"int", Scalar::int32},      ScalarName{"int32", Scalar::int32},
    ScalarName{"uint", Scalar::uint32},    ScalarName{"uint32", Scalar::uint32},
    ScalarName{"float", Scalar::float32},  ScalarName{"float32", Scalar::float32},
    ScalarName{"double", Scalar::float64}, ScalarName{"float64", Scalar::float64},
};

std::size_t size_of(Scalar scalar) {
  constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(scalar)];
}
bool is_integer(Scalar scalar) {
  return scalar < Scalar::float32;
}

struct Property {
  std::string name;
  Scalar type;                   ///< of the value, or of a list's items
  std::optional<Scalar> length;  ///< the type of a list's length
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Format { ascii, little_endian, big_endian };

struct Header {
  Format format = Format::ascii;
  std::vector<Element> elements;
};

Scalar scalar_named(std::string_view word, const TextCursor& cursor) {
  for (const auto& [name, scalar] : scalar_names)
    if (word == name) return scalar;
  cursor.fail(fmt::format("unknown type {}", in_quotes(word)));
}

Property read_property(TextCursor& cursor) {
  Property property{};
  std::string_view word = cursor.word_on_line();
  if (word == "list") {
    property.length = scalar_named(cursor.word_on_line(), cursor);
    if (!is_integer(*property.length)) cursor.fail("a list's length can't be a floating-point number");
    word = cursor.word_on_line();
  }
  property.type = scalar_named(word, cursor);
  property.name = cursor.word_on_line();
  if (property.name.empty()) cursor.fail("a property without a name");
  return property;
}

/// Leaves the cursor at the first byte of the data.
Header read_header(TextCursor& cursor) {
  Header header;
  bool has_format = false;
  if (cursor.word_on_line() != "ply") cursor.fail("not a PLY file: it doesn't begin with \"ply\"");
  cursor.skip_line();
  for (;;) {
    const std::string_view word = cursor.word();
    if (word == "end_header") {
      cursor.skip_line();
      break;
    }
    if (word == "format") {
      const std::string_view format = cursor.word_on_line();
      if (format == "ascii")
        header.format = Format::ascii;
      else if (format == "binary_little_endian")
        header.format = Format::little_endian;
      else if (format == "binary_big_endian")
        header.format = Format::big_endian;
      else
        cursor.fail(fmt::format("unknown format {}", in_quotes(format)));
      const std::string_view version = cursor.word_on_line();
      if (version != "1.0") cursor.fail(fmt::format("version {}; 1.0 can be read", in_quotes(version)));
      has_format = true;
    } else if (word == "element") {
      Element element;
      element.name = cursor.word_on_line();
      for (const Element& other : header.elements)
        if (other.name == element.name && (element.name == "vertex" || element.name == "face"))
          cursor.fail(fmt::format("a second element {}", in_quotes(element.name)));
      const std::int64_t count = cursor.to_integer(cursor.word_on_line(), "the number of elements");
      if (count < 0) cursor.fail(fmt::format("{} elements", count));
      element.count = static_cast<std::uint64_t>(count);
      header.elements.push_back(std::move(element));
    } else if (word == "property") {
      if (header.elements.empty()) cursor.fail("a property before the first element");
      header.elements.back().properties.push_back(read_property(cursor));
    } else if (word.empty()) {
      cursor.fail("the file ends in its header");
    } else if (word != "comment" && word != "obj_info") {
      cursor.fail(fmt::format("unknown keyword {} in the header", in_quotes(word)));
    }
    cursor.skip_line();
  }
  if (!has_format) cursor.fail("the header names no format");
  return header;
}

/// The values of an ascii file.
class TextValues {
 public:
  explicit TextValues(const TextCursor& cursor) : cursor_(cursor) {}

  float number(Scalar) { return cursor_.next_float("a number"); }
  std::int64_t integer(Scalar) { return cursor_.next_integer("a whole number"); }
  void skip(Scalar, std::uint64_t count) {
    for (; count > 0; --count)
      if (cursor_.word().empty()) cursor_.fail("the file ends in the middle of its data");
  }
  std::size_t bytes_left() const { return cursor_.bytes_left() + 1; }  // the last line may have no end
  static std::size_t least_bytes(Scalar) { return 2; }                 // a digit and a separator
  [[noreturn]] void fail(std::string_view what) const { cursor_.fail(what); }

 private:
  TextCursor cursor_;
};

/// The values of a binary file.
class BinaryValues {
 public:
  explicit BinaryValues(const ByteCursor& cursor) : cursor_(cursor) {}

  float number(Scalar type) {
    if (is_integer(type)) return static_cast<float>(integer(type));
    const double value = type == Scalar::float32 ? double(read<float>()) : read<double>();
    constexpr double too_large = 0x1.ffffffp127;  // rounds to infinity, as in TextCursor::to_float
    if (!(std::abs(value) < too_large))
      fail(fmt::format("the number {} is not finite or beyond the range of float", value));
    return static_cast<float>(value);
  }
  std::int64_t integer(Scalar type) {
    switch (type) {
      case Scalar::int8:
        return read<std::int8_t>();
      case Scalar::uint8:
        return read<std::uint8_t>();
      case Scalar::int16:
        return read<std::int16_t>();
      case Scalar::uint16:
        return read<std::uint16_t>();
      case Scalar::int32:
        return read<std::int32_t>();
      default:
        return read<std::uint32_t>();
    }
  }
  void skip(Scalar type, std::uint64_t count) {
    begin_ = cursor_.offset();
    if (count > bytes_left() / size_of(type)) fail("the file ends in the middle of its data");
    cursor_.skip(static_cast<std::size_t>(count) * size_of(type));
  }
  std::size_t bytes_left() const { return cursor_.bytes_left(); }
  static std::size_t least_bytes(Scalar type) { return size_of(type); }
  [[noreturn]] void fail(std::string_view what) const { cursor_.fail_at(begin_, what); }

 private:
  template <class T>
  T read() {
    begin_ = cursor_.offset();
    return cursor_.read<T>();
  }

  ByteCursor cursor_;
  std::size_t begin_ = 0;  ///< of the last value
};

template <class Values>
class BodyReader {
 public:
  explicit BodyReader(const Values& values) : values_(values) {}

  SceneData read(const Header& header) {
    for (const Element& element : header.elements) {
      check_count(element);
      if (element.name == "vertex") {
        read_vertices(element);
      } else if (element.name == "face") {
        if (!has_vertices_) values_.fail("the faces come before the vertices");
        read_faces(element);
      } else {
        skip(element);
      }
    }
    if (data_.triangles.empty()) values_.fail("the file has no faces");
    if (dropped_)
      data_.warnings.push_back(fmt::format("dropped {} faces of fewer than three corners", dropped_));
    return std::move(data_);
  }

 private:
  /// Refuses counts that the rest of the file can't hold, before anything is allocated for them.
  void check_count(const Element& element) const {
    std::size_t bytes = 0;
    for (const Property& property : element.properties)
      bytes += Values::least_bytes(property.length.value_or(property.type));
    if (bytes > 0 && element.count > values_.bytes_left() / bytes)
      values_.fail(fmt::format("the header counts {} of element {} but only {} bytes are left", element.count,
                               in_quotes(element.name), values_.bytes_left()));
  }

  std::uint64_t read_length(const Property& property) {
    const std::int64_t length = values_.integer(*property.length);
    if (length < 0 ||
        static_cast<std::uint64_t>(length) > values_.bytes_left() / Values::least_bytes(property.type))
      values_.fail(
          fmt::format("a list of {} items but only {} bytes are left", length, values_.bytes_left()));
    return static_cast<std::uint64_t>(length);
  }

  void skip(const Property& property) {
    values_.skip(property.type, property.length ? read_length(property) : 1);
  }

  void skip(const Element& element) {
    if (element.properties.empty()) return;  // such elements, however many, take no bytes
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (const Property& property : element.properties) skip(property);
  }

  void read_vertices(const Element& element) {
    constexpr std::array<std::string_view, 6> names{"x", "y", "z", "nx", "ny", "nz"};
    std::vector<std::size_t> role(element.properties.size(), names.size());
    std::array<bool, names.size()> given{};
    for (std::size_t i = 0; i < role.size(); ++i)
      for (std::size_t name = 0; name < names.size(); ++name)
        if (element.properties[i].name == names[name] && !element.properties[i].length) {
          role[i] = name;
          given[name] = true;
        }
    if (!given[0] || !given[1] || !given[2]) values_.fail("the element vertex lacks x, y or z");
    has_vertices_ = true;
    has_normals_ = given[3] && given[4] && given[5];

    data_.vertices.reserve(element.count);
    if (has_normals_) data_.normals.reserve(element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      std::array<float, names.size()> value{};
      for (std::size_t p = 0; p < role.size(); ++p) {
        if (role[p] < (has_normals_ ? 6u : 3u))
          value[role[p]] = values_.number(element.properties[p].type);
        else
          skip(element.properties[p]);
      }
      data_.vertices.push_back({value[0], value[1], value[2]});
      if (has_normals_) data_.normals.push_back({value[3], value[4], value[5]});
    }
  }

  void read_faces(const Element& element) {
    const Property* corners = nullptr;
    for (const Property& property : element.properties)
      if ((property.name == "vertex_indices" || property.name == "vertex_index") && property.length)
        corners = &property;
    if (!corners) values_.fail("the element face lacks the list vertex_indices");
    if (!is_integer(corners->type)) values_.fail("vertex indices can't be floating-point numbers");
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (const Property& property : element.properties) {
        if (&property == corners)
          read_face(property);
        else
          skip(property);
      }
  }

  void read_face(const Property& property) {
    const std::uint64_t length = read_length(property);
    corners_.clear();
    for (std::uint64_t i = 0; i < length; ++i) {
      const std::int64_t index = values_.integer(property.type);
      if (index < 0 || static_cast<std::uint64_t>(index) >= data_.vertices.size())
        values_.fail(fmt::format("vertex {} of {}", index, data_.vertices.size()));
      corners_.push_back(static_cast<std::uint32_t>(index));
    }
    if (length < 3) {
      ++dropped_;
      return;
    }
    // A vertex and its normal have the same index.
    const std::span<const std::uint32_t> normals = corners_;
    if (!builder_.add_polygon(corners_, has_normals_ ? normals : normals.first(0)))
      values_.fail(SceneBuilder::too_large(corners_.size()));
    ++data_.shapes;
  }

  Values values_;
  SceneData data_;
  SceneBuilder builder_{data_};
  std::vector<std::uint32_t> corners_;
  std::size_t dropped_ = 0;
  bool has_vertices_ = false, has_normals_ = false;
};

}  // namespace

SceneData read_ply(const std::filesystem::path& file) {
  const std::string bytes = read_file_bytes(file);
  TextCursor cursor(file.string(), bytes);
  const Header header = read_header(cursor);
  if (header.format == Format::ascii) return BodyReader(TextValues(cursor)).read(header);
  const std::endian order = header.format == Format::big_endian ? std::endian::big : std::endian::little;
  return BodyReader(BinaryValues(ByteCursor(file.string(), bytes, order, cursor.offset()))).read(header);
}

}  // namespace raymeter
