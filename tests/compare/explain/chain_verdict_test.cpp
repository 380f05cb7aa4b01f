// Chains of hinges, which are right in their own way, and what is said of those that are not.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/explanation.hpp"
#include "explain/own_polygon.hpp"
#include "hinged_chain.hpp"
#include "judged_shape.hpp"

namespace dlo::compare {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::clamped;
using test::expect_named;
using test::hinged_chain;
using test::judged;
using test::JudgedShape;
using test::made;
using test::says;

// A right chain of few hinges is percents away from the rod: it is called what it is, and passes;
// one with other springs does not.
TEST(Explanation, AChainOfHingesIsRightInItsOwnWay) {
  const Scene scene = clamped();
  for (const int segments : {10, 20, 40}) {
    SCOPED_TRACE(segments);
    const double h = 1.0 / segments;
    const std::vector<double> whole(static_cast<std::size_t>(segments), h);
    const JudgedShape hinged = judged(scene, made(hinged_chain(whole, h, 1, false)));
    EXPECT_TRUE(hinged.judgement.passes()) << hinged.judgement.reason;
    EXPECT_TRUE(says(hinged.judgement.reason, {"with a hinge at the clamp", "discretisation"}));
    const JudgedShape welded = judged(scene, made(hinged_chain(whole, h, 1, true)));
    EXPECT_TRUE(welded.judgement.passes()) << welded.judgement.reason;
    EXPECT_TRUE(says(welded.judgement.reason, {"welded"}));
    std::vector<double> half(static_cast<std::size_t>(segments) + 1, h);
    half.front() = half.back() = h / 2;
    const JudgedShape middle = judged(scene, made(hinged_chain(half, h, 1, true)));
    EXPECT_TRUE(middle.judgement.passes()) << middle.judgement.reason;
    EXPECT_TRUE(middle.explanations.empty());  // near the rod itself
    expect_named("half as stiff", scene, made(hinged_chain(whole, h, 0.5, false)),
                 {"with a hinge at the clamp", "springs of 0.", "times EI/h"});
  }
}

// That is so whether or not anything is explained, and whatever else explains it.
TEST(Explanation, TheVerdictKnowsChainsWithoutAnyExplanation) {
  const Scene scene = clamped();
  const MeasuredShape right = made(hinged_chain(std::vector<double>(20, 0.05), 0.05, 1, false));
  const ShapeCheck check = check_shape(scene, right, {.modulus = ModulusSearch::no});
  for (const bool largest : {false, true}) {
    const ShapeTolerance tolerance{.allowed_m = 0.01, .largest = largest};
    EXPECT_FALSE(judge(check, tolerance).passes());
    const ShapeJudgement alone = judge_with_chains(scene, check, tolerance);
    EXPECT_TRUE(alone.passes()) << alone.reason;
    EXPECT_EQ(with_explanation(alone, explain_shape(scene, right, check, {}), tolerance).reason,
              alone.reason);
  }
  const MeasuredShape soft = made(hinged_chain(std::vector<double>(20, 0.05), 0.05, 0.8, false));
  const ShapeCheck soft_check = check_shape(scene, soft, {.modulus = ModulusSearch::no});
  const ShapeJudgement alone = judge_with_chains(scene, soft_check, {.allowed_m = 1e-3});
  EXPECT_FALSE(alone.passes());
  const ShapeJudgement explained =
      with_explanation(alone, explain_shape(scene, soft, soft_check, {}), {.allowed_m = 1e-3});
  EXPECT_FALSE(explained.passes());
  EXPECT_EQ(explained.reason.find(alone.reason), 0);
}

// Its springs are EI/h, and linear in the angle: so they are called, where the angles are large
// enough for it to show.
TEST(Explanation, AChainsSpringsAreCalledByTheirLaw) {
  Scene rope = clamped();
  rope.scale_modulus(0.2);
  const Eigen::Matrix3Xd chain = hinged_chain(std::vector<double>(20, 0.05), 0.05, 0.2, true);
  const JudgedShape outcome = judged(rope, made(chain));
  EXPECT_TRUE(outcome.judgement.passes()) << outcome.judgement.reason;
  EXPECT_TRUE(says(outcome.judgement.reason, {"its springs EI/h and linear in the angle"}));
  Shape shape;
  shape.points = chain;
  for (const OwnPolygon& one : own_polygons(rope, shape, Springs::fitted)) {
    if (one.clamp != ChainClamp::welded) continue;
    EXPECT_EQ(one.law, energy_model::JointLaw::linear);
    EXPECT_TRUE(one.law_shows);
    EXPECT_NEAR(one.stiffness, 1, 1e-3);
    EXPECT_LT(one.rms_m, 1e-5);
    for (const energy_model::JointLaw law :
         {energy_model::JointLaw::hooke, energy_model::JointLaw::binormal}) {
      for (const OwnPolygon& other : own_polygons(rope, shape, Springs::fitted, law)) {
        if (other.clamp == ChainClamp::welded) EXPECT_LT(other.stiffness, 0.997);
      }
    }
  }
}

// It is nearer to the rod than the others; a tolerance of 0.2 % tells them apart.
TEST(Explanation, AChainClampedInTheMiddleOfASegmentIsKnown) {
  std::vector<double> lengths(11, 0.1);
  lengths.front() = lengths.back() = 0.05;
  const Matrix3Xd right = hinged_chain(lengths, 0.1, 1, true);
  const JudgedShape outcome = judged(clamped(), made(right), 0.002);
  ASSERT_FALSE(outcome.explanations.empty());
  const Explanation& best = outcome.explanations.front();
  EXPECT_TRUE(says(best.cause, {"in the middle of a segment"}));
  EXPECT_LT(best.rms_m, 1e-4);
  for (const Explanation& other : outcome.explanations) {
    const bool middle = other.cause.find("in the middle of a segment") != std::string::npos;
    const bool chain = other.cause.find("a chain of") != std::string::npos;
    if (chain && !middle) {
      EXPECT_GT(other.rms_m, 10 * best.rms_m) << other.cause;
    }
  }
}

// A chain that is right but for its tip is right in the mean, and not everywhere.
TEST(Explanation, AChainIsHeldAgainstTheMeasureThatWasAsked) {
  Matrix3Xd points = hinged_chain(std::vector<double>(20, 0.05), 0.05, 1, false);
  points.rightCols<1>() += Vector3d(0.003, 0.0045, 0);
  EXPECT_TRUE(judged(clamped(), made(points)).judgement.passes());
  EXPECT_FALSE(judged(clamped(), made(points), 0.01, true).judgement.passes());
}

}  // namespace
}  // namespace dlo::compare
