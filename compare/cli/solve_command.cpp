#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "commands.hpp"
#include "dlo/compare/display.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/solve.hpp"
#include "dlo/compare/vtk_polyline.hpp"
#include "json.hpp"
#include "output.hpp"
#include "plan_text.hpp"
#include "scene_options.hpp"

namespace dlo::cli {
namespace {

struct SolveOptions {
  std::string scene;
  std::string model = "energy";
  int samples = 0;
  bool all = false;
  SceneOptions overrides;
  PlanOptions plan;
  OutputOptions output;
};

std::string csv(const compare::Solution& solution) {
  std::string text = "x,y,z,s\n";
  for (std::size_t i = 0; i < solution.shape.arc_length.size(); ++i) {
    const auto point = solution.shape.points.col(static_cast<Eigen::Index>(i));
    append_csv(text, "{:.17g},{:.17g},{:.17g},{:.17g}\n", point.x(), point.y(), point.z(),
               solution.shape.arc_length[i]);
  }
  return text;
}

/// Eight decimals; what rounds to zero has no sign.
std::string coordinate(double value) {
  return fmt::format("{:.8f}", std::abs(value) < 0.5e-8 ? 0.0 : value);
}

std::string text(const compare::Solution& solution, const compare::Scene& scene) {
  std::string out;
  append(out, "scene      {}\n", compare::display(scene.name));
  append(out, "model      {}, {}\n", compare::to_string(solution.model), solution.message);
  append(out, "Gamma      {:.6g}   (w l^3 / EI)\n", scene.gamma());
  if (solution.steps > 0) {
    append(out, "steps      {}   c_F {:.4g} m/N, c_h {:.6f}\n", solution.steps, solution.c_F,
           solution.c_h);
  } else {
    append(out, "work       {} evaluations", solution.evaluations);
    if (solution.terms > 0) append(out, ", {} terms", solution.terms);
    append(out, "\n");
  }
  append(out, "wall time  {:.3g} ms\n", solution.seconds * 1e3);
  compare::SceneEnergies e = solution.energy;
  // Adding zero turns -0 into 0.
  for (double* part : {&e.bending, &e.gravity, &e.load, &e.stretch}) *part += 0.0;
  append(out, "energy     bending {:.9g} J, gravity {:.9g} J, load {:.9g} J, stretch {:.3g} J\n",
         e.bending, e.gravity, e.load, e.stretch);
  for (const Eigen::Vector3d& force : solution.obstacles) {
    append(out, "obstacle   force [{:.6g}, {:.6g}, {:.6g}] N on the rod\n", force.x(), force.y(),
           force.z());
  }
  for (std::size_t i = 0; i < solution.grippers.size(); ++i) {
    compare::GripperLoad load = solution.grippers[i];
    const compare::Gripper& gripper = scene.grippers[i];
    load.force.array() += 0.0;
    load.torque.array() += 0.0;
    append(out,
           "gripper {} at s = {:.4g} m ({}): force [{:.6g}, {:.6g}, {:.6g}] N, torque [{:.6g}, "
           "{:.6g}, {:.6g}] Nm on the "
           "rod\n",
           i + 1, gripper.at, gripper.direction ? "clamp" : "pin", load.force.x(), load.force.y(),
           load.force.z(), load.torque.x(), load.torque.y(), load.torque.z());
  }
  append(out, "\n{:>12} {:>13} {:>13} {:>13}\n", "s [m]", "x [m]", "y [m]", "z [m]");
  for (std::size_t i = 0; i < solution.shape.arc_length.size(); ++i) {
    const auto point = solution.shape.points.col(static_cast<Eigen::Index>(i));
    append(out, "{:12.6f} {:>13} {:>13} {:>13}\n", solution.shape.arc_length[i],
           coordinate(point.x()), coordinate(point.y()), coordinate(point.z()));
  }
  return out;
}

/// The first of several equilibria in full, then what tells them apart.
Json json(const std::vector<compare::Solution>& solutions, const compare::Scene& scene,
          const compare::Plan& plan, bool all) {
  Json document = to_json(solutions.front(), scene, plan);
  if (!all) return document;
  Json equilibria = Json::array();
  for (const compare::Solution& solution : solutions) {
    equilibria.push_back({{"stable", solution.smallest_curvature >= -1e-7},
                          {"smallest_curvature", solution.smallest_curvature},
                          {"energy_J", solution.energy.total()},
                          {"points_m", points_json(solution.shape.points)}});
  }
  document["equilibria"] = std::move(equilibria);
  return document;
}

std::string equilibria_text(const std::vector<compare::Solution>& solutions) {
  std::string out;
  append(out, "\n{} equilibria found\n{:>16} {:>10} {:>20} {:>13} {:>13} {:>13}\n",
         solutions.size(), "energy [J]", "", "smallest curvature", "x(l) [m]", "y(l) [m]",
         "z(l) [m]");
  for (const compare::Solution& solution : solutions) {
    const Eigen::Vector3d tip = solution.shape.points.rightCols<1>();
    append(out, "{:16.9g} {:>10} {:20.6g} {:13.6f} {:13.6f} {:13.6f}\n", solution.energy.total(),
           solution.smallest_curvature >= -1e-7 ? "stable" : "unstable",
           solution.smallest_curvature, tip.x(), tip.y(), tip.z());
  }
  return out;
}

/// What a format cannot say is not left out in silence.
void require_format_for(const SolveOptions& options) {
  const std::string& format = options.output.format;
  if (format != "csv" && format != "vtk") return;
  if (options.all) {
    throw compare::InputError(
        fmt::format("--all: format {} holds one shape (allowed: text or json)", format));
  }
  if (options.plan.explain()) {
    throw compare::InputError(
        fmt::format("--explain: format {} holds no plan (allowed: text or json)", format));
  }
}

void warn_of_force_model_options(const SolveOptions& options) {
  const std::string names = options.overrides.force_model_options();
  if (names.empty()) return;
  say("{}: no effect on the shape of model {} (only on force and chain)", names, options.model);
}

/// A shape that is not resolved has been shown, which is no success.
void require_resolved(const compare::Solution& solution, const compare::Scene& scene) {
  if (solution.status != energy_model::SolveStatus::not_resolved) return;
  throw compare::ConvergenceError(
      fmt::format("{}: the energy model: {}", scene.file, solution.message));
}

void run(const SolveOptions& options) {
  require_format_for(options);
  const compare::Scene scene = options.overrides.load(options.scene);
  const compare::Model model = compare::model_from(options.model);
  constexpr int text_samples = 11;
  int samples = options.samples;
  const bool continuous = model == compare::Model::energy || model == compare::Model::exact;
  if (continuous) warn_of_force_model_options(options);
  if (samples == 0 && continuous && options.output.kind() == Format::text) samples = text_samples;
  const std::vector<double> arc_lengths =
      samples > 0 ? compare::equal_arc_lengths(scene.length, samples) : std::vector<double>{};
  if (options.all && model != compare::Model::energy) {
    throw compare::InputError("--all: only model energy searches for all equilibria");
  }
  compare::SolveOptions solve = options.overrides.solve();
  solve.accept_unresolved = true;
  const std::vector<compare::Solution> solutions =
      options.all
          ? compare::solve_all(scene, solve, arc_lengths)
          : std::vector<compare::Solution>{compare::solve(scene, model, solve, arc_lengths)};
  const compare::Solution& solution = solutions.front();
  if (options.output.format == "vtk") {
    write_output(options.output, compare::vtk_polyline(solution, scene.name));
    return require_resolved(solution, scene);
  }
  const auto plan = [&] {
    compare::PlanOptions plan_options = options.plan.plan();
    plan_options.time_limit = std::min(plan_options.time_limit, solve.time_limit);
    return compare::make_plan(scene, plan_options);
  };
  std::string content;
  switch (options.output.kind()) {
    case Format::json:
      content = json_text(json(solutions, scene, plan(), options.all));
      break;
    case Format::csv:
      content = csv(solution);
      break;
    case Format::text:
      if (options.plan.explain()) content = plan_text(plan(), scene);
      content += text(solution, scene);
      if (options.all) content += equilibria_text(solutions);
      break;
  }
  write_output(options.output, content);
  require_resolved(solution, scene);
}

}  // namespace

void add_solve(CLI::App& app) {
  CLI::App* command = app.add_subcommand("solve", "the shape of one scene with one model");
  const auto options = std::make_shared<SolveOptions>();
  command->add_option("SCENE", options->scene, "scene file (TOML)")->required();
  command->add_option("--model", options->model, "energy, chain, exact or force")
      ->check(CLI::IsMember(compare::model_names()))
      ->capture_default_str();
  command->add_option("--samples", options->samples, "M points at equal arc lengths from 0 to l")
      ->check(CLI::Range(2, 1000000));
  command->add_flag("--all", options->all, "every equilibrium that is found, with its stability");
  options->overrides.add_to(*command);
  options->plan.add_to(*command);
  std::vector<std::string> formats = format_names();
  formats.emplace_back("vtk");
  add_output_options(*command, options->output, formats);
  command->footer(
      "Examples:\n"
      "  dlo solve data/scenes/spring_steel_175.toml --model exact --samples 5\n"
      "  dlo solve data/scenes/cable.toml --format vtk -o cable.vtk   # for ParaView");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
