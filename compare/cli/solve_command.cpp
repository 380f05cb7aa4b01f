#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "dlo/compare/solve.hpp"
#include "json.hpp"
#include "output.hpp"
#include "scene_options.hpp"

namespace dlo::cli {
namespace {

struct Options {
  std::string scene;
  std::string model = "energy";
  int samples = 0;
  SceneOptions overrides;
  OutputOptions output;
};

std::string csv(const compare::Solution& solution) {
  std::string text = "x,y,z,s\n";
  for (std::size_t i = 0; i < solution.shape.arc_length.size(); ++i) {
    const auto point = solution.shape.points.col(static_cast<Eigen::Index>(i));
    append(text, "{:.17g},{:.17g},{:.17g},{:.17g}\n", point.x(), point.y(), point.z(),
           solution.shape.arc_length[i]);
  }
  return text;
}

std::string text(const compare::Solution& solution, const compare::Scene& scene) {
  std::string out;
  append(out, "scene      {}\n", scene.name);
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
  const compare::SceneEnergies& e = solution.energy;
  append(out, "energy     bending {:.9g} J, gravity {:.9g} J, load {:.9g} J, stretch {:.3g} J\n",
         e.bending, e.gravity, e.load, e.stretch);
  for (const compare::GripperLoad& load : solution.grippers) {
    append(out,
           "gripper    force [{:.6g}, {:.6g}, {:.6g}] N, torque [{:.6g}, {:.6g}, {:.6g}] Nm on the "
           "rod\n",
           load.force.x(), load.force.y(), load.force.z(), load.torque.x(), load.torque.y(),
           load.torque.z());
  }
  append(out, "\n{:>12} {:>13} {:>13} {:>13}\n", "s [m]", "x [m]", "y [m]", "z [m]");
  for (std::size_t i = 0; i < solution.shape.arc_length.size(); ++i) {
    const auto point = solution.shape.points.col(static_cast<Eigen::Index>(i));
    append(out, "{:12.6f} {:13.8f} {:13.8f} {:13.8f}\n", solution.shape.arc_length[i], point.x(),
           point.y(), point.z());
  }
  return out;
}

void run(const Options& options) {
  const compare::Scene scene = options.overrides.load(options.scene);
  const compare::Model model = compare::model_from(options.model);
  constexpr int text_samples = 11;
  int samples = options.samples;
  const bool continuous = model == compare::Model::energy || model == compare::Model::exact;
  if (samples == 0 && continuous && options.output.kind() == Format::text) samples = text_samples;
  const std::vector<double> arc_lengths =
      samples > 0 ? compare::equal_arc_lengths(scene.length, samples) : std::vector<double>{};
  const compare::Solution solution =
      compare::solve(scene, model, options.overrides.solve(), arc_lengths);
  std::string content;
  switch (options.output.kind()) {
    case Format::json:
      content = to_json(solution, scene).dump(2) + "\n";
      break;
    case Format::csv:
      content = csv(solution);
      break;
    case Format::text:
      content = text(solution, scene);
      break;
  }
  write_output(options.output, content);
}

}  // namespace

void add_solve(CLI::App& app) {
  CLI::App* command = app.add_subcommand("solve", "the shape of one scene with one model");
  const auto options = std::make_shared<Options>();
  command->add_option("SCENE", options->scene, "scene file (TOML)")->required();
  command->add_option("--model", options->model, "energy, chain, exact or force")
      ->check(CLI::IsMember(compare::model_names()))
      ->capture_default_str();
  command->add_option("--samples", options->samples, "M points at equal arc lengths from 0 to l")
      ->check(CLI::Range(2, 10000000));
  options->overrides.add_to(*command);
  add_output_options(*command, options->output);
  command->footer(
      "Example:\n  dlo solve data/scenes/spring_steel_175.toml --model exact --samples 5");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
