#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "picture/figures.hpp"

namespace dlo::compare {
namespace {

/// Runs that one curve of the front connects.
struct FrontCurve {
  const char* title;
  bool (*holds)(const BenchmarkRun&);
};

bool is_best_polygon(const BenchmarkRun& run) {
  return run.variant && run.variant->law == BendingLaw::hooke &&
         run.variant->bookkeeping == Bookkeeping::consistent;
}

constexpr FrontCurve front_curves[] = {
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

}  // namespace

Figure front_figure(const SceneBenchmark& scene) {
  const auto add_point = [](const BenchmarkRun& run, PlottedCurve& curve) {
    curve.x.push_back(run.time.median_s * 1e3);
    curve.y.push_back(run.rms_over_length);
  };
  Panel panel{.x = {.label = "time [ms]", .logarithmic = true},
              .y = {.label = "error, RMS over the length", .logarithmic = true}};
  PlottedCurve line{.id = "front", .title = "the front", .look = {.dashes = Dashes::dashed}};
  panel.curves.emplace_back();
  std::vector<const BenchmarkRun*> front;
  for (std::size_t k = 0; k < std::size(front_curves); ++k) {
    PlottedCurve points{
        .id = std::to_string(k + 1), .title = front_curves[k].title, .look = curve_style(k)};
    points.look.width = 0;
    for (const BenchmarkRun& run : scene.runs) {
      if (!front_curves[k].holds(run)) continue;
      if (run.front) front.push_back(&run);
      add_point(run, points);
    }
    panel.curves.push_back(std::move(points));
  }
  std::ranges::sort(front, {}, [](const BenchmarkRun* run) { return run->time.median_s; });
  for (const BenchmarkRun* run : front) {
    add_point(*run, line);
    if (run->size == 0) continue;
    panel.texts.push_back({.x = line.x.back(),
                           .y = line.y.back(),
                           .words = std::to_string(run->size),
                           .dx = 8,
                           .dy = 5});
  }
  panel.curves.front() = std::move(line);
  return {.title = fmt::format("{}, Gamma = {:.4g}: error against time", scene.scene, scene.gamma),
          .panels = {std::move(panel)}};
}

}  // namespace dlo::compare
