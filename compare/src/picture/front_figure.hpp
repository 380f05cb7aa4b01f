#pragma once

#include "figure/layout.hpp"
#include "study/benchmark.hpp"

namespace dlo::compare {

/// Error against time of a scene's static runs, and the line of those that no other run beats in
/// both. For scenes that have runs.
[[nodiscard]] Figure front_figure(const SceneBenchmark& scene);

}  // namespace dlo::compare
