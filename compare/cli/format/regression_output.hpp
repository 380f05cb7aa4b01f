#pragma once

#include <string>
#include <vector>

#include "batch/regression.hpp"
#include "format/json.hpp"

namespace dlo::cli {

/// What --update did to each case of the baseline.
[[nodiscard]] std::string baseline_update_text(
    const std::vector<compare::RegressionResult>& results);

/// @param file  that the text goes to; empty: standard output, which may be a terminal
[[nodiscard]] std::string regression_text(const std::vector<compare::RegressionResult>& results,
                                          const std::string& file);

/// The same without the cases whose errors are the same.
[[nodiscard]] std::string regression_changes_text(
    const std::vector<compare::RegressionResult>& results, const std::string& file);

/// @param good  no case fails
[[nodiscard]] Json regression_json(const std::vector<compare::RegressionResult>& results,
                                   bool good);

[[nodiscard]] std::string regression_csv(const std::vector<compare::RegressionResult>& results);

}  // namespace dlo::cli
