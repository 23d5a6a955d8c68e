#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "harness/pixel_order.h"
#include "harness/ray_batch.h"
#include "harness/tracing.h"
#include "scenes/scene.h"

namespace raymeter {

/// What a ray of a Whitted tracer is for.
enum class RayPurpose : std::uint8_t { primary, reflection, refraction, shadow };
inline constexpr std::size_t ray_purposes = 4;
/// "primary", "reflection", "refraction", "shadow".
const char* name_of(RayPurpose purpose);

/// The rays of one generation and purpose, or a part of them. `rays.name` says the purpose, and the
/// depth of all but primary rays: "reflection-2", "shadow-1" (from surfaces that rays of
/// depth 1 hit).
struct WhittedBatch {
  RayPurpose purpose = RayPurpose::primary;
  unsigned depth = 1;  ///< of an eye ray 1; of a shadow ray, that of the ray whose hit it starts from
  RayBatch rays;
  std::vector<std::uint32_t> pixels;  ///< by ray: the place of its pixel in the list that was given
};

struct WhittedSettings {
  PictureSize size;
  std::optional<Camera> camera = {};  ///< instead of the scene's
  RayOrder order = RayOrder::tiled;   ///< what batches are marked with
  unsigned depth = 5;                 ///< deepest generation; eye rays are at depth 1
  /// Where a generation of these pixels has more rays it is traced in parts, later generations of one part
  /// before the next part, so that memory is bounded by depth * batch_rays.
  std::size_t batch_rays = most_rays;
};

/// What a pixel's ray saw.
struct WhittedPixel {
  Vec3d colour;  ///< linear
  Hit hit;       ///< of the primary ray
  Vec3 normal;   ///< the one that was shaded with at that hit, toward the viewer; {0,0,0} for none
};

/// Traces a batch: fills in the answers.
using AnswerBatch = std::function<void(const WhittedBatch& batch, BatchAnswers& answers)>;

/// A recursive ray tracer after Whitted ("An improved illumination model for shaded display", 1980) that
/// works generation by generation, without recursion: forms the batches of a depth, has them answered,
/// shades, forms the next. `pixels` (row * columns + column) are rendered in their order; picture[i] is of
/// pixels[i].
///
/// The rules are those of the SPD (Haines, "A proposal for standard graphics environments", 1987), by which
/// rays are counted: a surface with Ks > 0 or T > 0 reflects, one with T > 0 refracts unless reflection is
/// total, down to `depth`; a shadow ray goes to each light in front of the shading normal, and anything
/// blocks it; all surfaces have two sides. Light: NFF's fill, Kd colour and a Phong highlight of Ks for each
/// light that is seen, + Ks times what is reflected (Ks + T in total reflection) + T times what is refracted;
/// each of n lights has sqrt(n) / n of its colour; no ambient light; a ray that leaves the scene sees the
/// background.
///
/// Batches follow from the answers alone: their rays are computed with + - * / sqrt. The origins are
/// leave_surface's and enter_surface's, tnear is 0. The batches of a depth come in the order
/// reflection, refraction, shadow; in them the order is that of the parents, in shadow batches light by
/// light. Throws Error for a camera that shows nothing.
void trace_whitted(const Scene& scene, const WhittedSettings& settings, std::span<const std::uint32_t> pixels,
                   const AnswerBatch& answer, std::span<WhittedPixel> picture);

}  // namespace raymeter
