#include <memory>

#include "command/commands.hpp"
#include "option/output.hpp"
#include "option/scene_options.hpp"
#include "option/terminal.hpp"
#include "paper/paper.hpp"
#include "series/study_output.hpp"

namespace dlo::cli {
namespace {

void run(const OutputOptions& options) {
  compare::PaperReport report;
  compare::MovingReport moving;
  {
    ProgressBar bar("paper");
    report = compare::paper_report([&](const std::string& what) { bar.stage(what); });
    bar.stage("moving grippers, Tables 2 to 4");
    moving = compare::moving_report();
  }
  const compare::Document paper = paper_document(report, moving);
  write_output(options, paper, [&] { return paper_csv(paper); });
}

}  // namespace

void add_paper(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("paper", "the paper's own comparison: its tables, its rod, its E/3");
  const auto options = std::make_shared<OutputOptions>();
  add_output_options(*command, *options);
  command->footer("Example:\n  dlo paper --format json -o paper.json");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
