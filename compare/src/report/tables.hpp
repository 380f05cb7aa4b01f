#pragma once

#include <string>
#include <vector>

#include "report/html.hpp"
#include "report/report.hpp"

namespace dlo::compare {

/// Tables of a report. Every number names its law and bookkeeping.
[[nodiscard]] HtmlTable scene_table(const Report& report);
[[nodiscard]] HtmlTable deviation_table(const Report& report);
[[nodiscard]] HtmlTable state_table(const Report& report);
[[nodiscard]] HtmlTable budget_table(const Report& report);
[[nodiscard]] HtmlTable motion_table(const Report& report);
[[nodiscard]] HtmlTable modulus_table(const Report& report);
[[nodiscard]] HtmlTable history_table(const Report& report);
[[nodiscard]] HtmlTable answer_table(const Report& report);
[[nodiscard]] HtmlTable front_table(const SceneBenchmark& scene);
[[nodiscard]] HtmlTable map_table(const StabilityMap& map);
[[nodiscard]] HtmlTable hard_case_table(const std::vector<StabilityResult>& results);
[[nodiscard]] HtmlTable parameter_table(const Report& report);

}  // namespace dlo::compare
