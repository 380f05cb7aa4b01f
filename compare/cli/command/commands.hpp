#pragma once

#include <CLI/CLI.hpp>
#include <vector>

namespace dlo::cli {

// Each adds its command to the application and runs it when it is chosen. Errors are exceptions;
// report_exception() turns them into messages and exit statuses. A result outside a tolerance is
// printed, then end_with(ExitStatus::outside_tolerance) called.
void add_init(CLI::App& app);
void add_materials(CLI::App& app);
void add_solve(CLI::App& app);
void add_compare(CLI::App& app);
void add_check(CLI::App& app);
void add_calibrate(CLI::App& app);
void add_paper(CLI::App& app);
void add_bench(CLI::App& app);
void add_stability(CLI::App& app);
void add_regress(CLI::App& app);
void add_scene(CLI::App& app);
void add_sweep(CLI::App& app);
void add_modes(CLI::App& app);
void add_suite(CLI::App& app);
void add_track(CLI::App& app);

/// Commands by what a user wants to do.
struct Task {
  const char* what;
  std::vector<void (*)(CLI::App&)> commands;
};

/// All commands, in the order of the help.
[[nodiscard]] const std::vector<Task>& tasks();

}  // namespace dlo::cli
