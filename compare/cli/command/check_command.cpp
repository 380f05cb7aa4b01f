#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/input_file.hpp"
#include "base/output_file.hpp"
#include "command/commands.hpp"
#include "dlo/compare/check.hpp"
#include "dlo/compare/error.hpp"
#include "format/result_output.hpp"
#include "option/command_line.hpp"
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
  ToleranceOptions tolerance;
  bool no_modulus = false;
  bool no_explanation = false;
  ShapeOptions shapes;
  SceneOptions overrides;
  OutputOptions output;
  PlotOptions plot;
  std::string report;
};

/// Writes the page of --report.
void write_page(const CheckOptions& options, compare::PageResult page,
                const std::function<compare::Picture()>& picture) {
  if (options.report.empty()) return;
  page.pictures = page_pictures(picture(), "check", "--report " + options.report);
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
  if (options.output.format == "csv") warn_of_friction(scene);
  write_output(options.output, shape_check_document(page),
               {{"markdown", [&] { return shape_check_markdown(result); }}});
  const auto picture = [&] {
    return compare::check_picture(scene, result.check, result.tolerance.allowed_m);
  };
  options.plot.draw(picture);
  write_page(options,
             {scene.name, result.passes(), shape_check_document({result, page.unit_hint}).text()},
             picture);
  if (options.tolerance.allowed && !result.passes())
    exit_with_status(ExitStatus::outside_tolerance);
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
  write_output(options.output, motion_check_document(result, verdict));
  const auto picture = [&] { return compare::motion_check_picture(result); };
  options.plot.draw(picture);
  write_page(options, {scene.name, result.passes, motion_check_document(result).text()}, picture);
  if (options.tolerance.allowed && !result.passes) exit_with_status(ExitStatus::outside_tolerance);
}

}  // namespace

void add_check_command(CLI::App& app) {
  add_command<CheckOptions>(
      app, "check",
      [](const CheckOptions& options) {
        if (options.shape.empty() && options.motion.empty()) {
          throw compare::InputError(
              "dlo check: nothing to check (allowed: --shape FILE, --motion FILE)");
        }
        options.motion.empty() ? run(options) : run_motion(options);
      },
      [](Command& command, CheckOptions& o) {
        command.bind("SCENE", o.scene, "--shape", o.shape, "--tolerance", o.tolerance.allowed,
                     "--measure", o.tolerance.measure, "--min-seen", o.tolerance.min_observed_share,
                     "--no-modulus", o.no_modulus, "--no-explanation", o.no_explanation, o.shapes,
                     o.overrides, o.output, "--report", o.report, o.plot, "--motion", o.motion,
                     "--dynamic", o.dynamic, o.damping, "--from", o.moving.from, "--frame-rate",
                     o.moving.frame_rate);
      });
}

}  // namespace dlo::cli
