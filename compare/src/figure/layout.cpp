#include "figure/layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

namespace dlo::compare {
namespace {

constexpr int right_margin = figure_width - 76 - plot_width;  // [pixels]

/// Colours after Okabe and Ito, darker, so that they stand out inverted as well, each with its own
/// dashes and marks, so that none is told by colour alone.
struct CurveLook {
  const char* colour;
  Mark mark;
  Dashes dashes;
};
constexpr CurveLook looks[curve_colours] = {
    {"#0059A8", Mark::circle, Dashes::solid},
    {"#B34700", Mark::open_square, Dashes::dashed},
    {"#00704F", Mark::triangle, Dashes::dotted},
    {"#8A2F85", Mark::diamond, Dashes::dash_dotted},
    {"#7A5600", Mark::down_triangle, Dashes::dash_dot_dotted},
    {"#404040", Mark::cross, Dashes::dashed}};

using PlotRange = std::array<double, 2>;
constexpr PlotRange nothing = {HUGE_VAL, -HUGE_VAL};

void widen(PlotRange& range, const std::vector<double>& values) {
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    range = {std::min(range[0], value), std::max(range[1], value)};
  }
}

/// A number at an axis, with as many digits as its neighbours a step away differ in.
std::string number_at(double at, double step) {
  constexpr int usual = 6;
  if (std::abs(at) < step / 2) return "0";
  const int needed = static_cast<int>(std::ceil(std::log10(std::abs(at) / step) - 1e-9)) + 1;
  return fmt::format("{:.{}g}", at, std::max(usual, needed));
}

std::vector<Tic> linear_tics(const PlotAxis& axis, double step) {
  std::vector<Tic> tics;
  constexpr double round = 1e-9;
  for (double k = std::ceil(*axis.from / step - round); k * step <= *axis.to + round * step; ++k) {
    tics.push_back({k * step, number_at(k * step, step)});
  }
  return tics;
}

/// Powers of ten, every so many, or with twice and five times as much between.
std::vector<Tic> logarithmic_tics(const PlotAxis& axis, int every) {
  std::vector<Tic> tics;
  constexpr double round = 1e-9;
  const int first = static_cast<int>(std::floor(std::log10(*axis.from)));
  for (int k = first; std::pow(10, k) <= *axis.to * (1 + round); ++k) {
    if (every > 1 && k % every != 0) continue;
    for (const int factor : {1, 2, 5}) {
      if (factor > 1 && every > 0) break;
      const double at = factor * std::pow(10, k);
      if (at < *axis.from * (1 - round) || at > *axis.to * (1 + round)) continue;
      tics.push_back({at, fmt::format("{:.6g}", at)});
    }
  }
  // All in one way.
  const bool is_any_long = std::any_of(
      tics.begin(), tics.end(), [](const Tic& tic) { return tic.at >= 1e5 || tic.at < 1e-4; });
  for (Tic& tic : tics) {
    if (is_any_long) tic.label = fmt::format("{:.0e}", tic.at);
  }
  return tics;
}

double scaled(const PlotAxis& axis, double value) {
  return axis.logarithmic ? std::log10(value) : value;
}

/// Of an axis that is so many pixels long.
double pixels_between(const PlotAxis& axis, double from, double to, double pixels) {
  return (scaled(axis, to) - scaled(axis, from)) /
         (scaled(axis, *axis.to) - scaled(axis, *axis.from)) * pixels;
}

enum class Direction { level, upright };

bool have_room(const std::vector<Tic>& tics, const PlotAxis& axis, double pixels,
               Direction direction) {
  constexpr double gap = 8;
  constexpr double line = 24;
  for (std::size_t i = 1; i < tics.size(); ++i) {
    const double needed =
        direction == Direction::upright
            ? line
            : (text_width(tics[i - 1].label) + text_width(tics[i].label)) / 2 + gap;
    if (pixels_between(axis, tics[i - 1].at, tics[i].at, pixels) < needed) return false;
  }
  return true;
}

std::vector<Tic> tics_with_room(const PlotAxis& axis, double pixels, Direction direction) {
  constexpr int longest = 64;  // of the ranges and numbers of decades that doubles have
  std::vector<Tic> tics;
  for (int k = 1; k <= longest; k *= 2) {
    tics = axis.logarithmic ? logarithmic_tics(axis, k / 2)
                            : linear_tics(axis, tic_step((*axis.to - *axis.from) * k));
    if (tics.size() < 2 && axis.logarithmic)
      tics = linear_tics(axis, tic_step(*axis.to - *axis.from));
    if (have_room(tics, axis, pixels, direction)) break;
  }
  return tics;
}

/// What is drawn, and a little more.
void set_limits(PlotAxis& axis, const PlotRange& drawn) {
  PlotRange range = drawn[0] <= drawn[1] ? drawn
                    : axis.logarithmic   ? PlotRange{1, 10}
                                         : PlotRange{0, 1};
  if (axis.logarithmic) range = {std::log10(range[0]), std::log10(range[1])};
  constexpr double margin = 0.05;
  double more = margin * (range[1] - range[0]);
  // Of one value: what surrounds it.
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

void put_at_edge(double& value, const PlotAxis& axis) {
  if (std::isinf(value)) value = value > 0 ? *axis.to : *axis.from;
}

void lay_out(PlotAxis& axis, std::vector<PlottedCurve>& curves,
             std::vector<double> PlottedCurve::*values) {
  PlotRange drawn = nothing;
  for (PlottedCurve& curve : curves) {
    for (double& value : curve.*values) {
      // What a logarithmic axis has no place for.
      if (axis.logarithmic && std::isfinite(value) && value <= 0) value = NAN;
    }
    widen(drawn, curve.*values);
  }
  set_limits(axis, drawn);
  for (PlottedCurve& curve : curves) {
    for (double& value : curve.*values) put_at_edge(value, axis);
  }
}

bool shows_something(const PlottedCurve& curve) {
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (!std::isnan(curve.x[i]) && !std::isnan(curve.y[i])) return true;
  }
  return false;
}

}  // namespace

Look curve_look(std::size_t i) {
  const CurveLook& look = looks[i % curve_colours];
  return {.colour = look.colour, .dashes = look.dashes, .mark = look.mark, .mark_size = 0.8};
}

Look curve_line(std::size_t i) {
  Look look = curve_look(i);
  look.mark = Mark::none;
  return look;
}

Look curve_marks(std::size_t i) {
  Look look = curve_look(i);
  look.width = 0;
  return look;
}

std::pair<double, double> Cells::range() const {
  PlotRange range = nothing;
  widen(range, values);
  return {range[0], range[1]};
}

std::vector<std::string> Panel::titles() const {
  std::vector<std::string> titles;
  for (const PlottedCurve& curve : curves) {
    if (has_legend && !curve.title.empty()) titles.push_back(curve.title);
  }
  return titles;
}

int Panel::width() const { return figure_width - right_margin - left; }

int Panel::legend_top() const {
  constexpr int scale = 48;  // of cells' colours, with their numbers
  return top_margin + height + axis_pixels + (cells ? scale : 0);
}

int Panel::full_height() const {
  constexpr int below = 8;  // as far as the largest mark reaches
  return legend_top() + static_cast<int>(titles().size()) * key_row_pixels + below;
}

Panel laid_out(Panel panel) {
  lay_out(panel.x, panel.curves, &PlottedCurve::x);
  lay_out(panel.y, panel.curves, &PlottedCurve::y);
  if (panel.z) lay_out(*panel.z, panel.curves, &PlottedCurve::z);
  panel.curves.erase(
      std::remove_if(panel.curves.begin(), panel.curves.end(),
                     [](const PlottedCurve& curve) { return !shows_something(curve); }),
      panel.curves.end());
  for (Text& text : panel.texts) {
    put_at_edge(text.x, panel.x);
    put_at_edge(text.y, panel.y);
  }
  if (!panel.y.tics) panel.y.tics = tics_with_room(panel.y, panel.height, Direction::upright);
  if (!panel.equal_aspect) {  // whose limits fit its width
    constexpr int beside = 16;
    for (const Tic& tic : *panel.y.tics) {
      panel.left =
          std::max(panel.left, beside + static_cast<int>(std::ceil(text_width(tic.label))));
    }
  }
  if (!panel.x.tics) panel.x.tics = tics_with_room(panel.x, panel.width(), Direction::level);
  // A number half of which would be outside of the picture.
  for (Tic& tic : *panel.x.tics) {
    const double right = pixels_between(panel.x, tic.at, *panel.x.to, panel.width()) + right_margin;
    if (text_width(tic.label) / 2 > right) tic.label.clear();
  }
  return panel;
}

double tic_step(double range) {
  const double power = std::pow(10, std::floor(std::log10(range)));
  const double leading = range / power;
  return power * (leading >= 5 ? 1 : leading >= 2 ? 0.5 : 0.2);
}

double text_width(const std::string& text) {
  constexpr double letter = 10.2;
  constexpr double narrow = 5.8;
  constexpr std::string_view narrow_ones = " .,:;-'|()[]fijlrt";
  double width = 0;
  for (const char c : text) {
    width += narrow_ones.find(c) == std::string_view::npos ? letter : narrow;
  }
  return width;
}

}  // namespace dlo::compare
