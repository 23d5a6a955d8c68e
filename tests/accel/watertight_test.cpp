// No ray escapes from a closed mesh through a vertex or an edge, whatever the structure.
#include "tests/accel/grid_tests.h"
#include "tests/closed_sphere.h"

namespace raymeter {
namespace {

class Watertight : public testing::TestWithParam<std::string> {};

TEST_P(Watertight, SlowNoRayLeavesAClosedSphere) {
  expect_watertight_everywhere([&](const Scene& scene) { return build(GetParam(), scene); });
}

INSTANTIATE_TEST_SUITE_P(AllStructures, Watertight,
                         testing::Values("grid", "tunable-grid", "tunable-grid:cells=32:fit=box:mailbox=on",
                                         "tunable-grid:cells=48x32x20", "octree", "octree:traversal=top-down",
                                         "two-level-grid", "two-level-grid:cells=5:threshold=0", "brick-grid",
                                         "brick-grid:cells=3:leaf=4", "grid:leaf=simd",
                                         "tunable-grid:cells=32:leaf=simd", "two-level-grid:leaf=simd"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::erase_if(name,
                                         [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); });
                           return name;
                         });

}  // namespace
}  // namespace raymeter
