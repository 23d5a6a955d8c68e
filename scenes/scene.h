#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/geometry/bounds.h"
#include "scenes/geometry/primitives.h"
#include "scenes/geometry/vec3.h"

namespace raymeter {

/// NFF's fill: colour 0..1, Kd, Ks, Phong exponent, transmittance, index of refraction.
struct Material {
  Vec3 colour{0.8f, 0.8f, 0.8f};
  float diffuse = 0.8f;
  float specular = 0.2f;
  float shine = 20;
  float transmittance = 0;
  float refraction_index = 1;

  friend bool operator==(const Material&, const Material&) = default;
};

/// A positional light.
struct Light {
  Vec3 position;
  Vec3 colour{1, 1, 1};
};

/// A pinhole camera with square pixels. `angle` is the full horizontal angle in degrees, between the left
/// and right edge of the picture (for NFF's square pictures it is the vertical angle too).
struct Camera {
  Vec3 from, at;
  Vec3 up{0, 1, 0};
  float angle = 45;
  std::uint32_t width = 320, height = 240;
};

/// Throws an Error that names `scene` when the camera is not finite or shows nothing: an angle outside
/// 0 .. 180 degrees, no view direction, an up vector along it.
void check_camera(const Camera& camera, std::string_view scene);

/// What a reader or a generator fills in; `Scene` checks it. Primitives are numbered: first all triangles in
/// order, then all quadrics, then all general quadrics.
struct SceneData {
  std::string name;
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into `vertices`
  std::vector<Quadric> quadrics;
  std::vector<GeneralQuadric> general_quadrics;

  std::vector<Material> materials;                       ///< when empty, one default material is supplied
  std::vector<std::uint32_t> triangle_materials;         ///< one for each triangle; empty: all 0
  std::vector<std::uint32_t> quadric_materials;          ///< one for each quadric; empty: all 0
  std::vector<std::uint32_t> general_quadric_materials;  ///< one for each general quadric; empty: all 0

  std::vector<Vec3> normals;  ///< shading normals; may be empty
  /// For each triangle three indices into `normals`, or all no_normal; empty when no triangle has any.
  std::vector<std::array<std::uint32_t, 3>> triangle_normals;
  static constexpr std::uint32_t no_normal = 0xffffffffu;

  std::vector<Light> lights;     ///< when empty, one light near the camera is supplied
  std::optional<Camera> camera;  ///< when empty, one that sees the whole scene is supplied
  Vec3 background{0, 0, 0};
  std::uint64_t shapes =
      0;  ///< what the source calls an object (a polygon counts once); 0: as many as primitives
  std::vector<std::string> warnings;  ///< what was dropped or mended, one line each
};

/// What is traced. Immutable; safe to share between threads. Its coordinates are finite floats without
/// denormals, its indices in range.
class Scene {
 public:
  /// Flushes denormals, checks indices and finiteness, drops quadrics without extent (radius or axis zero)
  /// and general quadrics that nothing can hit (a constant polynomial; no surface within the clip box), with
  /// a warning, refuses clip boxes whose low is above their high, warns of triangles without area (they stay,
  /// so that numbering is the source's, and are never hit), supplies missing camera, lights and material, and
  /// hashes the content. Throws Error naming the scene.
  explicit Scene(SceneData data);

  const std::string& name() const { return data_.name; }
  std::size_t triangle_count() const { return data_.triangles.size(); }
  std::size_t primitive_count() const {
    return data_.triangles.size() + data_.quadrics.size() + data_.general_quadrics.size();
  }
  std::uint64_t shape_count() const { return data_.shapes; }

  /// Vertices, in an array that may be read 4 bytes past its end (Embree reads 16 bytes a vertex).
  std::span<const Vec3> vertices() const { return {data_.vertices.data(), data_.vertices.size() - 1}; }
  std::span<const std::array<std::uint32_t, 3>> triangles() const { return data_.triangles; }
  std::span<const Quadric> quadrics() const { return data_.quadrics; }
  std::span<const GeneralQuadric> general_quadrics() const { return data_.general_quadrics; }

  bool is_triangle(std::uint32_t primitive) const { return primitive < data_.triangles.size(); }
  Triangle triangle(std::uint32_t primitive) const {
    const auto& [a, b, c] = data_.triangles[primitive];
    return {data_.vertices[a], data_.vertices[b], data_.vertices[c]};
  }
  const Quadric& quadric(std::uint32_t primitive) const {
    return data_.quadrics[primitive - data_.triangles.size()];
  }
  const GeneralQuadric& general_quadric(std::uint32_t primitive) const {
    return data_.general_quadrics[primitive - data_.triangles.size() - data_.quadrics.size()];
  }
  /// Calls f with the primitive itself: a Triangle, a Quadric or a GeneralQuadric.
  template <class F>
  decltype(auto) visit(std::uint32_t primitive, F&& f) const {
    if (is_triangle(primitive)) return std::forward<F>(f)(triangle(primitive));
    if (primitive - data_.triangles.size() < data_.quadrics.size())
      return std::forward<F>(f)(quadric(primitive));
    return std::forward<F>(f)(general_quadric(primitive));
  }
  Bounds bounds_of(std::uint32_t primitive) const {
    return is_triangle(primitive) ? raymeter::bounds_of(triangle(primitive)) : bounds_of_other(primitive);
  }

  /// Unit normal of the surface at a point on it, unoriented; {0,0,0} where there is none (a cone's tip).
  Vec3d geometric_normal(std::uint32_t primitive, const Vec3d& point) const;

  const Material& material_of(std::uint32_t primitive) const;
  std::span<const Light> lights() const { return data_.lights; }
  const Camera& camera() const { return *data_.camera; }
  const Vec3& background() const { return data_.background; }
  std::span<const Vec3> normals() const { return data_.normals; }
  std::span<const std::array<std::uint32_t, 3>> triangle_normals() const { return data_.triangle_normals; }

  /// The box of all primitives; empty when there are none.
  const Bounds& bounds() const { return bounds_; }
  /// Of the geometry, materials, lights and camera, not of the name: equal on every machine.
  std::uint64_t hash() const { return hash_; }
  std::span<const std::string> warnings() const { return data_.warnings; }

 private:
  Bounds bounds_of_other(std::uint32_t primitive) const;

  SceneData data_;
  std::vector<Bounds> general_quadric_bounds_;  // which take microseconds to find
  Bounds bounds_;
  std::uint64_t hash_ = 0;
};

/// A camera in front of the box that sees all of it, a little from above (up: the z axis where the box is
/// flattest along z, else y).
Camera default_camera(const Bounds& box);

}  // namespace raymeter
