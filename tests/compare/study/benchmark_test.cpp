#include "study/benchmark.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

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
  mark_front(runs);
  const std::vector<bool> expected = {true, true, false, true, false, true};
  for (std::size_t i = 0; i < runs.size(); ++i) EXPECT_EQ(runs[i].front, expected[i]) << i;
  EXPECT_EQ(fastest_within(runs, 5e-4), 3U);
  EXPECT_EQ(fastest_within(runs, 1e-3), 1U);
  EXPECT_FALSE(fastest_within(runs, 1e-9));
  EXPECT_TRUE(has_run(runs));
  EXPECT_TRUE(has_run(runs, Model::energy));
  EXPECT_FALSE(has_run(runs, Model::force));
}

/// Whether a model's runs of a scene were skipped for lack of time and reported as skipped.
bool said_to_be_skipped(const BenchmarkReport& report, const std::string& scene, Model model) {
  return std::any_of(report.skipped.begin(), report.skipped.end(), [&](const std::string& one) {
    return one.starts_with(scene + ": " + to_string(model));
  });
}

/// Times depend on the machine. These facts hold on every machine, however slow: runs that do not
/// fit into the budget are reported as skipped.
TEST(Benchmark, RunsEveryModelOrSaysThatItDidNotAndItsAnswersFitTheRows) {
  const BenchmarkReport report =
      run_benchmark(benchmark_scenes(), {.budget_s = 3, .repeats = 1, .frames = 10});
  ASSERT_EQ(report.scenes.size(), 2U);
  EXPECT_NEAR(report.scenes[0].gamma, 0.18, 0.01);
  EXPECT_NEAR(report.scenes[1].gamma, 18, 1);
  for (const SceneBenchmark& scene : report.scenes) {
    EXPECT_EQ(scene.reference, Model::exact);
    std::map<Model, int> count;
    for (const BenchmarkRun& run : scene.runs) {
      ++count[run.model];
      EXPECT_GT(run.evaluations, 0);
      EXPECT_GE(run.time.repeats, 1);
      EXPECT_LE(run.time.lower_quartile_s, run.time.median_s);
      EXPECT_LE(run.time.median_s, run.time.upper_quartile_s);
      for (const BenchmarkRun& other : scene.runs) {
        const bool beaten =
            other.time.median_s < run.time.median_s && other.rms_over_length < run.rms_over_length;
        EXPECT_FALSE(run.front && beaten);
        // For one chain more points are more accurate: second order, or first order with the
        // paper's convention.
        if (run.model == Model::chain && other.model == Model::chain &&
            run.variant == other.variant && run.variant->law == BendingLaw::hooke &&
            run.size == 2 * other.size) {
          EXPECT_LT(run.rms_over_length, other.rms_over_length / 3);
        }
      }
    }
    for (const Model model : {Model::exact, Model::energy, Model::chain, Model::force}) {
      EXPECT_TRUE(count[model] > 0 || said_to_be_skipped(report, scene.scene, model))
          << to_string(model);
    }
    const bool energy_skipped = said_to_be_skipped(report, scene.scene, Model::energy);
    ASSERT_EQ(scene.answers.size(), 4U);
    for (const BenchmarkAnswer& answer : scene.answers) {
      ASSERT_TRUE(answer.best || energy_skipped) << answer.error;
      if (!answer.best) continue;
      const BenchmarkRun& best = scene.runs[*answer.best];
      EXPECT_LE(best.rms_over_length, answer.error);
      EXPECT_TRUE(best.front || answer.error > best.rms_over_length);
      for (const BenchmarkRun& run : scene.runs) {
        EXPECT_FALSE(run.rms_over_length <= answer.error && run.time.median_s < best.time.median_s);
      }
    }
    ASSERT_TRUE(scene.energy_at_1e6 || energy_skipped);
    if (scene.energy_at_1e6) {
      EXPECT_EQ(scene.runs[*scene.energy_at_1e6].model, Model::energy);
    }
    EXPECT_TRUE(!scene.tracking.empty() || !report.skipped.empty());
    for (const BenchmarkRun& run : scene.tracking) {
      if (run.model == Model::energy && run.size == 0) {
        EXPECT_LT(run.rms_over_length, 1e-8);
      } else if (run.model == Model::energy && run.size == 3) {
        EXPECT_GT(run.rms_over_length, 1e-10);
      }
    }
  }
}

TEST(Benchmark, SaysWhatItSkipped) {
  const BenchmarkReport report =
      run_benchmark(benchmark_scenes(), {.budget_s = 1e-9, .repeats = 1, .frames = 100});
  for (const SceneBenchmark& scene : report.scenes) {
    EXPECT_FALSE(has_run(scene.runs));
    EXPECT_FALSE(has_run(scene.tracking));
  }
  ASSERT_FALSE(report.skipped.empty());
  for (const std::string& skipped : report.skipped) {
    EXPECT_THAT(skipped, testing::EndsWith(": no time is left (--seconds)"));
  }
}

TEST(Benchmark, OptionsOutOfRangeAreRefused) {
  EXPECT_THROW((void)run_benchmark(benchmark_scenes(), {.budget_s = 0}), std::invalid_argument);
  EXPECT_THROW((void)run_benchmark(benchmark_scenes(), {.repeats = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::compare
