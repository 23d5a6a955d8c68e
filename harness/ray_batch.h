#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "accel/structure.h"

namespace raymeter {

/// Rays that every structure gets, unchanged.
struct RayBatch {
  std::string name;  ///< canonical spec of the kind: "primary", "ao:length=0.05", ...
  std::string kind;  ///< primary, shadow, reflection, diffuse, ao, random
  QueryKind query = QueryKind::closest;
  RayOrder order = RayOrder::tiled;
  std::vector<Ray> rays;
  std::uint64_t hash = 0;  ///< of the rays, in order: the same on every machine

  bool coherent() const { return order != RayOrder::shuffled && (kind == "primary" || kind == "shadow"); }
  BatchView view() const { return {rays, query, order, coherent(), 0}; }
};

}  // namespace raymeter
