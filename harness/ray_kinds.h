#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "accel/structure.h"
#include "scenes/base/spec.h"

namespace raymeter {

/// A kind of rays, named with parameters like a structure: `ao:length=0.05`.
struct RayKind {
  std::string name;
  std::string summary;             ///< one line
  std::optional<QueryKind> query;  ///< nothing: rays of both
  std::vector<Parameter> parameters;
};

/// primary, shadow, reflection, diffuse, ao, random, whitted: in the order of `raymeter list rays`.
std::span<const RayKind> ray_kinds();

/// Throws Error naming what kinds there are.
const RayKind& find_ray_kind(std::string_view name);

/// A spec's arguments, checked against the table of its kind. Throws Error.
Arguments ray_arguments(const Spec& spec);

}  // namespace raymeter
