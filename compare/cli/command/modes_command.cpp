#include <fmt/format.h>

#include <memory>

#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "motion/scene_modes.hpp"
#include "option/option_values.hpp"
#include "option/output.hpp"
#include "option/scene_options.hpp"
#include "series/series_output.hpp"

namespace dlo::cli {
namespace {

using compare::SceneModes;

struct ModesOptions {
  std::string scene;
  compare::ModeOptions modes;
  int samples = 41;
  SceneOptions overrides;
  OutputOptions output;
};

void run(const ModesOptions& options) {
  const compare::Scene scene = options.overrides.load(options.scene);
  warn_of_friction(scene);
  compare::ModeOptions mode_options = options.modes;
  mode_options.solve = options.overrides.solve();
  const SceneModes modes = compare::scene_modes(scene, mode_options);
  write_output(options.output, modes_document(modes, scene, options.modes.rate, options.samples));
  if (!succeeded(modes.status)) {
    throw compare::ConvergenceError(fmt::format("{}: {}", scene.file, modes.message));
  }
}

}  // namespace

void add_modes(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "modes",
      "natural frequencies about a scene's shape: of the rod, its polygon, and as it steps");
  const auto options = std::make_shared<ModesOptions>();
  command->add_option("SCENE", options->scene, "scene file (TOML)")->required();
  add_checked(*command, "--count", options->modes.count, CLI::Range(1, 40),
              "modes, the slowest ones");
  add_checked(*command, "--rate", options->modes.rate, number_between(1e-6, 1e9),
              "steps of the force model a second, of which a step makes its mass dt^2 / c_F");
  add_checked(*command, "--damping", options->modes.damping, number_between(1e-6, 1),
              "damping ratio of the slowest mode that the material has, for c_h");
  command
      ->add_option(
          "--tension", options->modes.tension,
          "of a rod that clamps hold straight [N], not identifiable from its shape; default 0")
      ->check(number_between(-1e12, 1e12));
  add_checked(*command, "--samples", options->samples, CLI::Range(2, 100000),
              "points of each mode's shape in JSON");
  options->overrides.add_to(*command, Steps::none);
  add_output_options(*command, options->output);
  command->footer(
      "Examples:\n"
      "  dlo modes data/scenes/spring_steel_175.toml\n"
      "  dlo modes data/scenes/cable.toml --points 32 --stepper dynamic --rate 10000");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
