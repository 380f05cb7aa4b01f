#include <memory>
#include <string>

#include "command/commands.hpp"
#include "format/scene_document.hpp"
#include "option/output.hpp"
#include "option/scene_options.hpp"
#include "record/csv_table.hpp"

namespace dlo::cli {
namespace {

struct ShowOptions {
  std::string scene;
  SceneOptions overrides;
  OutputOptions output;
};

void run(const ShowOptions& options) {
  write_output(options.output,
               compare::Document{compare::scene_document(options.overrides.load(options.scene))});
}

}  // namespace

void add_scene(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "scene", "a scene in SI units with all that follows from it, for other programs");
  const auto options = std::make_shared<ShowOptions>();
  command->add_option("SCENE", options->scene, "scene file (TOML)")->required();
  options->overrides.add_settings_to(*command);
  add_output_options(*command, options->output, {"text", "json"});
  command->footer(
      "Examples:\n"
      "  dlo scene data/scenes/twisted_wire.toml\n"
      "  dlo scene data/scenes/spliced_cable.toml --points 32 -o scene.json");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
