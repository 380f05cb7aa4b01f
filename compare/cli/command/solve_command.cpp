#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/shape_file.hpp"
#include "dlo/compare/solve.hpp"
#include "format/json.hpp"
#include "format/result_output.hpp"
#include "option/command_line.hpp"
#include "option/output.hpp"
#include "option/plot.hpp"
#include "option/scene_options.hpp"
#include "picture/figures.hpp"
#include "record/solution_fields.hpp"
#include "shape/write_vtk.hpp"

namespace dlo::cli {
namespace {

struct SolveOptions {
  std::string scene;
  std::optional<compare::Model> model = {};  // none: reference_model()
  int samples = 0;
  bool all = false;
  int equilibrium = 0;  // number in the list of --all; 0: the equilibrium of the model
  std::string near;
  SceneOptions overrides;
  PlanOptions plan;
  OutputOptions output;
  PlotOptions plot;
};

/// Reports properties that the model neglects, for formats that do not contain them.
void warn_of_neglected(const SolveOptions& options, const compare::Solution& solution,
                       const compare::Scene& scene) {
  if (options.output.format == "text" || options.output.format == "json") return;
  for (const std::string& what : solution.neglected) {
    print_message("{}: model {} neglects the {} that the scene has", scene.file,
                  compare::to_string(solution.model), what);
  }
}

void require_model_of_all(const char* option, compare::Model model, const compare::Scene& scene) {
  if (model == compare::Model::energy) return;
  throw compare::InputError(fmt::format(
      "{0}: only model energy searches for all equilibria{1}", option,
      scene.stretch == compare::Stretch::counted
          ? fmt::format(", and it has no stretch (allowed: rod.stretch = false, or no {})", option)
          : ""));
}

/// Fails for a shape that was shown but is no success: not verified, at a singular point, or
/// unstable although it is the first of all. Loads without a potential are excepted, since their
/// equilibria cannot be verified further.
void require_verified(const compare::Solution& solution, const compare::Scene& scene) {
  if (energy_model::succeeded(solution.status)) return;
  if (compare::is_balance_alone(scene, solution)) return;
  throw compare::ConvergenceError(fmt::format(
      "{}: the {} model: {}", scene.file, compare::to_string(solution.model), solution.message));
}

/// Solves once: by one model, or by the energy model from the points of a file, or by its number in
/// the list of all equilibria.
compare::Solution requested_solution(const SolveOptions& options,
                                     const compare::SolveOptions& solve,
                                     const compare::Scene& scene, compare::Model model,
                                     const std::vector<double>& arc_lengths) {
  if (options.equilibrium > 0) {
    return numbered_equilibrium(compare::solve_all(scene, solve, arc_lengths), options.equilibrium,
                                scene);
  }
  if (options.near.empty()) return compare::solve(scene, model, solve, arc_lengths);
  return compare::solve_near(scene, compare::load_shape(options.near), solve, arc_lengths);
}

/// Returns the solutions to draw, with enough points of a rod for a smooth line.
std::vector<compare::Solution> solutions_to_draw(const SolveOptions& options,
                                                 const compare::SolveOptions& solve,
                                                 const compare::Scene& scene,
                                                 const std::vector<compare::Solution>& solved) {
  constexpr std::size_t dense_shape_points = 101;
  const compare::Solution& first = solved.front();
  const bool continuous =
      first.model == compare::Model::energy || first.model == compare::Model::exact;
  if (!continuous || first.shape.arc_length.size() >= dense_shape_points) return solved;
  constexpr int samples = 201;
  const std::vector<double> s = compare::equal_arc_lengths(scene.length, samples);
  if (options.all) return compare::solve_all(scene, solve, s).solutions;
  return {requested_solution(options, solve, scene, first.model, s)};
}

void plot(const SolveOptions& options, const compare::SolveOptions& solve,
          const compare::Scene& scene, const std::vector<compare::Solution>& solved) {
  options.plot.draw([&] {
    return compare::solution_picture(scene, solutions_to_draw(options, solve, scene, solved));
  });
}

void run(const SolveOptions& options) {
  options.plot.require_drawable();
  const compare::Scene scene = options.overrides.load(options.scene);
  print_assumptions(scene);
  const compare::Model model = options.model ? *options.model : compare::reference_model(scene);
  constexpr int text_samples = 11;
  int samples = options.samples;
  const bool continuous = model == compare::Model::energy || model == compare::Model::exact;
  if (samples == 0 && continuous && options.output.format == "text") samples = text_samples;
  const std::vector<double> arc_lengths =
      samples > 0 ? compare::equal_arc_lengths(scene.length, samples) : std::vector<double>{};
  if (options.all) require_model_of_all("--all", model, scene);
  if (options.equilibrium > 0) require_model_of_all("--equilibrium", model, scene);
  if (!options.near.empty() && model != compare::Model::energy) {
    throw compare::InputError("--near: only model energy starts from the points of a file");
  }
  compare::SolveOptions solve = options.overrides.solve();
  solve.accept_unverified = true;
  solve.target = options.plan.plan.target;
  compare::AllSolutions all;
  if (options.all) {
    all = compare::solve_all(scene, solve, arc_lengths);
  } else {
    all.solutions.push_back(requested_solution(options, solve, scene, model, arc_lengths));
  }
  const compare::Solution& solution = all.solutions.front();
  warn_of_neglected(options, solution, scene);
  const auto plan = [&] {
    compare::PlanOptions plan_options = options.plan.plan;
    plan_options.time_limit = std::min(plan_options.time_limit, solve.time_limit);
    return compare::make_plan(scene, plan_options);
  };
  write_output(options.output,
               Formats{{"text",
                        [&] {
                          return (options.plan.explain ? plan_text(plan(), scene) : "") +
                                 solution_text(solution, scene) +
                                 (options.all ? equilibria_text(all, scene) : "");
                        }},
                       {"json",
                        [&] {
                          return json_text(options.all ? equilibria_json(all, scene, plan())
                                                       : solution_json(solution, scene, plan()));
                        }},
                       {"csv", [&] { return solution_csv(solution); }},
                       {"vtk", [&] {
                          return compare::vtk_polyline(solution.shape,
                                                       {.curvature = solution.curvature,
                                                        .tension = solution.tension,
                                                        .d1 = solution.d1},
                                                       scene.name);
                        }}});
  plot(options, solve, scene, all.solutions);
  require_verified(solution, scene);
}

}  // namespace

void add_solve_command(CLI::App& app) {
  add_command<SolveOptions>(app, "solve", run, [](Command& command, SolveOptions& o) {
    command.bind("SCENE", o.scene, "--model", o.model, "--samples", o.samples, "--all", o.all,
                 "--equilibrium", o.equilibrium, "--near", o.near, o.overrides, o.plan, o.output,
                 o.plot);
  });
}

}  // namespace dlo::cli
