#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "accel/structure.h"
#include "scenes/base/spec.h"

namespace raymeter {

/// What a structure is built from.
struct BuildInput {
  const Scene& scene;    ///< outlives the structure
  unsigned threads = 1;  ///< of the task arena (TBB) in which it is built; at least 1
  std::uint64_t memory_limit =
      std::numeric_limits<std::uint64_t>::max();  ///< bytes; exceeding it throws MemoryLimitExceeded
};

/// A kind of structure, as the registry knows it.
struct StructureKind {
  std::string name;
  std::string summary = {};  ///< one line
  std::string source = {};   ///< where the algorithm comes from: author, year
  Answers answers = Answers::exact;
  std::vector<Parameter> parameters = {};
  std::function<std::unique_ptr<Structure>(const Arguments&, const BuildInput&)> build;
  /// Faults of this kind are shown, but are no failure of a comparison: for a library like Embree, whose
  /// limits are known and nobody's here to mend.
  bool tolerated = false;
};

/// All structures that can be named. Filled explicitly, by register_accel, register_baselines and users.
class Registry {
 public:
  /// Throws std::logic_error when the name is taken.
  void add(StructureKind kind);
  /// Throws Error naming what there is.
  const StructureKind& find(std::string_view name) const;
  std::span<const StructureKind> kinds() const { return kinds_; }

  /// The checked arguments of a spec; throws Error.
  Arguments arguments(const Spec& spec) const;
  /// Builds in a task arena of input.threads, with denormals flushed. Throws Error, MemoryLimitExceeded or
  /// what the structure throws.
  std::unique_ptr<Structure> build(const Spec& spec, const BuildInput& input) const;

 private:
  std::vector<StructureKind> kinds_;
};

/// grid, tunable-grid, octree, two-level-grid, brick-grid.
void register_accel(Registry& registry);

}  // namespace raymeter
