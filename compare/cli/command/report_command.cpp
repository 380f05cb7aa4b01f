#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/display.hpp"
#include "base/quote.hpp"
#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "option/exit_status.hpp"
#include "option/output.hpp"
#include "option/share.hpp"
#include "option/terminal.hpp"
#include "report/folder.hpp"
#include "report/report.hpp"
#include "report/verdict.hpp"

namespace dlo::cli {
namespace {

struct ReportOptions {
  std::vector<std::string> scenes;
  std::string folder;
  double tolerance = 0.01;
  int threads = 0;
  bool quick = false;
};

std::string command_line(const ReportOptions& options) {
  std::string line = "dlo report";
  for (const std::string& scene : options.scenes) line += " " + compare::shell_word(scene);
  if (options.quick) line += " --quick";
  if (options.tolerance != ReportOptions{}.tolerance)
    append(line, " --tolerance {}", options.tolerance);
  if (options.threads != 0) append(line, " --threads {}", options.threads);
  return line + " -o " + compare::shell_word(options.folder);
}

compare::ReportOptions report_options(const ReportOptions& options) {
  compare::ReportOptions result =
      options.quick ? compare::quick_report_options() : compare::ReportOptions{};
  result.tolerance = options.tolerance;
  result.threads = options.threads;
  return result;
}

void run(const ReportOptions& options) {
  compare::refuse_scenes_inside(options.folder, options.scenes);
  compare::check_report_folder(options.folder);
  const std::vector<compare::SceneFile> files = compare::load_scene_files(options.scenes);
  const compare::Report report = [&] {
    ProgressBar bar("report");
    return compare::make_report(files, report_options(options),
                                [&](const std::string& what) { bar.stage(what); });
  }();
  const compare::WrittenReport written = compare::write_report(
      report, {.version = DLO_VERSION, .command = command_line(options)}, options.folder);
  std::string out;
  for (const std::string& sentence : compare::report_verdict(report))
    append(out, "{}\n", compare::display(sentence));
  append(out, "\n{}: {} scenes, {} figures, {:.3g} s\n", compare::display(written.page),
         report.scenes.size(), written.figures, report.seconds);
  write_output({}, out);
  if (written.figures_missing > 0) {
    say("{} figures are missing: {}; install gnuplot-nox", written.figures_missing,
        written.why_missing);
  }
  if (!report.failures.empty()) end_with(ExitStatus::not_converged);
}

}  // namespace

void add_report(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("report", "a page for people: verdict, shapes, errors, speed, stability");
  const auto options = std::make_shared<ReportOptions>();
  command->add_option("SCENE", options->scenes,
                      "scene files, or folders with *.toml; none: the paper's three scenes and two "
                      "that tell more");
  command
      ->add_option("-o,--output", options->folder,
                   "folder to make: index.html, and its numbers, scripts and scenes beside it. A "
                   "report in it is replaced, anything else is refused")
      ->type_name("DIR")
      ->required();
  command
      ->add_option("--tolerance", options->tolerance,
                   "RMS up to which a shape counts as right, share of the length such as 1%")
      ->transform(share_of_length())
      ->capture_default_str();
  command->add_flag("--quick", options->quick,
                    "a benchmark of 1 s, a coarse map, no hard cases; the page says so");
  command->add_option("--threads", options->threads, "at most; 0: as many as the machine has")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->footer(
      "Exit status 3: something did not converge; the page has the rest, and says what.\n"
      "Example:\n  dlo report data/scenes/cable.toml --quick -o report");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
