#include <memory>

#include "base/quote.hpp"
#include "command/commands.hpp"
#include "dlo/compare/material.hpp"
#include "format/json.hpp"
#include "option/help.hpp"
#include "option/output.hpp"
#include "option/scene_options.hpp"

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

std::string csv(const std::vector<Material>& materials) {
  std::string out = "material,youngs_modulus_Pa,density_kg_per_m3,source\n";
  for (const Material& material : materials) {
    append_csv(out, "{},{:.10g},{:.10g},{}\n", compare::csv_field(material.name),
               material.youngs_modulus, material.density, compare::csv_field(material.source));
  }
  return out;
}

Json json(const std::vector<Material>& materials) {
  Json list = Json::array();
  for (const Material& material : materials) {
    list.push_back({{"material", material.name},
                    {"youngs_modulus_Pa", material.youngs_modulus},
                    {"density_kg_per_m3", material.density},
                    {"source", material.source}});
  }
  return {{"schema", "dlo/materials/1"}, {"materials", std::move(list)}};
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
