#include "figure/layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace dlo::compare {
namespace {

/// Style of a curve. The colours follow Okabe and Ito, but are darker, so that they are visible
/// inverted as well. Each has its own marks, so that curves can be distinguished without colour.
struct CurveStyleEntry {
  const char* colour;
  Mark mark;
  Dashes dashes;
};
constexpr CurveStyleEntry styles[curve_colours] = {
    {"#0059A8", Mark::circle, Dashes::solid},
    {"#B34700", Mark::open_square, Dashes::dashed},
    {"#00704F", Mark::triangle, Dashes::dotted},
    {"#8A2F85", Mark::diamond, Dashes::dash_dotted},
    {"#7A5600", Mark::down_triangle, Dashes::dash_dot_dotted},
    {"#404040", Mark::cross, Dashes::dashed}};

using PlotRange = std::array<double, 2>;
constexpr PlotRange empty_range = {HUGE_VAL, -HUGE_VAL};

void widen(PlotRange& range, const std::vector<double>& values) {
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    range = {std::min(range[0], value), std::max(range[1], value)};
  }
}

/// Sets missing limits of an axis to the range of the drawn values plus a margin; without values to
/// that of 0 to 1, or of 1 to 10 on a logarithmic axis. An upper limit that is not above the lower
/// one is moved to 1 above it.
void set_limits(PlotAxis& axis, const PlotRange& drawn) {
  PlotRange range = drawn[0] <= drawn[1] ? drawn
                    : axis.logarithmic   ? PlotRange{1, 10}
                                         : PlotRange{0, 1};
  if (axis.logarithmic) range = {std::log10(range[0]), std::log10(range[1])};
  constexpr double margin = 0.05;
  double more = margin * (range[1] - range[0]);
  // The range of a single value is extended around it.
  if (!(more > 1e-12 * std::abs(range[1]))) {
    more = axis.logarithmic ? 0.5 : range[1] == 0 ? 1 : 0.1 * std::abs(range[1]);
  }
  const auto limit = [&axis](double value) {
    return axis.logarithmic ? std::pow(10, value) : value;
  };
  if (!axis.from) axis.from = limit(range[0] - more);
  if (!axis.to) axis.to = limit(range[1] + more);
  if (!(*axis.to > *axis.from)) axis.to = *axis.from + 1;
}

void move_infinity_to_edge(double& value, const PlotAxis& axis) {
  if (std::isinf(value)) value = value > 0 ? *axis.to : *axis.from;
}

void lay_out(PlotAxis& axis, std::vector<PlottedCurve>& curves,
             std::vector<double> PlottedCurve::*values) {
  PlotRange drawn = empty_range;
  for (PlottedCurve& curve : curves) {
    for (double& value : curve.*values) {
      // A logarithmic axis cannot show it.
      if (axis.logarithmic && std::isfinite(value) && value <= 0) value = NAN;
    }
    widen(drawn, curve.*values);
  }
  set_limits(axis, drawn);
  for (PlottedCurve& curve : curves) {
    for (double& value : curve.*values) move_infinity_to_edge(value, axis);
  }
}

bool has_finite_point(const PlottedCurve& curve) {
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (!std::isnan(curve.x[i]) && !std::isnan(curve.y[i])) return true;
  }
  return false;
}

}  // namespace

CurveStyle curve_style(std::size_t i) {
  const CurveStyleEntry& style = styles[i % curve_colours];
  return {.colour = style.colour, .dashes = style.dashes, .mark = style.mark, .mark_size = 0.8};
}

std::pair<double, double> Cells::range() const {
  PlotRange range = empty_range;
  widen(range, values);
  return {range[0], range[1]};
}

int Panel::full_height() const {
  // Pixels of the labels and title of the horizontal axis, and of the space above the plot.
  constexpr int axis_pixels = 90;
  constexpr int legend_row = 20;
  const auto rows = std::count_if(curves.begin(), curves.end(),
                                  [this](const PlottedCurve& curve) { return shows_title(curve); });
  return height + axis_pixels + legend_row * static_cast<int>(rows);
}

Panel laid_out(Panel panel) {
  lay_out(panel.x, panel.curves, &PlottedCurve::x);
  lay_out(panel.y, panel.curves, &PlottedCurve::y);
  if (panel.z) lay_out(*panel.z, panel.curves, &PlottedCurve::z);
  std::erase_if(panel.curves, [](const PlottedCurve& curve) { return !has_finite_point(curve); });
  for (Text& text : panel.texts) {
    move_infinity_to_edge(text.x, panel.x);
    move_infinity_to_edge(text.y, panel.y);
  }
  return panel;
}

}  // namespace dlo::compare
