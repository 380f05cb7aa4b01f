#include "study/stability.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "dlo/compare/force_model_settings.hpp"
#include "scenes.hpp"
#include "study/stability_map.hpp"

namespace dlo::compare {
namespace {

/// Returns two points a metre apart, of which the second one is displaced upwards by `offset`.
Eigen::Matrix3Xd two_points(double offset) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, 2);
  points.col(1) = Eigen::Vector3d(1, offset, 0);
  return points;
}

Outcome classify_late(const std::vector<double>& offsets, bool at_rest = false) {
  SimulationEnd trajectory{.finite = true, .at_rest = at_rest};
  for (const double offset : offsets) trajectory.late_shapes.push_back(two_points(offset));
  return classify(trajectory, two_points(0), 1, 1e-3);
}

TEST(Classify, TellsTheOutcomesApart) {
  EXPECT_EQ(classify_late({1e-4}), Outcome::pass);
  EXPECT_EQ(classify_late({0.5, 1e-4}), Outcome::wrong);  // on its way through
  EXPECT_EQ(classify_late({0.5, 1e-4}, true), Outcome::pass);
  EXPECT_EQ(classify_late({0.5}, true), Outcome::wrong);
  EXPECT_EQ(classify_late({0.4, 0.3, 0.2, 0.1}), Outcome::wrong);
  EXPECT_EQ(classify_late({0.1, -0.1, 0.1, -0.1, 0.1}), Outcome::oscillates);
  EXPECT_EQ(classify_late({20}), Outcome::diverges);
  EXPECT_EQ(classify_late({std::numeric_limits<double>::quiet_NaN()}), Outcome::diverges);
  EXPECT_EQ(classify({.finite = false}, two_points(0), 1, 1e-3), Outcome::diverges);
}

TEST(Classify, SeesOscillationFromStepToStep) {
  // Samples at equal phases do not show the oscillation; consecutive steps do.
  SimulationEnd trajectory{.finite = true};
  trajectory.late_shapes.assign(8, two_points(0.1));
  for (int i = 0; i < 8; ++i) trajectory.last_shapes.push_back(two_points(i % 2 == 0 ? 0.1 : -0.1));
  EXPECT_EQ(classify(trajectory, two_points(0), 1, 1e-3), Outcome::oscillates);
}

TEST(HardCases, AreLeftOutByName) {
  const StabilityOptions options = {.max_steps = 1,
                                    .max_steps_auto = 1,
                                    .name_contains = "crumpled",
                                    .excluded = {"crumpled 2", "N = 1000"},
                                    .steppers = {Stepper::automatic}};
  const std::vector<StabilityResult> results = stability(options);
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(results[0].name, "crumpled 1");
  EXPECT_EQ(results[1].name, "crumpled 3");
}

/// Whether a case needs so many steps that only the command runs it: N = 1000 needs eight million.
bool exceeds_a_million_steps(const HardCase& hard) { return hard.start.cols() > 500; }

std::vector<int> cases_within_a_million_steps() {
  std::vector<int> indices;
  const std::vector<HardCase> cases = hard_cases(1);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (!exceeds_a_million_steps(cases[i])) indices.push_back(static_cast<int>(i));
  }
  return indices;
}

void expect_pass(const HardCase& hard, const StabilityResult& result) {
  EXPECT_EQ(result.outcome, Outcome::pass) << hard.name << ": " << result.note;
  EXPECT_LT(result.error_over_length, 1e-5) << hard.name;
  EXPECT_EQ(result.at_rest, hard.steps_at_rest == 0) << hard.name;
}

class AutomaticStepper : public testing::TestWithParam<int> {};

TEST_P(AutomaticStepper, PassesTheHardCaseOrRefusesIt) {
  StabilityOptions options;
  options.max_steps_auto = 1'000'000;
  const HardCase hard = hard_cases(200'000).at(static_cast<std::size_t>(GetParam()));
  const StabilityResult result = run_hard_case(hard, Stepper::automatic, options);
  RecordProperty("case", hard.name);
  RecordProperty("steps", static_cast<int>(result.steps));
  EXPECT_EQ(!hard.refusal.empty(), hard.name == "pulled too far") << hard.name;
  if (!hard.refusal.empty()) {
    EXPECT_EQ(result.outcome, Outcome::refused);
    EXPECT_EQ(result.note, hard.refusal);
    EXPECT_TRUE(std::isnan(result.error_over_length));
    return;
  }
  expect_pass(hard, result);
}

INSTANTIATE_TEST_SUITE_P(HardCases, AutomaticStepper,
                         testing::ValuesIn(cases_within_a_million_steps()));

TEST(ImplicitStepper, PassesEveryHardCaseThatIsNotRefused) {
  StabilityOptions options;
  options.max_steps_auto = 100'000;
  for (const HardCase& hard : hard_cases(10'000)) {
    if (!hard.refusal.empty()) continue;
    expect_pass(hard, run_hard_case(hard, Stepper::implicit, options));
  }
}

TEST(HardCases, AreAllRunByTheAutomaticStepperButOne) {
  EXPECT_EQ(hard_cases(1).size(), 26U);
  EXPECT_EQ(cases_within_a_million_steps().size(), 25U);
}

TEST(HardCases, AThousandPointsCreepOnAndAreNotSaidToRest) {
  StabilityOptions options;
  options.max_steps_auto = 10'000;
  const std::vector<HardCase> cases = hard_cases(1);
  const auto found = std::find_if(cases.begin(), cases.end(), exceeds_a_million_steps);
  ASSERT_NE(found, cases.end());
  const StabilityResult result = run_hard_case(*found, Stepper::automatic, options);
  EXPECT_EQ(result.outcome, Outcome::wrong);
  EXPECT_EQ(result.note, "still creeping");
  EXPECT_FALSE(result.at_rest);
  EXPECT_GT(result.error_over_length, 0.01);
}

TEST(HardCases, AnotherEquilibriumPassesAndSaysSo) {
  // Above buckling the rod falls to the side on which it starts; the reference is on one side only.
  const std::vector<HardCase> cases = hard_cases(1);
  const auto buckling = std::find_if(cases.begin(), cases.end(), [](const HardCase& hard) {
    return hard.name.find("above buckling") != std::string::npos;
  });
  ASSERT_NE(buckling, cases.end());
  int others = 0;
  for (const double lean : {0.01, -0.01}) {
    HardCase hard = *buckling;
    for (Eigen::Index i = 2; i < hard.start.cols(); ++i) {
      hard.start(0, i) += lean * (hard.start(1, i) - hard.start(1, 0));
    }
    const StabilityResult result = run_hard_case(hard, Stepper::automatic, {});
    EXPECT_EQ(result.outcome, Outcome::pass) << result.note;
    EXPECT_TRUE(result.at_rest);
    EXPECT_LT(result.error_over_length, 1e-5);
    if (result.note.empty()) continue;
    ++others;
    EXPECT_EQ(result.note.find("another stable equilibrium, "), 0U) << result.note;
    // Mirror images have the same energy, to the nine digits that are printed.
    const std::size_t first = result.note.find("energy ") + 7;
    const std::size_t second = result.note.find("there ") + 6;
    EXPECT_EQ(result.note.substr(first, 9), result.note.substr(second, 9)) << result.note;
  }
  EXPECT_GE(others, 1);
}

TEST(Stability, ThePapersStepperBlowsUpBetweenUnequalSegments) {
  // The default c_F of these steps depends on the mean length of the segments only.
  StabilityOptions options;
  options.name_contains = "unequal segments";
  options.steppers = {Stepper::basic};
  EXPECT_EQ(stability(options).front().outcome, Outcome::diverges);
}

/// Expects that the predicted limits of a stability map are safe and close to the measured ones: of
/// the columns' ratios of measured to predicted limit the least is >= 1 and < `tightest`, and the
/// largest is < `loosest`.
void expect_safe_and_tight(const std::string& what, const Scene& scene, MapAxis axis,
                           double tightest, double loosest) {
  const StabilityMap map =
      stability_map(scene, {.axis = axis, .columns = 8, .rows = 16, .steps = 8000});
  ASSERT_EQ(map.columns.size(), 8U);
  ASSERT_EQ(map.points.size(), 8U * 16);
  double least = INFINITY;
  double most = 0;
  for (const MapColumn& column : map.columns) {
    least = std::min(least, column.measured / column.predicted);
    most = std::max(most, column.measured / column.predicted);
  }
  testing::Test::RecordProperty(what + "_least_measured_over_predicted", std::to_string(least));
  testing::Test::RecordProperty(what + "_most_measured_over_predicted", std::to_string(most));
  EXPECT_GE(least, 1) << scene.name;
  EXPECT_LT(least, tightest) << scene.name;
  EXPECT_LT(most, loosest) << scene.name;
}

// Contraction and bending act in perpendicular directions, so the sum of their bounds is at most
// twice the larger one. For bent rods the rotation of the joints' forces is added.
TEST(StabilityMap, PredictionIsSafeAndTightForHookeanRods) {
  expect_safe_and_tight("hooke_c_c", hard_case_scene(), MapAxis::c_c, 1.02, 2);
  expect_safe_and_tight("hooke_c_h", hard_case_scene(), MapAxis::c_h, 1.5, 1.5);
}

TEST(StabilityMap, PredictionIsSafeForThePapersLawAndSeveralGrips) {
  Scene paper = test::heavy_scene(2, -175);
  paper.force_model.law = BendingLaw::paper;
  paper.force_model.bookkeeping = Bookkeeping::paper;
  expect_safe_and_tight("paper_c_c", paper, MapAxis::c_c, 1.1, 4);
  Scene grips = test::heavy_scene(20, 0);
  grips.grippers.push_back({.at = 0.71, .position = {0.5, 0.1, 0.05}, .where = "test"});
  expect_safe_and_tight("grips_c_c", grips, MapAxis::c_c, 1.5, 4);
}

TEST(StabilityMap, GridAgreesWithItsLimitsForAnyNumberOfThreads) {
  const StabilityMapOptions options{.columns = 3, .rows = 12, .steps = 4000};
  StabilityMapOptions threaded = options;
  threaded.threads = 3;
  const StabilityMap map = stability_map(hard_case_scene(), options);
  const StabilityMap same = stability_map(hard_case_scene(), threaded);
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    const MapPoint& point = map.points[i];
    EXPECT_EQ(point.outcome == Outcome::pass, point.c_F <= map.columns[i / 12].measured) << i;
    EXPECT_EQ(point.outcome, same.points[i].outcome);
  }
  for (std::size_t k = 0; k < map.columns.size(); ++k) {
    EXPECT_EQ(map.columns[k].measured, same.columns[k].measured);
  }
}

}  // namespace
}  // namespace dlo::compare
