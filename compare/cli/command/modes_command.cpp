#include <fmt/format.h>

#include <memory>

#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "motion/scene_modes.hpp"
#include "option/command_line.hpp"
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

void add_modes_command(CLI::App& app) {
  add_command<ModesOptions>(app, "modes", run, [](Command& command, ModesOptions& o) {
    command.bind("SCENE", o.scene, "--count", o.modes.count, "--rate", o.modes.rate, "--damping",
                 o.modes.damping, "--tension", o.modes.tension, "--samples", o.samples, o.overrides,
                 o.output);
  });
}

}  // namespace dlo::cli
