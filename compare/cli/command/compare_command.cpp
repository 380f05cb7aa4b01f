
#include <memory>
#include <optional>

#include "base/output_file.hpp"
#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/solution.hpp"
#include "format/json.hpp"
#include "format/result_output.hpp"
#include "option/option_values.hpp"
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
    compare::PageResult& page = results.emplace_back(compare::page_result(comparisons[i]));
    page.pictures = page_pictures({{comparison_row(scenes[i], comparisons[i])}},
                                  fmt::format("scene-{}", i + 1), "--report " + file);
    page.details = comparison_text(comparisons[i]);
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
  const bool explain = options.plan.explain() && options.output.is(Format::text);
  const bool shows_plan = explain || options.output.is(Format::json);
  const auto plan = shows_plan ? std::optional(options.plan.plan()) : std::nullopt;
  {
    ProgressBar bar("compare");
    for (const std::string& path : options.scenes) {
      const compare::Scene& scene = scenes.emplace_back(options.overrides.load(path));
      say_assumptions(scene);
      if (options.output.is(Format::csv)) warn_of_polygons(scene);
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
  write_output(options.output, {.text =
                                    [&] {
                                      std::string text = plans;
                                      for (const compare::Comparison& comparison : comparisons) {
                                        text += comparison_text(comparison);
                                      }
                                      return text;
                                    },
                                .json = [&] { return json_text(comparisons_json(comparisons)); },
                                .csv = [&] { return comparisons_csv(comparisons); }});
  options.plot.draw([&] { return comparison_picture(scenes, comparisons); });
  write_page(options.report, scenes, comparisons);
  if (!unverified.empty()) throw compare::ConvergenceError(unverified);
}

}  // namespace

void add_compare(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("compare", "how far the force model is from the energy model, and why");
  const auto options = std::make_shared<CompareOptions>();
  command->add_option("SCENE", options->scenes, "scene files (TOML)")->required();
  command->add_flag("--no-modulus", options->no_modulus, "leave E*/E out");
  options->overrides.add_to(*command);
  options->plan.add_to(*command);
  add_output_options(*command, options->output);
  options->plot.add_to(*command, "both shapes, curvature, deviation along the rod and its budget");
  add_file(*command, "--report", options->report,
           "write a page, FILE.html: verdict, pictures, numbers and error budget of each scene");
  command->footer(
      "Examples:\n  dlo compare data/scenes/spring_steel_175.toml --law hooke --bookkeeping "
      "consistent\n  dlo compare data/scenes/spring_steel_175.toml --plot both.svg");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
