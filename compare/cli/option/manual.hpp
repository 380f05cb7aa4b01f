#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace dlo::cli {

/// The manual page dlo(1) in mdoc, of the commands and options as they are.
[[nodiscard]] std::string manual_page(const CLI::App& app);

/// Completion for bash: commands, their options, values of options that have a choice, files.
[[nodiscard]] std::string bash_completion(const CLI::App& app);

}  // namespace dlo::cli
