#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "scenes/base/error.h"
#include "scenes/readers/byte_cursor.h"
#include "scenes/readers/file_bytes.h"
#include "scenes/readers/json_place.h"
#include "scenes/readers/readers.h"
#include "scenes/readers/text_cursor.h"
#include "scenes/scene_builder.h"

namespace raymeter {
namespace {

using nlohmann::json;

/// x -> linear columns times x, plus the translation.
struct Transform {
  std::array<Vec3d, 3> columns{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3d translation;

  Vec3d linear(const Vec3d& v) const { return v.x * columns[0] + v.y * columns[1] + v.z * columns[2]; }
  Vec3d point(const Vec3d& p) const { return linear(p) + translation; }
};

Transform operator*(const Transform& outer, const Transform& inner) {
  Transform product;
  for (std::size_t i = 0; i < 3; ++i) product.columns[i] = outer.linear(inner.columns[i]);
  product.translation = outer.point(inner.translation);
  return product;
}

/// How normals go: by the inverse transpose, here the cofactors with the sign of the determinant.
Transform for_normals(const Transform& transform) {
  const auto& [x, y, z] = transform.columns;
  const double sign = dot(x, cross(y, z)) < 0 ? -1.0 : 1.0;
  return {{sign * cross(y, z), sign * cross(z, x), sign * cross(x, y)}, {}};
}

template <std::size_t n>
std::array<double, n> read_numbers(const JsonPlace& place) {
  if (place.size() != n) place.fail(fmt::format("it has {} numbers instead of {}", place.size(), n));
  std::array<double, n> numbers;
  for (std::size_t i = 0; i < n; ++i) numbers[i] = place.at(i).number();
  return numbers;
}

Transform read_transform(const JsonPlace& node) {
  Transform transform;
  if (const auto matrix = node.find("matrix")) {
    const auto m = read_numbers<16>(*matrix);
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1) matrix->fail("the matrix is not affine");
    transform.columns = {{{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}}};
    transform.translation = {m[12], m[13], m[14]};
    return transform;
  }
  if (const auto place = node.find("translation")) {
    const auto [x, y, z] = read_numbers<3>(*place);
    transform.translation = {x, y, z};
  }
  if (const auto place = node.find("rotation")) {
    const auto [x, y, z, w] = read_numbers<4>(*place);
    const double norm = x * x + y * y + z * z + w * w;
    if (!(norm > 0 && std::isfinite(norm))) place->fail("the quaternion has no direction");
    const double s = 2 / norm;
    transform.columns = {{{1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)},
                          {s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)},
                          {s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)}}};
  }
  if (const auto place = node.find("scale")) {
    const auto scale = read_numbers<3>(*place);
    for (std::size_t i = 0; i < 3; ++i) transform.columns[i] = scale[i] * transform.columns[i];
  }
  return transform;
}

/// Nothing when the text isn't base64.
std::optional<std::string> decode_base64(std::string_view text) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  while (text.ends_with('=')) text.remove_suffix(1);
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::size_t digit = digits.find(c);
    if (digit == std::string_view::npos) return std::nullopt;
    bits = (bits << 6u) | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(static_cast<unsigned char>((bits >> count) & 0xffu));
  }
  return bytes;
}

/// %20 and the like as the characters they stand for.
std::string decode_percent(std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned code = 0;
    const char* const digits = uri.data() + i + 1;
    if (uri[i] == '%' && i + 2 < uri.size() &&
        std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2) {
      text += static_cast<char>(static_cast<unsigned char>(code));
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

/// Elements of one accessor; every one of them lies within its buffer.
struct Accessor {
  const char* data = nullptr;
  std::size_t count = 0, stride = 0;
  std::uint64_t component = 0;

  Vec3 vector(std::size_t i) const {
    Vec3 v;
    for (int axis = 0; axis < 3; ++axis)
      v[axis] = load<float>(data + i * stride + std::size_t{4} * static_cast<std::size_t>(axis),
                            std::endian::little);
    return v;
  }
  std::uint32_t index(std::size_t i) const {
    const char* const from = data + i * stride;
    if (component == 5121) return load<std::uint8_t>(from, std::endian::little);
    if (component == 5123) return load<std::uint16_t>(from, std::endian::little);
    return load<std::uint32_t>(from, std::endian::little);
  }
};

/// glTF 2.0. Read are the meshes of the default scene (the first when none is named, all root nodes when
/// there is no scene), placed by their nodes, and of the materials colour and transmission. Points, lines,
/// skins, morph targets, animations, cameras and lights are not read. Refused: sparse accessors, compressed
/// and quantised geometry, buffers outside the file's folder.
class GltfReader {
 public:
  GltfReader(const std::filesystem::path& folder, const std::string& file, const json& document,
             std::string_view chunk)
      : folder_(folder), root_(file, document), chunk_(chunk) {}

  SceneData read() {
    check_asset();
    read_materials();
    read_nodes();
    if (data_.triangles.empty()) root_.fail("the scene has no triangles");
    if (dropped_)
      data_.warnings.push_back(fmt::format("dropped {} mesh primitives of points or lines", dropped_));
    for (const char* what : {"skins", "animations"})
      if (root_.find(what)) data_.warnings.push_back(fmt::format("ignored {}", what));
    return std::move(data_);
  }

 private:
  /// A file can name one mesh in any number of nodes; beyond this many triangles or vertices it is refused.
  static constexpr std::size_t most_items = std::size_t{1} << 24u;

  void check_asset() const {
    const JsonPlace version = root_.at("asset").at("version");
    if (!version.text().starts_with("2."))
      version.fail(fmt::format("version {}; 2.0 can be read", in_quotes(version.text())));
    const auto required = root_.find("extensionsRequired");
    for (std::size_t i = 0; required && i < required->size(); ++i) {
      const JsonPlace extension = required->at(i);
      const std::string& name = extension.text();
      // Those that change how surfaces look but not where they are.
      bool harmless = name == "KHR_lights_punctual" || name == "KHR_animation_pointer";
      for (const char* family : {"KHR_materials_", "KHR_texture_", "EXT_texture_"})
        harmless |= name.starts_with(family);
      if (!harmless) extension.fail(fmt::format("the extension {} can't be read", in_quotes(name)));
    }
  }

  /// The item of a list at the document's root that the integer at `place` names.
  std::pair<JsonPlace, std::size_t> item(std::string_view list, const JsonPlace& place) const {
    const std::uint64_t index = place.integer();
    const auto items = root_.find(list);
    const std::size_t count = items ? items->size() : 0;
    if (index >= count) place.fail(fmt::format("it names number {} of {} {}", index, count, list));
    return {items->at(static_cast<std::size_t>(index)), static_cast<std::size_t>(index)};
  }

  void read_materials() {
    const auto materials = root_.find("materials");
    if (!materials) return;
    data_.materials.emplace_back();  // of primitives without one
    for (std::size_t i = 0; i < materials->size(); ++i) {
      const JsonPlace place = materials->at(i);
      Material material;
      if (const auto surface = place.find("pbrMetallicRoughness"))
        if (const auto factor = surface->find("baseColorFactor")) {
          const auto [r, g, b, a] = read_numbers<4>(*factor);
          for (const double part : {r, g, b})
            if (!(part >= 0 && part <= 1)) factor->fail("a colour's parts lie between 0 and 1");
          material.colour = to_float(Vec3d{r, g, b});
        }
      if (const auto extensions = place.find("extensions")) {
        if (const auto transmission = extensions->find("KHR_materials_transmission"))
          material.transmittance = fraction(*transmission, "transmissionFactor", 0, 1);
        if (const auto refraction = extensions->find("KHR_materials_ior"))
          material.refraction_index = fraction(*refraction, "ior", 1.5, 1000);
        else if (material.transmittance > 0)
          material.refraction_index = 1.5;
      }
      data_.materials.push_back(material);
    }
  }

  static float fraction(const JsonPlace& place, std::string_view key, double otherwise, double most) {
    const double value = place.number_or(key, otherwise);
    if (!(value >= 0 && value <= most)) place.at(key).fail(fmt::format("it must lie between 0 and {}", most));
    return static_cast<float>(value);
  }

  void read_nodes() {
    const auto nodes = root_.find("nodes");
    if (!nodes) root_.fail("the file has no nodes");
    struct Visit {
      JsonPlace name;  ///< where the node is named
      Transform parent;
    };
    std::vector<Visit> to_visit;
    const auto push = [&](const JsonPlace& list, const Transform& parent) {
      for (std::size_t i = list.size(); i-- > 0;) to_visit.push_back({list.at(i), parent});
    };
    json roots = json::array();
    const JsonPlace root_list = scene_roots(*nodes, roots);
    push(root_list, {});

    // Depth first, in the order of the document; every node has its place in one tree only.
    std::vector<bool> visited(nodes->size());
    while (!to_visit.empty()) {
      const auto [name, parent] = std::move(to_visit.back());
      to_visit.pop_back();
      const auto [node, index] = item("nodes", name);
      if (visited[index]) name.fail(fmt::format("node {} is in the graph twice", index));
      visited[index] = true;
      const Transform transform = parent * read_transform(node);
      if (const auto mesh = node.find("mesh")) read_mesh(item("meshes", *mesh).first, node, transform);
      if (const auto children = node.find("children")) push(*children, transform);
    }
  }

  /// The list of the nodes to begin with; `roots` holds it where the file has none.
  JsonPlace scene_roots(const JsonPlace& nodes, json& roots) const {
    const auto chosen = root_.find("scene"), scenes = root_.find("scenes");
    if (chosen) return list_or_empty(item("scenes", *chosen).first);
    if (scenes && scenes->size() > 0) return list_or_empty(scenes->at(std::size_t{0}));
    std::vector<bool> is_child(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (const auto children = nodes.at(i).find("children"))
        for (std::size_t c = 0; c < children->size(); ++c)
          is_child[item("nodes", children->at(c)).second] = true;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (!is_child[i]) roots.push_back(i);
    return root_.with(roots);
  }
  static JsonPlace list_or_empty(const JsonPlace& scene) {
    static const json empty = json::array();
    const auto nodes = scene.find("nodes");
    return nodes ? *nodes : scene.with(empty);
  }

  void read_mesh(const JsonPlace& mesh, const JsonPlace& node, const Transform& transform) {
    const JsonPlace primitives = mesh.at("primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) read_primitive(primitives.at(i), node, transform);
  }

  void read_primitive(const JsonPlace& primitive, const JsonPlace& node, const Transform& transform) {
    const std::uint64_t mode = primitive.integer_or("mode", 4);
    if (mode > 6) primitive.at("mode").fail(fmt::format("mode {}; there are 0 to 6", mode));
    if (mode < 4) {
      ++dropped_;
      return;
    }
    const JsonPlace attributes = primitive.at("attributes"), position = attributes.at("POSITION");
    const Accessor positions = accessor(position, "VEC3", {5126});
    Accessor indices;
    const auto index_place = primitive.find("indices");
    if (index_place) indices = accessor(*index_place, "SCALAR", {5121, 5123, 5125});
    const std::size_t corners = index_place ? indices.count : positions.count;
    if (mode == 4 && corners % 3 != 0)
      primitive.fail(fmt::format("{} corners are no whole number of triangles", corners));
    const std::size_t triangles = mode == 4 ? corners / 3 : std::max<std::size_t>(corners, 2) - 2;
    if (data_.triangles.size() + triangles > most_items ||
        data_.vertices.size() + positions.count > most_items)
      primitive.fail(fmt::format("with it the scene has more than {} triangles or vertices", most_items));

    const auto first_vertex = static_cast<std::uint32_t>(data_.vertices.size());
    add_positions(positions, node, transform);
    const auto first_normal = static_cast<std::uint32_t>(data_.normals.size());
    const auto normal = attributes.find("NORMAL");
    if (normal) add_normals(accessor(*normal, "VEC3", {5126}), positions.count, *normal, transform);

    std::uint32_t material = 0;
    if (const auto place = primitive.find("material"))
      material = 1 + static_cast<std::uint32_t>(item("materials", *place).second);
    const auto corner = [&](std::size_t i) {
      const std::size_t vertex = index_place ? indices.index(i) : i;
      if (vertex >= positions.count)
        index_place->fail(fmt::format("index {} names vertex {} of {}", i, vertex, positions.count));
      return static_cast<std::uint32_t>(vertex);
    };
    for (std::size_t i = 0; i < triangles; ++i) {
      const std::size_t odd = i % 2;
      const std::array<std::size_t, 3> from = mode == 4   ? std::array{3 * i, 3 * i + 1, 3 * i + 2}
                                              : mode == 5 ? std::array{i, i + 1 + odd, i + 2 - odd}
                                                          : std::array{i + 1, i + 2, std::size_t{0}};
      std::array<std::uint32_t, 3> vertices, normals;
      for (std::size_t k = 0; k < 3; ++k) {
        vertices[k] = first_vertex + corner(from[k]);
        normals[k] = first_normal + (vertices[k] - first_vertex);
      }
      builder_.add_polygon(vertices, std::span<const std::uint32_t>(normals).first(normal ? 3 : 0), material);
    }
  }

  void add_positions(const Accessor& positions, const JsonPlace& node, const Transform& transform) {
    for (std::size_t i = 0; i < positions.count; ++i) {
      const Vec3d p = transform.point(to_double(positions.vector(i)));
      for (int axis = 0; axis < 3; ++axis)
        if (!(std::abs(p[axis]) <= double(std::numeric_limits<float>::max())))
          node.fail(fmt::format("vertex {} of its mesh is not finite or beyond the range of float", i));
      data_.vertices.push_back(to_float(p));
    }
  }

  void add_normals(const Accessor& normals, std::size_t vertices, const JsonPlace& place,
                   const Transform& transform) {
    if (normals.count != vertices)
      place.fail(fmt::format("{} normals for {} vertices", normals.count, vertices));
    const Transform to_world = for_normals(transform);
    for (std::size_t i = 0; i < normals.count; ++i) {
      const Vec3d n = to_world.linear(to_double(normals.vector(i)));
      const double size = length(n);
      data_.normals.push_back(size > 0 && std::isfinite(size) ? to_float((1 / size) * n) : Vec3{});
    }
  }

  Accessor accessor(const JsonPlace& name, std::string_view type,
                    std::initializer_list<std::uint64_t> components) {
    const JsonPlace place = item("accessors", name).first;
    if (place.find("sparse")) place.fail("sparse accessors can't be read");
    if (place.at("type").text() != type)
      place.fail(fmt::format("its type is {}, not {}", in_quotes(place.at("type").text()), type));
    Accessor accessor;
    accessor.component = place.at("componentType").integer();
    if (std::ranges::find(components, accessor.component) == components.end())
      place.fail(fmt::format("componentType {} can't be read here", accessor.component));
    const std::size_t component_size = accessor.component == 5121   ? 1
                                       : accessor.component == 5123 ? 2
                                                                    : 4,
                      element_size = component_size * (type == "VEC3" ? 3 : 1);

    const JsonPlace view = item("bufferViews", place.at("bufferView")).first;
    const std::uint64_t count = place.at("count").integer(), offset = place.integer_or("byteOffset", 0),
                        stride = view.integer_or("byteStride", element_size);
    if (stride < element_size || stride > 252)
      view.fail(fmt::format("byteStride {} for elements of {} bytes", stride, element_size));
    const std::string_view bytes = bytes_of_view(view);
    if (count == 0) return accessor;
    if (offset > bytes.size() || bytes.size() - offset < element_size ||
        (bytes.size() - offset - element_size) / stride < count - 1)
      place.fail(fmt::format(
          "{} elements of {} bytes, {} apart, from byte {} run past the end of their buffer view of {} bytes",
          count, element_size, stride, offset, bytes.size()));
    accessor.data = bytes.data() + offset;
    accessor.count = static_cast<std::size_t>(count);
    accessor.stride = static_cast<std::size_t>(stride);
    return accessor;
  }

  std::string_view bytes_of_view(const JsonPlace& view) {
    const auto [place, index] = item("buffers", view.at("buffer"));
    const std::string_view buffer = bytes_of_buffer(place, index);
    const std::uint64_t offset = view.integer_or("byteOffset", 0), length = view.at("byteLength").integer();
    if (offset > buffer.size() || length > buffer.size() - offset)
      view.fail(fmt::format("{} bytes from byte {} run past the end of their buffer of {}", length, offset,
                            buffer.size()));
    return buffer.substr(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
  }

  std::string_view bytes_of_buffer(const JsonPlace& place, std::size_t index) {
    if (buffers_.size() <= index) buffers_.resize(root_.at("buffers").size());
    const auto uri = place.find("uri");
    std::string_view bytes;
    if (!uri) {
      if (index != 0 || chunk_.empty())
        place.fail("the buffer has no uri and the file no binary chunk for it");
      bytes = chunk_;
    } else {
      if (!buffers_[index]) buffers_[index] = load_uri(*uri);
      bytes = *buffers_[index];
    }
    const std::uint64_t length = place.at("byteLength").integer();
    if (bytes.size() < length)
      place.fail(fmt::format("the buffer should have {} bytes but has {}", length, bytes.size()));
    return bytes.substr(0, static_cast<std::size_t>(length));
  }

  std::string load_uri(const JsonPlace& place) const {
    const std::string_view uri = place.text();
    if (uri.starts_with("data:")) {
      const std::size_t comma = uri.find(',');
      if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(";base64"))
        place.fail("the data URI is not in base64");
      auto bytes = decode_base64(uri.substr(comma + 1));
      if (!bytes) place.fail("the data URI is malformed base64");
      return std::move(*bytes);
    }
    const std::filesystem::path path = decode_percent(uri);
    const bool leaves = path.is_absolute() || std::ranges::find(path, "..") != path.end();
    if (leaves || uri.find("://") != std::string_view::npos || path.string().find('\0') != std::string::npos)
      place.fail(fmt::format("{} is no file in the folder of this one", in_quotes(uri)));
    std::error_code status;
    if (!std::filesystem::is_regular_file(folder_ / path, status))
      place.fail(fmt::format("there is no file {}", in_quotes(uri)));
    return read_file_bytes(folder_ / path);
  }

  std::filesystem::path folder_;
  JsonPlace root_;
  std::string_view chunk_;  ///< a .glb's binary one
  std::vector<std::optional<std::string>> buffers_;
  SceneData data_;
  SceneBuilder builder_{data_};
  std::size_t dropped_ = 0;
};

struct Chunks {
  std::string_view document, binary;
  std::size_t document_offset = 0;
};

/// A .glb file: magic, version, length, then chunks of length, type and bytes; the first is JSON.
Chunks split_binary(const std::string& file, std::string_view bytes) {
  constexpr std::uint32_t json_type = 0x4E4F534A, binary_type = 0x004E4942;
  ByteCursor cursor(file, bytes, std::endian::little, 4);
  const auto version = cursor.read<std::uint32_t>();
  if (version != 2) cursor.fail_at(4, fmt::format("version {}; 2 can be read", version));
  const auto length = cursor.read<std::uint32_t>();
  if (length > bytes.size())
    cursor.fail_at(8, fmt::format("the header counts {} bytes but the file has {}", length, bytes.size()));
  Chunks chunks;
  while (cursor.bytes_left() >= 8) {
    const std::size_t begin = cursor.offset();
    const auto size = cursor.read<std::uint32_t>(), type = cursor.read<std::uint32_t>();
    if (size > cursor.bytes_left())
      cursor.fail_at(begin, fmt::format("a chunk of {} bytes but {} are left", size, cursor.bytes_left()));
    if (begin == 12 && type != json_type) cursor.fail_at(begin, "the first chunk is not JSON");
    const std::string_view chunk = bytes.substr(cursor.offset(), size);
    if (begin == 12) {
      chunks.document = chunk;
      chunks.document_offset = cursor.offset();
    } else if (type == binary_type && chunks.binary.empty()) {
      chunks.binary = chunk;
    }
    cursor.skip(size);
  }
  if (chunks.document.empty()) cursor.fail("the file has no JSON chunk");
  return chunks;
}

/// What the JSON library says, in one short line.
std::string cleaned(std::string_view message) {
  if (message.starts_with('[')) message.remove_prefix(std::min(message.size(), message.find("] ") + 2));
  std::string line(message.substr(0, 200));
  for (char& c : line)
    if (c < ' ' || c > '~') c = '?';
  return line;
}

}  // namespace

SceneData read_gltf(const std::filesystem::path& file) {
  const std::string bytes = read_file_bytes(file), name = file.string();
  Chunks chunks{bytes, {}};
  if (bytes.starts_with("glTF")) chunks = split_binary(name, bytes);
  json document;
  try {
    document = json::parse(chunks.document);
  } catch (const json::parse_error& error) {
    throw error_at_byte(name, chunks.document_offset + (error.byte > 0 ? error.byte - 1 : 0),
                        cleaned(error.what()));
  } catch (const json::exception& error) {  // a number beyond double
    throw Error(fmt::format("{}: {}", name, cleaned(error.what())));
  }
  return GltfReader(file.parent_path(), name, document, chunks.binary).read();
}

}  // namespace raymeter
