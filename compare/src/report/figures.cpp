#include "report/figures.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "base/quote.hpp"
#include "paper/printed_tables.hpp"
#include "picture/budget_figure.hpp"
#include "picture/comparison_figure.hpp"
#include "picture/front_figure.hpp"
#include "picture/map_figure.hpp"
#include "picture/track_figure.hpp"
#include "report/provenance.hpp"

namespace dlo::compare {
namespace {

Figure history_figure(const std::string& name, const std::vector<const SceneHistory*>& histories,
                      const std::string& weight, const std::string& command) {
  Figure figure{.name = name,
                .section = "modulus",
                .title = "E*/E on the way to rest, " + weight,
                .command = command,
                .csv_file = name + ".csv"};
  figure.description =
      "E*/E against simulated time, both logarithmic, and on the right at rest. Dashed: 1/3, which "
      "the paper says of its rod, whose simulations took 28 s.";
  figure.csv = "curve,scene_file,time_s,steps,effective_modulus_ratio,rms_at_effective_modulus_m\n";
  constexpr double place_of_rest = 600;  // on the axis of time
  Panel panel{.x = {.label = "simulated time [s], 4000 steps/s",
                    .from = 0.8,
                    .to = 1.4 * place_of_rest,
                    .logarithmic = true,
                    .tics = {{{1, "1"},
                              {3, "3"},
                              {10, "10"},
                              {28, "28"},
                              {100, "100"},
                              {place_of_rest, "rest"}}}},
              .y = {.label = "E*/E", .logarithmic = true}};
  panel.curves.push_back({.title = "1/3, said of the paper's rod",
                          .look = {.width = 1.5, .dashes = Dashes::dashed},
                          .x = {-HUGE_VAL, HUGE_VAL},
                          .y = {1 / 3.0, 1 / 3.0}});
  for (std::size_t i = 0; i < histories.size(); ++i) {
    const SceneHistory& history = *histories[i];
    PlottedCurve curve{.title = history.scene, .look = curve_look(i)};
    for (const ModulusAtTime& at : history.history.times) {
      figure.csv +=
          fmt::format("{},{},{},{},{},{}\n", i + 1, history.file, csv_number(at.time_s), at.steps,
                      csv_number(at.modulus.ratio), csv_number(at.modulus.rms_m));
      curve.x.push_back(at.time_s);
      curve.y.push_back(at.modulus.ratio);
    }
    figure.csv += fmt::format("{},{},rest,,{},{}\n", i + 1, history.file,
                              csv_number(history.rest.ratio), csv_number(history.rest.rms_m));
    panel.curves.push_back(std::move(curve));
    panel.curves.push_back(
        {.look = curve_marks(i), .x = {place_of_rest}, .y = {history.rest.ratio}});
  }
  figure.panels = {std::move(panel)};
  return figure;
}

/// Of a scene with comparisons.
std::vector<Figure> scene_figures(const SceneReport& scene, std::size_t number) {
  std::string command = compare_command(scene.file, scene.comparisons.front());
  if (command.empty()) command = "dlo compare scenes/" + scene.file.name;
  ComparisonFigures all = comparison_figures(scene.file.scene, scene.comparisons, number);
  std::vector<Figure> figures = {std::move(all.shapes), std::move(all.curvature),
                                 std::move(all.deviation),
                                 budget_figure(scene.comparisons, number)};
  for (Figure& figure : figures) {
    figure.command = command + " --format json";
    figure.given = "distances and points";
  }
  return figures;
}

}  // namespace

std::vector<Figure> report_figures(const Report& report) {
  std::vector<Figure> figures;
  for (std::size_t i = 0; i < report.scenes.size(); ++i) {
    if (report.scenes[i].comparisons.empty()) continue;
    for (Figure& figure : scene_figures(report.scenes[i], i + 1)) {
      figures.push_back(std::move(figure));
    }
  }
  for (std::size_t i = 0; i < report.motions.size(); ++i) {
    const MotionReport& motion = report.motions[i];
    TrackFigures drawn =
        track_figures(motion.file.scene, {motion.track, motion.moving ? &*motion.moving : nullptr},
                      motion.options, i + 1);
    for (Figure* figure : {&drawn.strip, &drawn.forces}) {
      figure->command = track_command(motion) + " --shapes --format json";
      figures.push_back(std::move(*figure));
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
      const SceneBenchmark& scene = report.benchmark->scenes[i];
      if (!has_run(scene.runs)) continue;
      figures.push_back(front_figure(scene, i + 1));
      figures.back().command = benchmark_command(report) + " --format csv";
    }
  }
  if (report.map) {
    figures.push_back(map_figure(*report.map));
    figures.back().command = map_command(report) + " --format csv";
  }
  return figures;
}

}  // namespace dlo::compare
