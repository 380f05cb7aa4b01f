#pragma once

#include <string>
#include <vector>

#include "figure/layout.hpp"
#include "report/report.hpp"

namespace dlo::compare {

/// Every figure of a report, in the order of the page.
[[nodiscard]] std::vector<Figure> report_figures(const Report& report);

}  // namespace dlo::compare
