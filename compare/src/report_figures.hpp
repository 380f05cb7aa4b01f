#pragma once

#include <string>
#include <vector>

#include "dlo/compare/report.hpp"
#include "figure.hpp"

namespace dlo::compare {

/// "law paper, bookkeeping paper, N = 16".
[[nodiscard]] std::string setting_name(const ForceModelSettings& settings);

/// Shapes and curvature of a scene; `number` (from 1) is part of their names.
[[nodiscard]] std::vector<Figure> scene_figures(const SceneReport& scene, std::size_t number);

/// Every figure of a report, in the order of the page.
[[nodiscard]] std::vector<Figure> report_figures(const Report& report);

/// Commands that give a part's numbers again, run in the report's folder. compare_command is empty
/// where the scene names a number that dlo compare refuses with the other law or bookkeeping.
[[nodiscard]] std::string compare_command(const SceneFile& file, const Comparison& comparison);
[[nodiscard]] std::string benchmark_command(const Report& report);
[[nodiscard]] std::string map_command(const Report& report);
[[nodiscard]] std::string history_command(const Report& report);
[[nodiscard]] std::string report_command(const Report& report, const std::string& scenes);

}  // namespace dlo::compare
