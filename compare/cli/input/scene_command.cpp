#include <memory>
#include <string>

#include "command/commands.hpp"
#include "format/scene_document.hpp"
#include "option/command_line.hpp"
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

void add_scene_command(CLI::App& app) {
  add_command<ShowOptions>(app, "scene", run, [](Command& command, ShowOptions& o) {
    command.bind("SCENE", o.scene, o.overrides, o.output);
  });
}

}  // namespace dlo::cli
