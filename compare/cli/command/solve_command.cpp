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
#include "option/option_values.hpp"
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
  std::string model;  // empty: reference_model()
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
  if (options.output.is(Format::text) || options.output.is(Format::json)) return;
  for (const std::string& what : solution.neglected) {
    say("{}: model {} neglects the {} that the scene has", scene.file,
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
compare::Solution solved_once(const SolveOptions& options, const compare::SolveOptions& solve,
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
std::vector<compare::Solution> drawn_solutions(const SolveOptions& options,
                                               const compare::SolveOptions& solve,
                                               const compare::Scene& scene,
                                               const std::vector<compare::Solution>& solved) {
  constexpr std::size_t enough = 101;
  const compare::Solution& first = solved.front();
  const bool continuous =
      first.model == compare::Model::energy || first.model == compare::Model::exact;
  if (!continuous || first.shape.arc_length.size() >= enough) return solved;
  constexpr int samples = 201;
  const std::vector<double> s = compare::equal_arc_lengths(scene.length, samples);
  if (options.all) return compare::solve_all(scene, solve, s).solutions;
  return {solved_once(options, solve, scene, first.model, s)};
}

void plot(const SolveOptions& options, const compare::SolveOptions& solve,
          const compare::Scene& scene, const std::vector<compare::Solution>& solved) {
  options.plot.draw([&] {
    return compare::solution_picture(scene, drawn_solutions(options, solve, scene, solved));
  });
}

void run(const SolveOptions& options) {
  options.plot.require_drawable();
  const compare::Scene scene = options.overrides.load(options.scene);
  say_assumptions(scene);
  const compare::Model model = options.model.empty()
                                   ? compare::reference_model(scene)
                                   : compare::from_name<compare::Model>(options.model);
  constexpr int text_samples = 11;
  int samples = options.samples;
  const bool continuous = model == compare::Model::energy || model == compare::Model::exact;
  if (samples == 0 && continuous && options.output.is(Format::text)) samples = text_samples;
  const std::vector<double> arc_lengths =
      samples > 0 ? compare::equal_arc_lengths(scene.length, samples) : std::vector<double>{};
  if (options.all) require_model_of_all("--all", model, scene);
  if (options.equilibrium > 0) require_model_of_all("--equilibrium", model, scene);
  if (!options.near.empty() && model != compare::Model::energy) {
    throw compare::InputError("--near: only model energy starts from the points of a file");
  }
  compare::SolveOptions solve = options.overrides.solve();
  solve.accept_unverified = true;
  solve.target = options.plan.plan().target;
  compare::AllSolutions all;
  if (options.all) {
    all = compare::solve_all(scene, solve, arc_lengths);
  } else {
    all.solutions.push_back(solved_once(options, solve, scene, model, arc_lengths));
  }
  const compare::Solution& solution = all.solutions.front();
  warn_of_neglected(options, solution, scene);
  if (options.output.format == "vtk") {
    write_output(options.output, compare::vtk_polyline(solution.shape,
                                                       {.curvature = solution.curvature,
                                                        .tension = solution.tension,
                                                        .d1 = solution.d1},
                                                       scene.name));
    plot(options, solve, scene, all.solutions);
    return require_verified(solution, scene);
  }
  const auto plan = [&] {
    compare::PlanOptions plan_options = options.plan.plan();
    plan_options.time_limit = std::min(plan_options.time_limit, solve.time_limit);
    return compare::make_plan(scene, plan_options);
  };
  write_output(options.output,
               {.text =
                    [&] {
                      return (options.plan.explain() ? plan_text(plan(), scene) : "") +
                             solution_text(solution, scene) +
                             (options.all ? equilibria_text(all, scene) : "");
                    },
                .json =
                    [&] {
                      return json_text(options.all ? equilibria_json(all, scene, plan())
                                                   : solution_json(solution, scene, plan()));
                    },
                .csv = [&] { return solution_csv(solution); }});
  plot(options, solve, scene, all.solutions);
  require_verified(solution, scene);
}

}  // namespace

void add_solve(CLI::App& app) {
  CLI::App* command = app.add_subcommand("solve", "the shape of one scene with one model");
  const auto options = std::make_shared<SolveOptions>();
  command->add_option("SCENE", options->scene, "scene file (TOML)")->required();
  command->add_option("--model", options->model, compare::meanings<compare::Model>())
      ->check(CLI::IsMember(compare::names<compare::Model>()))
      ->default_str("energy, or exact if stretch = true");
  command->add_option("--samples", options->samples, "M points at equal arc lengths from 0 to l")
      ->check(CLI::Range(2, 1000000));
  CLI::Option* all = command->add_flag("--all", options->all,
                                       "every equilibrium that is found, with its stability");
  CLI::Option* number =
      command
          ->add_option("--equilibrium", options->equilibrium,
                       "the N-th equilibrium that --all lists, with its forces and contacts")
          ->type_name("N")
          ->check(CLI::Range(1, 1000))
          ->excludes(all);
  add_file(*command, "--near", options->near,
           "the equilibrium that a local search from the points of FILE leads to, in place of the "
           "lowest: a shape in metres, as check --shape reads it")
      ->excludes(all)
      ->excludes(number);
  options->overrides.add_to(*command);
  options->plan.add_to(*command);
  std::vector<std::string> formats = compare::names<Format>();
  formats.emplace_back("vtk");
  add_output_options(*command, options->output, formats);
  options->plot.add_to(*command, "shape and curvature (with --all: of every equilibrium)");
  command->footer(
      "Examples:\n"
      "  dlo solve data/scenes/spring_steel_175.toml --model exact --samples 5\n"
      "  dlo solve data/scenes/cable.toml --format vtk -o cable.vtk   # for ParaView\n"
      "  dlo solve data/scenes/cable.toml --plot cable.svg");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
