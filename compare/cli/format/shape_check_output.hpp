#pragma once

#include <string>

#include "dlo/compare/check.hpp"
#include "format/json.hpp"

namespace dlo::cli {

/// A judged shape for the page.
struct CheckPage {
  const compare::CheckResult& result;
  std::string unit_hint = {};  ///< where the check itself has none
  std::string verdict = {};    ///< its word where that is shown otherwise, as in colour
};

[[nodiscard]] std::string shape_check_text(const CheckPage& page);

[[nodiscard]] Json shape_check_json(const compare::CheckResult& report);

/// A summary for a page of Markdown, such as that of a job of continuous integration.
[[nodiscard]] std::string shape_check_markdown(const compare::CheckResult& report);

[[nodiscard]] std::string shape_check_csv(const compare::CheckResult& report);

}  // namespace dlo::cli
