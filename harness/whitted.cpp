#include "harness/whitted.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "harness/camera_rays.h"
#include "harness/ray_origin.h"
#include "harness/shading.h"

namespace raymeter {
namespace {

/// Rays of one purpose that wait to be traced, and what they are worth.
struct Rays {
  std::vector<Ray> rays;
  std::vector<std::uint32_t> pixels;
  std::vector<double> weights;

  std::size_t size() const { return rays.size(); }

  void add(const Vec3& origin, const Vec3d& direction, std::uint32_t pixel, double weight) {
    const Ray ray{origin, 0, flushed(to_float(direction))};
    if (!is_traceable(ray)) return;
    rays.push_back(ray);
    pixels.push_back(pixel);
    weights.push_back(weight);
  }

  /// Takes away the first `count` of them.
  Rays take(std::size_t count) {
    if (count >= size()) return std::exchange(*this, {});
    const auto cut = [count](auto& items) {
      auto rest = std::vector(items.begin() + static_cast<std::ptrdiff_t>(count), items.end());
      items.resize(count);
      return std::exchange(items, std::move(rest));
    };
    return {cut(rays), cut(pixels), cut(weights)};
  }
};

/// The rays of a depth, by purpose; of shadow rays none.
struct Generation {
  unsigned depth = 1;
  Rays rays[ray_purposes - 1];

  bool empty() const {
    return std::ranges::all_of(rays, [](const Rays& some) { return some.size() == 0; });
  }
  /// Takes away a part of at most `most` rays.
  Generation take(std::size_t most) {
    Generation part{depth, {}};
    for (std::size_t purpose = 0; purpose < std::size(rays); ++purpose) {
      part.rays[purpose] = rays[purpose].take(most);
      most -= part.rays[purpose].size();
    }
    return part;
  }
};

/// A surface that waits for its lights.
struct LitSurface {
  ShadedSurface surface;
  std::uint32_t pixel;
  double weight;
};

class Tracer {
 public:
  Tracer(const Scene& scene, const WhittedSettings& settings, const AnswerBatch& answer,
         std::span<WhittedPixel> picture)
      : scene_(scene), settings_(settings), answer_(answer), picture_(picture) {
    const auto lights = static_cast<double>(scene.lights().size());
    for (const Light& light : scene.lights())
      light_colours_.push_back((std::sqrt(lights) / lights) * to_double(light.colour));
  }

  void trace(Rays primary) {
    // At most two parts of each depth wait here: what is left of a generation, and the next one.
    std::vector<Generation> waiting(1);
    waiting[0].rays[0] = std::move(primary);
    while (!waiting.empty()) {
      const Generation part = waiting.back().take(settings_.batch_rays);
      if (waiting.back().empty()) waiting.pop_back();
      Generation next = trace(part);
      if (!next.empty()) waiting.push_back(std::move(next));
    }
  }

 private:
  /// Returns the next generation.
  Generation trace(const Generation& part) {
    Generation next{part.depth + 1, {}};
    std::vector<LitSurface> surfaces;
    for (std::size_t purpose = 0; purpose < std::size(part.rays); ++purpose) {
      const Rays& rays = part.rays[purpose];
      if (rays.size() == 0) continue;
      const BatchAnswers answers =
          answer(begin(static_cast<RayPurpose>(purpose), part.depth), rays.rays, rays.pixels);
      for (std::size_t i = 0; i < rays.size(); ++i) shade(rays, i, answers.hits[i], surfaces, next);
    }
    light(surfaces, part.depth);
    return next;
  }

  WhittedBatch begin(RayPurpose purpose, unsigned depth) const {
    WhittedBatch batch;
    batch.purpose = purpose;
    batch.depth = depth;
    // What later rays begin from is scattered.
    batch.rays.coherent = depth == 1 && settings_.order != RayOrder::shuffled;
    batch.rays.name =
        purpose == RayPurpose::primary ? name_of(purpose) : fmt::format("{}-{}", name_of(purpose), depth);
    batch.rays.query = purpose == RayPurpose::shadow ? QueryKind::any : QueryKind::closest;
    batch.rays.order = settings_.order;
    return batch;
  }

  BatchAnswers answer(WhittedBatch batch, std::vector<Ray> rays, std::vector<std::uint32_t> pixels) const {
    batch.rays.hash = ray_hash(rays);
    batch.rays.rays = std::move(rays);
    batch.pixels = std::move(pixels);
    BatchAnswers answers;
    answer_(batch, answers);
    if (answers.size() != batch.rays.rays.size())
      throw std::logic_error("trace_whitted: not as many answers as rays");
    return answers;
  }

  /// What rays[i] sees: the background, or a surface that waits for light and sends rays on.
  void shade(const Rays& rays, std::size_t i, const Hit& hit, std::vector<LitSurface>& surfaces,
             Generation& next) {
    const std::uint32_t pixel = rays.pixels[i];
    const double weight = rays.weights[i];
    const bool is_primary = next.depth == 2;
    if (is_primary) picture_[pixel].hit = hit;
    if (!hit.found()) {
      add_light(pixel, weight * to_double(scene_.background()));
      return;
    }
    const auto surface = shaded_surface(scene_, rays.rays[i], hit);
    if (!surface) return;
    if (is_primary) picture_[pixel].normal = to_float(surface->normal);
    surfaces.push_back({*surface, pixel, weight});
    if (next.depth > settings_.depth) return;

    const Material& material = *surface->material;
    double mirrored = std::max(0.0f, material.specular);
    if (material.transmittance > 0) {
      const auto direction = refracted_direction(*surface);
      if (!direction) mirrored += material.transmittance;  // total reflection
      const auto start = enter_surface(scene_, rays.rays[i], hit);
      if (direction && start)
        next.rays[std::size_t(RayPurpose::refraction)].add(start->origin, *direction, pixel,
                                                           weight * material.transmittance);
    }
    if (material.specular > 0 || material.transmittance > 0)
      next.rays[std::size_t(RayPurpose::reflection)].add(surface->origin, mirror_direction(*surface), pixel,
                                                         weight * mirrored);
  }

  /// Adds the light of all lights that the surfaces see.
  void light(const std::vector<LitSurface>& surfaces, unsigned depth) {
    std::vector<Ray> rays;
    std::vector<std::uint32_t> pixels;
    std::vector<Vec3d> colours;
    const auto trace_shadows = [&] {
      if (rays.empty()) return;
      const std::size_t count = rays.size();
      const std::vector<std::uint32_t> lit = pixels;
      const BatchAnswers answers =
          answer(begin(RayPurpose::shadow, depth), std::exchange(rays, {}), std::exchange(pixels, {}));
      for (std::size_t i = 0; i < count; ++i)
        if (answers.occluded[i] == 0) add_light(lit[i], colours[i]);
      colours.clear();
    };
    for (std::size_t number = 0; number < scene_.lights().size(); ++number)
      for (const LitSurface& lit : surfaces) {
        const Vec3d to_light = to_double(scene_.lights()[number].position) - to_double(lit.surface.origin);
        if (!(dot(lit.surface.normal, to_light) > 0)) continue;
        const Ray ray{lit.surface.origin, 0, flushed(to_float(to_light)), short_of_the_light};
        if (!is_traceable(ray)) continue;
        if (rays.size() >= settings_.batch_rays) trace_shadows();
        const Vec3d reflected = lit.weight * reflected_light(lit.surface, to_light);
        const Vec3d& colour = light_colours_[number];
        rays.push_back(ray);
        pixels.push_back(lit.pixel);
        colours.push_back({reflected.x * colour.x, reflected.y * colour.y, reflected.z * colour.z});
      }
    trace_shadows();
  }

  void add_light(std::uint32_t pixel, const Vec3d& light) {
    picture_[pixel].colour = picture_[pixel].colour + light;
  }

  const Scene& scene_;
  const WhittedSettings& settings_;
  const AnswerBatch& answer_;
  std::span<WhittedPixel> picture_;
  std::vector<Vec3d> light_colours_;
};

}  // namespace

const char* name_of(RayPurpose purpose) {
  constexpr const char* names[ray_purposes] = {"primary", "reflection", "refraction", "shadow"};
  return names[static_cast<std::size_t>(purpose)];
}

void trace_whitted(const Scene& scene, const WhittedSettings& settings, std::span<const std::uint32_t> pixels,
                   const AnswerBatch& answer, std::span<WhittedPixel> picture) {
  if (picture.size() != pixels.size()) throw std::logic_error("trace_whitted: pixels and picture differ");
  const Camera& camera = settings.camera ? *settings.camera : scene.camera();
  check_camera(camera, scene.name());
  const CameraRays camera_rays(camera, settings.size);
  Rays primary;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    picture[i] = {};
    primary.rays.push_back(camera_rays.through_pixel(pixels[i]));
    primary.pixels.push_back(static_cast<std::uint32_t>(i));
    primary.weights.push_back(1);
  }
  Tracer(scene, settings, answer, picture).trace(std::move(primary));
}

}  // namespace raymeter
