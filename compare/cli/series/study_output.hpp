#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "batch/regression.hpp"
#include "format/json.hpp"
#include "paper/moving_tables.hpp"
#include "paper/paper.hpp"
#include "study/benchmark.hpp"
#include "study/stability.hpp"
#include "study/stability_map.hpp"

namespace dlo::cli {

/// A benchmark as a person reads it.
[[nodiscard]] std::string benchmark_text(const compare::BenchmarkReport& report);

[[nodiscard]] Json benchmark_json(const compare::BenchmarkReport& report);

[[nodiscard]] std::string benchmark_csv(const compare::BenchmarkReport& report);

/// The section on Tables 2 to 4 as a person reads it.
[[nodiscard]] std::string moving_text(const compare::MovingReport& report);

/// Its lines of the CSV output: section, scene, item, quantity, value.
[[nodiscard]] std::string moving_csv(const compare::MovingReport& report);

[[nodiscard]] Json moving_json(const compare::MovingReport& report);

[[nodiscard]] std::string paper_text(const compare::PaperReport& report);

[[nodiscard]] Json paper_json(const compare::PaperReport& report);

/// One number a line: section, scene, item, quantity, value.
[[nodiscard]] std::string paper_csv(const compare::PaperReport& report);

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

/// The hard cases as a person reads them.
/// @param results  of each case those of all steppers, one after the other
/// @param steppers  how many of them
[[nodiscard]] std::string hard_cases_text(const std::vector<compare::StabilityResult>& results,
                                          std::size_t steppers);

[[nodiscard]] Json hard_cases_json(const std::vector<compare::StabilityResult>& results);

[[nodiscard]] std::string hard_cases_csv(const std::vector<compare::StabilityResult>& results);

/// The largest stable c_F, measured and predicted.
[[nodiscard]] std::string stability_map_text(const compare::StabilityMap& map);

[[nodiscard]] Json stability_map_json(const compare::StabilityMap& map);

[[nodiscard]] std::string stability_map_csv(const compare::StabilityMap& map);

}  // namespace dlo::cli
