#pragma once
// Why a float kernel and the truth may differ about one primitive and one ray. Each reason is a formula,
// evaluated in double.
#include <optional>

#include "harness/grading.h"
#include "scenes/scene.h"

namespace raymeter {

/// How far the t of a float kernel may be from the true one, for a ray that hits the primitive at about t.
///
/// Triangle: with e, f two edges, N = e x f and C = vertex - origin, Moeller & Trumbore (1997) in floats that
/// are relative to the origin compute t = (N . C) / (N . D). With u = 2^-24 the rounding of N is at most
/// 7 u |e||f|, so to first order the numerator is off by 11 u |e||f||C|, the denominator by 10 u |e||f||D|
/// and the quotient by 3 u t more. The bound used is 16 u |e||f| (|C| + t |D|) / |N . D| + 4 u t, with the
/// two longest edges and the farthest vertex, since kernels differ in the ones they use.
///
/// Quadric: the discriminant is a difference of terms of the size S^2, with S = |origin - base| + radius +
/// |axis| + t |D|; a float evaluation displaces the surface by about u S^2 / radius, and t by that over the
/// cosine to the normal: 16 u S^2 / (radius |cos| |D|) + 4 u t.
///
/// General quadric: on the line the polynomial is a t^2 + 2 b t + c. A float evaluation of it is off by about
/// 16 u P, where P is the sum of its terms' magnitudes at |origin - centre| + |t D| on each axis, and t by
/// that over the slope: 16 u P / |2 (a t + b)| + 4 u t.
///
/// All are capped where the hit would be displaced by 2^-12 of its distance: beyond that it is for the
/// other formulas to explain it.
double t_bound(const Scene& scene, const Ray& ray, std::uint32_t primitive, double t);

/// Whether b is a or one of the two floats on either side of it.
bool within_2_ulp(float a, float b);

/// What explains `answer` from the two hits alone, where something does: within_bound when the primitive is
/// the same, tie when `decide` puts the other primitive within 2 ulp of the truth. Neither needs a look at
/// the scene.
std::optional<Grade> explain_hit(const Scene& scene, const Ray& ray, const Hit& truth, const Hit& answer);

/// `primitive` is hit, says `decide`, but a kernel did not report it: edge, grazing, at_limit or degenerate,
/// the first that holds; or nothing. `t` is decide's.
std::optional<Grade> explain_missed(const Scene& scene, const Ray& ray, std::uint32_t primitive, float t);

/// `primitive` is not hit in the ray's interval, says `decide`, but a kernel reported it at `t`, or at
/// some t (no value, for any-hit queries): the same reasons.
std::optional<Grade> explain_invented(const Scene& scene, const Ray& ray, std::uint32_t primitive,
                                      std::optional<float> t);

}  // namespace raymeter
