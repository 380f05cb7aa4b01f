// Tests of chains of hinges: those that are correct discretisations, and the diagnosis of those
// that are not.

#include <gtest/gtest.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/check.hpp"
#include "dlo/compare/explanation.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solve.hpp"
#include "explain/own_polygon.hpp"
#include "hinged_chain.hpp"
#include "judged_shape.hpp"

namespace dlo::compare {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Returns the lengths of equal segments of a rod of 1 m.
std::vector<double> equal_segments(int segments) {
  return std::vector<double>(static_cast<std::size_t>(segments), 1.0 / segments);
}

// A correct chain of few hinges deviates from the rod by a few percent. The diagnosis identifies it
// as a chain, and it passes; a chain with other springs does not.
TEST(Explanation, AChainOfHingesIsRightInItsOwnWay) {
  const Scene scene = clamped();
  for (const int segments : {10, 20, 40}) {
    SCOPED_TRACE(segments);
    const double h = 1.0 / segments;
    for (const bool welded : {false, true}) {
      const ShapeJudgement whole =
          judge_shape(scene, file_shape(hinged_chain(equal_segments(segments), h, 1, welded)))
              .judgement;
      EXPECT_TRUE(whole.passes()) << whole.reason;
      EXPECT_TRUE(has_all(whole.reason,
                          {welded ? "welded" : "with a hinge at the clamp", "discretisation"}));
    }
    std::vector<double> half(static_cast<std::size_t>(segments) + 1, h);
    half.front() = half.back() = h / 2;
    const JudgedShape middle = judge_shape(scene, file_shape(hinged_chain(half, h, 1, true)));
    EXPECT_TRUE(middle.judgement.passes()) << middle.judgement.reason;
    EXPECT_TRUE(middle.explanations.empty());  // near the rod itself
    expect_cause("half as stiff", scene,
                 file_shape(hinged_chain(equal_segments(segments), h, 0.5, false)),
                 {"with a hinge at the clamp", "springs of 0.", "times EI/h"});
  }
}

// judge_as_chain() gives the same verdict whether or not explanations are searched, and whichever
// are found.
TEST(Explanation, TheVerdictKnowsChainsWithoutAnyExplanation) {
  const Scene scene = clamped();
  const MeasuredShape right = file_shape(hinged_chain(equal_segments(20), 0.05, 1, false));
  const ShapeCheck check = check_shape(scene, right, {.modulus = ModulusSearch::no});
  for (const bool largest : {false, true}) {
    const ShapeTolerance tolerance{.allowed_m = 0.01, .largest = largest};
    EXPECT_FALSE(judge(check, tolerance).passes());
    const ShapeJudgement alone = judge_as_chain(scene, check, tolerance).judgement;
    EXPECT_TRUE(alone.passes()) << alone.reason;
    EXPECT_EQ(with_explanation(alone, explain_shape(scene, right, check, {}), tolerance).reason,
              alone.reason);
  }
  const MeasuredShape soft = file_shape(hinged_chain(equal_segments(20), 0.05, 0.8, false));
  const ShapeCheck soft_check = check_shape(scene, soft, {.modulus = ModulusSearch::no});
  const ShapeJudgement alone = judge_as_chain(scene, soft_check, {.allowed_m = 1e-3}).judgement;
  EXPECT_FALSE(alone.passes());
  const ShapeJudgement explained =
      with_explanation(alone, explain_shape(scene, soft, soft_check, {}), {.allowed_m = 1e-3});
  EXPECT_FALSE(explained.passes());
  EXPECT_EQ(explained.reason.find(alone.reason), 0);
}

// The springs are EI/h and linear in the angle. The reason names this law if the angles are large
// enough to distinguish laws.
TEST(Explanation, AChainsSpringsAreCalledByTheirLaw) {
  Scene rope = clamped();
  rope.scale_modulus(0.2);
  const JudgedShape outcome =
      judge_shape(rope, file_shape(hinged_chain(equal_segments(20), 0.05, 0.2, true)));
  EXPECT_TRUE(outcome.judgement.passes()) << outcome.judgement.reason;
  EXPECT_TRUE(has_all(outcome.judgement.reason, {"its springs EI/h and linear in the angle"}));
}

// A chain that is clamped in the middle of a segment is nearer to the rod than other chains; a
// tolerance of 0.2 % distinguishes them.
TEST(Explanation, AChainClampedInTheMiddleOfASegmentIsKnown) {
  std::vector<double> lengths(11, 0.1);
  lengths.front() = lengths.back() = 0.05;
  const Matrix3Xd right = hinged_chain(lengths, 0.1, 1, true);
  const JudgedShape outcome = judge_shape(clamped(), file_shape(right), 0.002);
  ASSERT_FALSE(outcome.explanations.empty());
  const Explanation& best = outcome.explanations.front();
  EXPECT_TRUE(has_all(best.cause, {"in the middle of a segment"}));
  EXPECT_LT(best.rms_m, 1e-4);
  for (const Explanation& other : outcome.explanations) {
    if (other.cause.find("a chain of") == std::string::npos ||
        other.cause.find("in the middle of a segment") != std::string::npos) {
      continue;
    }
    EXPECT_GT(other.rms_m, 10 * best.rms_m) << other.cause;
  }
}

// Only the tip of the chain is wrong: its RMS deviation passes, its largest deviation does not.
TEST(Explanation, AChainIsHeldAgainstTheMeasureThatWasAsked) {
  Matrix3Xd points = hinged_chain(equal_segments(20), 0.05, 1, false);
  points.rightCols<1>() += Vector3d(0.003, 0.0045, 0);
  EXPECT_TRUE(judge_shape(clamped(), file_shape(points)).judgement.passes());
  EXPECT_FALSE(judge_shape(clamped(), file_shape(points), 0.01, true).judgement.passes());
}

/// Returns the result of check() without E*.
CheckResult check_without_modulus(const Scene& scene, const Matrix3Xd& points,
                                  Explaining explaining = Explaining::yes,
                                  double allowed_m = 0.01) {
  return check(scene, file_shape(points),
               {.tolerance = ShapeTolerance{.allowed_m = allowed_m},
                .explaining = explaining,
                .shape = {.modulus = ModulusSearch::no}});
}

// Points of the wrong length do not pass, although a chain at rest can be computed for them: the
// length of its segments is that of the rod divided by their number.
TEST(ChainVerdict, NeedsPointsThatAreAsLongAsTheRod) {
  const Scene scene = clamped();
  const Matrix3Xd chain = hinged_chain(equal_segments(32), 1.0 / 32, 1, false);
  ASSERT_TRUE(check_without_modulus(scene, chain).passes());
  for (const double factor : {1e-6, 1e-3, 0.01, 0.1, 0.5, 0.9, 1.1, 100.0}) {
    const CheckResult result = check_without_modulus(scene, factor * chain, Explaining::no);
    EXPECT_EQ(result.judgement.verdict, ShapeVerdict::fail)
        << factor << ": " << result.judgement.reason;
  }
}

// Points that alternate between the two sides of a chain are near it, but their polyline is too
// long.
TEST(ChainVerdict, NeedsAsMuchOfTheRodAsIsAsked) {
  const Scene scene = clamped();
  const ShapeTolerance tolerance{.allowed_m = 0.005};
  Matrix3Xd chain = hinged_chain(equal_segments(60), 1.0 / 60, 1, false);
  const auto compared = [&] {
    return check_shape(scene, file_shape(chain), {.modulus = ModulusSearch::no});
  };
  ShapeCheck right = compared();
  ASSERT_FALSE(judge(right, tolerance).passes());
  EXPECT_TRUE(judge_as_chain(scene, right, tolerance).judgement.passes());
  right.observed_share = 0.4;
  EXPECT_FALSE(judge_as_chain(scene, right, tolerance).judgement.passes());
  for (Eigen::Index i = 1; i < chain.cols(); ++i) chain(2, i) = i % 2 == 0 ? 1e-3 : -1e-3;
  ShapeCheck wavy = compared();
  EXPECT_GT(wavy.polyline_length_m, 1 + tolerance.allowed_m);
  EXPECT_FALSE(judge_as_chain(scene, wavy, tolerance).judgement.passes());
  wavy.polyline_length_m = 1;
  EXPECT_TRUE(judge_as_chain(scene, wavy, tolerance).judgement.passes());
}

// The unit is named, whichever one the file was read in.
TEST(ChainVerdict, AFileReadInAnotherUnitFailsWithTheUnitAsCause) {
  const Scene scene = clamped();
  const Matrix3Xd chain = hinged_chain(equal_segments(32), 1.0 / 32, 1, false);
  for (const double unit : {1e-6, 1e-3, 0.01}) {
    MeasuredShape shape = file_shape(unit * chain);
    shape.unit = unit;
    const CheckResult result = check(
        scene, shape,
        {.tolerance = ShapeTolerance{.allowed_m = 0.02}, .shape = {.modulus = ModulusSearch::no}});
    EXPECT_EQ(result.judgement.verdict, ShapeVerdict::fail);
    ASSERT_FALSE(result.explanations.empty());
    EXPECT_TRUE(has_all(result.explanations.front().cause, {"the file is in metres, not in "}));
  }
}

// A rod that buckles out of its plane has an equilibrium on either side of the plane. The distance
// between a chain on one side and the rod on the other does not decrease with the length of the
// segments. The bound of `plan` applies to chains whose clamps hold the middles of segments.
TEST(ChainVerdict, AChainThatDoesNotConvergeToTheRodIsNone) {
  const Scene scene = clamped_arch(0.05);
  const energy_model::Equilibrium rod = solve_reference(scene, Model::energy);
  std::vector<double> half_at_clamps = {0};
  for (int i = 0; i < 29; ++i) half_at_clamps.push_back((i + 0.5) / 29);
  half_at_clamps.push_back(1);
  struct Case {
    ChainClamp clamp;
    std::vector<double> arc_length;
    double allowed_m;
  };
  for (const Case& each : {Case{ChainClamp::welded, equal_arc_lengths(1, 31), 0.005},
                           Case{ChainClamp::middle, half_at_clamps, 0.0005}}) {
    SCOPED_TRACE(each.allowed_m);
    CandidateChain like;
    like.clamp = each.clamp;
    Shape start = {each.arc_length, {}};
    start.points = rod.sample(start.arc_length).points;
    ASSERT_GT(start.points.row(2).cwiseAbs().maxCoeff(), 0.1);
    const std::optional<Shape> chain = chain_at_rest(scene, start, like);
    ASSERT_TRUE(chain);
    const ShapeTolerance tolerance{.allowed_m = each.allowed_m};
    ShapeCheck compared =
        check_shape(scene, file_shape(chain->points), {.modulus = ModulusSearch::no});
    ASSERT_FALSE(judge(compared, tolerance).passes());
    EXPECT_TRUE(judge_as_chain(scene, compared, tolerance).judgement.passes());
    const energy_model::Equilibrium right = compared.rod;
    compared.rod.sample = [right](std::span<const double> s) {
      energy_model::Samples samples = right.sample(s);
      for (Eigen::Matrix3Xd* mirrored : {&samples.points, &samples.tangents, &samples.curvature}) {
        mirrored->row(2) *= -1;
      }
      return samples;
    };
    EXPECT_EQ(judge_as_chain(scene, compared, tolerance).judgement.verdict, ShapeVerdict::fail);
    compared.rod = right;
    compared.rod.status = energy_model::SolveStatus::not_verified;
    EXPECT_EQ(judge_as_chain(scene, compared, tolerance).judgement.verdict, ShapeVerdict::fail);
  }
}

// The segments of model chain are strained by its finite c_c, so that the pin is not at the arc
// length that equal shares of the file's polyline have.
TEST(ChainVerdict, AChainMayBeStrainedBetweenItsGrippers) {
  const Scene scene = parse_scene(
      "[rod]\nlength = 1\nbending_stiffness = 0.1\nmass_per_length = 0.5\n[[gripper]]\nat = 0\n"
      "position = [0, 0, 0]\ndirection = \"20 deg\"\n[[gripper]]\nat = 0.7\n"
      "position = [0.5, 0, 0]\nhold = \"pin\"\n",
      "pin.toml");
  Scene coarse = scene;
  coarse.force_model.points = 13;
  Matrix3Xd points = solve(coarse, Model::chain).shape.points;
  const double away = check_without_modulus(scene, points, Explaining::no).judgement.judged_m;
  points.rightCols<1>() += 1e-4 * (points.col(points.cols() - 1) - points.col(points.cols() - 2));
  const CheckResult result = check_without_modulus(scene, points, Explaining::no, away / 2);
  EXPECT_NE(result.judgement.verdict, ShapeVerdict::fail) << result.judgement.reason;
}

// A rope with a Gamma of 1000 is bent within less than a coarse chain's first segment.
TEST(ChainVerdict, AChainOfAnotherOrderIsTooCoarse) {
  Scene rope = clamped();
  rope.scale_modulus(0.5 * 9.81 / 1000);
  for (const int segments : {6, 8}) {
    const Shape start = {equal_arc_lengths(1, segments + 1), exact_file(rope, segments + 1).points};
    const std::optional<Shape> chain = chain_at_rest(rope, start, {});
    ASSERT_TRUE(chain);
    const CheckResult result = check_without_modulus(rope, chain->points, Explaining::no);
    EXPECT_EQ(result.judgement.verdict, ShapeVerdict::undetermined);
    EXPECT_TRUE(has_all(result.judgement.reason, {"too coarse to judge", "mm = ", "segments"}));
  }
}

// The paper's joints have another stiffness with every number of segments.
TEST(ChainVerdict, AChainWithThePapersLawFailsWithItAsCause) {
  for (const Bookkeeping bookkeeping : {Bookkeeping::paper, Bookkeeping::consistent}) {
    Scene scene = clamped();
    scene.force_model.points = 25;
    scene.force_model.law = BendingLaw::paper;
    scene.force_model.bookkeeping = bookkeeping;
    const CheckResult result =
        check_without_modulus(scene, solve(scene, Model::chain).shape.points);
    EXPECT_EQ(result.judgement.verdict, ShapeVerdict::fail);
    ASSERT_FALSE(result.explanations.empty());
    EXPECT_TRUE(has_all(result.explanations.front().cause, {"the paper's joint law"}));
  }
}

// A file of body positions has the begins of all segments, but not the end of the last segment.
TEST(ChainVerdict, AMissingLastEndIsAppended) {
  const Matrix3Xd chain = hinged_chain(equal_segments(20), 0.05, 1, false);
  const CheckResult result = check_without_modulus(clamped(), chain.leftCols(20));
  EXPECT_TRUE(result.passes()) << result.judgement.reason;
  ASSERT_EQ(result.notes.size(), 1U);
  EXPECT_TRUE(has_all(result.notes[0], {"20 points", "end of the last segment is appended"}));
  EXPECT_LT((result.check.alignment.shape.points.col(20) - chain.col(20)).norm(), 1e-4);
  // Nothing is appended if the first point of a chain is missing, or if so many points are given
  // that the polyline is as long as the rod.
  EXPECT_TRUE(check_without_modulus(clamped(), chain.rightCols(20)).notes.empty());
  const Matrix3Xd rod = exact_file(clamped(), 101).points;
  EXPECT_TRUE(check_without_modulus(clamped(), rod).notes.empty());
  EXPECT_EQ(check_without_modulus(clamped(), rod.leftCols(100)).notes.size(), 1U);
}

// A file without its last point is extended straight, but the chain has a joint before that point.
TEST(ChainVerdict, AMissingLastPointIsTheChains) {
  const Matrix3Xd chain = hinged_chain(std::vector<double>(8, 0.125), 0.125, 1, false);
  Shape file{equal_arc_lengths(1, 9), chain};
  file.points.col(8) = 2 * chain.col(7) - chain.col(6);
  EXPECT_GT((file.points.col(8) - chain.col(8)).norm(), 3e-4);
  for (const Springs springs : {Springs::rod_stiffness, Springs::fitted}) {
    const std::vector<CandidateChain> found = candidate_chains(
        clamped(), file, springs, energy_model::JointLaw::linear, LastPoint::missing);
    ASSERT_FALSE(found.empty());
    EXPECT_LT(found.front().max_m, 1e-5);
    EXPECT_LT((found.front().rest.points - chain).colwise().norm().maxCoeff(), 1e-5);
  }
}

// A chain whose second point is at the clamp would have a first segment of length 0.
TEST(ChainVerdict, APointBehindTheClampIsNoChainsPoint) {
  const Matrix3Xd chain = hinged_chain(equal_segments(20), 0.05, 0.5, true);
  Matrix3Xd points(3, 22);
  points << Vector3d(-0.03, -0.01, 0), chain;
  EXPECT_EQ(check_without_modulus(clamped(), points).judgement.verdict, ShapeVerdict::fail);
}

// One measured point has three coordinates, so a cause with three fitted numbers always fits it.
TEST(ChainVerdict, OneMeasuredPointIsJudgedByItsDistance) {
  const Vector3d tip = exact_file(clamped(), 2).points.col(1);
  Matrix3Xd points = Matrix3Xd::Zero(3, 2);
  points.col(1) = tip + Vector3d(0, 0.03, 0.04);
  const CheckResult result = check_without_modulus(clamped(), points);
  EXPECT_EQ(result.judgement.verdict, ShapeVerdict::fail);
  EXPECT_NEAR(result.judgement.judged_m, 0.05, 2e-3);
  for (const Explanation& cause : result.explanations) EXPECT_LE(cause.numbers, 1) << cause.cause;
  points.col(1) = tip + Vector3d(0, 0.003, 0.004);
  EXPECT_LT(check_without_modulus(clamped(), points).judgement.judged_m, 0.005 + 1e-9);
}

TEST(ChainVerdict, AFileThatPassesHasNoCauseAndNoHint) {
  const Matrix3Xd chain = hinged_chain(equal_segments(10), 0.1, 1, false);
  const CheckResult result =
      check(clamped(), file_shape(chain), {.tolerance = ShapeTolerance{.allowed_m = 0.01}});
  EXPECT_TRUE(result.passes());
  EXPECT_TRUE(result.explanations.empty());
  EXPECT_TRUE(result.check.hint.empty()) << result.check.hint;
  // E* would describe the discretisation error, not the material; the cause "a chain" supersedes
  // it.
  ASSERT_TRUE(is_identified(result.check.effective_modulus.optimum));
  ASSERT_TRUE(result.superseding_cause);
  EXPECT_TRUE(has_all(result.superseding_cause->cause, {"a chain of 10 segments"}));
}

}  // namespace
}  // namespace dlo::compare
