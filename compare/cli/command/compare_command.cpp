
#include <memory>
#include <optional>

#include "base/output_file.hpp"
#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/solution.hpp"
#include "format/json.hpp"
#include "format/result_output.hpp"
#include "option/command_line.hpp"
#include "option/output.hpp"
#include "option/plot.hpp"
#include "option/scene_options.hpp"
#include "option/terminal.hpp"
#include "picture/figures.hpp"
#include "report/page.hpp"

namespace dlo::cli {
namespace {

struct CompareOptions {
  std::vector<std::string> scenes;
  bool no_modulus = false;
  SceneOptions overrides;
  PlanOptions plan;
  OutputOptions output;
  PlotOptions plot;
  std::string report;
};

/// Returns a row of figures: shapes and budget, next to curvature and deviation along the rod.
compare::PictureRow comparison_row(const compare::Scene& scene,
                                   const compare::Comparison& comparison) {
  compare::ComparisonFigures figures = compare::comparison_figures(scene, comparison);
  return {{figures.shapes, compare::budget_figure(comparison)},
          {figures.curvature, figures.deviation}};
}

compare::Picture comparison_picture(const std::vector<compare::Scene>& scenes,
                                    const std::vector<compare::Comparison>& comparisons) {
  compare::Picture picture;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    picture.rows.push_back(comparison_row(scenes[i], comparisons[i]));
  }
  return picture;
}

/// Writes the page of --report.
void write_page(const std::string& file, const std::vector<compare::Scene>& scenes,
                const std::vector<compare::Comparison>& comparisons) {
  if (file.empty()) return;
  std::vector<compare::PageResult> results;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    results.push_back({scenes[i].name, within_limit(comparisons[i]),
                       comparison_text(comparisons[i]),
                       page_pictures({{comparison_row(scenes[i], comparisons[i])}},
                                     fmt::format("scene-{}", i + 1), "--report " + file)});
  }
  compare::write_file(file, compare::page_html(results, "dlo compare", DLO_VERSION));
}

void run(const CompareOptions& options) {
  options.plot.require_drawable();
  std::vector<compare::Scene> scenes;
  std::vector<compare::Comparison> comparisons;
  std::string plans;
  std::string unverified;
  compare::SolveOptions solve = options.overrides.solve();
  solve.accept_unverified = true;
  const bool explain = options.plan.explain && options.output.format == "text";
  const bool shows_plan = explain || options.output.format == "json";
  const auto plan = shows_plan ? std::optional(options.plan.plan) : std::nullopt;
  {
    ProgressBar bar("compare");
    for (const std::string& path : options.scenes) {
      const compare::Scene& scene = scenes.emplace_back(options.overrides.load(path));
      print_assumptions(scene);
      if (options.output.format == "csv") warn_of_neglected_by_polygon(scene);
      comparisons.push_back(compare::compare(
          scene, solve, plan,
          options.no_modulus ? compare::ModulusSearch::no : compare::ModulusSearch::yes));
      const std::string& why = comparisons.back().unverified;
      if (!why.empty()) {
        append(unverified, "{}{}: the energy model: {}", unverified.empty() ? "" : "; ", scene.file,
               why);
      }
      if (explain) plans += plan_text(*comparisons.back().plan, scene);
      bar.show(static_cast<std::int64_t>(comparisons.size()),
               static_cast<std::int64_t>(options.scenes.size()));
    }
  }
  write_output(options.output,
               Formats{{"text",
                        [&] {
                          std::string text = plans;
                          for (const compare::Comparison& comparison : comparisons) {
                            text += comparison_text(comparison);
                          }
                          return text;
                        }},
                       {"json", [&] { return json_text(comparisons_json(comparisons)); }},
                       {"csv", [&] { return comparisons_csv(comparisons); }}});
  options.plot.draw([&] { return comparison_picture(scenes, comparisons); });
  write_page(options.report, scenes, comparisons);
  if (!unverified.empty()) throw compare::ConvergenceError(unverified);
}

}  // namespace

void add_compare_command(CLI::App& app) {
  add_command<CompareOptions>(app, "compare", run, [](Command& command, CompareOptions& o) {
    command.bind("SCENE", o.scenes, "--no-modulus", o.no_modulus, o.overrides, o.plan, o.output,
                 o.plot, "--report", o.report);
  });
}

}  // namespace dlo::cli
