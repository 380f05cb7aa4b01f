#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace dlo::cli {

/// --with NAME=COMMAND, which may be given again; compare::parse_foreign_programs() takes them.
void add_program_options(CLI::App& command, std::vector<std::string>& programs);

}  // namespace dlo::cli
