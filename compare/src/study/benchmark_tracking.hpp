#pragma once

#include <vector>

#include "study/benchmark_runs.hpp"

namespace dlo::compare {

[[nodiscard]] std::vector<BenchmarkRun> tracking_runs(const Scene& scene,
                                                      const ReferenceShape& reference,
                                                      const BenchmarkOptions& options,
                                                      Stopwatch& watch);

}  // namespace dlo::compare
