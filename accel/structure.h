#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "accel/probe.h"
#include "scenes/geometry/ray.h"
#include "scenes/scene.h"

namespace raymeter {

enum class QueryKind : std::uint8_t { closest, any };
enum class RayOrder : std::uint8_t { tiled, scanline, shuffled };

/// Rays to be traced, as a structure sees them: a whole batch (`prepare`) or one chunk of it.
struct BatchView {
  std::span<const Ray> rays;
  QueryKind query = QueryKind::closest;
  RayOrder order = RayOrder::tiled;
  bool coherent =
      false;  ///< neighbours in the array are neighbours in space (primary and shadow rays, not shuffled)
  std::size_t first = 0;  ///< index of rays[0] in the batch given to `prepare`
};

/// How a structure's answers relate to brute force.
enum class Answers : std::uint8_t {
  exact,         ///< bit-identical hits; anything else is a fault
  within_bound,  ///< its own kernels: differences in the last bits are graded, not failed
};

/// What a structure is made of. A count that means nothing for it stays 0.
struct StructureStats {
  std::array<std::uint32_t, 3> resolution{};  ///< effective cells along each axis (top level)
  std::uint64_t cells = 0;                    ///< N_V: elementary cells or leaves
  std::uint64_t empty_cells = 0;              ///< N_EV
  std::uint64_t inner_nodes = 0;              ///< N_IN
  std::uint64_t references = 0;               ///< N_OIV: primitives in cells, duplicates counted
  std::uint32_t depth = 0;                    ///< levels below the root that exist
  std::uint64_t bytes = 0;                    ///< held after the build, without the scene
  std::uint64_t peak_bytes = 0;               ///< most held at once while building
  std::vector<std::pair<std::string, std::uint64_t>> bytes_by_part;  ///< names without blanks
  std::string isa;  ///< instruction set of the traversal, where it chooses one; empty: what the build is for
  std::string
      note;  ///< what was clamped or substituted, in words; empty when the spec was followed to the letter
};

/// An acceleration structure, built over one scene. Tracing is batched: a virtual call costs a chunk (64 Ki
/// rays or so), never a ray. All functions are const and may run on several threads at once on different
/// chunks.
///
/// Write a class with `template <class Probe> Hit closest_hit(const Ray&, Probe&) const` and
/// `template <class Probe> bool any_hit(const Ray&, Probe&) const` and derive it from `PerRayStructure`
/// (accel/per_ray_structure.h); override these functions directly only to trace packets or foreign code.
class Structure {
 public:
  virtual ~Structure() = default;

  /// hits[i] answers rays[i].
  virtual void trace_closest(const BatchView& batch, std::span<Hit> hits) const = 0;
  /// occluded[i] is 1 where rays[i] hits anything in its interval, else 0.
  virtual void trace_any(const BatchView& batch, std::span<std::uint8_t> occluded) const = 0;

  /// The same source with a counting probe: the same answers, and counters[i] of rays[i]. Chunks may be
  /// larger than timed ones.
  /// A structure that can't count (`counts()` false) is never asked.
  virtual void count_closest(const BatchView& batch, std::span<Hit> hits,
                             std::span<RayCounters> counters) const = 0;
  virtual void count_any(const BatchView& batch, std::span<std::uint8_t> occluded,
                         std::span<RayCounters> counters) const = 0;
  virtual bool counts() const { return true; }

  /// Untimed, once for each batch before it is traced: a chance to lay out rays in place. The rays stay alive
  /// and unchanged until the next `prepare`.
  virtual void prepare(const BatchView& /*batch*/) {}
  virtual StructureStats stats() const = 0;
};

}  // namespace raymeter
