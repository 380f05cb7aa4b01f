#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace dlo::cli {

/// The manual page dlo(1) in mdoc, of the commands and options as they are.
[[nodiscard]] std::string manual_page(const CLI::App& app);

}  // namespace dlo::cli
