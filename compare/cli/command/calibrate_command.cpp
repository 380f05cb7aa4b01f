#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "base/input_file.hpp"
#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/fitted_material.hpp"
#include "fit/chain_springs.hpp"
#include "format/calibration_output.hpp"
#include "format/json.hpp"
#include "format/result_output.hpp"
#include "option/command_line.hpp"
#include "option/output.hpp"
#include "option/plot.hpp"
#include "option/scene_options.hpp"
#include "option/shape_options.hpp"
#include "option/share.hpp"
#include "option/terminal.hpp"
#include "picture/figures.hpp"
#include "series/series_output.hpp"
#include "toml/quantity.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::cli {
namespace {

/// Segments of a chain that --segments gives.
struct ChainLayout {
  int segments = 0;                     // number of equal segments
  std::vector<double> segment_lengths;  // lengths of unequal segments [m]
};

/// Arguments and options of `dlo calibrate`.
struct CalibrateOptions {
  std::vector<std::string> scenes;
  std::vector<std::string> shapes;
  bool density = false;
  bool torsional_stiffness = false;
  std::string noise;
  int natural_curvature_terms = 0;
  std::vector<std::string> motions;
  std::string segments;  // a number, or the name of a file
  std::string clamp_angles;
  std::string clamp_positions;
  std::string clamp_rolls;
  bool same_clamps = false;
  std::string clamp_scatter;
  std::string camera_tilt;
  bool predict = false;
  std::string chosen;  // empty: the default of calibrate()
  std::vector<std::string> holdouts;
  std::optional<double> target;
  ShapeOptions shape_options;
  SceneOptions overrides;
  OutputOptions output;
  PlotOptions plot;

  /// Check and convert the options. @throws compare::InputError naming the option
  [[nodiscard]] ChainLayout chain_layout() const;
  [[nodiscard]] compare::MaterialFitOptions material_options() const;
};

/// Reads the quantity > 0 of an option, if it is given.
std::optional<double> quantity_of(const char* option, const std::string& text,
                                  compare::Dimension dimension) {
  if (text.empty()) return std::nullopt;
  try {
    const double value = compare::parse_quantity(text, dimension);
    if (value > 0) return value;
  } catch (const compare::InputError& error) {
    throw compare::InputError(fmt::format("{} = {}: {}", option, text, error.what()));
  }
  throw compare::InputError(fmt::format("{} = {}: out of range (allowed: > 0)", option, text));
}

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("+-0123456789") == std::string::npos;
}

/// Returns an empty string for a file or for a number in range, else the error.
std::string check_segments(const std::string& text) {
  if (!is_number(text)) return "";
  std::string copy = text;
  return CLI::Range(4, 200)(copy);
}

ChainLayout CalibrateOptions::chain_layout() const {
  if (segments.empty()) return {};
  if (is_number(segments)) return {.segments = std::stoi(segments)};
  return {.segment_lengths = compare::segment_lengths(shape_options.load(segments).points)};
}

compare::MaterialFitOptions CalibrateOptions::material_options() const {
  constexpr int profile_points = 41;
  using compare::Dimension;
  const ChainLayout chain = chain_layout();
  return {.pose = shape_options.pose(),
          .arc_lengths = shape_options.arc_lengths(),
          .density = density,
          .torsional_stiffness = torsional_stiffness,
          .natural_curvature_terms = natural_curvature_terms,
          .direction_tolerance =
              quantity_of("--clamp-angles", clamp_angles, Dimension::angle).value_or(0),
          .position_tolerance =
              quantity_of("--clamp-positions", clamp_positions, Dimension::length).value_or(0),
          .roll_tolerance = quantity_of("--clamp-rolls", clamp_rolls, Dimension::angle).value_or(0),
          .shared_clamps = same_clamps,
          .direction_scatter =
              quantity_of("--clamp-scatter", clamp_scatter, Dimension::angle).value_or(0),
          .camera_tilt = quantity_of("--camera-tilt", camera_tilt, Dimension::angle).value_or(0),
          .predict = predict,
          .choose_options = chosen.empty() ? std::nullopt : std::optional(chosen == "auto"),
          .chain_segments = chain.segments,
          .chain_segment_lengths = chain.segment_lengths,
          .profile_points = plot.draws() ? profile_points : 0,
          .noise = quantity_of("--noise", noise, Dimension::length),
          .solve = overrides.solve()};
}

std::vector<compare::Scene> load_all(const std::vector<std::string>& paths,
                                     const SceneOptions& overrides) {
  std::vector<compare::Scene> scenes;
  scenes.reserve(paths.size());
  for (const std::string& path : paths) scenes.push_back(overrides.load(path));
  return scenes;
}

/// Writes the result. Without --format, a .toml file gets the document that can be read again, and
/// the text is shown as well.
void write_calibration(const OutputOptions& output, bool format_is_given, const Formats& formats) {
  const bool to_toml_file = !format_is_given && output.format == "toml";
  // The text is shown even if there is nothing to write.
  if (to_toml_file) write_output({}, formats.at("text")());
  write_output(output, formats);
}

/// Loads shapes. @param scenes  scenes of all shapes; @param first  index of the first shape, if
/// each has its own scene
std::vector<compare::MeasuredShape> load_shapes(const std::vector<std::string>& files,
                                                const CalibrateOptions& options,
                                                const std::vector<compare::Scene>& scenes,
                                                std::size_t first) {
  std::vector<compare::MeasuredShape> shapes;
  shapes.reserve(files.size());
  for (std::size_t i = 0; i < files.size(); ++i) {
    shapes.push_back(options.shape_options.load(files[i]));
    const std::size_t of = std::min(first + i, scenes.size() - 1);
    options.shape_options.require_likely_unit(shapes.back(), scenes[of].length);
  }
  return shapes;
}

void run_material(const CalibrateOptions& options, bool format_is_given) {
  options.plot.require_drawable();
  std::vector<compare::Scene> scenes = load_all(options.scenes, options.overrides);
  const std::vector<compare::MeasuredShape> shapes =
      load_shapes(options.shapes, options, scenes, 0);
  const std::vector<compare::MeasuredShape> held_out =
      load_shapes(options.holdouts, options, scenes, shapes.size());
  for (const compare::Scene& scene : scenes) {
    say_assumptions(scene);
    warn_of_friction(scene);
  }
  const compare::Calibration found = with_progress("calibrate", [&](const auto& /*unknown*/) {
    return compare::calibrate(std::move(scenes), shapes, options.material_options(), held_out);
  });
  write_calibration(options.output, format_is_given,
                    Formats{{"text", [&] { return material_text(found); }},
                            {"json", [&] { return json_text(material_json(found)); }},
                            {"csv", [&] { return material_csv(found); }},
                            {"toml", [&] { return material_toml(found); }}});
  options.plot.draw([&] { return compare::fit_picture(found.scenes, found.fit); });
}

/// Calibrates the springs of chains for the scenes' own rods, without measured shapes.
void run_chains(const CalibrateOptions& options, bool format_is_given) {
  const ChainLayout layout = options.chain_layout();
  const compare::SolveOptions solve = options.overrides.solve();
  std::vector<compare::ChainSprings> chains;
  for (const compare::Scene& scene : load_all(options.scenes, options.overrides)) {
    for (compare::ChainSprings& chain :
         layout.segment_lengths.empty()
             ? compare::chain_springs(scene, layout.segments, solve)
             : compare::chain_springs(scene, layout.segment_lengths, solve)) {
      chains.push_back(std::move(chain));
    }
  }
  if (chains.empty()) {
    throw compare::InputError(
        "--segments: a plain chain of hinges represents the rod of no scene (allowed: one section, "
        "intrinsically straight, not twisted, touching nothing)");
  }
  const compare::Document document{
      .json = {{"chains", chains_json(chains)}},
      .columns = {
          {"chains/#/joints", "at_m,joint_stiffness_Nm_per_rad,binormal_stiffness_Nm_per_rad"}}};
  write_calibration(options.output, format_is_given,
                    Formats{{"text", [&] { return document.text(); }},
                            {"json", [&] { return json_text(document.json); }}});
}

void run_motion(const CalibrateOptions& options, bool format_is_given) {
  if (options.scenes.size() != 1) {
    throw compare::InputError("--motion: of one scene (allowed: one SCENE)");
  }
  const compare::Scene scene = options.overrides.load(options.scenes.front());
  std::vector<compare::MarkerMotion> recordings;
  for (const std::string& file : options.motions) {
    recordings.push_back(compare::parse_markers(compare::read_file(file), file));
  }
  ProgressBar bar("calibrate");
  const compare::MotionFit found =
      compare::fit_motion(scene, recordings,
                          {.damping = DampingOptions{}.of(options.overrides.calibrated()),
                           .solve = options.overrides.solve()},
                          [&bar](const std::string& what) { bar.stage(what); });
  const compare::Document document = motion_fit_document(found, scene);
  write_calibration(options.output, format_is_given,
                    Formats{{"text", [&] { return document.text(); }},
                            {"json", [&] { return json_text(document.json); }},
                            {"toml", [&] { return motion_toml(found, scene); }}});
  if (!found.not_identified.empty()) end_with(ExitStatus::not_converged);
}

void run_force_model(const CalibrateOptions& options, bool points_are_given, bool format_is_given) {
  const std::vector<compare::Scene> scenes = load_all(options.scenes, options.overrides);
  const std::vector<compare::Scene> holdouts = load_all(options.holdouts, options.overrides);
  for (const auto* list : {&scenes, &holdouts}) {
    for (const compare::Scene& scene : *list) warn_of_polygons(scene);
  }
  compare::ForceModelFitOptions fit_options;
  if (points_are_given) fit_options.points = scenes.front().force_model.points;
  if (options.target) fit_options.target = *options.target;
  fit_options.solve = options.overrides.solve();
  const compare::ForceModelFit fit = with_progress("calibrate", [&](const auto& progress) {
    fit_options.progress = progress;
    return compare::fit_force_model(scenes, holdouts, fit_options);
  });
  write_calibration(
      options.output, format_is_given,
      Formats{{"text", [&] { return force_model_text(fit, options.target.has_value()); }},
              {"json", [&] { return json_text(force_model_json(fit)); }},
              {"csv", [&] { return force_model_csv(fit); }},
              {"toml", [&] { return force_model_toml(fit); }}});
  // The default target was not requested by the user.
  if (!fit.reached() && options.target) end_with(ExitStatus::outside_tolerance);
}

void prepare(Command& command) {
  const auto options = std::make_shared<CalibrateOptions>();
  CalibrateOptions& o = *options;
  command.bind("SCENE", o.scenes, "--holdout", o.holdouts, "--target", o.target, "--shape",
               o.shapes, "--density", o.density, "--torsional-stiffness", o.torsional_stiffness,
               "--noise", o.noise, "--natural-curvature", o.natural_curvature_terms,
               "--clamp-angles", o.clamp_angles, "--clamp-positions", o.clamp_positions,
               "--clamp-rolls", o.clamp_rolls, "--same-clamps", o.same_clamps, "--clamp-scatter",
               o.clamp_scatter, "--camera-tilt", o.camera_tilt, "--predict", o.predict, "--options",
               o.chosen, "--motion", o.motions);
  command.add("--segments", o.segments)->check(check_segments);
  command.bind(o.plot, o.shape_options, o.overrides, o.output);
  command.runs([options, &app = command.app()] {
    const bool format_is_given = app.count("--format") > 0;
    if (!options->motions.empty()) {
      run_motion(*options, format_is_given);
    } else if (options->shapes.empty() && !options->segments.empty()) {
      run_chains(*options, format_is_given);
    } else if (options->shapes.empty()) {
      run_force_model(*options, app.count("--points") > 0, format_is_given);
    } else {
      run_material(*options, format_is_given);
    }
  });
}

}  // namespace

void add_calibrate_command(CLI::App& app) {
  const auto command = std::make_shared<Command>(app, "calibrate");
  command->prepares([command] { prepare(*command); });
}

}  // namespace dlo::cli
