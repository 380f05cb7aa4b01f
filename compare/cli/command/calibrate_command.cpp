#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "calibration/calibrated_toml.hpp"
#include "calibration/chain_springs_output.hpp"
#include "command/commands.hpp"
#include "dlo/compare/alignment.hpp"
#include "dlo/compare/error.hpp"
#include "fit/chain_springs.hpp"
#include "format/force_model_fit_output.hpp"
#include "format/json.hpp"
#include "format/material_fit_output.hpp"
#include "option/exit_status.hpp"
#include "option/output.hpp"
#include "option/plot.hpp"
#include "option/scene_options.hpp"
#include "option/shape_options.hpp"
#include "option/share.hpp"
#include "option/terminal.hpp"
#include "picture/fit_figure.hpp"
#include "recording/recorded_frames.hpp"
#include "series/motion_fit_output.hpp"
#include "toml/quantity.hpp"
#include "trajectory/read_markers.hpp"

namespace dlo::cli {
namespace {

struct CalibrateOptions {
  std::vector<std::string> scenes;
  std::vector<std::string> shapes;
  bool density = false;
  bool torsional_stiffness = false;
  std::string noise;
  int natural_curvature_terms = 0;
  std::string motion;
  std::string segments;  // a number, or a file
  std::string clamp_angles;
  std::string clamp_positions;
  std::string clamp_rolls;
  bool same_clamps = false;
  std::string clamp_scatter;
  std::string camera_tilt;
  bool predict = false;
  std::string chosen;  // empty: as calibrate() has it
  std::vector<std::string> holdouts;
  std::optional<double> target;
  ShapeOptions shape_options;
  SceneOptions overrides;
  OutputOptions output;
  PlotOptions plot;
};

/// A quantity > 0 that an option has, if it is given.
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

/// What --segments says of a chain.
struct ChainLayout {
  int segments = 0;                     // equal ones
  std::vector<double> segment_lengths;  // else [m]
};

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("+-0123456789") == std::string::npos;
}

/// "" if it is a file, or a number in range.
std::string check_segments(const std::string& text) {
  if (!is_number(text)) return "";
  std::string copy = text;
  return CLI::Range(4, 200)(copy);
}

ChainLayout chain_layout(const CalibrateOptions& options) {
  if (options.segments.empty()) return {};
  if (is_number(options.segments)) return {.segments = std::stoi(options.segments)};
  return {.segment_lengths =
              compare::segment_lengths(options.shape_options.load(options.segments).points)};
}

std::vector<compare::Scene> load_all(const std::vector<std::string>& paths,
                                     const SceneOptions& overrides) {
  std::vector<compare::Scene> scenes;
  scenes.reserve(paths.size());
  for (const std::string& path : paths) scenes.push_back(overrides.load(path));
  return scenes;
}

/// Without --format a .toml file gets what can be read again, and the text is shown as well.
void write_calibration(OutputOptions output, bool format_is_given, const Formats& formats) {
  const bool to_toml_file = !format_is_given && output.file.ends_with(".toml");
  if (!format_is_given) {
    const std::string format = format_of_file(output.file, {"json", "csv", "toml"});
    if (!format.empty()) output.format = format;
  }
  write_output(output, formats);
  if (to_toml_file) write_output({}, formats.text());
}

compare::MaterialFitOptions material_options(const CalibrateOptions& options) {
  constexpr int profile_points = 41;
  using compare::Dimension;
  const ChainLayout chain = chain_layout(options);
  return {
      .pose = options.shape_options.pose(),
      .arc_lengths = options.shape_options.arc_lengths(),
      .density = options.density,
      .torsional_stiffness = options.torsional_stiffness,
      .natural_curvature_terms = options.natural_curvature_terms,
      .direction_tolerance =
          quantity_of("--clamp-angles", options.clamp_angles, Dimension::angle).value_or(0),
      .position_tolerance =
          quantity_of("--clamp-positions", options.clamp_positions, Dimension::length).value_or(0),
      .roll_tolerance =
          quantity_of("--clamp-rolls", options.clamp_rolls, Dimension::angle).value_or(0),
      .shared_clamps = options.same_clamps,
      .direction_scatter =
          quantity_of("--clamp-scatter", options.clamp_scatter, Dimension::angle).value_or(0),
      .camera_tilt =
          quantity_of("--camera-tilt", options.camera_tilt, Dimension::angle).value_or(0),
      .predict = options.predict,
      .choose_options =
          options.chosen.empty() ? std::nullopt : std::optional(options.chosen == "auto"),
      .chain_segments = chain.segments,
      .chain_segment_lengths = chain.segment_lengths,
      .profile_points = options.plot.draws() ? profile_points : 0,
      .noise = quantity_of("--noise", options.noise, Dimension::length),
      .solve = options.overrides.solve()};
}

/// @param scenes  of all shapes; @param first  of the first shape, if each has its own
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
  options.plot.require_drawable(options.output);
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
    return compare::calibrate(std::move(scenes), shapes, material_options(options), held_out);
  });
  write_calibration(options.output, format_is_given,
                    {.text = [&] { return material_text(found); },
                     .json = [&] { return json_text(material_json(found)); },
                     .csv = [&] { return material_csv(found); },
                     .toml = [&] { return material_toml(found); }});
  options.plot.draw([&] { return compare::fit_picture(found.scenes, found.fit); });
}

/// Springs for chains of the scenes' own rods, nothing measured.
void run_chains(const CalibrateOptions& options, bool format_is_given) {
  const auto refuse = [](const char* format) -> std::string {
    throw compare::InputError(fmt::format(
        "--segments without --shape: has no format {} (allowed: text, json, or a shape)", format));
  };
  const ChainLayout layout = chain_layout(options);
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
        "--segments: no scene's rod is like a plain chain of hinges (allowed: one section, "
        "intrinsically straight, not twisted, touching nothing)");
  }
  write_calibration(options.output, format_is_given,
                    {.text = [&] { return chains_text(chains); },
                     .json =
                         [&] {
                           return json_text(Json{{"chains", chains_json(chains)}});
                         },
                     .csv = [&] { return refuse("csv"); },
                     .toml = [&] { return refuse("toml"); }});
}

void run_motion(const CalibrateOptions& options, bool format_is_given) {
  if (options.scenes.size() != 1) {
    throw compare::InputError("--motion: of one scene (allowed: one SCENE)");
  }
  const compare::Scene scene = options.overrides.load(options.scenes.front());
  const compare::MarkerMotion recorded = compare::load_recording(options.motion, scene.length);
  const compare::MotionFit found = with_progress("calibrate", [&](const auto& /*unknown*/) {
    return compare::fit_motion(scene, recorded, {.solve = options.overrides.solve()});
  });
  const auto refuse = [](const char* format) -> std::string {
    throw compare::InputError(
        fmt::format("--motion: has no format {} (allowed: text, json)", format));
  };
  write_calibration(options.output, format_is_given,
                    {.text = [&] { return motion_fit_text(found, scene); },
                     .json = [&] { return json_text(motion_fit_json(found, scene)); },
                     .csv = [&] { return refuse("csv"); },
                     .toml = [&] { return refuse("toml"); }});
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
  write_calibration(options.output, format_is_given,
                    {.text = [&] { return force_model_text(fit, options.target.has_value()); },
                     .json = [&] { return json_text(force_model_json(fit)); },
                     .csv = [&] { return force_model_csv(fit); },
                     .toml = [&] { return force_model_toml(fit); }});
  // Nobody asked for the default.
  if (!fit.reached() && options.target) end_with(ExitStatus::outside_tolerance);
}

}  // namespace

void add_calibrate(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "calibrate",
      "parameters of the force model from physics, or Young's modulus from measured shapes or a "
      "recorded motion");
  const auto options = std::make_shared<CalibrateOptions>();
  command->add_option("SCENE", options->scenes, "scene files (TOML)")->required();
  const std::string parameters = "Parameters of the force model";
  CLI::Option* holdout =
      command
          ->add_option("--holdout", options->holdouts,
                       "hold-out scenes, or with --shape shapes: judged, not fitted. Their scenes "
                       "stand after those of the others, if each shape has its own")
          ->type_name("FILE ...")
          ->group(parameters);
  CLI::Option* target =
      command
          ->add_option("--target", options->target,
                       "RMS deviation wanted, share of the length such as 0.1%; law hooke takes N "
                       "from it unless --points is given. Exit status 1 if it is missed; without "
                       "--target the default is 0.1%, and status is 0")
          ->transform(share_of_length())
          ->group(parameters);
  const std::string measured = "Young's modulus from measured shapes";
  CLI::Option* shape =
      command->add_option("--shape", options->shapes, "one per scene, or several of one scene")
          ->type_name("FILE ...")
          ->excludes(target)
          ->group(measured);
  command->add_flag("--density", options->density, "fit the density as well")
      ->needs(shape)
      ->group(measured);
  command
      ->add_flag("--torsional-stiffness", options->torsional_stiffness,
                 "fit GJ as well, from shapes whose clamps twist the wire")
      ->needs(shape)
      ->group(measured);
  command
      ->add_option("--noise", options->noise,
                   "standard deviation of one coordinate such as \"0.5 mm\"; default: estimated")
      ->needs(shape)
      ->group(measured);
  command
      ->add_option("--natural-curvature", options->natural_curvature_terms,
                   "fit this many terms of the wire's natural curvature as well (1: the same all "
                   "along; Legendre's polynomials)")
      ->check(CLI::Range(0, 24))
      ->needs(shape)
      ->group(measured);
  command
      ->add_option("--clamp-angles", options->clamp_angles,
                   "how well the clamps' directions are known, as standard deviation such as \"5 "
                   "deg\"; each shape's own are fitted as well")
      ->needs(shape)
      ->group(measured);
  command
      ->add_option("--clamp-positions", options->clamp_positions,
                   "the same of the grippers' positions, such as \"2 mm\"")
      ->needs(shape)
      ->group(measured);
  command
      ->add_option("--clamp-rolls", options->clamp_rolls,
                   "the same of how they hold the wire about its tangent, in space: \"180 deg\" if "
                   "nothing is known; each shape has its own, with --same-clamps too")
      ->needs(shape)
      ->group(measured);
  command
      ->add_flag(
          "--same-clamps", options->same_clamps,
          "the clamps are misaligned alike in all shapes, as in one fixture: what is found of "
          "them is shared, and -o writes it; with --clamp-angles or --clamp-positions")
      ->needs(shape)
      ->group(measured);
  command
      ->add_option("--clamp-scatter", options->clamp_scatter,
                   "with --same-clamps: how far each shape's own directions are from the shared "
                   "ones, such as \"5 deg\"; they are fitted as well")
      ->needs(shape)
      ->group(measured);
  command
      ->add_option("--camera-tilt", options->camera_tilt,
                   "how level the camera is, such as \"2 deg\" (standard deviation); one tilt of "
                   "all shapes is fitted as well, and -o writes it")
      ->needs(shape)
      ->group(measured);
  command
      ->add_flag("--predict", options->predict,
                 "leave out each shape in turn and predict it by the fit to the others: says which "
                 "options predict best (three shapes or more)")
      ->needs(shape)
      ->group(measured);
  command
      ->add_option(
          "--options", options->chosen,
          "given, or auto: where residuals are systematic, the terms of natural curvature, "
          "and clamps as said, misaligned alike or each on its own, that predict "
          "shapes "
          "best that are left out; default: auto of three shapes or more, without the "
          "six above")
      ->check(CLI::IsMember({"given", "auto"}))
      ->needs(shape)
      ->group(measured);
  command
      ->add_option("--motion", options->motion,
                   "recorded motion of the rod, a CSV file of markers, time,s,x,y,z in s and m, or "
                   "frames as check takes them: stiffness over mass and damping")
      ->type_name("FILE|DIR")
      ->excludes(shape)
      ->excludes(holdout)
      ->excludes(target)
      ->group("Stiffness and damping from a recorded motion");
  command
      ->add_option(
          "--segments", options->segments,
          "of your simulator's chain, 4 to 200, or a file of its points where they are unequal: "
          "the "
          "stiffness of its joints with which it comes nearest to the rod, for three ways to hold "
          "it; with --shape: to the fitted one")
      ->type_name("N|FILE")
      ->check(check_segments)
      ->excludes(target)
      ->excludes(holdout)
      ->group(measured);
  options->plot
      .add_to(*command, "points on the fitted rod, and E's profile likelihood,", Sketches::none)
      ->needs(shape)
      ->group(measured);
  options->shape_options.add_to(*command, ChordLengths::not_exact_enough);
  options->overrides.add_to(*command);
  std::vector<std::string> formats = compare::names<Format>();
  formats.emplace_back("toml");
  command->add_option("--format", options->output.format, "text, json, csv or toml")
      ->check(CLI::IsMember(formats))
      ->capture_default_str();
  command
      ->add_option("-o,--output", options->output.file,
                   "write to FILE instead of standard output; .json and .csv are formats, a .toml "
                   "gets what --parameters (with "
                   "--shape: --materials) reads, and the text still goes to standard output")
      ->type_name("FILE");
  command->footer(
      "Examples:\n  dlo calibrate data/scenes/spring_steel_135.toml --law hooke --bookkeeping "
      "consistent --target 0.1% --holdout data/scenes/spring_steel_215.toml -o params.toml\n  dlo "
      "solve data/scenes/spring_steel_135.toml --model exact --samples 12 --format csv -o "
      "seen.csv\n  dlo calibrate data/scenes/spring_steel_135.toml --shape seen.csv --plot "
      "fit.svg");
  command->callback([options, command] {
    const bool format_is_given = command->count("--format") > 0;
    if (!options->motion.empty()) {
      run_motion(*options, format_is_given);
    } else if (options->shapes.empty() && !options->segments.empty()) {
      run_chains(*options, format_is_given);
    } else if (options->shapes.empty()) {
      run_force_model(*options, command->count("--points") > 0, format_is_given);
    } else {
      run_material(*options, format_is_given);
    }
  });
}

}  // namespace dlo::cli
