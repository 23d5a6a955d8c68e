#pragma once
// The rules that choose how many cells a grid has along each axis.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "accel/cell_grid.h"
#include "scenes/base/spec.h"
#include "scenes/scene.h"

namespace raymeter {

/// What the rules look at.
struct ShapeSizes {
  std::uint64_t count = 0;  ///< N
  Vec3d extent;             ///< L_a: of the box of all
  Vec3d mean_extent;        ///< m_a: mean over the shapes of the extents of their boxes
};

/// Of a scene's primitives.
ShapeSizes shape_sizes(const Scene& scene);

/// One way of choosing; exactly one holds.
struct ResolutionRule {
  enum class Kind : std::uint8_t {
    cells,    ///< as given
    amount,   ///< n_a = round(amount L_a / m_a): Sakai et al., early 1990s
    density,  ///< n_a = round(L_a (lambda N / V)^(1/3)), V = L_x L_y L_z: lambda cells for each primitive
    pbrt,     ///< n_a = round(3 N^(1/3) L_a / max L), at most 64: Pharr & Humphreys, pbrt-v2, 2010
  };
  Kind kind = Kind::density;
  double value = 4;                      ///< amount or lambda
  std::array<double, 3> cells{1, 1, 1};  ///< for Kind::cells; whole numbers
};

/// The rules known by name: paper (amount 1), rayshade (lambda 1; Kolb), woo and havran (3; Woo's form, used
/// by Havran 2000), wald (5; Wald et al. 2006), pbrt, kalojanov (0.12; the top level of Kalojanov et al.
/// 2011).
std::vector<std::string> resolution_rule_names();
/// Throws std::logic_error for any other name.
ResolutionRule resolution_rule(const std::string& name);

/// The parameters `cells`, `amount`, `density` and `rule`, of which at most one may be given.
std::vector<Parameter> resolution_parameters(const std::string& default_meaning);
/// The rule that they say, or `otherwise` when none is given. Throws Error when two are, or when cells are
/// not whole.
ResolutionRule resolution_rule(const Arguments& arguments, const ResolutionRule& otherwise);

/// What no rule may exceed.
struct ResolutionLimits {
  std::uint64_t per_axis = 4096;
  std::uint64_t cells = std::uint64_t{1} << 26;  ///< 256 MB of offsets where none is empty
  double thinnest = 0;                           ///< least size of a cell along an axis (unit of the scene)

  /// The default, but with no more cells than can be numbered in half of the memory.
  static ResolutionLimits within(std::uint64_t memory_limit, double thinnest);
};

struct ChosenResolution {
  Resolution n{1, 1, 1};
  bool clamped = false;  ///< by the limits
  std::string note;      ///< where this differs from what the rule's formula says; else empty
};

/// Applies the rule; at least one cell along each axis. Where a formula has no answer or a bad one:
/// - `amount` where all shapes are flat along an axis (m_a = 0 < L_a): round(amount N^(1/3)) cells there;
/// - `density` where the box is thinner than half a cell: one cell there, and the other axes alone get
///   lambda N cells (else a flat scene would get none or far too many);
/// - beyond the limits: all axes are reduced by the same factor.
/// Each is said in the note.
ChosenResolution choose_resolution(const ResolutionRule& rule, const ShapeSizes& shapes,
                                   const ResolutionLimits& limits);

}  // namespace raymeter
