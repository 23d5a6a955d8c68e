// Times are too noisy to notice a structure that has become a little worse; what it does for a ray is not.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "accel/registry.h"
#include "scenes/base/spec.h"
#include "scenes/open_scene.h"
#include "tests/fixed_batches.h"

namespace raymeter {
namespace {

/// Evenly spread; a surface; large beside small, and beside finely meshed; long and thin; crowded; a hall;
/// small bodies on large planes; quadrics among triangles.
const char* const scenes[] = {"soup:triangles=10000",
                              "terrain:triangles=20000",
                              "sizes:triangles=10000:sigma=1.5",
                              "stadium:triangles=20000",
                              "slivers:triangles=5000",
                              "clusters:objects=10000",
                              "paper/2",
                              "paper/3",
                              "spd/gears:size=2",
                              "spd/teapot",
                              "spd/mount:size=5"};
/// The instruction set that they all have: a block's size depends on it.
const char* const structures[] = {"grid",
                                  "tunable-grid",
                                  "two-level-grid",
                                  "octree",
                                  "octree:traversal=top-down",
                                  "brick-grid:isa=sse4.2",
                                  "brick-grid:isa=sse4.2:query=1"};

const char* const table_file = RAYMETER_TEST_DATA "/work_per_ray.csv";
const char* const renew = "where that is meant to be, renew the table with script/renew-work-tables";

/// By "scene,structure" and the name of a measure.
using Table = std::map<std::string, std::map<std::string, double>>;

std::map<std::string, double> measure(const Scene& scene, const std::vector<RayBatch>& batches,
                                      const Structure& structure) {
  const auto primitives = double(scene.primitive_count());
  const StructureStats stats = structure.stats();
  std::map<std::string, double> measured{{"references per primitive", double(stats.references) / primitives},
                                         {"bytes per primitive", double(stats.bytes) / primitives}};
  for (const RayBatch& batch : batches) {
    BatchAnswers answers;
    const CounterTotals totals = count(structure, batch.view(), answers);
    const auto put = [&](const char* name, std::uint64_t sum) {
      measured[batch.name.substr(0, batch.name.find(':')) + " " + name] = totals.per_ray(sum);
    };
    put("steps", totals.steps);
    put("tests", totals.tests);
    put("test blocks", totals.test_blocks);
    put("decides", totals.decides);
  }
  return measured;
}

Table measure_all() {
  Registry registry;
  register_accel(registry);
  Table table;
  for (const char* name : scenes) {
    const Scene scene = open_scene(name);
    const auto batches = fixed_batches(scene);
    for (const char* spec : structures)
      table[std::string(name) + "," + spec] =
          measure(scene, batches, *registry.build(parse_spec(spec), {scene}));
  }
  return table;
}

void write(const Table& table) {
  std::ofstream file(table_file);
  file << "scene,structure";
  for (const auto& [measure, value] : table.begin()->second) file << ',' << measure;
  for (const auto& [key, row] : table) {
    file << '\n' << key;
    for (const auto& [measure, value] : row) file << ',' << std::round(value * 1000) / 1000;
  }
  file << '\n';
}

Table read() {
  std::ifstream file(table_file);
  std::string line, cell;
  std::vector<std::string> measures;
  Table table;
  while (std::getline(file, line)) {
    const std::size_t end = line.find(',', line.find(',') + 1);
    std::istringstream cells(line.substr(end + 1));
    const bool head = measures.empty();
    for (std::size_t i = 0; std::getline(cells, cell, ','); ++i)
      if (head)
        measures.push_back(cell);
      else
        table[line.substr(0, end)][measures.at(i)] = std::stod(cell);
  }
  return table;
}

TEST(WorkPerRay, SlowIsNoMoreThanItWas) {
#if !defined(__x86_64__)
  GTEST_SKIP() << "brick-grid is for x86";
#endif
  const Table measured = measure_all();
  if (std::getenv("RAYMETER_RENEW") != nullptr) write(measured);
  Table expected = read();
  for (const auto& [key, row] : measured) {
    if (expected[key].size() != row.size()) ADD_FAILURE() << key << " is not in the table; " << renew;
    for (const auto& [measure, was] : expected[key]) {
      const double value = row.at(measure);
      // Of few decides, a few more or less are nothing.
      EXPECT_LE(value, 1.03 * was + 0.003) << key << ": more " << measure << "; " << renew;
      EXPECT_GE(value, 0.85 * was - 0.003) << key << ": far fewer " << measure << ", well done; " << renew;
    }
  }
}

}  // namespace
}  // namespace raymeter
