#pragma once

namespace raymeter::double_stage {

// The double stage of `decide` for triangles. With P, Q, e: differences of the given floats and d exact,
// every product of three factors in det[d, P, Q] passes at most 7 roundings on its way into the result (2
// differences, 2 products, 1 difference, 2 sums), and in det[e1, e2, P] at most 8. So the results are off by
// at most 7u/(1-7u), 8u/(1-8u) times the sum of the products' magnitudes (u = 2^-53; Higham, "Accuracy and
// Stability of Numerical Algorithms", 2002, lemma 3.1; Shewchuk, "Adaptive Precision Floating-Point
// Arithmetic and Fast Robust Geometric Predicates", 1997, whose orient3d bound has the same 7u), and that sum
// is at most the product of the three 1-norms. One more u pays for the rounding of the norms and of the bound
// itself.
//
// `tiny`, added to each norm, pays for denormal inputs, which count as zero but are not flushed here: they
// move a vector of differences by at most 6 * 2^-126 in the 1-norm, and 8u * tiny = 2^-120. Nothing else can
// underflow or overflow: products of seven floats stay within double's exponents.
inline constexpr double edge_error = 8 * 0x1p-53, plane_error = 9 * 0x1p-53, tiny = 0x1p-70;

}  // namespace raymeter::double_stage
