#include <memory>

#include "command/commands.hpp"
#include "dlo/compare/material.hpp"
#include "format/json.hpp"
#include "option/help.hpp"
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

std::string modulus_text(double pascal) {
  return pascal >= 1e9 ? fmt::format("{:g} GPa", pascal * 1e-9)
                       : fmt::format("{:g} MPa", pascal * 1e-6);
}

std::string text(const std::vector<Material>& materials) {
  std::string out;
  for (const Material& material : materials) {
    append(out, "{:<16} E = {:>8}, density {:>4g} kg/m^3\n    {}\n", material.name,
           modulus_text(material.youngs_modulus), material.density, wrap(material.source, 4));
  }
  return out;
}

Json json(const std::vector<Material>& materials) {
  return {{"schema", "dlo/materials/1"},
          {"materials", json_list(materials, [&](const Material& material) -> Json {
             return {{"material", material.name},
                     {"youngs_modulus_Pa", material.youngs_modulus},
                     {"density_kg_per_m3", material.density},
                     {"source", material.source}};
           })}};
}

std::string csv(const std::vector<Material>& materials) {
  const compare::CsvTable table("material,youngs_modulus_Pa,density_kg_per_m3,source");
  return table.text(json(materials).at("materials"));
}

void run(const MaterialsOptions& options) {
  const std::vector<Material> materials =
      options.file.empty() ? compare::materials() : compare::load_materials(options.file);
  write_output(options.output, {.text = [&] { return text(materials); },
                                .json = [&] { return json_text(json(materials)); },
                                .csv = [&] { return csv(materials); }});
}

}  // namespace

void add_materials(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("materials", "the materials that a scene can name, with their values");
  const auto options = std::make_shared<MaterialsOptions>();
  command->add_option("--materials", options->file, "materials file instead of the built-in one")
      ->type_name("FILE");
  add_output_options(*command, options->output);
  command->footer("Example:\n  dlo materials");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
