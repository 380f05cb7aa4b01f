#pragma once

#include <string>
#include <vector>

#include "report/report.hpp"

namespace dlo::compare {

/// What a report comes to, most important first, one plain sentence each; the first ones are the
/// report's failures.
[[nodiscard]] std::vector<std::string> report_verdict(const Report& report);

}  // namespace dlo::compare
