#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "accel/structure.h"
#include "harness/pixel_order.h"
#include "scenes/base/spec.h"

namespace raymeter {

/// Rays that every structure gets, unchanged.
struct RayBatch {
  std::string name;  ///< canonical spec of the kind: "primary", "ao:length=0.05:samples=1", ...; of random,
                     ///< with the count that there is, not 0; of a file, what that says, and "from FILE"
  QueryKind query = QueryKind::closest;
  RayOrder order = RayOrder::tiled;
  bool coherent = false;   ///< neighbours in the array are neighbours in space
  bool from_file = false;  ///< harness/ray_file.h
  std::vector<Ray> rays;
  std::uint64_t hash = 0;  ///< of the rays, in order: the same on every machine

  BatchView view() const { return {rays, query, order, coherent, 0}; }
};

/// Of rays in order: RayBatch::hash.
std::uint64_t ray_hash(std::span<const Ray> rays);

/// The most rays in one batch: 8 GiB of them.
inline constexpr std::uint64_t most_rays = std::uint64_t{1} << 28u;
/// The end of a shadow ray, whose light is at t = 1: short of whatever the light hangs on.
inline constexpr float short_of_the_light = 0x1.ffffep-1f;  // 1 - 2^-20

/// What a scene's batches have in common.
struct BatchSettings {
  PictureSize size;
  RayOrder order = RayOrder::tiled;
  std::optional<Camera> camera =
      {};                  ///< instead of the scene's; its width and height are not used: `size` is
  std::uint64_t seed = 1;  ///< of everything random. Other seeds than the timed one give pilot rays
};

/// Rays are computed from + - * / sqrt and Random in double and rounded to float, denormals and -0 to +0, so
/// a batch has the same hash on every machine. A batch of more than most_rays is refused with an
/// Error. A batch may be empty.

/// One ray for each pixel of the camera's picture, in the order asked for; directions are unit vectors,
/// rounded. Throws Error for a picture of no or too many pixels and for a camera that shows nothing.
RayBatch make_primary(const Scene& scene, const BatchSettings& settings);

/// The rays of `kind` (its arguments from ray_arguments, harness/ray_kinds.h), which is not `whitted`: those
/// come from trace_whitted. `primary` is make_primary's
/// with the same scene and settings, and `primary_hits[i]` the closest hit of primary.rays[i].
///
/// Secondary rays start at every primary hit, whatever its material, where leave_surface
/// (harness/ray_origin.h) puts their origin: just off the surface, on the side that the primary ray came
/// from; tnear is 0. So the batch follows from the primary hits alone, and is to be derived once, from hits
/// known to be right. Their normals are geometric, not interpolated: reflections and bounces never begin
/// by diving into the surface they leave.
///
/// - shadow: to each light, whether it shines on the viewer's side or not; direction = light - origin, so
/// that
///   the light is at t = 1, and tfar = short_of_the_light. All rays to the first
///   light come first, then all to the second: neighbours are neighbours in space.
/// - reflection: the mirror direction, a unit vector.
/// - diffuse: directions cosine-weighted about the normal, unit vectors.
/// - ao: the directions of diffuse, tfar = length * the diagonal of the scene's box.
/// - random: uniform isotropic chords of the sphere about the scene's box; independent of camera and order.
///
/// The rays of a hit are the same in every order: they are seeded with the pixel, not with the ray's place.
RayBatch make_batch(const Scene& scene, const Arguments& kind, const BatchSettings& settings,
                    const RayBatch& primary, std::span<const Hit> primary_hits);

}  // namespace raymeter
