#include <memory>

#include "command/commands.hpp"
#include "option/command_line.hpp"
#include "option/output.hpp"
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
  write_output(options, paper, {{"csv", [&] { return paper_csv(paper); }}});
}

}  // namespace

void add_paper_command(CLI::App& app) {
  add_command<OutputOptions>(app, "paper", run,
                             [](Command& command, OutputOptions& o) { command.bind(o); });
}

}  // namespace dlo::cli
