#include "scenes/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenes/base/error.h"
#include "scenes/base/hash.h"
#include "scenes/geometry/ray.h"

namespace raymeter {
namespace {

void flush(float& x) {
  if (std::abs(x) < std::numeric_limits<float>::min()) x = 0;  // denormals and -0 become +0
}
void flush(Vec3& v) {
  flush(v.x);
  flush(v.y);
  flush(v.z);
}

void check_finite(const SceneData& data, const Vec3& v, std::string_view what, std::size_t index) {
  if (!is_finite(v)) throw Error(fmt::format("{}: {} {} is not finite", data.name, what, index));
}

bool has_no_area(const Triangle& t) {
  // Exact enough for a warning: the cross product of differences, in double.
  const Vec3d n = cross(to_double(t.b) - to_double(t.a), to_double(t.c) - to_double(t.a));
  return n == Vec3d{};
}

bool has_extent(const Quadric& q) {
  if (q.kind == QuadricKind::sphere) return q.base_radius > 0;
  return !(q.base == q.apex) && (q.base_radius > 0 || q.apex_radius > 0);
}

void check_quadrics(SceneData& data) {
  std::size_t dropped = 0, kept = 0;
  const bool has_materials = !data.quadric_materials.empty();
  for (std::size_t i = 0; i < data.quadrics.size(); ++i) {
    Quadric& q = data.quadrics[i];
    check_finite(data, q.base, "the position of quadric", i);
    check_finite(data, q.apex, "the apex of quadric", i);
    if (!std::isfinite(q.base_radius) || !std::isfinite(q.apex_radius) || q.base_radius < 0 ||
        q.apex_radius < 0)
      throw Error(fmt::format("{}: the radius of quadric {} is negative or not finite", data.name, i));
    flush(q.base);
    flush(q.apex);
    flush(q.base_radius);
    flush(q.apex_radius);
    if (q.kind != QuadricKind::sphere)
      q.kind = q.base_radius == q.apex_radius ? QuadricKind::cylinder : QuadricKind::cone;
    if (!has_extent(q)) {
      ++dropped;
      continue;
    }
    const Bounds box = bounds_of(q);
    if (!is_finite(box.low) || !is_finite(box.high))
      throw Error(fmt::format("{}: quadric {} reaches beyond the range of float", data.name, i));
    if (has_materials) data.quadric_materials[kept] = data.quadric_materials[i];
    data.quadrics[kept++] = q;
  }
  data.quadrics.resize(kept);
  if (has_materials) data.quadric_materials.resize(kept);
  if (dropped)
    data.warnings.push_back(fmt::format("dropped {} quadrics without extent (radius or axis zero)", dropped));
}

bool is_constant(const GeneralQuadric& q) {
  return std::all_of(q.coefficients.begin(), q.coefficients.end() - 1, [](float x) { return x == 0; });
}

/// Gives the bounds of those that are kept.
std::vector<Bounds> check_general_quadrics(SceneData& data) {
  std::vector<Bounds> bounds;
  std::size_t kept = 0;
  const bool has_materials = !data.general_quadric_materials.empty();
  for (std::size_t i = 0; i < data.general_quadrics.size(); ++i) {
    GeneralQuadric& q = data.general_quadrics[i];
    if (!is_finite(q))
      throw Error(fmt::format("{}: general quadric {} has a number that is not finite", data.name, i));
    for (int axis = 0; axis < 3; ++axis)
      if (q.clip.low[axis] > q.clip.high[axis])
        throw Error(fmt::format("{}: the clip box of general quadric {} is empty", data.name, i));
    flush(q.centre);
    flush(q.clip.low);
    flush(q.clip.high);
    for (float& x : q.coefficients) flush(x);
    const Bounds box = is_constant(q) ? Bounds{} : bounds_of(q);
    if (box.empty()) continue;
    if (has_materials) data.general_quadric_materials[kept] = data.general_quadric_materials[i];
    data.general_quadrics[kept++] = q;
    bounds.push_back(box);
  }
  if (const std::size_t dropped = data.general_quadrics.size() - kept)
    data.warnings.push_back(fmt::format(
        "dropped {} general quadrics without surface (constant, or none in the clip box)", dropped));
  data.general_quadrics.resize(kept);
  if (has_materials) data.general_quadric_materials.resize(kept);
  return bounds;
}

void check_triangles(SceneData& data) {
  for (std::size_t i = 0; i < data.vertices.size(); ++i) {
    check_finite(data, data.vertices[i], "vertex", i);
    flush(data.vertices[i]);
  }
  for (std::size_t i = 0; i < data.normals.size(); ++i) {
    check_finite(data, data.normals[i], "normal", i);
    flush(data.normals[i]);
  }
  std::size_t flat = 0;
  for (std::size_t i = 0; i < data.triangles.size(); ++i) {
    const auto& [a, b, c] = data.triangles[i];
    if (std::max({a, b, c}) >= data.vertices.size())
      throw Error(fmt::format("{}: triangle {} names vertex {} of {}", data.name, i, std::max({a, b, c}),
                              data.vertices.size()));
    flat += has_no_area({data.vertices[a], data.vertices[b], data.vertices[c]});
  }
  if (flat) data.warnings.push_back(fmt::format("{} triangles have no area and are never hit", flat));
  if (!data.triangle_normals.empty() && data.triangle_normals.size() != data.triangles.size())
    throw Error(fmt::format("{}: {} triangles but normals for {}", data.name, data.triangles.size(),
                            data.triangle_normals.size()));
  for (const auto& corners : data.triangle_normals)
    for (const auto n : corners)
      if (n != SceneData::no_normal && n >= data.normals.size())
        throw Error(fmt::format("{}: a triangle names normal {} of {}", data.name, n, data.normals.size()));
}

void check_materials(SceneData& data) {
  if (data.materials.empty()) data.materials.emplace_back();
  for (const auto& [ids, count] :
       {std::pair(&data.triangle_materials, data.triangles.size()),
        std::pair(&data.quadric_materials, data.quadrics.size()),
        std::pair(&data.general_quadric_materials, data.general_quadrics.size())}) {
    if (!ids->empty() && ids->size() != count)
      throw Error(fmt::format("{}: {} primitives but {} material numbers", data.name, count, ids->size()));
    for (const auto id : *ids)
      if (id >= data.materials.size())
        throw Error(fmt::format("{}: material {} of {}", data.name, id, data.materials.size()));
  }
}

std::uint64_t hash_of(const SceneData& data) {
  Hasher hasher;
  hasher.array(std::span<const Vec3>(data.vertices));
  hasher.array(std::span<const std::array<std::uint32_t, 3>>(data.triangles));
  for (const Quadric& q : data.quadrics) {
    hasher.value(q.kind);
    for (const float x :
         {q.base.x, q.base.y, q.base.z, q.base_radius, q.apex.x, q.apex.y, q.apex.z, q.apex_radius})
      hasher.value(x);
  }
  hasher.array(std::span<const std::uint32_t>(data.triangle_materials));
  hasher.array(std::span<const std::uint32_t>(data.quadric_materials));
  for (const Material& m : data.materials)
    for (const float x : {m.colour.x, m.colour.y, m.colour.z, m.diffuse, m.specular, m.shine, m.transmittance,
                          m.refraction_index})
      hasher.value(x);
  hasher.array(std::span<const Vec3>(data.normals));
  hasher.array(std::span<const std::array<std::uint32_t, 3>>(data.triangle_normals));
  for (const Light& light : data.lights)
    for (const Vec3& v : {light.position, light.colour})
      for (int axis = 0; axis < 3; ++axis) hasher.value(v[axis]);
  const Camera& camera = *data.camera;
  for (const Vec3& v : {camera.from, camera.at, camera.up, data.background})
    for (int axis = 0; axis < 3; ++axis) hasher.value(v[axis]);
  hasher.value(camera.angle);
  // Only where there are any: hashes of scenes without are older than these.
  if (!data.general_quadrics.empty()) {
    for (const GeneralQuadric& q : data.general_quadrics) {
      for (const Vec3& v : {q.centre, q.clip.low, q.clip.high})
        for (int axis = 0; axis < 3; ++axis) hasher.value(v[axis]);
      hasher.array(std::span<const float>(q.coefficients));
    }
    hasher.array(std::span<const std::uint32_t>(data.general_quadric_materials));
  }
  return hasher.digest();
}

// Along the normal at a point of the surface, of any length.
Vec3d normal_of(const Triangle& t, const Vec3d&) {
  return cross(to_double(t.b) - to_double(t.a), to_double(t.c) - to_double(t.a));
}
Vec3d normal_of(const Quadric& q, const Vec3d& point) {
  const Vec3d w = point - to_double(q.base);
  if (q.kind == QuadricKind::sphere) return w;
  // The gradient of L |w x A|^2 - (L r0 + delta w.A)^2 (decide.h), halved and divided by L.
  const Vec3d axis = to_double(q.apex) - to_double(q.base);
  const double l = dot(axis, axis), r = q.base_radius, delta = double(q.apex_radius) - r,
               along = dot(w, axis);
  return l * w - along * axis - ((r + delta * along / l) * delta) * axis;
}
Vec3d normal_of(const GeneralQuadric& quadric, const Vec3d& point) {
  const Vec3d w = point - to_double(quadric.centre);
  const auto& q = quadric.coefficients;
  return {2 * (q[0] * w.x) + q[3] * w.y + q[5] * w.z + q[6],
          q[3] * w.x + 2 * (q[1] * w.y) + q[4] * w.z + q[7],
          q[5] * w.x + q[4] * w.y + 2 * (q[2] * w.z) + q[8]};
}

}  // namespace

void check_camera(const Camera& camera, std::string_view scene) {
  if (!is_finite(camera.from) || !is_finite(camera.at) || !is_finite(camera.up))
    throw Error(fmt::format("{}: the camera is not finite", scene));
  if (!(camera.angle > 0 && camera.angle < 180))
    throw Error(fmt::format("{}: the camera's angle is {}, it must lie between 0 and 180 degrees", scene,
                            camera.angle));
  const Vec3d view = to_double(camera.at) - to_double(camera.from);
  if (view == Vec3d{})
    throw Error(fmt::format("{}: the camera looks from the point that it looks at", scene));
  if (length(cross((1 / length(view)) * view, to_double(camera.up))) <= 1e-9 * length(to_double(camera.up)))
    throw Error(fmt::format("{}: the camera's up vector is parallel to its view direction", scene));
}

Scene::Scene(SceneData data) : data_(std::move(data)) {
  if (primitive_count() >= not_answered)
    throw Error(fmt::format("{}: more primitives than can be numbered", data_.name));
  check_materials(data_);
  check_triangles(data_);
  check_quadrics(data_);
  general_quadric_bounds_ = check_general_quadrics(data_);
  data_.vertices.emplace_back();  // the pad that vertices() promises
  if (data_.shapes == 0) data_.shapes = primitive_count();
  for (std::uint32_t i = 0; i < primitive_count(); ++i) bounds_.extend(bounds_of(i));
  if (!data_.camera) data_.camera = default_camera(bounds_);
  if (data_.lights.empty()) {
    // Over the camera's shoulder: up and to the right, as far from the target as the camera.
    const Vec3d from = to_double(data_.camera->from), at = to_double(data_.camera->at);
    const Vec3d right = cross(at - from, to_double(data_.camera->up));
    const double distance = length(at - from), across = length(right);
    Light light;
    light.position = to_float(from + (0.4 * distance / (across > 0 ? across : 1)) * right +
                              (0.6 * distance / std::max(1e-300, length(to_double(data_.camera->up)))) *
                                  to_double(data_.camera->up));
    data_.lights.push_back(light);
  }
  for (std::size_t i = 0; i < data_.lights.size(); ++i) {
    check_finite(data_, data_.lights[i].position, "light", i);
    flush(data_.lights[i].position);
  }
  check_camera(*data_.camera, data_.name);
  flush(data_.camera->from);
  flush(data_.camera->at);
  flush(data_.camera->up);
  hash_ = hash_of(data_);
}

Bounds Scene::bounds_of_other(std::uint32_t primitive) const {
  const std::size_t others = data_.triangles.size() + data_.quadrics.size();
  return primitive >= others ? general_quadric_bounds_[primitive - others]
                             : raymeter::bounds_of(quadric(primitive));
}

Vec3d Scene::geometric_normal(std::uint32_t primitive, const Vec3d& point) const {
  const Vec3d n = visit(primitive, [&](const auto& shape) { return normal_of(shape, point); });
  const double size = length(n);
  return size > 0 ? (1 / size) * n : Vec3d{};
}

const Material& Scene::material_of(std::uint32_t primitive) const {
  std::size_t index = primitive;
  const std::vector<std::uint32_t>* ids = &data_.triangle_materials;
  if (index >= data_.triangles.size()) index -= data_.triangles.size(), ids = &data_.quadric_materials;
  if (ids != &data_.triangle_materials && index >= data_.quadrics.size())
    index -= data_.quadrics.size(), ids = &data_.general_quadric_materials;
  return data_.materials[ids->empty() ? 0 : (*ids)[index]];
}

Camera default_camera(const Bounds& box) {
  Camera camera;
  if (box.empty()) {
    camera.from = {0, 0, 1};
    return camera;
  }
  const Vec3d extent = box.extent();
  const Vec3d centre = to_double(box.low) + 0.5 * extent;
  const bool z_up = extent.z < extent.y && extent.z < extent.x;
  const Vec3d direction = z_up ? normalized(Vec3d{0.6, -0.9, 0.5}) : normalized(Vec3d{0.6, 0.5, 0.9});
  // The box's sphere fits a vertical half angle of atan(0.75 tan 22.5) = 17.3 degrees at 3.4 radii.
  // However small the box, the camera's place must differ from its centre in float.
  const double radius = std::max({0.5 * box.diagonal(), 1e-6 * length(centre), 1e-18});
  camera.from = to_float(centre + 3.4 * radius * direction);
  camera.at = to_float(centre);
  camera.up = z_up ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
  return camera;
}

}  // namespace raymeter
