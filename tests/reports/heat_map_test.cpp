#include "reports/heat_map.h"

#include <gmock/gmock.h>

#include "scenes/base/error.h"

namespace raymeter {
namespace {

/// 40 x 30 pixels whose steps are the column, tests the row.
Rendering gradient(std::uint64_t steps_more) {
  Rendering rendering;
  rendering.columns = 40;
  rendering.rows = 30;
  for (std::uint64_t y = 0; y < 30; ++y)
    for (std::uint64_t x = 0; x < 40; ++x) {
      rendering.pixels.push_back({{1, 0, 0}, {}, {}});
      rendering.work.push_back({.steps = x + steps_more, .tests = y});
    }
  return rendering;
}

/// How many pixels of the canvas have this colour.
int count(const Canvas& canvas, Rgb8 colour) {
  int found = 0;
  for (std::uint32_t y = 0; y < canvas.height(); ++y)
    for (std::uint32_t x = 0; x < canvas.width(); ++x) found += canvas.at(x, y) == colour;
  return found;
}

TEST(HeatMap, OneMapHasTheColoursOfItsScale) {
  const Rendering rendering = gradient(0);
  const HeatMapPanel panel{"grid", &rendering};
  const Canvas steps = heat_map_sheet("scene", WorkMeasure::steps, {&panel, 1});
  // Values 0 .. 39 on a scale that ends at 40.
  for (int value = 0; value < 40; ++value)
    EXPECT_GE(count(steps, sequential_colour(value / 40.0)), 30) << value;
  const Canvas tests = heat_map_sheet("scene", WorkMeasure::tests, {&panel, 1});
  for (int value = 0; value < 30; ++value)
    EXPECT_GE(count(tests, sequential_colour(value / 30.0)), 40) << value;
  const Canvas distinct = heat_map_sheet("scene", WorkMeasure::distinct_tests, {&panel, 1});
  EXPECT_GE(count(distinct, sequential_colour(0)), 40 * 30);
}

TEST(HeatMap, SeveralMapsShareAScaleAndShowDifferences) {
  const Rendering first = gradient(0), second = gradient(41);
  const HeatMapPanel panels[] = {{"grid", &first}, {"octree", &second}};
  const Canvas sheet = heat_map_sheet("scene", WorkMeasure::steps, panels);
  EXPECT_GE(count(sheet, sequential_colour(20 / 80.0)), 30);  // in the first alone
  EXPECT_GE(count(sheet, sequential_colour(60 / 80.0)), 30);  // in the second alone
  EXPECT_GE(count(sheet, diverging_colour(41 / 50.0)), 40 * 30);
  EXPECT_GE(count(sheet, {255, 0, 0}), 40 * 30);  // the picture
  const HeatMapPanel turned[] = {panels[1], panels[0]};
  EXPECT_GE(count(heat_map_sheet("scene", WorkMeasure::steps, turned), diverging_colour(-41 / 50.0)),
            40 * 30);
}

TEST(HeatMap, SeveralMeasuresAreRowsOfSmallerMapsBesideThePicture) {
  const Rendering first = gradient(0), second = gradient(41);
  const HeatMapPanel panels[] = {{"grid", &first}, {"octree", &second}};
  const WorkMeasure measures[] = {WorkMeasure::steps, WorkMeasure::tests};
  const Canvas sheet = heat_map_sheet("scene", measures, panels);
  EXPECT_GE(count(sheet, {255, 0, 0}), 40 * 30);  // the picture
  // A pixel of the maps is the mean of 2x2: 20.5 of 80 steps in the first, 61.5 in the second.
  EXPECT_GE(count(sheet, sequential_colour(20.5 / 80)), 15);
  EXPECT_GE(count(sheet, sequential_colour(61.5 / 80)), 15);
  EXPECT_GE(count(sheet, sequential_colour(10.5 / 30)), 2 * 20);  // the tests of both, on their own scale
  const WorkMeasure one[] = {WorkMeasure::steps};
  EXPECT_EQ(heat_map_sheet("scene", one, panels).bytes(),
            heat_map_sheet("scene", WorkMeasure::steps, panels).bytes());
}

TEST(HeatMap, AFewHugeValuesDoNotStretchTheScale) {
  Rendering rendering = gradient(0);
  rendering.work[7].steps = 1000000;
  const HeatMapPanel panel{"grid", &rendering};
  const Canvas sheet = heat_map_sheet("scene", WorkMeasure::steps, {&panel, 1});
  EXPECT_GE(count(sheet, sequential_colour(20 / 40.0)), 30);
}

TEST(HeatMap, MeasuresHaveNames) {
  EXPECT_EQ(work_measure("empty-steps"), WorkMeasure::empty_steps);
  try {
    work_measure("stairs");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "no heat map 'stairs'; there are: steps, empty-steps, tests, distinct-tests");
  }
}

}  // namespace
}  // namespace raymeter
