#pragma once
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "harness/ray_batch.h"
#include "harness/truth.h"
#include "scenes/base/spec.h"

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

/// Makes the batches of each kind and establishes the truth about them. Secondary rays, and the generations
/// of a Whitted rendering, start from true hits. `reference` is an exact structure; nothing of it is timed.
/// Throws Error as make_batch does, for a Whitted rendering of more than most_rays rays, and when it has not
/// those that were asked for.
std::vector<BatchGroup> make_judged_batches(const Scene& scene, Structure& reference,
                                            const BatchSettings& settings, std::span<const Arguments> kinds,
                                            const ReferenceRefuted& refuted);

}  // namespace raymeter
