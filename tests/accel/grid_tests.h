#pragma once
// Small scenes and rays that a grid may stumble over, and the answers by brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "accel/primitive_test.h"
#include "accel/registry.h"
#include "scenes/base/float_mode.h"
#include "scenes/base/random.h"
#include "scenes/scene.h"
#include "tests/scenes/geometry/adversary.h"

namespace raymeter {

/// Up to `most` triangles, spheres, cylinders and cones about `centre` at `scale`; some in planes parallel to
/// the box, some on a lattice, some coincident, some without area.
inline Scene small_scene(std::uint64_t seed, std::uint32_t most, float scale = 1, Vec3 centre = {}) {
  Random random(seed);
  const auto point = [&](float reach) {
    const float x = random.uniform(-reach, reach), y = random.uniform(-reach, reach);
    return Vec3{x, y, random.uniform(-reach, reach)};
  };
  SceneData data;
  data.name = "small";
  const std::uint32_t count = random.below(most + 1);
  const bool flat = random.below(8) == 0;  // the whole scene in one plane
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 middle = point(1);
    if (random.below(4) != 0 || flat) {
      const float size = random.below(4) == 0 ? 1.0f : 0.2f;
      const std::uint32_t kind = random.below(6);
      Vec3 corners[3];
      for (Vec3& v : corners) v = middle + point(size);
      if (kind == 1) corners[2] = corners[1];
      for (Vec3& v : corners) {
        if (kind == 0) v[int(i % 3)] = middle[int(i % 3)];
        if (kind == 2)
          for (int axis = 0; axis < 3; ++axis) v[axis] = std::floor(v[axis] * 4) * 0.25f;
        if (flat) v[int(seed % 3)] = 0.5f;
        v = centre + scale * v;
        data.vertices.push_back(v);
      }
      const auto last = static_cast<std::uint32_t>(data.vertices.size());
      data.triangles.push_back({last - 3, last - 2, last - 1});
      if (kind == 3) data.triangles.push_back(data.triangles.front());
    } else {
      Quadric q;
      q.kind = static_cast<QuadricKind>(random.below(3));
      q.base = centre + scale * middle;
      q.base_radius = scale * random.uniform(0.02f, 0.5f);
      if (q.kind != QuadricKind::sphere) {
        q.apex = q.base + scale * point(0.6f);
        q.apex_radius = q.kind == QuadricKind::cylinder ? q.base_radius : scale * random.uniform(0.0f, 0.3f);
      }
      data.quadrics.push_back(q);
    }
  }
  return Scene(std::move(data));
}

/// Rays of every kind at a scene: random; along axes with 0 and -0, at and from vertices and edges, in planes
/// of the box and of its cells, from inside and from beyond the far limit, short and reversed intervals, and
/// not traceable.
inline std::vector<Ray> hostile_rays(std::uint64_t seed, std::size_t count, const Scene& scene) {
  Random random(seed);
  const Bounds box = scene.bounds().empty() ? Bounds{{-1, -1, -1}, {1, 1, 1}} : scene.bounds();
  const Vec3d middle = 0.5 * (to_double(box.low) + to_double(box.high));
  const double size = std::max(1e-30, box.diagonal());
  const auto near = [&](double reach) {
    Vec3d p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = middle[axis] + reach * size * random.uniform(-1, 1);
    return to_float(p);
  };
  const auto vertex = [&] {
    const auto vertices = scene.vertices();
    return vertices.empty() ? near(0.5) : vertices[random.below(static_cast<std::uint32_t>(vertices.size()))];
  };
  // On a plane of the box cut into 1, 2, 4, 8 or 16 layers.
  const auto on_planes = [&] {
    Vec3 p = near(0.5);
    for (int axis = 0; axis < 3; ++axis) {
      if (random.below(3) == 0) continue;
      const std::uint32_t n = 1u << random.below(5);
      p[axis] = static_cast<float>(box.low[axis] + box.extent()[axis] * random.below(n + 1) / n);
    }
    return p;
  };
  constexpr float infinity = std::numeric_limits<float>::infinity();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    ray.origin = near(2);
    ray.direction = near(0.5) - ray.origin;
    switch (random.below(9)) {
      case 0:
        ray.direction = vertex() - ray.origin;
        break;
      case 1:
        ray.direction = 0.5f * (vertex() + vertex()) - ray.origin;
        break;
      case 2:
      case 3: {
        constexpr float components[] = {-1, -0.0f, 0.0f, 1};
        for (int axis = 0; axis < 3; ++axis) ray.direction[axis] = components[random.below(4)];
        ray.origin = random.below(2) == 0 ? vertex() : on_planes();
        if (random.below(2) == 0) ray.origin = ray.origin - static_cast<float>(2 * size) * ray.direction;
        break;
      }
      case 4: {
        const float far = random.below(2) == 0 ? 1e4f : 1e8f;
        const Vec3 target = vertex();
        ray.origin = target + far * ray.direction;
        ray.direction = target - ray.origin;
        break;
      }
      case 5:
        ray.origin = vertex();
        ray.direction = vertex() - ray.origin;
        break;
      case 6:
        ray.origin = on_planes();
        ray.direction = on_planes() - ray.origin;
        break;
      default:
        break;
    }
    switch (random.below(12)) {
      case 0:
        ray.tfar = random.uniform(0, 2);
        break;
      case 1:
        ray.tnear = random.uniform(0, 2);
        break;
      case 2:
        ray.tnear = random.uniform(-3, 1);
        ray.tfar = random.uniform(-1, 3);
        break;
      case 3:
        ray.tnear = -infinity;
        break;
      case 4: {
        float* const parts[] = {&ray.origin.x, &ray.direction.y, &ray.tnear, &ray.tfar};
        constexpr float values[] = {nan, infinity, -infinity, 0};
        *parts[random.below(4)] = values[random.below(4)];
        break;
      }
      case 5:
        if (random.below(4) == 0) ray.direction = {};
        break;
      case 6:
        ray.direction = (random.below(2) == 0 ? 1e-12f : 1e12f) * ray.direction;
        break;
      case 7:  // ends exactly at a hit, or begins there
      case 8: {
        const FilterRay filter(ray);
        NoProbe probe;
        Hit best;
        for (std::uint32_t p = 0; p < scene.primitive_count(); ++p)
          test_closest(scene, p, filter, best, probe);
        if (best.found()) (random.below(2) == 0 ? ray.tfar : ray.tnear) = best.t;
        break;
      }
      default:
        break;
    }
    // Batches hold no denormals (DESIGN: they are flushed when a batch is made).
    for (Vec3* v : {&ray.origin, &ray.direction})
      for (int axis = 0; axis < 3; ++axis)
        if (std::abs((*v)[axis]) < std::numeric_limits<float>::min())
          (*v)[axis] = std::signbit((*v)[axis]) ? -0.0f : 0.0f;
  }
  return rays;
}

inline std::unique_ptr<Structure> build(
    std::string_view spec, const Scene& scene,
    std::uint64_t memory_limit = std::numeric_limits<std::uint64_t>::max()) {
  Registry registry;
  register_accel(registry);
  return registry.build(parse_spec(spec), {scene, 1, memory_limit});
}

/// Traces all four ways and expects the answers of brute force, and equal ones with and without counters.
inline void expect_brute_force(const Structure& structure, const Scene& scene, std::span<const Ray> rays,
                               const std::string& what) {
  std::vector<Hit> hits(rays.size()), counted(rays.size());
  std::vector<std::uint8_t> occluded(rays.size()), counted_any(rays.size());
  std::vector<RayCounters> counters(rays.size());
  structure.trace_closest({rays}, hits);
  structure.count_closest({rays}, counted, counters);
  structure.trace_any({rays, QueryKind::any}, occluded);
  structure.count_any({rays, QueryKind::any}, counted_any, counters);
  const FlushDenormals mode;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Hit expected;
    for (std::uint32_t p = 0; p < scene.primitive_count(); ++p) {
      const float t = scene.visit(p, [&](const auto& shape) { return decide(rays[i], shape); });
      if (t != no_hit && Hit{t, p} < expected) expected = {t, p};
    }
    const Ray& r = rays[i];
    ASSERT_EQ(hits[i].primitive, expected.primitive)
        << what << ", ray " << i << ": t " << hits[i].t << " against " << expected.t << ", from "
        << r.origin.x << ' ' << r.origin.y << ' ' << r.origin.z << " to " << r.direction.x << ' '
        << r.direction.y << ' ' << r.direction.z << ", " << r.tnear << " .. " << r.tfar;
    ASSERT_EQ(hits[i].t, expected.t) << what << ", ray " << i;
    ASSERT_EQ(hits[i], counted[i]) << what << ", ray " << i;
    ASSERT_EQ(bool(occluded[i]), expected.found()) << what << ", ray " << i;
    ASSERT_EQ(occluded[i], counted_any[i]) << what << ", ray " << i;
  }
}

/// A few triangles of which a test of many at once, or a box, may make the wrong thing.
inline void expect_brute_force_to_an_adversary(std::span<const std::string> specs) {
  for (const auto style : adversary::styles) {
    Random random(9, unsigned(style));
    for (int round = 0; round < 150; ++round) {
      SceneData data;
      data.name = "adversary";
      std::vector<Triangle> triangles;
      for (std::uint32_t i = 0; i < 1 + random.below(20); ++i) {
        Triangle t = adversary::triangle(random, style);
        for (Vec3* v : {&t.a, &t.b, &t.c})
          for (int axis = 0; axis < 3; ++axis) (*v)[axis] = std::clamp((*v)[axis], -1e36f, 1e36f);
        const auto first = static_cast<std::uint32_t>(data.vertices.size());
        data.vertices.insert(data.vertices.end(), {t.a, t.b, t.c});
        data.triangles.push_back({first, first + 1, first + 2});
        triangles.push_back(t);
      }
      const Scene scene(std::move(data));
      std::vector<Ray> rays;
      for (int i = 0; i < 24; ++i) {
        const Triangle& target = triangles[random.below(static_cast<std::uint32_t>(triangles.size()))];
        Ray ray = adversary::ray_towards(random, style, adversary::point_on(random, target));
        adversary::tempt_interval(random, ray, decide(ray, target));
        rays.push_back(ray);
      }
      for (const std::string& spec : specs)
        ASSERT_NO_FATAL_FAILURE(expect_brute_force(
            *build(spec, scene), scene, rays,
            spec + ", style " + std::to_string(int(style)) + ", round " + std::to_string(round)));
    }
  }
}

/// Rays from afar that hit triangles exactly at their edges, which the boxes of cells end with: where they
/// enter the scene is no float. `at`: where that is all.
inline void expect_edges_hit_from_afar(std::span<const std::string> specs, float at) {
  Random random(17, at == 0 ? 0 : 1);
  for (int round = 0; round < 60; ++round) {
    SceneData data;
    data.name = "edges";
    const auto add = [&](Vec3 a, Vec3 b, Vec3 c) {
      const auto first = static_cast<std::uint32_t>(data.vertices.size());
      for (const Vec3& v : {a, b, c}) data.vertices.push_back({v.x + at, v.y + at, v.z});
      data.triangles.push_back({first, first + 1, first + 2});
    };
    add({-1, -1, 2}, {1, -1, 2}, {1, 1, 2});
    std::vector<Ray> rays;
    for (int i = 0; i < 20; ++i) {
      // All sums below are exact.
      const auto places = [&](float step) { return step * static_cast<float>(1 + random.below(4000)); };
      const bool low = random.below(2) == 0, across_y = random.below(2) == 0;
      const float edge = (low ? -1 : 1) * places(0x1p-12f), along = places(0x1p-13f),
                  size = low ? 0x1p-10f : -0x1p-10f;
      const float slope = places(0x1p-13f) * (random.below(2) == 0 ? 1 : -1);
      const auto point = [&](float u, float v, float z) { return across_y ? Vec3{v, u, z} : Vec3{u, v, z}; };
      add(point(edge, along, 0), point(edge + size, along, 0), point(edge, along + 0x1p-10f, 0));
      const float t = 64 * static_cast<float>(1 << random.below(3));
      const Vec3 from = point(edge - t * slope, along + 0x1p-11f, -t);
      rays.push_back({{from.x + at, from.y + at, from.z}, 0, point(slope, 0, 1)});
    }
    const Scene scene(std::move(data));
    std::size_t hits = 0;
    for (const Ray& ray : rays)
      for (std::uint32_t p = 1; p < scene.primitive_count(); ++p)
        hits += decide(ray, scene.triangle(p)) != no_hit;
    ASSERT_GE(hits, rays.size());
    for (const std::string& spec : specs)
      ASSERT_NO_FATAL_FAILURE(
          expect_brute_force(*build(spec, scene), scene, rays, spec + ", round " + std::to_string(round)));
  }
}

/// What one closest-hit query costs.
inline RayCounters count(const Structure& structure, const Ray& ray) {
  RayCounters counters;
  Hit hit;
  structure.count_closest({{&ray, 1}}, {&hit, 1}, {&counters, 1});
  return counters;
}

/// Two triangles across the x axis, at x = 0.5 (where y + z <= 1) and 3.5 (where y + z >= 1).
inline Scene two_walls() {
  SceneData data;
  data.name = "two walls";
  data.vertices = {{0.5f, 0, 0}, {0.5f, 1, 0}, {0.5f, 0, 1}, {3.5f, 1, 1}, {3.5f, 1, 0}, {3.5f, 0, 1}};
  data.triangles = {{0, 1, 2}, {3, 4, 5}};
  return Scene(std::move(data));
}

/// Thousands of scenes, each with rays at it, through a few specs.
inline void expect_brute_force_on_many_scenes(std::span<const std::string> specs, std::uint64_t scenes) {
  const std::pair<float, Vec3> places[] = {
      {1, {}},      {1, {}},     {1e-3f, {}},          {1e3f, {100, 0, -5000}},
      {1e-12f, {}}, {1e12f, {}}, {1e-2f, {1000, 3, 0}}};
  for (std::uint64_t seed = 0; seed < scenes; ++seed) {
    const auto& [scale, centre] = places[seed % std::size(places)];
    const Scene scene = small_scene(seed, seed % 5 == 0 ? 3 : 30, scale, centre);
    const auto rays = hostile_rays(seed + 1000000, 40, scene);
    for (std::size_t s = 0; s < 3; ++s) {  // three of the specs each, in turn
      const std::string& spec = specs[(seed * 3 + s) % specs.size()];
      ASSERT_NO_FATAL_FAILURE(
          expect_brute_force(*build(spec, scene), scene, rays, spec + ", seed " + std::to_string(seed)));
    }
  }
}

}  // namespace raymeter
