#include "picture/front_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "base/quote.hpp"

namespace dlo::compare {
namespace {

/// Runs that share a curve of the front.
struct FrontCurve {
  std::string title;
  bool (*holds)(const BenchmarkRun&);
};

bool is_best_polygon(const BenchmarkRun& run) {
  return run.variant && run.variant->law == BendingLaw::hooke &&
         run.variant->bookkeeping == Bookkeeping::consistent;
}

}  // namespace

Figure front_figure(const SceneBenchmark& scene, std::size_t number) {
  Figure figure{
      .name = fmt::format("front_{}", number),
      .section = "speed",
      .title = fmt::format("{}, Gamma = {:.4g}: error against time", scene.scene, scene.gamma),
      .description =
          "Error (RMS over the length) against the time to it from straight, both "
          "logarithmic; a line joins the runs that no other run beats in both.",
      .csv_file = fmt::format("front_{}.csv", number)};
  const FrontCurve curves[] = {
      {"exact", [](const BenchmarkRun& run) { return run.model == Model::exact; }},
      {"energy, K terms", [](const BenchmarkRun& run) { return run.model == Model::energy; }},
      {"chain, N points, hooke, consistent",
       [](const BenchmarkRun& run) { return run.model == Model::chain && is_best_polygon(run); }},
      {"chain, N points, other law or bookkeeping",
       [](const BenchmarkRun& run) { return run.model == Model::chain && !is_best_polygon(run); }},
      {"force, N points, hooke, consistent",
       [](const BenchmarkRun& run) { return run.model == Model::force && is_best_polygon(run); }},
      {"force, N points, other law or bookkeeping",
       [](const BenchmarkRun& run) { return run.model == Model::force && !is_best_polygon(run); }}};
  figure.csv = "curve,model,size,setting,time_s,rms_over_length,front\n";
  std::string plots;
  int rows = 1;
  std::vector<const BenchmarkRun*> front;
  for (std::size_t k = 0; k < std::size(curves); ++k) {
    std::size_t points = 0;
    for (const BenchmarkRun& run : scene.runs) {
      if (!curves[k].holds(run)) continue;
      ++points;
      if (run.front) front.push_back(&run);
      figure.csv += fmt::format("{},{},{},{},{},{},{}\n", k + 1, to_string(run.model), run.size,
                                csv_field(setting_of(run)), csv_number(run.time.median_s),
                                csv_number(run.rms_over_length), run.front ? 1 : 0);
    }
    if (points == 0) continue;
    ++rows;
    fmt::format_to(std::back_inserter(plots),
                   ", \\\n  '{}' using ($1 == {} ? $5*1e3 : NaN):6 title {} {}", figure.csv_file,
                   k + 1, gnuplot_string(curves[k].title), curve_style(k, "points"));
  }
  std::sort(front.begin(), front.end(), [](const BenchmarkRun* a, const BenchmarkRun* b) {
    return a->time.median_s < b->time.median_s;
  });
  for (const BenchmarkRun* run : front) {
    figure.csv += fmt::format("front,{},{},{},{},{},1\n", to_string(run->model), run->size,
                              csv_field(setting_of(*run)), csv_number(run->time.median_s),
                              csv_number(run->rms_over_length));
  }
  Panel panel{.x_label = "time [ms]", .y_label = "error, RMS over the length", .key_rows = rows};
  panel.script =
      "set logscale xy\n"
      "set format x '%g'\nset format y '%.0e'\n"
      "plot '" +
      figure.csv_file +
      "' using (strcol(1) eq 'front' ? $5*1e3 : NaN):6 title 'the front' with lines linecolor rgb "
      "'black' dashtype 2" +
      plots + "\n";
  figure.panels = {panel};
  return figure;
}

}  // namespace dlo::compare
