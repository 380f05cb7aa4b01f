#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "judge/budget_parts.hpp"
#include "picture/figures.hpp"

namespace dlo::compare {
namespace {

constexpr int row_pixels = 42;  // pixels of a line of text and a bar

}  // namespace

Figure budget_figure(const Comparison& comparison) {
  Panel panel{.x = {.label = "share of the total, with sign [%]"},
              .y = {.label = "part: its own RMS; its share", .to = 0, .tics = std::vector<Tic>()}};
  double least = 0;
  double most = 0;
  int bar = 0;
  PlottedCurve bars{.id = "parts",
                    .title = setting_name(comparison.settings),
                    .look = {.colour = curve_style(1).colour, .fill = "#C26C33"}};
  for (const auto& [name, part] : shown_parts(comparison)) {
    const double percent = part->share * 100 + 0.0;
    const std::string share = fmt::format("{:.2f} %", percent);
    if (share == "0.00 %" || share == "-0.00 %") continue;
    least = std::min(least, percent);
    most = std::max(most, percent);
    ++bar;
    bars.x.insert(bars.x.end(), {0, percent, percent, 0, NAN});
    bars.y.insert(bars.y.end(), {0.14 - bar, 0.14 - bar, 0.42 - bar, 0.42 - bar, NAN});
    panel.texts.push_back(
        {.x = -HUGE_VAL,
         .y = 0.68 - bar,
         .words = fmt::format("{}: {:.4g} mm; {}", name, part->rms_m * 1e3, share),
         .dx = 10});
  }
  panel.curves.push_back(std::move(bars));
  constexpr double range_margin_share = 0.06;
  const double more = range_margin_share * std::max(most - least, 1.0);
  panel.x.from = least - more;
  panel.x.to = most + more;
  panel.y.from = -bar - 0.25;
  panel.height = row_pixels * bar + row_pixels / 4;
  panel.curves.insert(panel.curves.begin(),
                      {.look = {.colour = "#B0B0B0"}, .x = {0, 0}, .y = {-HUGE_VAL, HUGE_VAL}});
  return {.title = fmt::format("{}: error budget of {:.4g} mm", comparison.scene,
                               comparison.budget.total_m * 1e3),
          .panels = {std::move(panel)}};
}

}  // namespace dlo::compare
