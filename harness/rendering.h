#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "accel/structure.h"
#include "harness/whitted.h"
#include "scenes/scene.h"

namespace raymeter {

struct RenderSettings {
  PictureSize size;
  std::optional<Camera> camera = {};  ///< instead of the scene's
  unsigned depth = 5;
  unsigned threads = 1;
  bool count = false;         ///< what the structure does for each pixel
  bool primary_only = false;  ///< count that of primary rays alone, not of all rays of the pixel
};

/// What a structure did for a pixel: sums of RayCounters over the rays of the pixel.
struct PixelWork {
  std::uint64_t steps = 0, empty_cell_steps = 0, tests = 0, distinct_tests = 0;
};

/// How many rays were cast from one generation for one purpose.
struct RayCount {
  RayPurpose purpose = RayPurpose::primary;
  unsigned depth = 1;
  std::uint64_t rays = 0;
  std::uint64_t hits = 0;  ///< of shadow rays: those that something blocks
};

/// A picture and what it took. Pixels are row by row from the upper left corner.
struct Rendering {
  std::uint32_t columns = 0, rows = 0;
  std::vector<WhittedPixel> pixels;
  std::vector<PixelWork> work;  ///< empty unless counted
  std::vector<RayCount> rays;   ///< those that were cast, by depth, then purpose
  std::uint64_t ray_hash = 0;   ///< of all rays

  /// Over all depths.
  RayCount total(RayPurpose purpose) const;
};

/// The most pixels of a rendering.
inline constexpr std::uint64_t most_pixels = std::uint64_t{1} << 26u;
/// The most rays of a rendering: what mirrors and glass on all sides send on without end.
inline constexpr std::uint64_t most_rays_of(std::uint64_t pixels) {
  return std::max(std::uint64_t{1} << 20u, 1024 * pixels);
}
/// Throws Error for a picture without pixels or with more than most_pixels.
void check_picture(const PictureSize& size);

/// Renders with trace_whitted, tile by tile on `threads` threads; the result depends on none of this.
/// `progress` is told, from any thread but never by two at once, how many of how many tiles are done. Throws
/// Error for a picture without pixels or with more than most_pixels, for more rays than most_rays_of its
/// pixels, for a camera that shows nothing, and for counting with a structure that can't count.
Rendering render(const Scene& scene, const Structure& structure, const RenderSettings& settings,
                 const std::function<void(std::size_t done, std::size_t total)>& progress = {});

}  // namespace raymeter
