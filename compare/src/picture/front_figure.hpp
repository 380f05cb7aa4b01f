#pragma once

#include <cstddef>

#include "figure/layout.hpp"
#include "study/benchmark.hpp"

namespace dlo::compare {

/// Error against time of a scene's static runs, and the line of those that no other run beats in
/// both; `number` (from 1) is part of its name. For scenes that have runs.
[[nodiscard]] Figure front_figure(const SceneBenchmark& scene, std::size_t number);

}  // namespace dlo::compare
