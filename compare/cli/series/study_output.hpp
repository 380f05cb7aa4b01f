#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "batch/regression.hpp"
#include "figure/layout.hpp"
#include "format/json.hpp"
#include "paper/moving_tables.hpp"
#include "paper/paper.hpp"
#include "record/csv_table.hpp"
#include "report/page.hpp"
#include "study/benchmark.hpp"
#include "study/stability.hpp"
#include "study/stability_map.hpp"
#include "suite/card.hpp"

namespace dlo::cli {

/// Returns the document `dlo/bench/2`.
[[nodiscard]] compare::Document benchmark_document(const compare::BenchmarkReport& report);

/// Returns a header, one row per run, then one per failure.
[[nodiscard]] std::string benchmark_csv(const compare::BenchmarkReport& report);

/// Returns Tables 2 to 4, the key `moving` of the document of the paper.
[[nodiscard]] Json moving_json(const compare::MovingReport& report);

/// Returns the document `dlo/paper/1`. @param moving  Tables 2 to 4
[[nodiscard]] compare::Document paper_document(const compare::PaperReport& report,
                                               const compare::MovingReport& moving);

/// Returns a header, then one number of the document per line: its path and its value.
[[nodiscard]] std::string paper_csv(const compare::Document& paper);

/// Returns the effect of --update on each case of the baseline.
[[nodiscard]] std::string baseline_update_text(
    const std::vector<compare::RegressionResult>& results);

/// Returns a regression as text. @param file  output file; empty: standard output, which may be a
/// terminal
[[nodiscard]] std::string regression_text(const std::vector<compare::RegressionResult>& results,
                                          const std::string& file);

/// Returns a regression as text, without the cases whose errors have not changed, which are only
/// counted.
[[nodiscard]] std::string regression_changes_text(
    const std::vector<compare::RegressionResult>& results, const std::string& file);

/// Returns a regression as JSON. @param good  whether no case fails; with --update, whether all
/// scenes were solved
[[nodiscard]] Json regression_json(const std::vector<compare::RegressionResult>& results,
                                   bool good);

[[nodiscard]] std::string regression_csv(const std::vector<compare::RegressionResult>& results);

/// Returns the document `dlo/stability/1`.
[[nodiscard]] compare::Document hard_cases_document(
    const std::vector<compare::StabilityResult>& results);

/// Returns the largest stable c_F, measured and predicted, and the points of the map: the document
/// `dlo/stability-map/1`. Its text omits the points.
[[nodiscard]] compare::Document stability_map_document(const compare::StabilityMap& map);

/// Returns a header, then one row per point of the map.
[[nodiscard]] std::string stability_map_csv(const compare::StabilityMap& map);

/// Returns a table of classes for each simulator, followed by the causes of wrong scenes.
[[nodiscard]] std::string cards_text(const std::vector<compare::Card>& cards);

/// Returns the tables in Markdown, for a pull request.
[[nodiscard]] std::string cards_markdown(const std::vector<compare::Card>& cards);

/// Returns JUnit XML with one test case per scene: skipped if it is not supported, an error if
/// there is no result to judge, else a failure unless it is right.
[[nodiscard]] std::string cards_junit(const std::vector<compare::Card>& cards);

/// Draws the largest error of each class against N.
[[nodiscard]] compare::Figure card_figure(const compare::Card& card);

/// Returns the results of a simulator for a page, without pictures.
[[nodiscard]] compare::PageResult card_page(const compare::Card& card);

}  // namespace dlo::cli
