#pragma once

#include <string>

#include "format/json.hpp"
#include "study/benchmark.hpp"

namespace dlo::cli {

/// A benchmark as a person reads it.
[[nodiscard]] std::string benchmark_text(const compare::BenchmarkReport& report);

[[nodiscard]] Json benchmark_json(const compare::BenchmarkReport& report);

[[nodiscard]] std::string benchmark_csv(const compare::BenchmarkReport& report);

}  // namespace dlo::cli
