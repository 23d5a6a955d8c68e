#pragma once
// Conservative tests in front of `decide`: they may say `false` only where `decide` would give no_hit, or a
// t above `tmax`. They are inline, in any precision, and hold for any compiler flags (contraction included).
#include "scenes/geometry/primitives.h"
#include "scenes/geometry/ray.h"

namespace raymeter {

/// A ray made ready for many primitive tests.
struct FilterRay {
  explicit FilterRay(const Ray& ray);
  Ray ray;
};

/// False only where decide(ray, triangle) is no_hit or greater than tmax.
bool may_hit(const FilterRay& ray, const Triangle& triangle, float tmax);
bool may_hit(const FilterRay& ray, const Quadric& quadric, float tmax);

// To be replaced by real filters: these let everything through.
inline FilterRay::FilterRay(const Ray& r) : ray(r) {}
inline bool may_hit(const FilterRay&, const Triangle&, float) {
  return true;
}
inline bool may_hit(const FilterRay&, const Quadric&, float) {
  return true;
}

}  // namespace raymeter
