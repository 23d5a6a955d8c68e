#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

#include "harness/truth.h"

namespace raymeter {

/// How an answer stands to the truth, from harmless to bad. An answer gets the first that is true of it; one
/// that contradicts the truth about several primitives gets the last of theirs. Formulas: dispute.h.
enum class Grade : std::uint8_t {
  right,         ///< bit-identical (or, of a within_bound row, a miss with whatever t)
  within_bound,  ///< the t of a float kernel, within its error bound
  tie,           ///< another primitive, whose exact t is within 2 ulp
  edge,  ///< a primitive passed so near its edge that a float kernel can't tell the side (2^-20 barycentric,
         ///< or its error bound)
  grazing,      ///< a primitive passed along its surface
  at_limit,     ///< a hit as near to tnear or tfar as the kernel's error
  degenerate,   ///< a triangle thinner than rounding
  wrong,        ///< contradicts the truth, and nothing above explains it
  not_given,    ///< the structure did not answer
  unexplained,  ///< differs, and was not examined: the budget had run out
};
inline constexpr std::size_t grade_count = 10;
std::string_view name_of(Grade grade);

/// How many rays got each grade. They sum to the rays of the batch.
struct Grades {
  std::uint64_t right = 0, within_bound = 0, tie = 0, edge = 0, grazing = 0, at_limit = 0, degenerate = 0,
                wrong = 0, not_given = 0, unexplained = 0;

  std::uint64_t& operator[](Grade grade);
  std::uint64_t operator[](Grade grade) const;
  std::uint64_t total() const;
  /// Nothing wrong, withheld or unexplained: what an own structure must be.
  bool faultless() const { return wrong == 0 && not_given == 0 && unexplained == 0; }
};

/// Grades every answer. Where an exact row differs it is wrong, or unexplained if brute force was not asked
/// (settle_disputes comes first). The differences of a within_bound row are explained from the two hits, or
/// else primitive by primitive, from `decide` over the whole scene; those beyond `test_budget` ray-primitive
/// tests are `unexplained`.
Grades grade(const Scene& scene, const RayBatch& batch, const Truth& truth, const Row& row,
             double test_budget = 2.5e9);

}  // namespace raymeter
