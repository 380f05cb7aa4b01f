#include <memory>
#include <utility>

#include "command/commands.hpp"
#include "dlo/compare/material.hpp"
#include "format/json.hpp"
#include "option/command_line.hpp"
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

void add_materials_command(CLI::App& app) {
  add_command<MaterialsOptions>(app, "materials", run, [](Command& command, MaterialsOptions& o) {
    command.bind("--materials", o.file, o.output);
  });
}

}  // namespace dlo::cli
