#pragma once

#include <string>
#include <utility>
#include <vector>

#include "report/report.hpp"

namespace dlo::compare {

/// What made a result, as names and values: compiler, libraries, machine, instruction set, time.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> provenance();

/// Commands that give a part's numbers again, run in the report's folder. compare_command is empty
/// where the scene names a number that dlo compare refuses with the other law or bookkeeping.
[[nodiscard]] std::string compare_command(const SceneFile& file, const Comparison& comparison);

[[nodiscard]] std::string benchmark_command(const Report& report);

[[nodiscard]] std::string track_command(const MotionReport& motion);

[[nodiscard]] std::string map_command(const Report& report);

[[nodiscard]] std::string history_command(const Report& report);

[[nodiscard]] std::string report_command(const Report& report, const std::string& scenes);

}  // namespace dlo::compare
