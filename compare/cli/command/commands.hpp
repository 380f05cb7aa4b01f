#pragma once

#include <CLI/CLI.hpp>
#include <string_view>

namespace dlo::cli {

// Each function adds its command to the application, which runs it when it is chosen. Errors are
// exceptions; report_exception() turns them into messages and exit statuses. A result outside a
// tolerance is printed first, then exit_with_status(ExitStatus::outside_tolerance) is called.
void add_init_command(CLI::App& app);
void add_materials_command(CLI::App& app);
void add_solve_command(CLI::App& app);
void add_compare_command(CLI::App& app);
void add_check_command(CLI::App& app);
void add_calibrate_command(CLI::App& app);
void add_paper_command(CLI::App& app);
void add_bench_command(CLI::App& app);
void add_stability_command(CLI::App& app);
void add_regress_command(CLI::App& app);
void add_scene_command(CLI::App& app);
void add_sweep_command(CLI::App& app);
void add_modes_command(CLI::App& app);
void add_suite_command(CLI::App& app);
void add_track_command(CLI::App& app);

/// A command and the function that adds it.
struct NamedCommand {
  std::string_view name;
  void (*add)(CLI::App&);
};

/// All commands, in the order of the help.
inline constexpr NamedCommand all_commands[] = {
    {"init", add_init_command},           {"materials", add_materials_command},
    {"solve", add_solve_command},         {"scene", add_scene_command},
    {"check", add_check_command},         {"suite", add_suite_command},
    {"calibrate", add_calibrate_command}, {"compare", add_compare_command},
    {"paper", add_paper_command},         {"bench", add_bench_command},
    {"stability", add_stability_command}, {"track", add_track_command},
    {"modes", add_modes_command},         {"sweep", add_sweep_command},
    {"regress", add_regress_command}};

}  // namespace dlo::cli
