#include "picture/budget_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>

#include "base/quote.hpp"
#include "figure/shape_panels.hpp"
#include "judge/budget_parts.hpp"
#include "picture/comparison_figure.hpp"

namespace dlo::compare {
namespace {

constexpr int row_pixels = 42;  // a line of text and a bar

/// Two digits behind the point, without a sign where they are zero.
std::string share_text(double percent) {
  std::string text = fmt::format("{:.2f} %", percent);
  if (text == "-0.00 %") text.erase(0, 1);
  return text;
}

}  // namespace

Figure budget_figure(const std::vector<Comparison>& comparisons, std::size_t number) {
  Figure figure{.name = fmt::format("budget_{}", number),
                .section = "budget",
                .title = fmt::format("{}: error budget of {:.4g} mm", comparisons.front().scene,
                                     comparisons.front().budget.total_m * 1e3),
                .description =
                    "Bars for each part's share of the total deviation, with sign; beside its name "
                    "its own RMS. Shares add up to 100 %, millimetres do not.",
                .csv_file = fmt::format("budget_{}.csv", number),
                .csv = "series,row,from_percent,to_percent,rms_m,label\n"};
  Panel panel{.x_label = "share of the total, with sign [%]",
              .y_label = "part: its own RMS; its share"};
  double least = 0;
  double most = 0;
  int row = 0;
  std::string plots;
  for (std::size_t i = 0; i < comparisons.size(); ++i) {
    const Comparison& c = comparisons[i];
    const std::string id = fmt::format("setting_{}", i + 1);
    for (const auto& [name, part] : shown_parts(c)) {
      const double percent = part->share * 100 + 0.0;
      least = std::min(least, percent);
      most = std::max(most, percent);
      fmt::format_to(std::back_inserter(figure.csv), "{},{},{},{},{},{}\n", id, ++row,
                     csv_number(std::min(0.0, percent)), csv_number(std::max(0.0, percent)),
                     csv_number(part->rms_m),
                     csv_field(fmt::format("{}: {:.4g} mm; {}", name, part->rms_m * 1e3,
                                           share_text(percent))));
    }
    fmt::format_to(
        std::back_inserter(plots),
        ", \\\n  {} title {} with boxxyerror linecolor rgb '{}' fillstyle {}",
        series_data(figure.csv_file, id, "($3+$4)/2", "(-$2+0.28):3:4:(-$2+0.14):(-$2+0.42)"),
        gnuplot_string(setting_name(c.settings)), curve_colour(i == 0 ? 1 : 0),
        i == 0 ? "solid 0.9" : "solid 0.35");
    ++panel.key_rows;
  }
  panel.height = row_pixels * row + row_pixels / 4;
  const double margin = 0.06 * std::max(most - least, 1.0);
  panel.script = fmt::format(
      "set xrange [{:.6g}:{:.6g}]\nset yrange [{:.6g}:0]\nunset ytics\nset grid noytics\n"
      "set arrow 1 from 0,graph 0 to 0,graph 1 nohead back linecolor rgb '#B0B0B0'\n"
      "plot '{}' skip 1 using ({:.6g}):(-$2+0.68):6 notitle with labels left",
      least - margin, most + margin, -row - 0.25, figure.csv_file, least - margin / 2);
  panel.script += plots + "\n";
  figure.panels = {panel};
  return figure;
}

}  // namespace dlo::compare
