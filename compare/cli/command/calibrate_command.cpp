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
  compare::MaterialFitOptions fit;
  std::vector<std::string> motions;
  std::string segments;  // a number, or the name of a file
  std::string chosen;    // empty: the default of calibrate()
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
  const ChainLayout chain = chain_layout();
  compare::MaterialFitOptions options = fit;
  options.pose = shape_options.pose();
  options.arc_lengths = shape_options.arc_lengths();
  if (!chosen.empty()) options.choose_options = chosen == "auto";
  options.chain_segments = chain.segments;
  options.chain_segment_lengths = chain.segment_lengths;
  options.profile_points = plot.draws() ? profile_points : 0;
  options.solve = overrides.solve();
  return options;
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
void write_calibration(const OutputOptions& output, const Formats& formats) {
  const bool to_toml_file = !output.format_is_given && output.format == "toml";
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

void run_material(const CalibrateOptions& options) {
  options.plot.require_drawable();
  std::vector<compare::Scene> scenes = load_all(options.scenes, options.overrides);
  const std::vector<compare::MeasuredShape> shapes =
      load_shapes(options.shapes, options, scenes, 0);
  const std::vector<compare::MeasuredShape> held_out =
      load_shapes(options.holdouts, options, scenes, shapes.size());
  for (const compare::Scene& scene : scenes) {
    print_assumptions(scene);
    warn_of_friction(scene);
  }
  const compare::Calibration found = with_progress("calibrate", [&](const auto& /*unknown*/) {
    return compare::calibrate(std::move(scenes), shapes, options.material_options(), held_out);
  });
  const compare::Document document = material_document(found);
  write_calibration(options.output,
                    formats_of(document, {{"toml", [&] { return material_toml(found); }}}));
  options.plot.draw([&] { return compare::fit_picture(found.scenes, found.fit); });
}

/// Calibrates the springs of chains for the scenes' own rods, without measured shapes.
void run_chains(const CalibrateOptions& options) {
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
  write_calibration(options.output, formats_of(document));
}

void run_motion(const CalibrateOptions& options) {
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
  write_calibration(options.output,
                    formats_of(document, {{"toml", [&] { return motion_toml(found, scene); }}}));
  if (!found.not_identified.empty()) exit_with_status(ExitStatus::not_converged);
}

void run_force_model(const CalibrateOptions& options) {
  const std::vector<compare::Scene> scenes = load_all(options.scenes, options.overrides);
  const std::vector<compare::Scene> holdouts = load_all(options.holdouts, options.overrides);
  for (const auto* list : {&scenes, &holdouts}) {
    for (const compare::Scene& scene : *list) warn_of_neglected_by_polygon(scene);
  }
  compare::ForceModelFitOptions fit_options;
  if (options.overrides.gives_points()) fit_options.points = scenes.front().force_model.points;
  if (options.target) fit_options.target = *options.target;
  fit_options.solve = options.overrides.solve();
  const compare::ForceModelFit fit = with_progress("calibrate", [&](const auto& progress) {
    fit_options.progress = progress;
    return compare::fit_force_model(scenes, holdouts, fit_options);
  });
  const compare::Document document = force_model_document(fit, options.target.has_value());
  write_calibration(options.output,
                    formats_of(document, {{"csv", [&] { return force_model_csv(fit); }},
                                          {"toml", [&] { return force_model_toml(fit); }}}));
  // The default target was not requested by the user.
  if (!fit.reaches_target() && options.target) exit_with_status(ExitStatus::outside_tolerance);
}

void run(const CalibrateOptions& options) {
  if (!options.motions.empty()) {
    run_motion(options);
  } else if (options.shapes.empty() && !options.segments.empty()) {
    run_chains(options);
  } else if (options.shapes.empty()) {
    run_force_model(options);
  } else {
    run_material(options);
  }
}

}  // namespace

void add_calibrate_command(CLI::App& app) {
  add_command<CalibrateOptions>(app, "calibrate", run, [](Command& command, CalibrateOptions& o) {
    command.bind("SCENE", o.scenes, "--holdout", o.holdouts, "--target", o.target, "--shape",
                 o.shapes, "--density", o.fit.density, "--torsional-stiffness",
                 o.fit.torsional_stiffness, "--noise", o.fit.noise, "--natural-curvature",
                 o.fit.natural_curvature_terms, "--clamp-angles", o.fit.direction_tolerance,
                 "--clamp-positions", o.fit.position_tolerance, "--clamp-rolls",
                 o.fit.roll_tolerance, "--same-clamps", o.fit.shared_clamps, "--clamp-scatter",
                 o.fit.direction_scatter, "--camera-tilt", o.fit.camera_tilt, "--predict",
                 o.fit.predict, "--options", o.chosen, "--motion", o.motions);
    command.add("--segments", o.segments)->check(check_segments);
    command.bind(o.plot, o.shape_options, o.overrides, o.output);
  });
}

}  // namespace dlo::cli
