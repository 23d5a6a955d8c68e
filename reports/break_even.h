#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace raymeter {

/// What a structure costs for N rays: build_s + N / rays_per_s.
struct Cost {
  double build_s = 0, rays_per_s = 0;

  double seconds(double rays) const { return build_s + rays / rays_per_s; }
};

/// The range of ray counts that the report looks at.
inline constexpr double fewest_rays = 1e3, most_rays_shown = 1e10;

/// From where on, or up to where, `a` needs less time than `b`: "always", "never", "from 1.2M rays",
/// "up to 1.2M rays".
std::string cheaper_when(const Cost& a, const Cost& b);

/// One of several structures, and the ray counts for which it is the cheapest of them.
struct CheapestFor {
  std::size_t index = 0;
  double from = 0, to = 0;
};

/// Who is the cheapest from fewest_rays to most_rays_shown, in order.
std::vector<CheapestFor> cheapest(std::span<const Cost> costs);

/// 950, 12k, 3.4M, 1.2G: a count of rays to about two digits.
std::string rough_count(double rays);

}  // namespace raymeter
