#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "report/report.hpp"

namespace dlo::compare {

/// What a report comes to in one glance: the scenes' own force models against the tolerance.
struct ReportSummary {
  std::size_t right = 0;    ///< scenes whose shape is within the tolerance
  std::size_t count = 0;    ///< of these, compared
  std::size_t worst = 0;    ///< the scene that is farthest off, in the report
  std::string main_reason;  ///< of its budget, with its share
};

/// Nothing where no scene could be compared.
[[nodiscard]] std::optional<ReportSummary> report_summary(const Report& report);

/// What a report comes to, most important first, one plain sentence each; the first ones are the
/// report's failures.
[[nodiscard]] std::vector<std::string> report_verdict(const Report& report);

}  // namespace dlo::compare
