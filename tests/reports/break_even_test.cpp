#include "reports/break_even.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace raymeter {
namespace {

TEST(BreakEven, SaysFromWhereOrUpToWhere) {
  const Cost base{0.1, 1e6};
  EXPECT_EQ(cheaper_when({0.2, 2e6}, base), "from 200k rays");   // 0.2 + N/2e6 = 0.1 + N/1e6
  EXPECT_EQ(cheaper_when({0, 0.5e6}, base), "up to 100k rays");  // N/0.5e6 = 0.1 + N/1e6
  EXPECT_EQ(cheaper_when({0.05, 2e6}, base), "always");
  EXPECT_EQ(cheaper_when({0.05, 1e6}, base), "always");
  EXPECT_EQ(cheaper_when({0.2, 1e6}, base), "never");
  EXPECT_EQ(cheaper_when({0.2, 0.5e6}, base), "never");
  EXPECT_EQ(cheaper_when(base, base), "never");
}

TEST(BreakEven, TheCheapestIsTheLeastEverywhere) {
  const std::vector<Cost> costs{{1, 1e8}, {0, 1e5}, {0.01, 1e6}, {0.5, 1e6}, {0.02, 1.01e6}, {0.01, 1e6}};
  const std::vector<CheapestFor> ranges = cheapest(costs);
  ASSERT_FALSE(ranges.empty());
  EXPECT_EQ(ranges.front().from, fewest_rays);
  EXPECT_EQ(ranges.back().to, most_rays_shown);
  for (std::size_t i = 1; i < ranges.size(); ++i) EXPECT_EQ(ranges[i].from, ranges[i - 1].to);
  for (const CheapestFor& range : ranges) {
    const double rays = std::sqrt(range.from * range.to);
    for (const Cost& other : costs) EXPECT_LE(costs[range.index].seconds(rays), other.seconds(rays)) << rays;
  }
  EXPECT_TRUE(cheapest({}).empty());
}

TEST(BreakEven, RoughCountsAreShort) {
  EXPECT_EQ(rough_count(950), "950");
  EXPECT_EQ(rough_count(999.6), "1.0k");
  EXPECT_EQ(rough_count(12'345), "12k");
  EXPECT_EQ(rough_count(1e10), "10G");
  EXPECT_EQ(rough_count(3.4e6), "3.4M");
  EXPECT_EQ(rough_count(1e18), "1.0e+06T");
}

}  // namespace
}  // namespace raymeter
