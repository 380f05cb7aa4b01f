#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "base/input_file.hpp"
#include "calibration/calibrate_options.hpp"
#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "fit/chain_springs.hpp"
#include "format/calibration_output.hpp"
#include "format/json.hpp"
#include "format/result_output.hpp"
#include "option/exit_status.hpp"
#include "option/share.hpp"
#include "option/terminal.hpp"
#include "picture/figures.hpp"
#include "series/series_output.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::cli {
namespace {

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
  if (to_toml_file) write_output({}, formats.text());
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
                    {.text = [&] { return material_text(found); },
                     .json = [&] { return json_text(material_json(found)); },
                     .csv = [&] { return material_csv(found); },
                     .toml = [&] { return material_toml(found); }});
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
        "--segments: no scene's rod is like a plain chain of hinges (allowed: one section, "
        "intrinsically straight, not twisted, touching nothing)");
  }
  const compare::Document document{
      .json = {{"chains", chains_json(chains)}},
      .columns = {
          {"chains/#/joints", "at_m,joint_stiffness_Nm_per_rad,binormal_stiffness_Nm_per_rad"}}};
  write_calibration(
      options.output, format_is_given,
      {.text = [&] { return document.text(); }, .json = [&] { return json_text(document.json); }});
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
                    {.text = [&] { return document.text(); },
                     .json = [&] { return json_text(document.json); },
                     .toml = [&] { return motion_toml(found, scene); }});
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
  write_calibration(options.output, format_is_given,
                    {.text = [&] { return force_model_text(fit, options.target.has_value()); },
                     .json = [&] { return json_text(force_model_json(fit)); },
                     .csv = [&] { return force_model_csv(fit); },
                     .toml = [&] { return force_model_toml(fit); }});
  // The default target was not requested by the user.
  if (!fit.reached() && options.target) end_with(ExitStatus::outside_tolerance);
}

}  // namespace

void add_calibrate(CLI::App& app) {
  CLI::App* command = app.add_subcommand("calibrate",
                                         "parameters of the force model from physics, or Young's "
                                         "modulus from measured shapes or a recorded motion");
  const auto options = std::make_shared<CalibrateOptions>();
  options->add_to(*command);
  command->footer(
      "Examples:\n  dlo calibrate data/scenes/spring_steel_135.toml --law hooke --bookkeeping "
      "consistent --target 0.1% --holdout data/scenes/spring_steel_215.toml -o params.toml\n  dlo "
      "solve data/scenes/spring_steel_135.toml --model exact --samples 12 --format csv -o "
      "seen.csv\n  dlo calibrate data/scenes/spring_steel_135.toml --shape seen.csv --plot "
      "fit.svg");
  command->callback([options, command] {
    const bool format_is_given = command->count("--format") > 0;
    if (!options->motions.empty()) {
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
