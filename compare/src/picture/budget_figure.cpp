#include "picture/budget_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

#include "base/quote.hpp"
#include "judge/budget_parts.hpp"
#include "picture/comparison_figure.hpp"

namespace dlo::compare {
namespace {

constexpr int row_pixels = 42;  // a line of text and a bar

}  // namespace

Figure budget_figure(const std::vector<Comparison>& comparisons, std::size_t number) {
  Figure figure{.name = fmt::format("budget_{}", number),
                .section = "budget",
                .title = fmt::format("{}: error budget of {:.4g} mm", comparisons.front().scene,
                                     comparisons.front().budget.total_m * 1e3),
                .description =
                    "Bars for each part's share of the total deviation, with sign; beside its name "
                    "its own RMS. Shares add up to 100 %, millimetres do not. Parts of less than "
                    "0.005 % are left out.",
                .csv_file = fmt::format("budget_{}.csv", number),
                .csv = "series,row,from_percent,to_percent,rms_m,label\n"};
  Panel panel{.x = {.label = "share of the total, with sign [%]"},
              .y = {.label = "part: its own RMS; its share", .to = 0, .tics = std::vector<Tic>()}};
  double least = 0;
  double most = 0;
  int row = 0;
  int bar = 0;
  for (std::size_t i = 0; i < comparisons.size(); ++i) {
    const Comparison& c = comparisons[i];
    PlottedCurve bars{.id = fmt::format("setting_{}", i + 1),
                      .title = setting_name(c.settings),
                      .look = {.colour = curve_look(i == 0 ? 1 : 0).colour,
                               .fill = i == 0 ? "#C26C33" : "#A6C5E1"}};
    for (const auto& [name, part] : shown_parts(c)) {
      const double percent = part->share * 100 + 0.0;
      const std::string share = fmt::format("{:.2f} %", percent);
      const std::string words = fmt::format("{}: {:.4g} mm; {}", name, part->rms_m * 1e3, share);
      fmt::format_to(std::back_inserter(figure.csv), "{},{},{},{},{},{}\n", bars.id, ++row,
                     csv_number(std::min(0.0, percent)), csv_number(std::max(0.0, percent)),
                     csv_number(part->rms_m), csv_field(words));
      if (share == "0.00 %" || share == "-0.00 %") continue;
      least = std::min(least, percent);
      most = std::max(most, percent);
      ++bar;
      bars.x.insert(bars.x.end(), {0, percent, percent, 0, NAN});
      bars.y.insert(bars.y.end(), {0.14 - bar, 0.14 - bar, 0.42 - bar, 0.42 - bar, NAN});
      panel.texts.push_back({.x = -HUGE_VAL, .y = 0.68 - bar, .words = words, .dx = 10});
    }
    panel.curves.push_back(std::move(bars));
  }
  constexpr double margin = 0.06;
  const double more = margin * std::max(most - least, 1.0);
  panel.x.from = least - more;
  panel.x.to = most + more;
  panel.y.from = -bar - 0.25;
  panel.height = row_pixels * bar + row_pixels / 4;
  panel.curves.insert(panel.curves.begin(),
                      {.look = {.colour = "#B0B0B0"}, .x = {0, 0}, .y = {-HUGE_VAL, HUGE_VAL}});
  figure.panels = {std::move(panel)};
  return figure;
}

}  // namespace dlo::compare
