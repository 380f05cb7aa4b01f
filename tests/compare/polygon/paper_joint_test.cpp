// Tests of the equivalent stiffness of the paper's cubic law: closed forms against the chain model.

#include "dlo/compare/paper_joint.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "dlo/compare/bending_rule.hpp"
#include "dlo/compare/chain.hpp"
#include "dlo/compare/discretise.hpp"
#include "dlo/compare/effective_modulus.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

TEST(EquivalentModulus, IsThePhysicalOneWhereTheRuleSaysSo) {
  const double EI = 0.165;
  const double k = 5;
  const double L = 1.0 / 30;
  const double formula_21 = paper_bending_stiffness(BendingRule::formula_21, EI, k, L);
  const double matched = paper_bending_stiffness(BendingRule::moment_matched, EI, k, L);
  EXPECT_NEAR(equivalent_bending_stiffness(formula_21, L, k * L), EI * k * L, 1e-15);
  EXPECT_NEAR(equivalent_bending_stiffness(matched, L, k * L), EI, 1e-14);
  // (3) at another angle
  const double alpha = 0.4;
  const double ratio =
      k * L * k * L / alpha * std::pow(std::sin(alpha / 2) / std::sin(k * L / 2), 3);
  EXPECT_NEAR(equivalent_bending_stiffness(formula_21, L, alpha), EI * ratio, 1e-14);
}

TEST(EquivalentModulus, MomentIsTheDerivativeOfThePotential) {
  const double c_b = 3;
  const double L = 0.2;
  const auto potential = [&](double alpha) {
    const double half = std::cos(alpha / 2);
    return c_b * L * (8.0 / 3 - 4 * half + 4.0 / 3 * half * half * half);
  };
  for (const double alpha : {0.01, 0.5, 1.5, 3.0}) {
    const double h = 1e-4;
    EXPECT_NEAR(paper_joint_moment(c_b, L, alpha),
                (potential(alpha + h) - potential(alpha - h)) / (2 * h), 1e-8);
    EXPECT_NEAR(paper_joint_angle(c_b, L, paper_joint_moment(c_b, L, alpha)), alpha, 1e-12);
  }
  EXPECT_NEAR(equivalent_bending_stiffness(c_b, L, 1e-3) / (c_b * L * L * 1e-6 / 4), 1, 1e-6);
  EXPECT_EQ(equivalent_bending_stiffness(c_b, L, 0), 0);
}

TEST(EquivalentModulus, RefusesWhatIsNoJoint) {
  EXPECT_THROW((void)paper_joint_moment(0, 1, 1), std::invalid_argument);
  EXPECT_THROW((void)paper_joint_moment(1, NAN, 1), std::invalid_argument);
  EXPECT_THROW((void)paper_joint_moment(1, 1, 3.2), std::invalid_argument);
  EXPECT_THROW((void)paper_joint_angle(1, 1, 2.1), std::invalid_argument);
  EXPECT_THROW((void)paper_joint_angle(1, 1, -1), std::invalid_argument);
  EXPECT_THROW((void)equivalent_bending_stiffness(1, 1, NAN), std::invalid_argument);
}

TEST(EquivalentModulus, PredictsTheBestFitOfACantileverUnderLittleWeight) {
  const double factor = 23023.0 / 32346;
  for (const int points : {16, 64}) {
    for (const double gamma : {1e-4, 1e-3}) {
      Scene scene = heavy_scene(gamma, 0);
      scene.force_model.law = BendingLaw::paper;
      scene.force_model.points = points;
      scene.force_model.design_curvature = 2.5;
      const Solution chain = solve(scene, Model::chain);
      const double c_b = chain.parameters.c_b;
      const double L = chain.parameters.segment_length;
      const double moment = scene.weight_per_length().norm() / 2;
      const double predicted =
          factor * equivalent_bending_stiffness(c_b, L, paper_joint_angle(c_b, L, moment)) /
          scene.bending_stiffness();
      const EffectiveModulus fitted = fit_effective_modulus(scene, chain.shape);
      // Slopes are not quite small (up to 0.2 rad), and 16 points are few.
      EXPECT_NEAR(fitted.ratio / predicted, 1, 0.02) << points << " " << gamma;
    }
  }
}

}  // namespace
}  // namespace dlo::compare
