#pragma once
// Where a ray's line meets a quadric surface of any kind: the roots of a quadratic equation, of which those
// outside of slabs don't count. What decide_quadric.cpp and decide_general_quadric.cpp share: doubles with
// error bounds first, then integers.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "scenes/geometry/bounded.h"
#include "scenes/geometry/exact.h"
#include "scenes/geometry/ray.h"
#include "scenes/geometry/rounding.h"

namespace raymeter {

/// a t^2 + 2 b t + c = 0; discriminant = b^2 - a c, however it is computed.
template <class Number>
struct Quadratic {
  Number a, b, c, discriminant;
};

/// A root counts where low <= p + root * q <= high.
template <class Number>
struct Clip {
  Number p, q, low, high;
};

/// Every t of magnitude `far` or more certainly lies outside of the clip.
inline bool certainly_beyond(const Clip<Bounded>& clip, double far) {
  const double low = std::abs(clip.low.value) + clip.low.error,
               high = std::abs(clip.high.value) + clip.high.error;
  return (std::abs(clip.q.value) - clip.q.error) * far * (1 - 0x1p-40) >
         std::abs(clip.p.value) + clip.p.error + std::max(low, high);
}

/// The answer of `decide`, or `undecided`. `t_of` gives the ray's t, as a Bounded, for a root.
template <class ToT>
float least_t(const Ray& ray, const Quadratic<Bounded>& quadratic, std::span<const Clip<Bounded>> clips,
              const ToT& t_of) {
  const auto& [a, b, c, discriminant] = quadratic;
  float best = no_hit;
  // Keeps the root if it counts; false where that is undecided.
  const auto take = [&](const Bounded& root) {
    const Bounded exact_t = t_of(root);
    const float t = within(ray, exact_t.value, exact_t.error);
    if (t == no_hit) return true;
    bool certain = !std::isnan(t);
    for (const Clip<Bounded>& clip : clips) {
      const Bounded place = clip.p + root * clip.q;
      const Bounded above_low = place - clip.low, below_high = clip.high - place;
      if (above_low.certainly_negative() || below_high.certainly_negative()) return true;
      certain &= above_low.certainly_positive() && below_high.certainly_positive();
    }
    if (certain) best = std::min(best, t);
    return certain;
  };

  if (discriminant.certainly_negative()) return no_hit;
  if (!discriminant.certainly_positive()) return undecided;
  // The root without cancellation is far / a, and the other by their product c / a.
  const Bounded s = sqrt(discriminant), far = b.value < 0 ? s - b : -(b + s);
  if (!far.certainly_not_zero() || !take(c / far)) return undecided;
  if (a.certainly_not_zero()) return take(far / a) ? best : undecided;
  // The line is (almost) parallel to an asymptote: the root, if there is one, is at least so far away.
  const double least = (std::abs(far.value) - far.error) / (std::abs(a.value) + a.error);
  return std::ranges::any_of(clips, [&](const Clip<Bounded>& clip) { return certainly_beyond(clip, least); })
             ? best
             : undecided;
}

/// One root of a t^2 + 2 b t + c, known by comparison with fractions.
class ExactRoot {
 public:
  /// a >= 0 and a real root exists; a = 0: the linear equation's, whichever is asked for.
  ExactRoot(const Quadratic<ExactInteger>& quadratic, bool greater) : q_(quadratic), greater_(greater) {}

  /// The sign of the root less h.
  int against(const ExactFraction& h) const {
    const ExactInteger &n = h.numerator, &m = h.denominator;
    if (q_.a.sign() == 0) return -ExactInteger(2 * q_.b * n + q_.c * m).sign() * q_.b.sign();
    const ExactInteger slope = q_.a * n + q_.b * m;
    const int value = ExactInteger((slope + q_.b * m) * n + q_.c * m * m).sign();
    // Between the roots; or outside, on the side that the slope tells; or at one of them, or at both.
    if (value < 0) return greater_ ? 1 : -1;
    if (value > 0) return -slope.sign();
    return slope.sign() == 0 || (slope.sign() > 0) == greater_ ? 0 : -slope.sign();
  }

  bool satisfies(const Clip<ExactInteger>& clip) const {
    return side(clip, clip.low) >= 0 && side(clip, clip.high) <= 0;
  }

  float nearest_float() const {
    return rounded_by_comparison([this](std::int32_t m, int e) { return against(ExactFraction(m, e)); });
  }

 private:
  /// The sign of p + root * q - level.
  int side(const Clip<ExactInteger>& clip, const ExactInteger& level) const {
    const ExactInteger rest = level - clip.p;
    if (clip.q.sign() == 0) return -rest.sign();
    return clip.q.sign() > 0 ? against({rest, clip.q}) : -against({-rest, -clip.q});
  }

  const Quadratic<ExactInteger>& q_;
  bool greater_;
};

/// The answer of `decide`. The roots are the ray's t.
inline float least_t(const Ray& ray, Quadratic<ExactInteger> quadratic,
                     std::span<const Clip<ExactInteger>> clips) {
  auto& [a, b, c, discriminant] = quadratic;
  if (a.sign() == 0 ? b.sign() == 0 : discriminant.sign() < 0) return no_hit;
  if (a.sign() < 0) a = -a, b = -b, c = -c;
  float best = no_hit;
  for (const bool greater : {false, true}) {
    const ExactRoot root(quadratic, greater);
    if (std::ranges::all_of(clips, [&](const Clip<ExactInteger>& clip) { return root.satisfies(clip); }))
      best = std::min(best, within(ray, root.nearest_float()));
  }
  return best;
}

}  // namespace raymeter
