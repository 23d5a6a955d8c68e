// No ray escapes from a closed mesh through a vertex or an edge, whatever the structure.
#include <fmt/format.h>

#include "accel/brick_kernels.h"
#include "tests/accel/grid_tests.h"
#include "tests/closed_sphere.h"

namespace raymeter {
namespace {

class Watertight : public testing::TestWithParam<std::string> {};

TEST_P(Watertight, SlowNoRayLeavesAClosedSphere) {
  expect_watertight_everywhere([&](const Scene& scene) { return build(GetParam(), scene); });
}

std::string name_of(const testing::TestParamInfo<std::string>& test) {
  std::string name = test.param;
  std::erase_if(name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); });
  return name;
}

/// What is compiled for several instruction sets, with each that this CPU has.
std::vector<std::string> every_instruction_set() {
  std::vector<std::string> specs;
  for (const BrickKernels* const kernels : brick_kernels())
    for (const char* spec : {"brick-grid:query=1", "brick-grid:query=16", "two-level-grid:leaf=simd"})
      specs.push_back(fmt::format("{}:isa={}", spec, kernels->isa));
  return specs;
}

INSTANTIATE_TEST_SUITE_P(EveryInstructionSet, Watertight, testing::ValuesIn(every_instruction_set()),
                         name_of);

INSTANTIATE_TEST_SUITE_P(AllStructures, Watertight,
                         testing::Values("grid", "tunable-grid", "tunable-grid:cells=32:fit=box:mailbox=on",
                                         "tunable-grid:cells=48x32x20", "octree", "octree:traversal=top-down",
                                         "two-level-grid", "two-level-grid:cells=5:threshold=0", "brick-grid",
                                         "brick-grid:cells=3:leaf=4", "grid:leaf=simd",
                                         "tunable-grid:cells=32:leaf=simd", "two-level-grid:leaf=simd"),
                         name_of);

}  // namespace
}  // namespace raymeter
