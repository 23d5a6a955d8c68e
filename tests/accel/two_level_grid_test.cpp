#include "accel/two_level_grid.h"

#include <gmock/gmock.h>

#include "tests/accel/grid_tests.h"

namespace raymeter {
namespace {

TEST(TwoLevelGrid, AnswersLikeBruteForce) {
  const std::string specs[] = {
      "two-level-grid",
      "two-level-grid:threshold=0",
      "two-level-grid:cells=3x4x5:threshold=1:leaf-density=20",
      "two-level-grid:amount=0.5:threshold=2:fit=box",
      "two-level-grid:cells=1:threshold=2:leaf-density=8",
      "two-level-grid:density=1:threshold=1000",
      "two-level-grid:rule=kalojanov:threshold=3:leaf-density=2.4",
  };
  expect_brute_force_on_many_scenes(specs, 1500);
}

}  // namespace
}  // namespace raymeter
