#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "scenes/base/error.h"
#include "scenes/readers/file_bytes.h"
#include "scenes/readers/readers.h"
#include "scenes/readers/text_cursor.h"
#include "scenes/scene_builder.h"

namespace raymeter {
namespace {

/// Eric Haines' Neutral File Format, version 3.1 of its document (SPD 3.14). Where files need it this is more
/// lenient than the document: white space and line breaks are free, entities come in any order (a fill
/// applies to the objects after it, the default material to those before the first), a cone's apex may be
/// its larger end, the view's parts come in any order, and hither may be missing. `hither` is ignored; it is
/// no surface. Surfaces are two-sided here, so a negative radius, NFF's "only the inside is visible", is
/// taken as its absolute value. Refused: a file without a view or with two, radii of opposite sign in one
/// cone, polygons of fewer than 3 vertices.
class NffReader {
 public:
  NffReader(const std::filesystem::path& file, std::string_view text)
      : cursor_(file.string(), text, {.comment = '#'}) {}

  SceneData read() {
    for (std::string_view word = cursor_.word(); !word.empty(); word = cursor_.word()) read_entity(word);
    if (!data_.camera) cursor_.fail("no view: the file has no entity v");
    return std::move(data_);
  }

 private:
  static constexpr std::int64_t most_pixels = 0x7fffffff;

  void read_entity(std::string_view word) {
    if (word == "v")
      read_view();
    else if (word == "b")
      data_.background = cursor_.next_vector("a number of the background colour (b)");
    else if (word == "l")
      read_light();
    else if (word == "f")
      read_fill();
    else if (word == "c")
      read_cone();
    else if (word == "s")
      read_sphere();
    else if (word == "p" || word == "pp")
      read_polygon(word == "pp");
    else
      cursor_.fail(fmt::format("unknown entity {}; NFF has v b l f c s p pp and comments", in_quotes(word)));
  }

  void read_view() {
    const std::size_t line = cursor_.line();
    if (data_.camera) cursor_.fail("a second view (v)");
    Camera camera;
    bool from = false, at = false, up = false, angle = false, hither = false, resolution = false;
    for (;;) {
      const std::string_view part = cursor_.peek();
      const auto take_once = [&](bool& taken) {
        cursor_.word();
        if (std::exchange(taken, true)) cursor_.fail(fmt::format("{} twice in one view", in_quotes(part)));
      };
      if (part == "from") {
        take_once(from);
        camera.from = cursor_.next_vector("a coordinate of the view's from");
      } else if (part == "at") {
        take_once(at);
        camera.at = cursor_.next_vector("a coordinate of the view's at");
      } else if (part == "up") {
        take_once(up);
        camera.up = cursor_.next_vector("a component of the view's up");
      } else if (part == "angle") {
        take_once(angle);
        camera.angle = cursor_.next_float("the view's angle");
        if (!(camera.angle > 0 && camera.angle < 180))
          cursor_.fail(fmt::format("angle {}: it must lie between 0 and 180 degrees", camera.angle));
      } else if (part == "hither") {
        take_once(hither);
        cursor_.next_float("the view's hither");
      } else if (part == "resolution") {
        take_once(resolution);
        camera.width = read_pixels();
        camera.height = read_pixels();
      } else {
        break;
      }
    }
    for (const auto& [given, name] : {std::pair(from, "from"), std::pair(at, "at"), std::pair(up, "up"),
                                      std::pair(angle, "angle"), std::pair(resolution, "resolution")})
      if (!given) cursor_.fail_at(line, fmt::format("the view (v) has no {}", name));

    const Vec3d view = to_double(camera.at) - to_double(camera.from), up_vector = to_double(camera.up);
    if (view == Vec3d{}) cursor_.fail_at(line, "the view's from and at are the same point");
    if (length(cross((1 / length(view)) * view, up_vector)) <= 1e-9 * length(up_vector))
      cursor_.fail_at(line, "the view's up is zero or parallel to its direction");
    data_.camera = camera;
  }

  std::uint32_t read_pixels() {
    const std::int64_t pixels = cursor_.next_integer("the view's resolution");
    if (pixels < 1 || pixels > most_pixels)
      cursor_.fail(fmt::format("resolution {}: it must lie between 1 and {}", pixels, most_pixels));
    return static_cast<std::uint32_t>(pixels);
  }

  void read_light() {
    Light light;
    light.position = cursor_.next_vector("a coordinate of a light (l)");
    // No entity's name begins like a number, so one that follows belongs to the light.
    const std::string_view next = cursor_.peek();
    if (!next.empty() && std::string_view("+-.0123456789").find(next[0]) != std::string_view::npos)
      light.colour = cursor_.next_vector("a number of a light's colour (l)");
    data_.lights.push_back(light);
  }

  void read_fill() {
    Material fill;
    fill.colour = cursor_.next_vector("a number of a fill's colour (f)");
    fill.diffuse = cursor_.next_float("a fill's Kd");
    fill.specular = cursor_.next_float("a fill's Ks");
    fill.shine = cursor_.next_float("a fill's Shine");
    fill.transmittance = cursor_.next_float("a fill's T");
    fill.refraction_index = cursor_.next_float("a fill's index of refraction");
    // Before the first fill objects have the default material, number 0.
    if (data_.materials.empty() && data_.shapes > 0) data_.materials.emplace_back();
    data_.materials.push_back(fill);
  }

  std::uint32_t material() const {
    return data_.materials.empty() ? 0 : static_cast<std::uint32_t>(data_.materials.size() - 1);
  }

  void add_quadric(const Quadric& quadric) {
    builder_.add_quadric(quadric, material());
    ++data_.shapes;
  }

  void read_cone() {
    Quadric cone;
    cone.base = cursor_.next_vector("a coordinate of a cone's base (c)");
    const float base_radius = cursor_.next_float("a cone's base radius");
    cone.apex = cursor_.next_vector("a coordinate of a cone's apex (c)");
    const float apex_radius = cursor_.next_float("a cone's apex radius");
    if ((base_radius < 0 && apex_radius > 0) || (base_radius > 0 && apex_radius < 0))
      cursor_.fail(
          fmt::format("radii of opposite sign in one cone (c): {} and {}", base_radius, apex_radius));
    cone.base_radius = std::abs(base_radius);
    cone.apex_radius = std::abs(apex_radius);
    cone.kind = cone.base_radius == cone.apex_radius ? QuadricKind::cylinder : QuadricKind::cone;
    add_quadric(cone);
  }

  void read_sphere() {
    Quadric sphere;
    sphere.base = cursor_.next_vector("a coordinate of a sphere's centre (s)");
    sphere.base_radius = std::abs(cursor_.next_float("a sphere's radius"));
    add_quadric(sphere);
  }

  void read_polygon(bool is_patch) {
    const std::size_t line = cursor_.line();
    const std::int64_t count = cursor_.next_integer("a polygon's number of vertices");
    if (count < 3) cursor_.fail(fmt::format("a polygon of {} vertices; it needs 3", count));
    // A vertex takes three numbers of a digit and a separator each.
    if (static_cast<std::uint64_t>(count) > (cursor_.bytes_left() + 1) / (is_patch ? 12 : 6))
      cursor_.fail(fmt::format("a polygon of {} vertices, but the file has only {} bytes left", count,
                               cursor_.bytes_left()));
    corners_.clear();
    corner_normals_.clear();
    for (std::int64_t i = 0; i < count; ++i) {
      corners_.push_back(static_cast<std::uint32_t>(data_.vertices.size()));
      data_.vertices.push_back(cursor_.next_vector("a coordinate of a polygon's vertex"));
      if (!is_patch) continue;
      corner_normals_.push_back(static_cast<std::uint32_t>(data_.normals.size()));
      data_.normals.push_back(cursor_.next_vector("a component of a patch's normal"));
    }
    if (!builder_.add_polygon(corners_, corner_normals_, material()))
      cursor_.fail_at(line, SceneBuilder::too_large(corners_.size()));
    ++data_.shapes;
  }

  TextCursor cursor_;
  SceneData data_;
  SceneBuilder builder_{data_};
  std::vector<std::uint32_t> corners_, corner_normals_;
};

}  // namespace

SceneData read_nff(const std::filesystem::path& file) {
  const std::string text = read_file_bytes(file);
  return NffReader(file, text).read();
}

}  // namespace raymeter
