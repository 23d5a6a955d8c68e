#include "harness/ray_batch.h"

#include <fmt/format.h>

#include "harness/camera_rays.h"
#include "harness/ray_kinds.h"
#include "harness/ray_origin.h"
#include "harness/shuffle.h"
#include "scenes/base/error.h"
#include "scenes/base/hash.h"
#include "scenes/base/random.h"

namespace raymeter {
namespace {

/// Streams of Random, one for each use, so that uses of one seed don't repeat each other.
enum Stream : std::uint64_t { ray_order_stream = 2, directions_stream, chords_stream };

/// Seeds for neighbouring numbers that have nothing in common (the finalizer of SplitMix64: Steele, Lea,
/// Flood, "Fast splittable pseudorandom number generators", 2014).
std::uint64_t mixed(std::uint64_t seed, std::uint64_t number) {
  std::uint64_t x = seed + (number + 1) * 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30u)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27u)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31u);
}

/// Uniform on the unit sphere: a point of the cube that lies in the ball, pushed out to its surface.
Vec3d random_unit_vector(Random& random) {
  while (true) {
    const double x = 2.0 * random.uniform() - 1, y = 2.0 * random.uniform() - 1;
    const Vec3d point{x, y, 2.0 * random.uniform() - 1};
    const double square = dot(point, point);
    if (square > 0x1p-40 && square <= 1) return (1 / std::sqrt(square)) * point;
  }
}

/// Cosine-weighted about the unit vector `normal`: the normal plus a uniform point of the unit sphere ends
/// on a sphere that touches the surface, and chords from a point of a sphere are cosine-weighted (Lambert).
/// Directions flatter than 2^-21, whose rounding might point below the surface, are drawn again.
Vec3d random_bounce(const Vec3d& normal, Random& random) {
  while (true) {
    const Vec3d direction = normal + random_unit_vector(random);
    const double square = dot(direction, direction);  // (2 cos)^2
    if (square > 0x1p-40) return (1 / std::sqrt(square)) * direction;
  }
}

/// A batch without rays, of this kind.
RayBatch begin(const Arguments& kind, RayOrder order) {
  RayBatch batch;
  batch.name = kind.canonical();
  batch.query = find_ray_kind(kind.name()).query.value();
  batch.order = order;
  batch.coherent = order != RayOrder::shuffled && (kind.name() == "primary" || kind.name() == "shadow");
  return batch;
}

void finish(RayBatch& batch) {
  batch.hash = ray_hash(batch.rays);
}

void check_count(std::string_view name, std::uint64_t rays) {
  if (rays > most_rays)
    throw Error(
        fmt::format("{}: {} rays are too many for one batch; {} are the most", name, rays, most_rays));
}

/// Adds origin + t * direction, unless it is beyond the range of float or has no direction.
void add(RayBatch& batch, const Vec3& origin, const Vec3d& direction,
         float tfar = std::numeric_limits<float>::infinity()) {
  const Ray ray{origin, 0, flushed(to_float(direction)), tfar};
  if (is_traceable(ray)) batch.rays.push_back(ray);
}

void add_shadow_rays(RayBatch& batch, const Scene& scene,
                     std::span<const std::optional<SurfaceStart>> starts) {
  for (const Light& light : scene.lights())
    for (const auto& start : starts)
      if (start)
        add(batch, start->origin, to_double(light.position) - to_double(start->origin), short_of_the_light);
}

void add_reflections(RayBatch& batch, std::span<const std::optional<SurfaceStart>> starts,
                     const RayBatch& primary) {
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (!starts[i]) continue;
    const Vec3d in = to_double(primary.rays[i].direction), normal = starts[i]->normal;
    add(batch, starts[i]->origin, normalized(in - (2 * dot(in, normal)) * normal));
  }
}

void add_bounces(RayBatch& batch, std::span<const std::optional<SurfaceStart>> starts,
                 const BatchSettings& settings, std::int64_t samples, float tfar) {
  const auto pixels = pixel_order(settings.size, settings.order, settings.seed);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (!starts[i]) continue;
    Random random(mixed(settings.seed, pixels[i]), directions_stream);
    for (std::int64_t sample = 0; sample < samples; ++sample)
      add(batch, starts[i]->origin, random_bounce(starts[i]->normal, random), tfar);
  }
}

/// The chord between two independent uniform points of a sphere is a uniform isotropic line: seen from the
/// first point, the second is cosine-weighted (see random_bounce), as lines through a surface element are.
void add_chords(RayBatch& batch, const Scene& scene, std::uint64_t seed, std::uint64_t count) {
  const Bounds& box = scene.bounds();
  if (box.empty()) return;
  const Vec3d centre = to_double(box.low) + 0.5 * box.extent();
  const double radius = 0.5 * box.diagonal();
  Random random(seed, chords_stream);
  for (std::uint64_t i = 0; i < count; ++i) {
    const Vec3d from = random_unit_vector(random), to = random_unit_vector(random);
    if (!(from == to)) add(batch, flushed(to_float(centre + radius * from)), normalized(to - from));
  }
}

}  // namespace

std::uint64_t ray_hash(std::span<const Ray> rays) {
  Hasher hasher;
  hasher.array(rays);
  return hasher.digest();
}

RayBatch make_primary(const Scene& scene, const BatchSettings& settings) {
  RayBatch batch = begin(ray_arguments({"primary", {}}), settings.order);
  const PictureSize& size = settings.size;
  if (size.width == 0 || size.height == 0) throw Error("a picture needs at least one pixel");
  check_count(batch.name, std::uint64_t{size.width} * size.height);
  check_count(batch.name, std::uint64_t{size.columns()} * size.rows());
  const Camera& camera = settings.camera ? *settings.camera : scene.camera();
  check_camera(camera, scene.name());

  const CameraRays rays(camera, size);
  for (const std::uint32_t pixel : pixel_order(size, settings.order, settings.seed))
    batch.rays.push_back(rays.through_pixel(pixel));
  finish(batch);
  return batch;
}

RayBatch make_batch(const Scene& scene, const Arguments& kind, const BatchSettings& settings,
                    const RayBatch& primary, std::span<const Hit> primary_hits) {
  if (primary.rays.size() != primary_hits.size() ||
      primary.rays.size() != std::size_t{settings.size.columns()} * settings.size.rows())
    throw std::logic_error("make_batch: rays, hits and settings are of different pictures");
  if (kind.name() == "primary") return primary;

  RayBatch batch = begin(kind, settings.order);
  if (kind.name() == "random") {
    const auto given = static_cast<std::uint64_t>(kind.integer("count"));
    const std::uint64_t count = given ? given : primary.rays.size();
    batch.name = ray_arguments({"random", {{"count", fmt::format("{}", count)}}}).canonical();
    batch.order = RayOrder::shuffled;  // as it is
    add_chords(batch, scene, settings.seed, count);
    finish(batch);
    return batch;
  }

  std::vector<std::optional<SurfaceStart>> starts;
  std::uint64_t found = 0;
  for (std::size_t i = 0; i < primary_hits.size(); ++i) {
    starts.push_back(leave_surface(scene, primary.rays[i], primary_hits[i]));
    found += starts.back().has_value();
  }
  if (kind.name() == "shadow") {
    check_count(batch.name, found * scene.lights().size());
    add_shadow_rays(batch, scene, starts);
  } else if (kind.name() == "reflection") {
    add_reflections(batch, starts, primary);
  } else {
    const std::int64_t samples = kind.integer("samples");
    check_count(batch.name, found * static_cast<std::uint64_t>(samples));
    const float tfar = kind.name() == "ao"
                           ? static_cast<float>(kind.number("length") * scene.bounds().diagonal())
                           : std::numeric_limits<float>::infinity();
    add_bounces(batch, starts, settings, samples, tfar);
  }
  // What starts at one hit would still lie together.
  if (settings.order == RayOrder::shuffled) shuffle(batch.rays, Random(settings.seed, ray_order_stream));
  finish(batch);
  return batch;
}

}  // namespace raymeter
