#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

#include "base/input_file.hpp"
#include "base/quote.hpp"
#include "base/text.hpp"
#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "option/command_line.hpp"
#include "option/output.hpp"
#include "reading/new_scene.hpp"

namespace dlo::cli {
namespace {

struct InitOptions {
  std::string target = "scene.toml";
  bool force = false;
  std::string materials;
  compare::SceneChoices choices;
};

/// Returns the file and the scene's name: "my cable" is written to my_cable.toml, and a FILE.toml
/// gives its name to the scene.
std::filesystem::path file_of(const std::string& target, std::string& name) {
  const std::filesystem::path path(target);
  name = path.extension() == ".toml" ? path.stem().string() : path.filename().string();
  if (name.empty()) {
    throw compare::InputError(
        fmt::format("init: {} is no name (allowed: a name, or FILE.toml)", target));
  }
  std::string stem = name;
  std::replace_if(
      stem.begin(), stem.end(), [](unsigned char c) { return std::isspace(c) != 0; }, '_');
  return path.parent_path() / (stem + ".toml");
}

std::string next_steps(const compare::Scene& scene, const std::string& file) {
  std::string out;
  const bool is_stiff = scene.material.youngs_modulus >= 1e9;
  append(out, "{} written: {:g} m long, {:g} mm thick, E = {:g} {}, density {:g} kg/m^3\n",
         compare::display(file), scene.length, scene.diameter * 1e3,
         scene.material.youngs_modulus / (is_stiff ? 1e9 : 1e6), is_stiff ? "GPa" : "MPa",
         scene.material.density);
  append(out, "  weight {:.4g} N, EI = {:.4g} N m^2, Gamma = w l^3 / (EI) = {:.4g}\n",
         scene.mass() * scene.gravity.norm(), scene.bending_stiffness(), scene.gamma());
  append(out,
         "Next:\n"
         "  dlo solve {0}                       its shape, and the gripper's force and torque\n"
         "  dlo check {0} --shape mine.csv      is your simulator's shape right?\n"
         "  dlo calibrate {0} -o params.toml    parameters of the force model\n",
         compare::shell_word(file));
  // Limit of Gamma; a horizontal cantilever sags by Gamma / 8 of its length.
  constexpr double stiff_gamma_limit = 1;
  if (scene.gamma() < stiff_gamma_limit) {
    append(
        out,
        "The rod is stiff: level, it sags by about {:.2g} % of its length. Check it with\n"
        "  --tolerance \"5% of deflection\"   a share of that sag, which a straight line misses\n",
        scene.gamma() / 8 * 100);
  }
  return out;
}

/// Returns the scene's text. Errors name the option that gave the value.
std::string text_of(const compare::SceneChoices& choices,
                    const std::vector<compare::Material>& known) {
  try {
    return compare::scene_text(choices, known);
  } catch (const compare::InputError& error) {
    constexpr std::string_view options[] = {"--length",         "--diameter", "--material",
                                            "--youngs-modulus", "--density",  "--direction"};
    std::string option = "--" + error.key().substr(error.key().rfind('.') + 1);
    std::ranges::replace(option, '_', '-');
    // A custom material has no name.
    const bool is_given = option != "--material" || choices.youngs_modulus.empty();
    if (is_given && std::ranges::find(options, option) != std::end(options)) {
      throw compare::InputError(option + error.problem());
    }
    throw;
  }
}

void run(const InitOptions& given) {
  InitOptions options = given;
  const std::string file = file_of(options.target, options.choices.name).string();
  std::error_code unknown;  // ignored: an unusable name is reported when the file is written
  if (!options.force && std::filesystem::exists(std::filesystem::symlink_status(file, unknown))) {
    throw compare::InputError(
        fmt::format("{}: exists (allowed: another name, or --force to replace it)", file));
  }
  check_output("init:", file);
  compare::declare_output(file, "init: " + file);
  const std::vector<compare::Material> known =
      options.materials.empty() ? compare::materials() : compare::load_materials(options.materials);
  const std::string text = text_of(options.choices, known);
  const compare::Scene scene = compare::parse_scene(text, file, known);
  write_output({.file = file}, text);
  write_output({}, next_steps(scene, file));
}

}  // namespace

void add_init_command(CLI::App& app) {
  add_command<InitOptions>(app, "init", run, [](Command& command, InitOptions& o) {
    command.bind("NAME", o.target, "--length", o.choices.length, "--diameter", o.choices.diameter,
                 "--material", o.choices.material, "--youngs-modulus", o.choices.youngs_modulus,
                 "--density", o.choices.density, "--direction", o.choices.direction, "--up",
                 o.choices.up, "--materials", o.materials, "--force", o.force);
  });
}

}  // namespace dlo::cli
