#include <memory>
#include <utility>

#include "command/commands.hpp"
#include "dlo/compare/material.hpp"
#include "format/json.hpp"
#include "option/option_values.hpp"
#include "option/output.hpp"
#include "option/scene_options.hpp"
#include "record/csv_table.hpp"

namespace dlo::cli {
namespace {

using compare::Material;

struct MaterialsOptions {
  std::string file;
  OutputOptions output;
};

void run(const MaterialsOptions& options) {
  const std::vector<Material> materials =
      options.file.empty() ? compare::materials() : compare::load_materials(options.file);
  Json list = json_list(materials, [&](const Material& material) -> Json {
    return {{"material", material.name},
            {"youngs_modulus_Pa", material.youngs_modulus},
            {"density_kg_per_m3", material.density},
            {"source", material.source}};
  });
  write_output(
      options.output,
      compare::Document{
          .json = {{"schema", "dlo/materials/1"}, {"materials", std::move(list)}},
          .columns = {{"materials", "material,youngs_modulus_Pa,density_kg_per_m3,source"}},
          .table = "materials"});
}

}  // namespace

void add_materials(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("materials", "the materials that a scene can name, with their values");
  const auto options = std::make_shared<MaterialsOptions>();
  add_file(*command, "--materials", options->file, "materials file instead of the built-in one");
  add_output_options(*command, options->output);
  command->footer("Example:\n  dlo materials");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
