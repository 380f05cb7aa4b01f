#include "study/benchmark.hpp"

#include <gtest/gtest.h>

#include "dlo/compare/solution.hpp"

namespace dlo::compare {
namespace {

BenchmarkRun run_of(double seconds, double error) {
  BenchmarkRun run;
  run.time.median_s = seconds;
  run.rms_over_length = error;
  return run;
}

TEST(Benchmark, FrontIsWhatNoOtherRunBeats) {
  std::vector<BenchmarkRun> runs = {run_of(1, 1e-2), run_of(2, 1e-3), run_of(3, 2e-3),
                                    run_of(4, 1e-5), run_of(4, 1e-4), run_of(1, 1e-2)};
  mark_pareto_front(runs);
  const std::vector<bool> expected = {true, true, false, true, false, true};
  for (std::size_t i = 0; i < runs.size(); ++i) EXPECT_EQ(runs[i].front, expected[i]) << i;
  EXPECT_EQ(fastest_within(runs, 5e-4), 3U);
  EXPECT_EQ(fastest_within(runs, 1e-3), 1U);
  EXPECT_FALSE(fastest_within(runs, 1e-9));
  EXPECT_TRUE(has_run(runs));
  EXPECT_TRUE(has_run(runs, Model::energy));
  EXPECT_FALSE(has_run(runs, Model::force));
}

}  // namespace
}  // namespace dlo::compare
