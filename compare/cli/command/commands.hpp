#pragma once

#include <CLI/CLI.hpp>

namespace dlo::cli {

// Each function adds its command to the application, which runs it when it is chosen. Errors are
// exceptions; report_exception() turns them into messages and exit statuses. A result outside a
// tolerance is printed first, then end_with(ExitStatus::outside_tolerance) is called.
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

/// All commands, in the order of the help.
inline constexpr void (*all_commands[])(CLI::App&) = {
    add_init_command,  add_materials_command, add_solve_command,     add_scene_command,
    add_check_command, add_suite_command,     add_calibrate_command, add_compare_command,
    add_paper_command, add_bench_command,     add_stability_command, add_track_command,
    add_modes_command, add_sweep_command,     add_regress_command};

}  // namespace dlo::cli
