#include "harness/rendering.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>

#include "scenes/base/error.h"
#include "scenes/base/float_mode.h"
#include "scenes/base/hash.h"

namespace raymeter {
namespace {

constexpr std::uint32_t tile_side = 64;
/// Fixed, as the tiles are: the order in which light is added up must not depend on the machine.
constexpr std::size_t tile_batch_rays = std::size_t{1} << 16u;

using RayCounts = std::map<std::pair<unsigned, RayPurpose>, RayCount>;

void add(RayCounts& counts, const RayCount& more) {
  RayCount& count =
      counts.try_emplace({more.depth, more.purpose}, RayCount{more.purpose, more.depth}).first->second;
  count.rays += more.rays;
  count.hits += more.hits;
}

/// Counts the rays of all tiles, and ends a rendering of too many.
class RayLimit {
 public:
  explicit RayLimit(std::uint64_t most) : most_(most) {}
  void add(std::uint64_t rays) {
    if (rays_ += rays; rays_ > most_)
      throw Error(fmt::format("the picture takes more than {} rays; a smaller depth takes fewer", most_));
  }

 private:
  std::uint64_t most_;
  std::atomic<std::uint64_t> rays_ = 0;
};

/// One tile of a picture, rendered by one thread.
class Tile {
 public:
  Tile(const Scene& scene, const Structure& structure, const RenderSettings& settings, RayLimit& limit)
      : scene_(scene), structure_(structure), settings_(settings), limit_(limit) {}

  void render(const WhittedSettings& whitted, std::vector<std::uint32_t> pixels) {
    const FlushDenormals mode;
    pixels_ = std::move(pixels);
    picture_.resize(pixels_.size());
    if (settings_.count) work_.resize(pixels_.size());
    trace_whitted(
        scene_, whitted, pixels_,
        [this](const WhittedBatch& batch, BatchAnswers& answers) { answer(batch, answers); }, picture_);
    hash_ = hasher_.digest();
  }

  void put_into(Rendering& rendering) const {
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      rendering.pixels[pixels_[i]] = picture_[i];
      if (settings_.count) rendering.work[pixels_[i]] = work_[i];
    }
  }
  const RayCounts& counts() const { return counts_; }
  std::uint64_t hash() const { return hash_; }

 private:
  void answer(const WhittedBatch& batch, BatchAnswers& answers) {
    const BatchView view = batch.rays.view();
    limit_.add(view.rays.size());
    const bool counted = settings_.count && (!settings_.primary_only || batch.purpose == RayPurpose::primary);
    std::vector<RayCounters> counters(counted ? view.rays.size() : 0);
    if (view.query == QueryKind::closest) {
      answers.hits.resize(view.rays.size());
      if (counted)
        structure_.count_closest(view, answers.hits, counters);
      else
        structure_.trace_closest(view, answers.hits);
    } else {
      answers.occluded.resize(view.rays.size());
      if (counted)
        structure_.count_any(view, answers.occluded, counters);
      else
        structure_.trace_any(view, answers.occluded);
    }
    for (std::size_t i = 0; i < counters.size(); ++i) {
      PixelWork& work = work_[batch.pixels[i]];
      work.steps += counters[i].steps;
      work.empty_cell_steps += counters[i].empty_cell_steps;
      work.tests += counters[i].tests;
      work.distinct_tests += counters[i].distinct_tests;
    }
    add(counts_, {batch.purpose, batch.depth, view.rays.size(), count_hits(answers)});
    hasher_.value(batch.rays.hash);
  }

  const Scene& scene_;
  const Structure& structure_;
  const RenderSettings& settings_;
  RayLimit& limit_;
  std::vector<std::uint32_t> pixels_;
  std::vector<WhittedPixel> picture_;
  std::vector<PixelWork> work_;
  RayCounts counts_;
  Hasher hasher_;
  std::uint64_t hash_ = 0;
};

/// The pixels of tile number `index`, in the order of pixel_order.
std::vector<std::uint32_t> tile_pixels(const PictureSize& size, std::size_t index) {
  const std::uint32_t across = (size.columns() + tile_side - 1) / tile_side;
  const auto left = static_cast<std::uint32_t>(index % across) * tile_side;
  const auto top = static_cast<std::uint32_t>(index / across) * tile_side;
  const PictureSize tile{std::min(tile_side, size.columns() - left), std::min(tile_side, size.rows() - top)};
  std::vector<std::uint32_t> pixels = pixel_order(tile, RayOrder::tiled, 0);
  for (std::uint32_t& pixel : pixels)
    pixel = (top + pixel / tile.width) * size.columns() + left + pixel % tile.width;
  return pixels;
}

}  // namespace

void check_picture(const PictureSize& size) {
  if (size.width == 0 || size.height == 0) throw Error("a picture needs at least one pixel");
  if (size.width > most_pixels || size.height > most_pixels ||
      std::uint64_t{size.columns()} * size.rows() > most_pixels)
    throw Error(fmt::format("a picture of {}x{} pixels is too large: {} pixels are the most", size.width,
                            size.height, most_pixels));
}

RayCount Rendering::total(RayPurpose purpose) const {
  RayCount sum{purpose, 0};
  for (const RayCount& count : rays) {
    if (count.purpose != purpose) continue;
    sum.rays += count.rays;
    sum.hits += count.hits;
  }
  return sum;
}

Rendering render(const Scene& scene, const Structure& structure, const RenderSettings& settings,
                 const std::function<void(std::size_t done, std::size_t total)>& progress) {
  const PictureSize& size = settings.size;
  check_picture(size);
  if (settings.count && !structure.counts()) throw Error("this structure can't count what it does");
  Rendering rendering;
  rendering.columns = size.columns();
  rendering.rows = size.rows();
  const std::size_t pixels = std::size_t{size.columns()} * size.rows();
  rendering.pixels.resize(pixels);
  if (settings.count) rendering.work.resize(pixels);

  const WhittedSettings whitted{
      .size = size, .camera = settings.camera, .depth = settings.depth, .batch_rays = tile_batch_rays};
  const std::size_t tiles =
      std::size_t{(size.columns() + tile_side - 1) / tile_side} * ((size.rows() + tile_side - 1) / tile_side);
  std::vector<std::uint64_t> hashes(tiles);
  RayCounts counts;
  RayLimit limit(most_rays_of(pixels));
  std::mutex mutex;
  std::size_t done = 0;
  const auto render_tile = [&](std::size_t index) {
    Tile tile(scene, structure, settings, limit);
    tile.render(whitted, tile_pixels(size, index));
    tile.put_into(rendering);
    hashes[index] = tile.hash();
    const std::lock_guard lock(mutex);
    for (const auto& [key, count] : tile.counts()) add(counts, count);
    if (progress) progress(++done, tiles);
  };
  const unsigned threads = std::max(1u, settings.threads);
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
  tbb::task_arena arena(static_cast<int>(threads));
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, tiles, render_tile, tbb::simple_partitioner()); });

  for (const auto& [key, count] : counts) rendering.rays.push_back(count);
  Hasher hasher;
  hasher.array(std::span<const std::uint64_t>(hashes));
  rendering.ray_hash = hasher.digest();
  return rendering;
}

}  // namespace raymeter
