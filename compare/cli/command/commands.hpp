#pragma once

#include <CLI/CLI.hpp>

namespace dlo::cli {

// Each function adds its command to the application, which runs it when it is chosen. Errors are
// exceptions; report_exception() turns them into messages and exit statuses. A result outside a
// tolerance is printed first, then end_with(ExitStatus::outside_tolerance) is called.
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

/// All commands, in the order of the help.
inline constexpr void (*all_commands[])(CLI::App&) = {
    add_init,      add_materials, add_solve,   add_scene, add_check,
    add_suite,     add_calibrate, add_compare, add_paper, add_bench,
    add_stability, add_track,     add_modes,   add_sweep, add_regress};

}  // namespace dlo::cli
