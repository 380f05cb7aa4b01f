#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "comparison_text.hpp"
#include "json.hpp"
#include "output.hpp"
#include "plan_text.hpp"
#include "scene_options.hpp"
#include "terminal.hpp"

namespace dlo::cli {
namespace {

struct CompareOptions {
  std::vector<std::string> scenes;
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
    append_csv(
        text,
        "{},{},{},{},{:.10g},{:.10g},{:.10g},{:.10g},{:.10g},{:.10g},{:.10g},{:.10g},{},{:.10g},"
        "{:.10g},{:.10g},{:.10g},{:.10g},{:.10g},{:.10g},{:.10g},{:.10g},{:.10g},{},{},{},{:.4g}"
        ",{},"
        "{:.4g}\n",
        csv_field(c.scene), compare::to_string(c.settings.law),
        compare::to_string(c.settings.bookkeeping), c.settings.points, c.gamma, c.deviation.rms_m,
        c.deviation.max_m, c.deviation.tip_m, c.deviation.rms_over_length,
        c.deviation.rms_over_movement, c.effective_modulus.ratio, c.effective_modulus.rms_m,
        compare::to_string(c.effective_modulus.optimum), c.force.parameters.c_b,
        c.force.parameters.c_c, c.budget.law.rms_m, c.budget.bookkeeping.rms_m,
        c.budget.discretisation.rms_m, c.budget.stretch.rms_m, c.budget.not_at_rest.rms_m,
        c.budget.interaction.rms_m, 1 - c.budget.interaction.share, c.residual_over_movement,
        c.state.rank, c.state.stable, c.force.steps, c.force.seconds, c.energy_evaluations,
        c.energy_seconds);
  }
  return text;
}

void run(const CompareOptions& options) {
  std::vector<compare::Comparison> comparisons;
  std::string content;
  const bool explain = options.plan.explain() && options.output.kind() == Format::text;
  {
    ProgressBar bar("compare");
    for (const std::string& path : options.scenes) {
      const compare::Scene scene = options.overrides.load(path);
      comparisons.push_back(
          compare::compare(scene, options.overrides.solve(), options.plan.plan()));
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
}

}  // namespace

void add_compare(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("compare", "how far the force model is from the energy model, and why");
  const auto options = std::make_shared<CompareOptions>();
  command->add_option("SCENE", options->scenes, "scene files (TOML)")->required();
  options->overrides.add_to(*command);
  options->plan.add_to(*command);
  add_output_options(*command, options->output);
  command->footer(
      "Example:\n  dlo compare data/scenes/spring_steel_175.toml --law hooke --bookkeeping "
      "consistent");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
