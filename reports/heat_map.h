#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "harness/rendering.h"
#include "reports/canvas.h"

namespace raymeter {

/// What of PixelWork a heat map shows.
enum class WorkMeasure : std::uint8_t { steps, empty_steps, tests, distinct_tests };

/// steps, empty-steps, tests, distinct-tests.
std::span<const std::string_view> work_measure_names();
/// Throws Error naming what there are.
WorkMeasure work_measure(std::string_view name);

/// One structure's part in a sheet of heat maps. Its rendering has been counted.
struct HeatMapPanel {
  std::string title;  ///< its spec
  const Rendering* rendering = nullptr;
};

/// The heat maps of structures, all of one scene and size, side by side on one scale, with a legend. Beneath,
/// where there are several: the picture itself, and for each other structure how much more (orange) or less
/// (blue) it does than the first, again on one scale. A scale ends at a round number above the 99.9th
/// percentile of all its pixels; the few pixels beyond have the colour of its end, which the legend then
/// marks ">=".
Canvas heat_map_sheet(std::string_view scene, WorkMeasure measure, std::span<const HeatMapPanel> panels);

/// The same for one measure. For n of them: the picture, and beside it a row of heat maps for each measure,
/// each row on a scale of its own and 1/n of the picture's size, a pixel of a map being the mean of n x n.
Canvas heat_map_sheet(std::string_view scene, std::span<const WorkMeasure> measures,
                      std::span<const HeatMapPanel> panels);

}  // namespace raymeter
