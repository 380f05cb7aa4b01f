#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <stdexcept>

#include "commands.hpp"
#include "dlo/compare/error.hpp"

namespace {

// 1, outside a tolerance, is a CLI::RuntimeError of a command that has printed its result.
enum ExitStatus : int { good = 0, bad_input = 2, not_converged = 3 };

int report(ExitStatus status, const std::exception& error) {
  std::string line = error.what();
  for (char& c : line) {
    if (c == '\n') c = ' ';
  }
  fmt::print(stderr, "dlo: {}\n", line);
  return status;
}

int run(int argc, char** argv) {
  CLI::App app(
      "How far is a fast rod model from physics? Shapes of deformable linear objects by the "
      "paper's force model and by the rod's energy, and how far they are apart.",
      "dlo");
  app.require_subcommand(1);
  app.set_version_flag("--version", "dlo " DLO_VERSION);
  dlo::cli::add_solve(app);
  dlo::cli::add_compare(app);
  dlo::cli::add_check(app);
  dlo::cli::add_calibrate(app);
  dlo::cli::add_paper(app);
  dlo::cli::add_bench(app);
  dlo::cli::add_stability(app);
  dlo::cli::add_regress(app);
  dlo::cli::add_report(app);
  dlo::cli::add_sweep(app);
  app.footer(
      "Exit status: 0 good, 1 outside a tolerance, 2 bad usage or input, 3 a solver did not "
      "converge.\nMore: dlo COMMAND --help");
  try {
    app.parse(argc, argv);
  } catch (const CLI::RuntimeError& status) {
    return status.get_exit_code();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    return report(bad_input, error);
  }
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const dlo::compare::InputError& error) {
    return report(bad_input, error);
  } catch (const std::invalid_argument& error) {
    return report(bad_input, error);
  } catch (const std::exception& error) {
    return report(not_converged, error);
  }
}
