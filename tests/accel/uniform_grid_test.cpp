#include "accel/uniform_grid.h"

#include <gmock/gmock.h>

#include "tests/accel/grid_tests.h"

namespace raymeter {
namespace {

TEST(UniformGrid, AnswersLikeBruteForce) {
  const std::string specs[] = {
      "grid",
      "grid:amount=0.3",
      "grid:amount=3",
      "tunable-grid",
      "tunable-grid:cells=1",
      "tunable-grid:cells=8:fit=box:mailbox=on",
      "tunable-grid:cells=16x2x5:mailbox=on",
      "tunable-grid:density=50",
      "tunable-grid:amount=2:fit=exact",
      "tunable-grid:rule=pbrt",
      "tunable-grid:cells=4:fit=exact",
  };
  expect_brute_force_on_many_scenes(specs, 1500);
}

}  // namespace
}  // namespace raymeter
