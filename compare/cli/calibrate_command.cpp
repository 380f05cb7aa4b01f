#include <fmt/format.h>

#include <memory>
#include <optional>

#include "calibration_text.hpp"
#include "commands.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/quantity.hpp"
#include "output.hpp"
#include "scene_options.hpp"
#include "shape_options.hpp"

namespace dlo::cli {
namespace {

struct Options {
  std::vector<std::string> scenes;
  std::vector<std::string> shapes;
  bool density = false;
  std::string noise;
  ShapeOptions shape_options;
  SceneOptions overrides;
  OutputOptions output;
};

std::optional<double> noise_m(const std::string& text) {
  if (text.empty()) return std::nullopt;
  try {
    const double value = compare::parse_quantity(text, compare::Dimension::length);
    if (value > 0) return value;
  } catch (const compare::InputError& error) {
    throw compare::InputError(fmt::format("--noise = {}: {}", text, error.what()));
  }
  throw compare::InputError(fmt::format("--noise = {}: out of range (allowed: > 0)", text));
}

/// The format, or toml for a file whose name says so.
std::string format_of(const OutputOptions& output, const CLI::App& command) {
  const bool given = command.count("--format") > 0;
  return !given && output.file.ends_with(".toml") ? "toml" : output.format;
}

void run_material(const Options& options, const std::string& format) {
  MaterialReport report;
  std::vector<compare::MeasuredShape> shapes;
  for (const std::string& path : options.scenes) {
    report.scenes.push_back(options.overrides.load(path));
  }
  for (const std::string& path : options.shapes) {
    shapes.push_back(options.shape_options.load(path));
  }
  // Several measurements of one scene
  if (report.scenes.size() == 1) report.scenes.resize(shapes.size(), report.scenes.front());
  report.files = options.shapes;
  report.frame_was_found = options.shape_options.pose() != compare::PoseFreedom::known;
  report.fit = compare::fit_material(report.scenes, shapes,
                                     {.pose = options.shape_options.pose(),
                                      .arc_lengths = options.shape_options.arc_lengths(),
                                      .density = options.density,
                                      .noise = noise_m(options.noise),
                                      .solve = options.overrides.solve()});
  std::string content;
  if (format == "json") {
    content = material_json(report).dump(2) + "\n";
  } else if (format == "csv") {
    content = material_csv(report);
  } else if (format == "toml") {
    content = material_toml(report);
  } else {
    content = material_text(report);
  }
  write_output(options.output, content);
}

}  // namespace

void add_calibrate(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "calibrate", "Young's modulus from measured shapes, with its 95 % interval");
  const auto options = std::make_shared<Options>();
  command->add_option("SCENE", options->scenes, "scene files (TOML)")->required();
  const std::string measured = "From measured shapes";
  command->add_option("--shape", options->shapes, "one per scene, or several of one scene")
      ->type_name("FILE")
      ->required()
      ->group(measured);
  command->add_flag("--density", options->density, "fit the density as well")->group(measured);
  command
      ->add_option("--noise", options->noise,
                   "standard deviation of one coordinate such as \"0.5 mm\"; default: estimated")
      ->group(measured);
  options->shape_options.add_to(*command);
  options->overrides.add_to(*command);
  std::vector<std::string> formats = format_names();
  formats.emplace_back("toml");
  command->add_option("--format", options->output.format, "text, json, csv or toml")
      ->check(CLI::IsMember(formats))
      ->capture_default_str();
  command
      ->add_option("-o,--output", options->output.file,
                   "write to FILE instead of standard output; .toml implies --format toml")
      ->type_name("FILE");
  command->footer(
      "Example:\n  dlo solve data/scenes/spring_steel_135.toml --model exact --samples 12 --format "
      "csv -o seen.csv\n  dlo calibrate data/scenes/spring_steel_135.toml --shape seen.csv");
  command->callback(
      [options, command] { run_material(*options, format_of(options->output, *command)); });
}

}  // namespace dlo::cli
