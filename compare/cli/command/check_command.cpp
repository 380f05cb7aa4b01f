#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "base/output_file.hpp"
#include "command/commands.hpp"
#include "dlo/compare/check.hpp"
#include "dlo/compare/error.hpp"
#include "figure/gnuplot.hpp"
#include "format/json.hpp"
#include "format/shape_check_output.hpp"
#include "option/exit_status.hpp"
#include "option/output.hpp"
#include "option/plot.hpp"
#include "option/scene_options.hpp"
#include "option/shape_options.hpp"
#include "option/share.hpp"
#include "option/terminal.hpp"
#include "picture/check_figure.hpp"
#include "report/check_page.hpp"

namespace dlo::cli {
namespace {

struct CheckOptions {
  std::string scene;
  std::string shape;
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

/// The page of a check, whole without a picture where gnuplot is missing.
void write_page(const CheckOptions& options, const compare::CheckResult& result,
                const std::string& text) {
  compare::CheckPageParts parts{.text = text, .version = DLO_VERSION};
  for (const compare::PictureRow& row : picture_of(result).rows) {
    for (const std::vector<compare::Figure>& column : row) {
      for (const compare::Figure& figure : column) {
        parts.figures.push_back({.figure = figure});
        compare::PageFigure& drawn = parts.figures.back();
        try {
          const std::string svg = drawn_picture({{{{figure}}}}, compare::PictureFormat::svg,
                                                "--report " + options.report);
          drawn.svg = compare::inline_svg(svg, figure);
        } catch (const compare::OutputError& error) {
          drawn.failure = error.what();
        }
      }
    }
  }
  compare::write_file(options.report, compare::check_page(result, parts));
}

void plot(const CheckOptions& options, const compare::CheckResult& report) {
  const compare::Scene& scene = report.scene;
  options.plot.draw([&] { return picture_of(report); });
  options.plot.sketch(scene, [&] {
    constexpr int samples = 201;
    const std::vector<double> s = compare::equal_arc_lengths(scene.length, samples);
    return std::vector<compare::SpatialLine>{
        {.points = report.check.rod.sample(s).points},
        {.points = report.check.alignment.shape.points, .joined = false}};
  });
}

void run(const CheckOptions& options) {
  options.plot.require_drawable(options.output);
  const compare::Scene scene = options.overrides.load(options.scene);
  const compare::MeasuredShape shape = options.shapes.load(options.shape);
  compare::CheckRequest request{
      .explaining = options.no_explanation ? compare::Explaining::no : compare::Explaining::yes,
      .shape = {
          .pose = options.shapes.pose(),
          .arc_lengths = options.shapes.arc_lengths(),
          .modulus = options.no_modulus ? compare::ModulusSearch::no : compare::ModulusSearch::yes,
          .solve = options.overrides.solve()}};
  if (!options.tolerance.allowed.empty()) {
    request.tolerance = shape_tolerance("--tolerance", options.tolerance, scene.length);
  }
  const compare::CheckResult result = compare::check(scene, shape, request);
  const CheckPage page{
      result, options.shapes.unit_hint(result.check.polyline_length_m, scene.length),
      verdict_word(result.passes() ? "pass" : "fail", result.passes(), options.output.file)};
  if (options.output.is(Format::csv)) warn_of_friction(scene);
  write_output(options.output, {.text = [&] { return shape_check_text(page); },
                                .json = [&] { return json_text(shape_check_json(result)); },
                                .csv = [&] { return shape_check_csv(result); },
                                .markdown = [&] { return shape_check_markdown(result); }});
  plot(options, result);
  if (!options.report.empty()) {
    write_page(options, result, shape_check_text({result, page.unit_hint}));
  }
  const bool was_asked = !options.tolerance.allowed.empty();
  if (was_asked && !result.passes()) end_with(ExitStatus::outside_tolerance);
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
  command
      ->add_option("--shape", options->shape,
                   "CSV, JSON, VTK polyline or NumPy array (FILE.npz:KEY)")
      ->type_name("FILE")
      ->required();
  command->add_option(
      "--tolerance", options->tolerance.allowed,
      "the deviation allowed, 1% or 0.01 of the length or \"2 mm\"; exit status 1 beyond it. "
      "Without it the verdict is that of 1%, and the exit status 0");
  command
      ->add_option("--measure", options->tolerance.measure,
                   "the deviation that is held against the tolerance")
      ->check(CLI::IsMember({"rms", "max"}))
      ->capture_default_str();
  command
      ->add_option(
          "--min-seen", options->tolerance.min_seen,
          "the file is a part of the rod, and only that part is judged; it fails if less than "
          "this share of the rod is seen, such as 10%. Without it the whole rod is judged, and "
          "half of it is needed")
      ->transform(share_of_length());
  command->add_flag("--no-modulus", options->no_modulus, "leave E*/E out");
  command->add_flag("--no-explanation", options->no_explanation,
                    "do not look for causes where a shape fails");
  options->shapes.add_to(*command, ChordLengths::offered);
  options->overrides.add_solvers_to(*command);
  std::vector<std::string> formats = compare::names<Format>();
  formats.emplace_back("markdown");
  add_output_options(*command, options->output, formats);
  command
      ->add_option("--report", options->report,
                   "write a page of one screen, FILE.html: verdict, picture, cause, numbers")
      ->type_name("FILE");
  options->plot.add_to(*command, "the points on the rod, and their distances along it",
                       Sketches::offered);
  command->footer(
      "Example, with dlo in place of your simulator:\n"
      "  dlo solve data/scenes/cable.toml --model force --points 32 --format csv -o mine.csv\n"
      "  dlo check data/scenes/cable.toml --shape mine.csv --tolerance 1% --plot check.svg");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
