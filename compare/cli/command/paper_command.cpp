#include <memory>

#include "command/commands.hpp"
#include "format/json.hpp"
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
  write_output(options, {.text = [&] { return paper_text(report) + moving_text(moving); },
                         .json =
                             [&] {
                               Json document = paper_json(report);
                               document["moving"] = moving_json(moving);
                               return json_text(document);
                             },
                         .csv = [&] { return paper_csv(report) + moving_csv(moving); }});
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
