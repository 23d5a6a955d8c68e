#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "accel/registry.h"
#include "harness/ray_batch.h"
#include "harness/truth.h"
#include "scenes/base/spec.h"
#include "scenes/scene.h"

namespace raymeter {

/// A batch with what is known to be true of it.
struct JudgedBatch {
  RayBatch rays;
  Truth truth;
};

/// The batches of one ray kind: one, or of `whitted` one for each generation and purpose.
struct BatchGroup {
  std::vector<JudgedBatch> batches;
  /// Canonical spec of all of them together, which get a row of their own; empty where there is none.
  std::string sum_name;

  /// Over the hashes of the batches, in order.
  std::uint64_t ray_hash() const;
};

/// Is told of a batch's name, and of the number of its rays on which brute force refuted the reference.
using ReferenceRefuted = std::function<void(std::string_view batch, std::size_t rays)>;

/// Makes a scene's batches, and says what is true of them. Answers are a reference structure's
/// (build_reference), proved as establish_truth does; nothing of it is timed.
class BatchJudge {
 public:
  /// `scene` must outlive it. Throws Error where no reference can be built.
  BatchJudge(const Scene& scene, const Registry& registry, const BatchSettings& settings, unsigned threads,
             ReferenceRefuted refuted);

  /// The batches of a kind (ray_arguments). Secondary rays, and the generations of a Whitted rendering, start
  /// from true hits; primary ones are derived once, at first need. Throws Error as make_batch does, for a
  /// Whitted rendering of more than most_rays rays, and when it has not those that were asked for.
  BatchGroup batches(const Arguments& kind);
  /// A batch of any origin.
  JudgedBatch judged(RayBatch rays) const;

 private:
  BatchGroup record_whitted(const Arguments& kind) const;

  const Scene& scene_;
  BatchSettings settings_;
  std::unique_ptr<Structure> reference_;
  ReferenceRefuted refuted_;
  std::optional<JudgedBatch> primary_;
};

}  // namespace raymeter
