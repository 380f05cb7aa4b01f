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

/// Returns a benchmark as text.
[[nodiscard]] std::string benchmark_text(const compare::BenchmarkReport& report);

[[nodiscard]] Json benchmark_json(const compare::BenchmarkReport& report);

[[nodiscard]] std::string benchmark_csv(const compare::BenchmarkReport& report);

/// Returns the section on Tables 2 to 4 as text.
[[nodiscard]] std::string moving_text(const compare::MovingReport& report);

/// Returns the lines of Tables 2 to 4 in the CSV output: section, scene, item, quantity, value.
[[nodiscard]] std::string moving_csv(const compare::MovingReport& report);

[[nodiscard]] Json moving_json(const compare::MovingReport& report);

[[nodiscard]] std::string paper_text(const compare::PaperReport& report);

[[nodiscard]] Json paper_json(const compare::PaperReport& report);

/// Returns one number per line: section, scene, item, quantity, value.
[[nodiscard]] std::string paper_csv(const compare::PaperReport& report);

/// Returns the effect of --update on each case of the baseline.
[[nodiscard]] std::string baseline_update_text(
    const std::vector<compare::RegressionResult>& results);

/// Returns a regression as text. @param file  output file; empty: standard output, which may be a
/// terminal
[[nodiscard]] std::string regression_text(const std::vector<compare::RegressionResult>& results,
                                          const std::string& file);

/// Returns a regression as text, without the cases whose errors have not changed.
[[nodiscard]] std::string regression_changes_text(
    const std::vector<compare::RegressionResult>& results, const std::string& file);

/// Returns a regression as JSON. @param good  whether no case fails; with --update, whether all
/// scenes were solved
[[nodiscard]] Json regression_json(const std::vector<compare::RegressionResult>& results,
                                   bool good);

[[nodiscard]] std::string regression_csv(const std::vector<compare::RegressionResult>& results);

/// Returns the hard cases as text.
/// @param results  for each case the results of all steppers in turn
/// @param steppers  number of steppers
[[nodiscard]] std::string hard_cases_text(const std::vector<compare::StabilityResult>& results,
                                          std::size_t steppers);

[[nodiscard]] Json hard_cases_json(const std::vector<compare::StabilityResult>& results);

[[nodiscard]] std::string hard_cases_csv(const std::vector<compare::StabilityResult>& results);

/// Returns the largest stable c_F, measured and predicted, as text.
[[nodiscard]] std::string stability_map_text(const compare::StabilityMap& map);

[[nodiscard]] Json stability_map_json(const compare::StabilityMap& map);

[[nodiscard]] std::string stability_map_csv(const compare::StabilityMap& map);

}  // namespace dlo::cli
