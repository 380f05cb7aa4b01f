#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/text.hpp"
#include "option/output.hpp"
#include "option/terminal.hpp"
#include "record/csv_table.hpp"
#include "series/study_output.hpp"

namespace dlo::cli {
namespace {

using compare::RegressionResult;
using compare::RegressionVerdict;

Json errors_json(const compare::ShapeErrors& errors) {
  return {{"rms_over_length", errors.rms},
          {"max_over_length", json_or_null(errors.max)},
          {"tip_over_length", json_or_null(errors.tip)}};
}

std::string result_text(const RegressionResult& result, const std::string& file) {
  const std::string verdict = fmt::format("{:<20}", compare::to_string(result.verdict));
  return fmt::format("{} {}\n{:<20} {}\n",
                     verdict_word(verdict, !compare::failed(result.verdict), file),
                     compare::display(result.name), "", compare::display(result.message));
}

std::string counts_text(const std::vector<RegressionResult>& results) {
  std::string out;
  for (const RegressionVerdict verdict :
       {RegressionVerdict::worse, RegressionVerdict::changed, RegressionVerdict::not_in_baseline,
        RegressionVerdict::not_measured, RegressionVerdict::not_solved, RegressionVerdict::better,
        RegressionVerdict::same}) {
    const long number = std::ranges::count(results, verdict, &RegressionResult::verdict);
    if (number == 0) continue;
    append(out, "{}{} {}", out.empty() ? "" : ", ", number, compare::to_string(verdict));
  }
  return out + "\n";
}

}  // namespace

std::string baseline_update_text(const std::vector<RegressionResult>& results) {
  std::string out;
  for (const RegressionResult& result : results) {
    const char* done = "same";
    if (!result.expected) {
      done = "added";
    } else if (!result.measured) {
      done = "removed";
    } else if (result.verdict != RegressionVerdict::same) {
      done = "changed";
    }
    append(out, "{:<20} {}\n", done, compare::display(result.name));
    // For a new or removed case the message describes the action that --update has just taken.
    if (result.expected && result.measured)
      append(out, "{:<20} {}\n", "", compare::display(result.message));
  }
  return out;
}

std::string regression_text(const std::vector<RegressionResult>& results, const std::string& file) {
  std::string out;
  for (const RegressionResult& result : results) out += result_text(result, file);
  return out + counts_text(results);
}

std::string regression_changes_text(const std::vector<RegressionResult>& results,
                                    const std::string& file) {
  std::string out;
  for (const RegressionResult& result : results) {
    if (result.verdict != RegressionVerdict::same) out += result_text(result, file);
  }
  return out + counts_text(results);
}

Json regression_json(const std::vector<RegressionResult>& results, bool good) {
  Json cases = json_list(results, [&](const RegressionResult& result) -> Json {
    return {{"case", result.name},
            {"verdict", compare::to_string(result.verdict)},
            {"baseline", json_or_null(result.expected, errors_json)},
            {"measured", json_or_null(result.measured, errors_json)},
            {"message", result.message}};
  });
  return {{"schema", "dlo/regress/1"},
          {"verdict", good ? "pass" : "fail"},
          {"cases", std::move(cases)}};
}

std::string regression_csv(const std::vector<RegressionResult>& results) {
  const compare::CsvTable table(
      "case,verdict,baseline_rms_over_length=baseline/rms_over_length,"
      "baseline_max_over_length=baseline/max_over_length,"
      "baseline_tip_over_length=baseline/tip_over_length,rms_over_length=measured/rms_over_length,"
      "max_over_length=measured/max_over_length,tip_over_length=measured/tip_over_length");
  return table.text(regression_json(results, true).at("cases"));
}

}  // namespace dlo::cli
