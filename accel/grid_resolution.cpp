#include "accel/grid_resolution.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "accel/note.h"
#include "accel/parallel.h"
#include "scenes/base/error.h"

namespace raymeter {
namespace {

using Kind = ResolutionRule::Kind;
using Wanted = std::array<double, 3>;

constexpr std::string_view unset = "unset";
constexpr std::string_view axis_names = "xyz";

struct NamedRule {
  std::string_view name;
  ResolutionRule rule;
};
const std::array<NamedRule, 7> named_rules{{
    {"paper", {Kind::amount, 1}},
    {"rayshade", {Kind::density, 1}},
    {"woo", {Kind::density, 3}},
    {"havran", {Kind::density, 3}},
    {"wald", {Kind::density, 5}},
    {"pbrt", {Kind::pbrt, 3}},
    {"kalojanov", {Kind::density, 0.12}},
}};

Wanted by_amount(double amount, const ShapeSizes& shapes, std::string& note) {
  Wanted n{1, 1, 1};
  for (int axis = 0; axis < 3; ++axis) {
    if (shapes.extent[axis] == 0) continue;
    if (shapes.mean_extent[axis] > 0) {
      n[axis] = amount * shapes.extent[axis] / shapes.mean_extent[axis];
    } else {
      n[axis] = amount * std::cbrt(double(shapes.count));
      add_note(note, fmt::format("all shapes are flat along {}: {} cells there", axis_names[axis],
                                 std::max(1.0, std::round(n[axis]))));
    }
  }
  return n;
}

Wanted by_density(double lambda, const ShapeSizes& shapes, std::string& note) {
  std::array<bool, 3> thin{};
  while (true) {
    // Cubic cells (or squares, or lengths) along the axes that are not thin.
    double volume = 1;
    int axes = 0;
    for (int axis = 0; axis < 3; ++axis) {
      thin[axis] |= shapes.extent[axis] == 0;
      if (thin[axis]) continue;
      volume *= shapes.extent[axis];
      ++axes;
    }
    if (axes == 0) return {1, 1, 1};
    const double wanted_cells = lambda * double(shapes.count);
    const double root = axes == 3   ? std::cbrt(wanted_cells / volume)
                        : axes == 2 ? std::sqrt(wanted_cells / volume)
                                    : wanted_cells / volume;
    Wanted n{1, 1, 1};
    bool again = false;
    for (int axis = 0; axis < 3; ++axis) {
      if (thin[axis]) continue;
      n[axis] = shapes.extent[axis] * root;
      // When nothing is left to give the cells to, one cell along this axis is what the formula says.
      if (n[axis] < 0.5 && wanted_cells >= 1 && axes > 1) {
        thin[axis] = again = true;
        add_note(note, fmt::format("thin along {}: 1 cell there", axis_names[axis]));
      }
    }
    if (!again) return n;
  }
}

Wanted by_pbrt(double factor, const ShapeSizes& shapes) {
  Wanted n{1, 1, 1};
  const double longest = std::max({shapes.extent.x, shapes.extent.y, shapes.extent.z});
  if (longest > 0)
    for (int axis = 0; axis < 3; ++axis)
      n[axis] = std::min(
          64.0, std::round(factor * std::cbrt(double(shapes.count)) * shapes.extent[axis] / longest));
  return n;
}

std::string product(const Wanted& n) {
  return fmt::format("{:.0f}x{:.0f}x{:.0f}", n[0], n[1], n[2]);
}

/// Whole, at least one along each axis, and within the limits.
ChosenResolution limited(Wanted wanted, const ShapeSizes& shapes, const ResolutionLimits& limits) {
  for (double& n : wanted) n = std::max(1.0, std::round(n));
  const Wanted asked = wanted;
  ChosenResolution chosen;
  std::string limit;

  for (int axis = 0; axis < 3; ++axis) {
    double most = double(limits.per_axis);
    std::string what = fmt::format("{} along an axis", limits.per_axis);
    if (limits.thinnest > 0 && shapes.extent[axis] / limits.thinnest < most) {
      most = std::max(1.0, std::floor(shapes.extent[axis] / limits.thinnest));
      what = fmt::format("cells along {} no thinner than {:.3g}", axis_names[axis], limits.thinnest);
    }
    if (wanted[axis] > most) {
      wanted[axis] = most;
      add_note(limit, what);
    }
  }

  const auto scaled = [&](double factor) {
    Wanted n;
    for (std::size_t axis = 0; axis < 3; ++axis) n[axis] = std::max(1.0, std::floor(wanted[axis] * factor));
    return n;
  };
  const auto fits = [&](const Wanted& n) { return n[0] * n[1] * n[2] <= double(limits.cells); };
  if (!fits(wanted)) {
    // Bisect for the greatest common factor that fits; 1x1x1 always does.
    double low = 0, high = 1;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (fits(scaled(middle)) ? low : high) = middle;
    }
    wanted = scaled(low);
    add_note(limit, fmt::format("{} cells", limits.cells));
  }

  chosen.clamped = wanted != asked;
  if (chosen.clamped)
    chosen.note = fmt::format("clamped from {} to {} (limit {})", product(asked), product(wanted), limit);
  for (std::size_t axis = 0; axis < 3; ++axis) chosen.n[axis] = static_cast<std::uint32_t>(wanted[axis]);
  return chosen;
}

}  // namespace

ShapeSizes shape_sizes(const Scene& scene) {
  ShapeSizes shapes;
  shapes.count = scene.primitive_count();
  shapes.extent = scene.bounds().extent();
  const auto sum = sum_of_ranges<Vec3d>(shapes.count, 4096, [&](std::uint64_t begin, std::uint64_t end) {
    Vec3d part;
    for (std::uint64_t p = begin; p < end; ++p)
      part = part + scene.bounds_of(static_cast<std::uint32_t>(p)).extent();
    return part;
  });
  if (shapes.count > 0) shapes.mean_extent = (1 / double(shapes.count)) * sum;
  return shapes;
}

std::vector<std::string> resolution_rule_names() {
  std::vector<std::string> names;
  for (const auto& known : named_rules) names.emplace_back(known.name);
  return names;
}

ResolutionRule resolution_rule(const std::string& name) {
  for (const auto& known : named_rules)
    if (known.name == name) return known.rule;
  throw std::logic_error(fmt::format("no resolution rule '{}'", name));
}

std::vector<Parameter> resolution_parameters(const std::string& default_meaning) {
  const std::string one =
      fmt::format("at most one of cells, amount, density, rule; none: {}", default_meaning);
  return {
      {"cells", ParameterType::vector, std::string(unset), "cells along x, y, z, or along each; " + one, 1,
       4096},
      {"amount", ParameterType::number, std::string(unset),
       "cell size is the mean extent of the primitives' boxes divided by this", 1e-3, 1e3},
      {"density", ParameterType::number, std::string(unset), "cells for each primitive", 1e-6, 1e4},
      {"rule", ParameterType::choice, std::string(unset),
       "a published rule: paper (amount 1), rayshade (density 1), woo and havran (3), wald (5), "
       "pbrt (3 N^(1/3) along the longest axis, at most 64), kalojanov (0.12)",
       0, 0, resolution_rule_names()},
  };
}

ResolutionRule resolution_rule(const Arguments& arguments, const ResolutionRule& otherwise) {
  std::vector<std::string_view> given;
  for (const std::string_view name : {"cells", "amount", "density", "rule"})
    if (arguments.text(name) != unset) given.push_back(name);
  if (given.size() > 1)
    throw Error(fmt::format("{}: {} each choose the resolution; give one", arguments.name(),
                            fmt::join(given, " and ")));
  if (given.empty()) return otherwise;
  if (given[0] == "amount") return {Kind::amount, arguments.number("amount")};
  if (given[0] == "density") return {Kind::density, arguments.number("density")};
  if (given[0] == "rule") return resolution_rule(arguments.text("rule"));
  const auto values = arguments.vector("cells");
  ResolutionRule rule{Kind::cells, 0};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    rule.cells[axis] = values[values.size() == 3 ? axis : 0];
    if (rule.cells[axis] != std::floor(rule.cells[axis]))
      throw Error(
          fmt::format("{}: cells={} should be whole numbers", arguments.name(), arguments.text("cells")));
  }
  return rule;
}

ResolutionLimits ResolutionLimits::within(std::uint64_t memory_limit, double thinnest) {
  ResolutionLimits limits;
  limits.cells = std::clamp(memory_limit / 2 / sizeof(std::uint32_t), std::uint64_t{1}, limits.cells);
  limits.thinnest = thinnest;
  return limits;
}

ChosenResolution choose_resolution(const ResolutionRule& rule, const ShapeSizes& shapes,
                                   const ResolutionLimits& limits) {
  std::string note;
  Wanted wanted{1, 1, 1};
  switch (rule.kind) {
    case Kind::cells:
      wanted = rule.cells;
      break;
    case Kind::amount:
      wanted = by_amount(rule.value, shapes, note);
      break;
    case Kind::density:
      wanted = by_density(rule.value, shapes, note);
      break;
    case Kind::pbrt:
      wanted = by_pbrt(rule.value, shapes);
      break;
  }
  ChosenResolution chosen = limited(wanted, shapes, limits);
  if (!chosen.note.empty()) add_note(note, chosen.note);
  chosen.note = std::move(note);
  return chosen;
}

}  // namespace raymeter
