#include "reports/heat_map.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "reports/rendering_pictures.h"
#include "scenes/base/error.h"

namespace raymeter {
namespace {

constexpr std::string_view measure_names[] = {"steps", "empty-steps", "tests", "distinct-tests"};
constexpr Rgb8 paper{255, 255, 255}, ink{32, 32, 32}, faint{110, 110, 110};

double value_of(const PixelWork& work, WorkMeasure measure) {
  switch (measure) {
    case WorkMeasure::steps:
      return static_cast<double>(work.steps);
    case WorkMeasure::empty_steps:
      return static_cast<double>(work.empty_cell_steps);
    case WorkMeasure::tests:
      return static_cast<double>(work.tests);
    case WorkMeasure::distinct_tests:
      return static_cast<double>(work.distinct_tests);
  }
  return 0;
}

/// Means over blocks of `block` x `block` pixels, row by row; blocks at the far edges may be cut off.
std::vector<double> values_of(const Rendering& rendering, WorkMeasure measure, std::uint32_t block) {
  std::vector<double> values;
  for (std::uint32_t top = 0; top < rendering.rows; top += block)
    for (std::uint32_t left = 0; left < rendering.columns; left += block) {
      double sum = 0;
      const std::uint32_t bottom = std::min(top + block, rendering.rows),
                          right = std::min(left + block, rendering.columns);
      for (std::uint32_t y = top; y < bottom; ++y)
        for (std::uint32_t x = left; x < right; ++x)
          sum += value_of(rendering.work[std::size_t{y} * rendering.columns + x], measure);
      values.push_back(sum / (double(bottom - top) * (right - left)));
    }
  return values;
}

std::vector<double> differences(const std::vector<double>& values, const std::vector<double>& from) {
  std::vector<double> result(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) result[i] = values[i] - from[i];
  return result;
}

/// 1, 2 or 5 times a power of ten: a fifth of `top` or a little more, and at least 1.
double tick_step(double top) {
  double power = 1;
  while (power * 50 < top) power *= 10;
  for (const double factor : {1.0, 2.0, 5.0})
    if (5 * factor * power >= top) return factor * power;
  return 10 * power;
}

/// From 0 (or -end) to end.
struct Scale {
  bool diverging = false;
  double end = 1, step = 1;
  bool cut = false;  ///< there are values beyond the end

  Scale(std::span<const std::vector<double>> maps, bool both_ways) : diverging(both_ways) {
    std::vector<double> values;
    for (const std::vector<double>& map : maps)
      for (const double value : map) values.push_back(std::abs(value));
    if (values.empty()) return;
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(0.999 * double(values.size() - 1));
    std::nth_element(values.begin(), place, values.end());
    step = tick_step(*place);
    end = std::max(step, step * std::ceil(*place / step));
    cut = *std::max_element(values.begin(), values.end()) > end;
  }

  double start() const { return diverging ? -end : 0; }
  Rgb8 colour(double value) const {
    return diverging ? diverging_colour(value / end) : sequential_colour(value / end);
  }
};

std::string number(double value) {
  return std::abs(value) >= 1e7 ? fmt::format("{:.3g}", value) : fmt::format("{:.0f}", value);
}

Canvas false_colours(std::uint32_t width, const std::vector<double>& values, const Scale& scale) {
  const auto height = static_cast<std::uint32_t>(values.size() / width);
  Canvas canvas(width, height, paper);
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      canvas.set(x, y, scale.colour(values[std::size_t{y} * width + x]));
  return canvas;
}

/// Where things stand on a sheet: rows and columns of pictures of one size, perhaps something else to the
/// left of them, legends to the right.
class Sheet {
 public:
  Sheet(std::uint32_t picture_width, std::uint32_t picture_height, std::uint32_t columns, std::uint32_t rows,
        std::uint32_t left_width = 0)
      // Letters that are still read when the whole sheet is shrunk to the width of a page.
      : scale_(std::clamp((left_width + columns * picture_width) / 700, 1u, 8u)),
        margin_(10 * scale_),
        line_(Canvas::text_height * scale_),
        column_width_(std::max(picture_width, 120 * scale_)),
        picture_height_(std::max(picture_height, (left_width == 0 ? 120 : 80) * scale_)),
        left_(left_width == 0 ? 0 : left_width + margin_),
        canvas_(left_ + columns * (column_width_ + margin_) + margin_ + legend_width * scale_,
                2 * margin_ + 2 * line_ + rows * row_height(), paper) {}

  void headline(std::string_view text) { write(margin_, margin_, text, ink, canvas_.width() - 2 * margin_); }

  /// What stands left of the first columns.
  void left(const Canvas& picture) { canvas_.paste(margin_, top(0) + 2 * line_, picture); }

  /// A picture with two lines above it.
  void panel(std::uint32_t column, std::uint32_t row, std::string_view title, std::string_view remark,
             const Canvas& picture) {
    const std::int64_t x = margin_ + left_ + std::int64_t{column} * (column_width_ + margin_);
    write(x, top(row), title, ink, column_width_);
    write(x, top(row) + line_, remark, faint, column_width_);
    canvas_.paste(x, top(row) + 2 * line_, picture);
  }

  void legend(std::uint32_t row, const Scale& scale, std::string_view title) {
    const std::int64_t x = std::int64_t{canvas_.width()} - legend_width * scale_;
    const std::int64_t y = top(row) + 2 * line_, width = 14 * scale_, height = picture_height_;
    write(x, top(row), title, ink, legend_width * scale_);
    for (std::int64_t i = 0; i < height; ++i) {
      const double part = 1 - double(i) / double(height - 1);
      canvas_.fill(x, y + i, static_cast<std::uint32_t>(width), 1,
                   scale.colour(scale.start() + part * (scale.end - scale.start())));
    }
    const int ticks = static_cast<int>(std::lround(scale.end / scale.step));
    for (int tick = scale.diverging ? -ticks : 0; tick <= ticks; ++tick) {
      const double value = tick * scale.step;
      const double part = (value - scale.start()) / (scale.end - scale.start());
      const auto at = y + std::lround((1 - part) * double(height - 1));
      canvas_.fill(x + width, at, 3 * scale_, scale_, ink);
      const bool beyond = scale.cut && std::abs(tick) == ticks;
      const char* sign = !beyond ? "" : tick > 0 ? ">=" : "<=";
      write(x + width + 5 * scale_, at - 3 * scale_,
            fmt::format("{}{}{}", sign, scale.diverging && tick > 0 ? "+" : "", number(value)), ink,
            legend_width * scale_);
    }
  }

  Canvas take() { return std::move(canvas_); }

 private:
  static constexpr std::uint32_t legend_width = 84;

  std::uint32_t row_height() const { return 2 * line_ + picture_height_ + margin_; }
  std::int64_t top(std::uint32_t row) const { return margin_ + 2 * line_ + std::int64_t{row} * row_height(); }
  void write(std::int64_t x, std::int64_t y, std::string_view text, Rgb8 colour, std::uint32_t room) {
    const std::size_t most = room / (Canvas::text_width * scale_);
    canvas_.write(x, y,
                  text.size() <= most ? std::string(text) : std::string(text.substr(0, most - 2)) + "..",
                  colour, scale_);
  }

  std::uint32_t scale_, margin_, line_, column_width_, picture_height_, left_;
  Canvas canvas_;
};

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

std::string_view name_of(WorkMeasure measure) {
  return measure_names[static_cast<std::size_t>(measure)];
}

std::uint32_t divided_up(std::uint32_t size, std::uint32_t by) {
  return (size + by - 1) / by;
}

std::vector<std::vector<double>> values_of_all(WorkMeasure measure, std::span<const HeatMapPanel> panels,
                                               std::uint32_t block) {
  std::vector<std::vector<double>> values;
  for (const HeatMapPanel& panel : panels) values.push_back(values_of(*panel.rendering, measure, block));
  return values;
}

/// One measure of all structures on one scale.
struct HeatMapRow {
  WorkMeasure measure;
  std::span<const HeatMapPanel> panels;
  std::uint32_t block;
  std::vector<std::vector<double>> values;
  Scale scale;

  HeatMapRow(WorkMeasure what, std::span<const HeatMapPanel> of, std::uint32_t block_side)
      : measure(what),
        panels(of),
        block(block_side),
        values(values_of_all(what, of, block_side)),
        scale(values, false) {}

  void put_on(Sheet& sheet, std::uint32_t row) const {
    for (std::uint32_t i = 0; i < panels.size(); ++i)
      sheet.panel(i, row, panels[i].title,
                  fmt::format("mean {:.{}f}, most {}", mean(values[i]), mean(values[i]) < 100 ? 1 : 0,
                              number(*std::max_element(values[i].begin(), values[i].end()))),
                  false_colours(divided_up(panels[i].rendering->columns, block), values[i], scale));
    sheet.legend(row, scale, name_of(measure));
  }
};

}  // namespace

std::span<const std::string_view> work_measure_names() {
  return measure_names;
}

WorkMeasure work_measure(std::string_view name) {
  const auto found = std::ranges::find(measure_names, name);
  if (found == std::end(measure_names))
    throw Error(fmt::format("no heat map '{}'; there are: {}", name, fmt::join(measure_names, ", ")));
  return static_cast<WorkMeasure>(found - std::begin(measure_names));
}

Canvas heat_map_sheet(std::string_view scene, WorkMeasure measure, std::span<const HeatMapPanel> panels) {
  const Rendering& first = *panels[0].rendering;
  const HeatMapRow maps(measure, panels, 1);
  std::vector<std::vector<double>> changes;
  for (const auto& values : maps.values) changes.push_back(differences(values, maps.values[0]));
  const Scale change_scale(changes, true);

  const auto columns = static_cast<std::uint32_t>(panels.size());
  Sheet sheet(first.columns, first.rows, columns, columns > 1 ? 2 : 1);
  sheet.headline(fmt::format("{}: {} per pixel", scene, name_of(measure)));
  maps.put_on(sheet, 0);
  if (columns == 1) return sheet.take();
  sheet.panel(0, 1, "the picture", "", colour_picture(first));
  for (std::uint32_t i = 1; i < columns; ++i)
    sheet.panel(i, 1, fmt::format("{} less {}", panels[i].title, panels[0].title),
                fmt::format("mean {:+.1f}", mean(changes[i])),
                false_colours(first.columns, changes[i], change_scale));
  sheet.legend(1, change_scale, "difference");
  return sheet.take();
}

Canvas heat_map_sheet(std::string_view scene, std::span<const WorkMeasure> measures,
                      std::span<const HeatMapPanel> panels) {
  if (measures.size() == 1) return heat_map_sheet(scene, measures[0], panels);
  const Rendering& picture = *panels[0].rendering;
  const auto rows = static_cast<std::uint32_t>(measures.size());
  Sheet sheet(divided_up(picture.columns, rows), divided_up(picture.rows, rows),
              static_cast<std::uint32_t>(panels.size()), rows, picture.columns);
  sheet.headline(fmt::format("{}, and what its pixels cost", scene));
  sheet.left(colour_picture(picture));
  for (std::uint32_t row = 0; row < rows; ++row) HeatMapRow(measures[row], panels, rows).put_on(sheet, row);
  return sheet.take();
}

}  // namespace raymeter
