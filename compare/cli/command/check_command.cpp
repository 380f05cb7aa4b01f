#include <fmt/format.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/input_file.hpp"
#include "base/output_file.hpp"
#include "command/commands.hpp"
#include "dlo/compare/check.hpp"
#include "dlo/compare/error.hpp"
#include "format/json.hpp"
#include "format/result_output.hpp"
#include "option/exit_status.hpp"
#include "option/option_values.hpp"
#include "option/output.hpp"
#include "option/plot.hpp"
#include "option/scene_options.hpp"
#include "option/shape_options.hpp"
#include "option/share.hpp"
#include "option/terminal.hpp"
#include "picture/figures.hpp"
#include "recording/motion_check.hpp"
#include "report/page.hpp"
#include "series/series_output.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::cli {
namespace {

struct CheckOptions {
  std::string scene;
  std::string shape;
  std::string motion;
  bool dynamic = false;
  compare::MotionCheckRequest moving;
  DampingOptions damping;
  ToleranceWords tolerance;
  bool no_modulus = false;
  bool no_explanation = false;
  ShapeOptions shapes;
  SceneOptions overrides;
  OutputOptions output;
  PlotOptions plot;
  std::string report;
};

compare::Picture picture_of(const compare::CheckResult& report) {
  return compare::check_picture(report.scene, report.check, report.tolerance.allowed_m);
}

/// Writes the page of --report.
template <typename Result>
void write_page(const CheckOptions& options, const Result& result,
                const std::function<compare::Picture()>& picture, const std::string& text) {
  if (options.report.empty()) return;
  compare::PageResult page = compare::page_result(result);
  page.pictures = page_pictures(picture(), "check", "--report " + options.report);
  page.details = text;
  compare::write_file(options.report, compare::page_html({page}, "dlo check", DLO_VERSION));
}

void run(const CheckOptions& options) {
  options.plot.require_drawable();
  const compare::Scene scene = options.overrides.load(options.scene);
  const compare::MeasuredShape shape = options.shapes.load(options.shape);
  compare::CheckRequest request{
      .explaining = options.no_explanation ? compare::Explaining::no : compare::Explaining::yes,
      .shape = {
          .pose = options.shapes.pose(),
          .arc_lengths = options.shapes.arc_lengths(),
          .modulus = options.no_modulus ? compare::ModulusSearch::no : compare::ModulusSearch::yes,
          .solve = options.overrides.solve()}};
  request.tolerance = shape_tolerance("--tolerance", options.tolerance, scene.length);
  const compare::CheckResult result = compare::check(scene, shape, request);
  const CheckPage page{
      result,
      options.shapes.unit_hint(result.check.polyline_length_m, result.check.stretched_length_m),
      verdict_word(compare::to_string(result.judgement.verdict), result.passes(),
                   options.output.file)};
  if (options.output.is(Format::csv)) warn_of_friction(scene);
  write_output(options.output, {.text = [&] { return shape_check_text(page); },
                                .json = [&] { return json_text(shape_check_json(result)); },
                                .csv = [&] { return shape_check_csv(result); },
                                .markdown = [&] { return shape_check_markdown(result); }});
  const auto picture = [&] { return picture_of(result); };
  options.plot.draw(picture);
  write_page(options, result, picture, shape_check_text({result, page.unit_hint}));
  if (options.tolerance.allowed && !result.passes()) end_with(ExitStatus::outside_tolerance);
}

void run_motion(const CheckOptions& options) {
  options.plot.require_drawable();
  const compare::Scene scene = options.overrides.load(options.scene);
  warn_of_friction(scene);
  compare::MotionCheckRequest request = options.moving;
  request.damping = options.damping.of(options.overrides.calibrated());
  if (options.dynamic) request.model = compare::MotionModel::with_inertia;
  if (options.no_explanation) request.explaining = compare::Explaining::no;
  request.tolerance = shape_tolerance("--tolerance", options.tolerance, scene.length);
  request.solve = options.overrides.solve();
  const compare::MarkerMotion recorded =
      compare::parse_markers(compare::read_file(options.motion), options.motion);
  const compare::MotionCheck result = with_progress("check", [&](const auto& progress) {
    return compare::check_motion(scene, recorded, request, progress);
  });
  const std::string verdict =
      verdict_word(result.passes ? "pass" : "fail", result.passes, options.output.file);
  const compare::Document document = motion_check_document(result);
  write_output(options.output, {.text = [&] { return motion_check_text(result, verdict); },
                                .json = [&] { return json_text(document.json); },
                                .csv = [&] { return document.csv(); }});
  const auto picture = [&] { return compare::motion_check_picture(result); };
  options.plot.draw(picture);
  write_page(options, result, picture, motion_check_text(result));
  if (options.tolerance.allowed && !result.passes) end_with(ExitStatus::outside_tolerance);
}

/// Adds the options for a recorded motion instead of a shape.
void add_motion_to(CLI::App& command, CheckOptions& options) {
  const OptionGroup group(command, "Recorded motion");
  CLI::Option* motion =
      add_file(command, "--motion", options.motion,
               "instead of a shape: a CSV file of markers on the rod, time,s,x,y,z in s and m");
  command
      .add_flag("--dynamic", options.dynamic,
                "with --motion: hold it against the rod with its inertia, not at rest")
      ->needs(motion);
  options.damping.add_to(command, motion);
  constexpr double most = 1e12;  // [s], the limit of times in files
  command
      .add_option(
          "--from", options.moving.from,
          "with --motion: when the rod's motion begins [s], default the recording's first time")
      ->check(number_between(-most, most))
      ->needs(motion);
  command
      .add_option("--frame-rate", options.moving.frame_rate,
                  "with --motion: frames of the rod a second, between which it is interpolated; "
                  "default as the recording and the scene need it")
      ->check(number_between(1e-6, 1e9))
      ->type_name("HZ")
      ->needs(motion);
  for (const char* name :
       {"--shape", "--min-seen", "--no-modulus", "--unit", "--register", "--arc-lengths"}) {
    motion->excludes(command.get_option(name));
  }
}

}  // namespace

void add_check(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "check", "how far a shape of your own simulator or camera is from the energy model");
  const auto options = std::make_shared<CheckOptions>();
  command
      ->add_option("SCENE", options->scene,
                   "scene file (TOML), or a MuJoCo model of a cable (MJCF)")
      ->required();
  add_file(*command, "--shape", options->shape,
           "CSV, JSON, legacy VTK polyline or NumPy array (FILE.npy)");
  command->add_option("--tolerance", options->tolerance.allowed,
                      "the deviation allowed: 1% or 0.01 of the length, \"5% of deflection\" (of a "
                      "stiff rod, by its weight and loads) or \"2 mm\"; exit status 1 beyond it. "
                      "Without it the verdict is that of 1%, and the exit status 0");
  add_checked(*command, "--measure", options->tolerance.measure, CLI::IsMember({"rms", "max"}),
              "the deviation that is held against the tolerance");
  command
      ->add_option("--min-seen", options->tolerance.min_seen,
                   "the file is a part of the rod, and only that part is judged; it fails if less "
                   "than this share of the rod is seen, such as 10%. Without it the whole rod is "
                   "judged, and half of it is needed")
      ->transform(share_of_length());
  command->add_flag("--no-modulus", options->no_modulus, "leave E*/E out");
  command->add_flag("--no-explanation", options->no_explanation,
                    "do not look for causes where a shape fails");
  options->shapes.add_to(*command, ChordLengths::offered);
  options->overrides.add_solvers_to(*command, Steps::none);
  std::vector<std::string> formats = compare::names<Format>();
  formats.emplace_back("markdown");
  add_output_options(*command, options->output, formats);
  add_file(*command, "--report", options->report,
           "write a page of one screen, FILE.html: verdict, picture, cause, numbers");
  options->plot.add_to(*command,
                       "the points on the rod, and their distances along it; of a motion the worst "
                       "frame, and the distances against time");
  add_motion_to(*command, *options);
  command->footer(
      "Example, with dlo in place of your simulator:\n"
      "  dlo solve data/scenes/cable.toml --model force --points 32 --format csv -o mine.csv\n"
      "  dlo check data/scenes/cable.toml --shape mine.csv --tolerance 1% --plot check.svg");
  command->callback([options] {
    if (options->shape.empty() && options->motion.empty()) {
      throw compare::InputError(
          "dlo check: nothing to check (allowed: --shape FILE, --motion FILE)");
    }
    options->motion.empty() ? run(*options) : run_motion(*options);
  });
}

}  // namespace dlo::cli
