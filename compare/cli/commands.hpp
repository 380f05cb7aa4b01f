#pragma once

#include <CLI/CLI.hpp>

namespace dlo::cli {

// Each adds its command to the application and runs it when it is chosen. Errors are exceptions;
// main() turns them into messages and exit statuses.
void add_bench(CLI::App& app);
void add_solve(CLI::App& app);
void add_compare(CLI::App& app);
void add_paper(CLI::App& app);

}  // namespace dlo::cli
