#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "comparison_text.hpp"
#include "dlo/compare/error.hpp"
#include "json.hpp"
#include "output.hpp"
#include "plan_text.hpp"
#include "scene_options.hpp"
#include "terminal.hpp"

namespace dlo::cli {
namespace {

struct CompareOptions {
  std::vector<std::string> scenes;
  bool no_modulus = false;
  SceneOptions overrides;
  PlanOptions plan;
  OutputOptions output;
};

std::string csv(const std::vector<compare::Comparison>& comparisons) {
  std::string text =
      "scene,law,bookkeeping,points,gamma,rms_m,max_m,tip_m,rms_over_length,rms_over_movement,"
      "effective_modulus_ratio,rms_at_effective_modulus_m,optimum,c_b,c_c,budget_law_m,"
      "budget_bookkeeping_m,budget_discretisation_m,budget_stretch_m,budget_not_at_rest_m,"
      "budget_interaction_m,budget_parts_share,residual_over_movement,state_rank,states_stable,"
      "force_steps,force_s,energy_evaluations,energy_s\n";
  for (const compare::Comparison& c : comparisons) {
    const bool has_modulus = c.effective_modulus.optimum != compare::Optimum::none;
    const std::string fields[] = {
        csv_field(c.scene),
        compare::to_string(c.settings.law),
        compare::to_string(c.settings.bookkeeping),
        std::to_string(c.settings.points),
        csv_number(c.gamma),
        csv_number(c.deviation.rms_m),
        csv_number(c.deviation.max_m),
        csv_number(c.deviation.tip_m),
        csv_number(c.deviation.rms_over_length),
        csv_number(c.deviation.rms_over_movement),
        csv_number(c.effective_modulus.ratio),
        csv_number(c.effective_modulus.rms_m),
        has_modulus ? compare::to_string(c.effective_modulus.optimum) : "",
        csv_number(c.force.parameters.c_b),
        csv_number(c.force.parameters.c_c),
        csv_number(c.budget.law.rms_m),
        csv_number(c.budget.bookkeeping.rms_m),
        csv_number(c.budget.discretisation.rms_m),
        csv_number(c.budget.stretch.rms_m),
        csv_number(c.budget.not_at_rest.rms_m),
        csv_number(c.budget.interaction.rms_m),
        csv_number(1 - c.budget.interaction.share),
        csv_number(c.residual_over_movement),
        std::to_string(c.state.rank),
        std::to_string(c.state.stable),
        std::to_string(c.force.steps),
        fmt::format("{:.4g}", c.force.seconds),
        std::to_string(c.energy_evaluations),
        fmt::format("{:.4g}", c.energy_seconds)};
    append(text, "{}\n", fmt::join(fields, ","));
  }
  return text;
}

void run(const CompareOptions& options) {
  std::vector<compare::Comparison> comparisons;
  std::string content;
  std::string unresolved;
  compare::SolveOptions solve = options.overrides.solve();
  solve.accept_unresolved = true;
  const bool explain = options.plan.explain() && options.output.kind() == Format::text;
  {
    ProgressBar bar("compare");
    for (const std::string& path : options.scenes) {
      const compare::Scene scene = options.overrides.load(path);
      comparisons.push_back(compare::compare(
          scene, solve, options.plan.plan(),
          options.no_modulus ? compare::ModulusSearch::no : compare::ModulusSearch::yes));
      const std::string& why = comparisons.back().unresolved;
      if (!why.empty()) {
        append(unresolved, "{}{}: the energy model: {}", unresolved.empty() ? "" : "; ", scene.file,
               why);
      }
      if (explain) content += plan_text(comparisons.back().plan, scene);
      bar.show(static_cast<std::int64_t>(comparisons.size()),
               static_cast<std::int64_t>(options.scenes.size()));
    }
  }
  switch (options.output.kind()) {
    case Format::json: {
      Json cases = Json::array();
      for (const compare::Comparison& comparison : comparisons)
        cases.push_back(to_json(comparison));
      content = json_text(Json{{"schema", "dlo/compare/1"}, {"cases", std::move(cases)}});
      break;
    }
    case Format::csv:
      content = csv(comparisons);
      break;
    case Format::text:
      for (const compare::Comparison& comparison : comparisons) {
        content += comparison_text(comparison);
      }
      break;
  }
  write_output(options.output, content);
  if (!unresolved.empty()) throw compare::ConvergenceError(unresolved);
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
  command->footer(
      "Example:\n  dlo compare data/scenes/spring_steel_175.toml --law hooke --bookkeeping "
      "consistent");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
