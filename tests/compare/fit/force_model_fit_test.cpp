#include "dlo/compare/force_model_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../../says.hpp"
#include "dlo/compare/chain.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

std::vector<Scene> scenes_of(const std::vector<double>& gammas, double degrees, BendingLaw law) {
  std::vector<Scene> scenes;
  for (const double gamma : gammas) {
    scenes.push_back(heavy_scene(gamma, degrees));
    scenes.back().force_model.law = law;
  }
  return scenes;
}

const RuleDeviations& rule_of(const ForceModelFit& fit, StiffnessRule rule) {
  return *std::find_if(fit.rules.begin(), fit.rules.end(),
                       [rule](const RuleDeviations& entry) { return entry.rule == rule; });
}

TEST(ForceModelFit, HookeChoosesPointsForTheTargetAndKeepsItOnHoldOutScenes) {
  const std::vector<Scene> scenes = scenes_of({0.2, 1, 5, 20}, 0, BendingLaw::hooke);
  const std::vector<Scene> holdouts = scenes_of({0.1, 2, 10, 20}, -30, BendingLaw::hooke);
  const ForceModelFit fit = fit_force_model(scenes, holdouts);
  EXPECT_NEAR(fit.order, 2, 0.1);
  EXPECT_LE(fit.largest_deviation(), 1e-3);
  EXPECT_LE(fit.largest_holdout_deviation(), 1e-3);
  // The error is of second order: a quarter of it requires twice the number of segments.
  const ForceModelFit finer = fit_force_model(scenes, {}, {.target = 1e-3 / 4});
  EXPECT_NEAR((finer.settings.points - 1.5) / (fit.settings.points - 1.5), 2, 0.15);
  EXPECT_LE(finer.largest_deviation(), 1e-3 / 4);
  // With 10 % fewer points the error exceeds the part of the target that is allowed for the
  // polygon.
  ForceModelFitOptions fewer{.points = fit.settings.points * 9 / 10};
  EXPECT_GT(fit_force_model(scenes, {}, fewer).largest_deviation(), 0.9e-3);
}

TEST(ForceModelFit, StretchTakesATenthOfTheTargetAtMost) {
  const std::vector<Scene> scenes = scenes_of({1, 8}, -60, BendingLaw::hooke);
  const ForceModelFit fit = fit_force_model(scenes, {}, {.points = 16, .target = 1e-2});
  const RuleDeviations& chain = rule_of(fit, StiffnessRule::physical);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    EXPECT_NEAR(fit.stepped_rms_over_length[i], chain.rms_over_length[i], 1e-3);
    EXPECT_GT(fit.steps[i], 0);
  }
  EXPECT_EQ(fit.settings.stepper, Stepper::dynamic);
  EXPECT_GT(*fit.settings.c_F, 0);
  EXPECT_LT(*fit.settings.c_h, 1);
  EXPECT_LT(*fit.settings.c_c, scenes[0].axial_stiffness());
  EXPECT_DOUBLE_EQ(*fit.settings.c_c, scenes[1].weight_per_length().norm() / 1e-3);
}

TEST(ForceModelFit, FittedStiffnessOfThePaperLawIsTheBest) {
  const std::vector<Scene> scenes = scenes_of({0.5, 2, 8}, 0, BendingLaw::paper);
  const ForceModelFit fit = fit_force_model(scenes, scenes_of({4}, 20, BendingLaw::paper));
  ASSERT_EQ(fit.rules.size(), 4U);
  const RuleDeviations& fitted = rule_of(fit, StiffnessRule::fitted);
  const RuleDeviations& alone = rule_of(fit, StiffnessRule::fitted_per_scene);
  EXPECT_EQ(fit.settings.c_b, fitted.c_b[0]);
  for (const RuleDeviations& rule : fit.rules) {
    double sum = 0;
    double fitted_sum = 0;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      EXPECT_LE(alone.rms_over_length[i], rule.rms_over_length[i] * (1 + 1e-9))
          << to_string(rule.rule) << ", " << i;
      sum += std::pow(rule.rms_over_length[i], 2);
      fitted_sum += std::pow(fitted.rms_over_length[i], 2);
    }
    if (rule.rule != StiffnessRule::fitted_per_scene) {
      EXPECT_LE(fitted_sum, sum) << to_string(rule.rule);
    }
  }
  // No c_b close by is better for a scene than the one fitted to it alone.
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const energy_model::Equilibrium energy = solve_reference(scenes[i], Model::energy);
    for (const double factor : {0.97, 1.03}) {
      ForceModelSettings settings = fit.settings;
      settings.c_b = alone.c_b[i] * factor;
      const Shape shape = solve_chain(scenes[i], settings).shape;
      EXPECT_GT(rms(shape.arc_length, shape.points - energy.sample(shape.arc_length).points),
                alone.rms_over_length[i]);
    }
  }
  // With any c_b, the shape of a cubic law deviates from that of a linear law by more than 0.5 % of
  // the length.
  EXPECT_GT(alone.rms_over_length[2], 0.005);
}

TEST(ForceModelFit, SeveralGrippersAreFittedToo) {
  Scene scene = test::two_clamps(5, {0.8, 0, 0});
  const ForceModelFit fit = fit_force_model({scene}, {});
  EXPECT_LE(fit.largest_deviation(), 1e-3);
}

// Between two pins a distance d apart a rod of length l hangs in a parabola with the sag f,
//     l - d = 8 f^2 / (3 d),   tension w d^2 / (8 f),
// so that a strain e deepens the sag by f e l / (2 (l - d)). The RMS of a parabola is sqrt(8/15) of
// its sag.
TEST(ForceModelFit, StretchBetweenTwoPinsIsComparedWithRigidSegments) {
  Scene scene = heavy_scene(1000, 0);
  scene.grippers.front().direction.reset();
  constexpr double d = 0.98;
  scene.grippers.push_back({.at = 1, .position = {d, 0, 0}});
  scene.force_model.law = BendingLaw::hooke;
  const double sag = std::sqrt(3 * d * (1 - d) / 8);
  constexpr double strain = 1e-3;
  scene.force_model.c_c = scene.weight_per_length().norm() * d * d / (8 * sag) / strain;
  const ForceModelFit fit = fit_force_model({scene}, {}, {.points = 32});
  const double deeper = sag * strain / (2 * (1 - d));
  EXPECT_NEAR(fit.stretch_rms_over_length.front() / (std::sqrt(8.0 / 15) * deeper), 1, 0.05);
  EXPECT_LT(rule_of(fit, StiffnessRule::physical).rms_over_length.front(), 1e-4);
  ASSERT_EQ(fit.shortfall_reasons().size(), 1U);
  EXPECT_TRUE(test::has_all(fit.shortfall_reasons().front(), {"the given c_c stretches the rod"}));
}

TEST(ForceModelFit, RefusesWhatCannotBeFitted) {
  const std::vector<Scene> hooke = scenes_of({1}, 0, BendingLaw::hooke);
  const std::vector<Scene> paper = scenes_of({1}, 0, BendingLaw::paper);
  EXPECT_THROW((void)fit_force_model({}, {}), InputError);
  EXPECT_THROW((void)fit_force_model(hooke, paper), InputError);
  EXPECT_THROW((void)fit_force_model(hooke, {}, {.target = 0}), InputError);
  EXPECT_THROW((void)fit_force_model(hooke, {}, {.target = NAN}), InputError);
}

}  // namespace
}  // namespace dlo::compare
