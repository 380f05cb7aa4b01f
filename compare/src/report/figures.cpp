#include "report/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/quote.hpp"
#include "dlo/compare/solution.hpp"
#include "paper/printed_tables.hpp"
#include "polygon/step_constants.hpp"
#include "report/again.hpp"
#include "report/scene_figures.hpp"

namespace dlo::compare {
namespace {

constexpr int figure_plot = 330;  // height [pixels]

/// Colours that colour-blind readers tell apart (after Okabe and Ito, darker, so that they stand
/// out inverted as well), each with its own dashes and points, so that none is told by colour
/// alone.
struct Look {
  const char* colour;
  int points;
  int dashes;
};
constexpr Look looks_of_curves[] = {{"#0059A8", 6, 1},  {"#B34700", 4, 2},  {"#00704F", 8, 3},
                                    {"#8A2F85", 12, 4}, {"#7A5600", 10, 5}, {"#404040", 2, 2}};

std::string style_of(std::size_t i, const char* with) {
  const Look& look = looks_of_curves[i % std::size(looks_of_curves)];
  return fmt::format("with {} linecolor rgb '{}' dashtype {} pointtype {} pointsize 0.8", with,
                     look.colour, look.dashes, look.points);
}

std::string head_of(const Figure& figure, int key_rows, const std::string& x,
                    const std::string& y) {
  const int height = height_besides_plot(key_rows) + figure_plot;
  return figure_head(figure.name, figure.csv_file, height, key_rows) +
         axis_labels(x, y, height, top_margin);
}

Figure history_figure(const std::string& name, const std::vector<const SceneHistory*>& histories,
                      const std::string& weight, const std::string& command) {
  Figure figure{.name = name,
                .section = "modulus",
                .title = "E*/E on the way to rest, " + weight,
                .command = command,
                .csv_file = name + ".csv"};
  figure.description =
      "E*/E against simulated time, both logarithmic, beside the paper's 1/3 (a dashed level), and "
      "on the right at rest. The paper's simulations took 28 s.";
  figure.csv = "curve,scene_file,time_s,steps,effective_modulus_ratio,rms_at_effective_modulus_m\n";
  constexpr double place_of_rest = 600;  // on the axis of time
  std::string plots;
  for (std::size_t i = 0; i < histories.size(); ++i) {
    const SceneHistory& history = *histories[i];
    for (const ModulusAtTime& at : history.history.times) {
      figure.csv +=
          fmt::format("{},{},{},{},{},{}\n", i + 1, history.file, csv_number(at.time_s), at.steps,
                      csv_number(at.modulus.ratio), csv_number(at.modulus.rms_m));
    }
    figure.csv += fmt::format("{},{},rest,,{},{}\n", i + 1, history.file,
                              csv_number(history.rest.ratio), csv_number(history.rest.rms_m));
    fmt::format_to(
        std::back_inserter(plots),
        ", \\\n  '{0}' using ($1 == {1} ? $3 : NaN):5 title {2} {3}"
        ", \\\n  '{0}' using ($1 == {1} && strcol(3) eq 'rest' ? {4:g} : NaN):5 notitle {5}",
        figure.csv_file, i + 1, gnuplot_string(history.scene), style_of(i, "linespoints"),
        place_of_rest, style_of(i, "points"));
  }
  const int rows = static_cast<int>(histories.size()) + 1;
  figure.script = head_of(figure, rows, "simulated time [s], 4000 steps/s", "E*/E");
  figure.script += fmt::format(
      "set logscale xy\nset xrange [0.8:{:g}]\n"
      "set xtics (1, 3, 10, 28, 100, 'rest' {:g})\nset format y '%g'\n"
      "plot 1/3. title 'what the paper says: 1/3' with lines linecolor rgb 'black' dashtype 2 "
      "linewidth 1.5",
      place_of_rest * 1.4, place_of_rest);
  figure.script += plots + "\n";
  return figure;
}

/// Runs that share a curve of the front.
struct FrontCurve {
  std::string title;
  bool (*holds)(const BenchmarkRun&);
};

bool is_best_polygon(const BenchmarkRun& run) {
  return run.variant && run.variant->law == BendingLaw::hooke &&
         run.variant->bookkeeping == Bookkeeping::consistent;
}

Figure front_figure(const Report& report, std::size_t index) {
  const SceneBenchmark& scene = report.benchmark->scenes[index];
  Figure figure{
      .name = fmt::format("front_{}", index + 1),
      .section = "speed",
      .title = fmt::format("{}, Gamma = {:.4g}: error against time", scene.scene, scene.gamma),
      .description =
          "Error (RMS over the length) against the time to it from straight, both "
          "logarithmic; a line joins the runs that no other run beats in both.",
      .command = benchmark_command(report) + " --format csv",
      .csv_file = fmt::format("front_{}.csv", index + 1)};
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
                   k + 1, gnuplot_string(curves[k].title), style_of(k, "points"));
  }
  std::sort(front.begin(), front.end(), [](const BenchmarkRun* a, const BenchmarkRun* b) {
    return a->time.median_s < b->time.median_s;
  });
  for (const BenchmarkRun* run : front) {
    figure.csv += fmt::format("front,{},{},{},{},{},1\n", to_string(run->model), run->size,
                              csv_field(setting_of(*run)), csv_number(run->time.median_s),
                              csv_number(run->rms_over_length));
  }
  figure.script = head_of(figure, rows, "time [ms]", "error, RMS over the length");
  figure.script +=
      "set logscale xy\n"
      "set format x '%g'\nset format y '%.0e'\n"
      "plot '" +
      figure.csv_file +
      "' using (strcol(1) eq 'front' ? $5*1e3 : NaN):6 title 'the front' with lines linecolor rgb "
      "'black' dashtype 2" +
      plots + "\n";
  return figure;
}

Figure map_figure(const Report& report) {
  const StabilityMap& map = *report.map;
  Figure figure{
      .name = "stability_map",
      .section = "stability",
      .title = map.scene + ": largest stable c_F",
      .description =
          "Grid of step factors c_F over stretch stiffnesses c_c, both logarithmic, each point by "
          "what became of the rod: stable, growing within bounds, or diverged. Lines for the "
          "predicted "
          "limit, the measured one, and Table 1's proportion.",
      .command = map_command(report) + " --format csv",
      .csv_file = "stability_map.csv"};
  figure.csv = "kind,c_c_N,c_h,c_F_m_per_N\n";
  for (const MapPoint& point : map.points) {
    figure.csv += fmt::format("{},{},{},{}\n", to_string(point.outcome), csv_number(point.c_c),
                              csv_number(point.c_h), csv_number(point.c_F));
  }
  const std::pair<const char*, double MapColumn::*> limits[] = {
      {"predicted", &MapColumn::predicted},
      {"measured", &MapColumn::measured},
      {"table_1", &MapColumn::table_1}};
  for (const auto& [kind, limit] : limits) {
    for (const MapColumn& column : map.columns) {
      figure.csv += fmt::format("{},{},{},{}\n", kind, csv_number(column.c_c),
                                csv_number(column.c_h), csv_number(column.*limit));
    }
  }
  struct Curve {
    const char* kind;
    std::string title;
    const char* style;
  };
  const Curve curves[] = {
      {"pass", "stable", "with points linecolor rgb '#0059A8' pointtype 7 pointsize 0.25"},
      {"oscillates", "grows, within bounds",
       "with points linecolor rgb '#8A2F85' pointtype 8 pointsize 0.6"},
      {"diverges", "diverges", "with points linecolor rgb '#B34700' pointtype 2 pointsize 0.7"},
      {"predicted", "predicted limit", "with lines linecolor rgb 'black' dashtype 1 linewidth 2"},
      {"measured", "measured limit",
       "with linespoints linecolor rgb '#00704F' dashtype 2 pointtype 4 pointsize 0.7"},
      {"table_1", fmt::format("Table 1: {}", table_1_step_formula),
       "with lines linecolor rgb '#606060' dashtype 3 linewidth 2"}};
  figure.script = head_of(figure, static_cast<int>(std::size(curves)), "c_c [N]", "c_F [m/N]");
  figure.script +=
      "set logscale xy\n"
      "set format x '%.0e'\nset format y '%.0e'\nset xtics 100\nplot";
  std::string separator = " ";
  for (const Curve& curve : curves) {
    figure.script += fmt::format("{}'{}' using (strcol(1) eq '{}' ? $2 : NaN):4 title '{}' {}",
                                 separator, figure.csv_file, curve.kind, curve.title, curve.style);
    separator = ", \\\n  ";
  }
  figure.script += "\n";
  return figure;
}

}  // namespace

std::vector<Figure> report_figures(const Report& report) {
  std::vector<Figure> figures;
  for (std::size_t i = 0; i < report.scenes.size(); ++i) {
    for (Figure& figure : scene_figures(report.scenes[i], i + 1)) {
      figures.push_back(std::move(figure));
    }
  }
  std::vector<const SceneHistory*> histories;
  for (const SceneReport& scene : report.scenes) {
    if (scene.history) histories.push_back(&*scene.history);
  }
  if (!histories.empty()) {
    figures.push_back(
        history_figure("modulus", histories, "the scenes' own weight", history_command(report)));
  }
  histories.clear();
  for (const SceneHistory& history : report.printed_weight) histories.push_back(&history);
  if (!histories.empty()) {
    figures.push_back(
        history_figure("modulus_printed_weight", histories,
                       fmt::format("Table 5's weight, {} N a point", printed_point_weight()),
                       history_command(report)));
  }
  if (report.benchmark) {
    for (std::size_t i = 0; i < report.benchmark->scenes.size(); ++i) {
      if (has_run(report.benchmark->scenes[i].runs)) figures.push_back(front_figure(report, i));
    }
  }
  if (report.map) figures.push_back(map_figure(report));
  return figures;
}

}  // namespace dlo::compare
