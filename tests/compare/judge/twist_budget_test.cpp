// Tests of the part of a deviation that is due to twist that the force model neglects. The part is
// zero if the force model includes twist.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "dlo/compare/comparison.hpp"
#include "dlo/compare/plan.hpp"
#include "judge/budget_shares.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

TEST(Budget, TellsWhatTwistThatIsLeftOutCosts) {
  Scene scene = test::two_clamps(1, {0.8, 0, 0});
  for (Gripper& gripper : scene.grippers) gripper.frame = FrameHold{};
  scene.grippers.back().frame->roll = 3;
  scene.torsional_stiffness = scene.bending_stiffness() / 1.3;
  scene.force_model.c_c = scene.axial_stiffness() / 100;
  scene.force_model.law = BendingLaw::paper;
  const Comparison c = compare(scene, {}, {}, ModulusSearch::no);
  EXPECT_EQ(c.force.neglected, std::vector<std::string>{"twist"});
  const Budget& b = c.budget;
  // The result equals that of the plan, except for the discretisation by 16 points.
  const double apart = make_plan(scene).bound("twist");
  EXPECT_NEAR(b.twist.rms_m, apart, 0.03 * apart);
  // The polygon's discretisation error is the same without twist.
  const double alone =
      compare(scene.without_twist(), {}, {}, ModulusSearch::no).budget.discretisation.rms_m;
  EXPECT_NEAR(b.discretisation.rms_m, alone, 1e-3 * alone);
  EXPECT_NEAR(test::sum_of_shares(b), 1, 1e-9);
}

}  // namespace
}  // namespace dlo::compare
