// Tests of chains of hinges: those that are correct discretisations, and the diagnosis of those
// that are not.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
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
using test::clamped;
using test::expect_named;
using test::hinged_chain;
using test::judged;
using test::JudgedShape;
using test::made;
using test::says;

// A correct chain of few hinges is a few percent away from the rod. It is identified as a chain and
// passes; one with other springs does not.
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
    const ShapeJudgement alone = judge_as_chain(scene, check, tolerance).judgement;
    EXPECT_TRUE(alone.passes()) << alone.reason;
    EXPECT_EQ(with_explanation(alone, explain_shape(scene, right, check, {}), tolerance).reason,
              alone.reason);
  }
  const MeasuredShape soft = made(hinged_chain(std::vector<double>(20, 0.05), 0.05, 0.8, false));
  const ShapeCheck soft_check = check_shape(scene, soft, {.modulus = ModulusSearch::no});
  const ShapeJudgement alone = judge_as_chain(scene, soft_check, {.allowed_m = 1e-3}).judgement;
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

// This chain is nearer to the rod than the others; a tolerance of 0.2 % distinguishes them.
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

/// Returns the result of check() without E*, within 1 % of the length.
CheckResult checked(const Scene& scene, const Matrix3Xd& points,
                    Explaining explaining = Explaining::yes) {
  return check(scene, made(points),
               {.tolerance = ShapeTolerance{.allowed_m = 0.01 * scene.length},
                .explaining = explaining,
                .shape = {.modulus = ModulusSearch::no}});
}

// A chain at rest can be found from any points, since its segments are as long as the rod's share.
TEST(ChainVerdict, NeedsPointsThatAreAsLongAsTheRod) {
  const Scene scene = clamped();
  const std::vector<double> segments(32, 1.0 / 32);
  const Matrix3Xd chain = hinged_chain(segments, segments[0], 1, false);
  ASSERT_TRUE(checked(scene, chain).passes());
  for (const double factor : {1e-6, 1e-3, 0.01, 0.1, 0.5, 0.9, 1.1, 100.0}) {
    const CheckResult result = checked(scene, factor * chain, Explaining::no);
    EXPECT_EQ(result.judgement.verdict, ShapeVerdict::fail)
        << factor << ": " << result.judgement.reason;
  }
}

// Points to and fro across a chain are near it, on a polyline that is too long for the rod.
TEST(ChainVerdict, NeedsAsMuchOfTheRodAsIsAsked) {
  const Scene scene = clamped();
  const ShapeTolerance tolerance{.allowed_m = 0.005};
  Matrix3Xd chain = hinged_chain(std::vector<double>(60, 1.0 / 60), 1.0 / 60, 1, false);
  const auto compared = [&] {
    return check_shape(scene, made(chain), {.modulus = ModulusSearch::no});
  };
  ShapeCheck right = compared();
  ASSERT_FALSE(judge(right, tolerance).passes());
  EXPECT_TRUE(judge_as_chain(scene, right, tolerance).judgement.passes());
  right.seen_share = 0.4;
  EXPECT_FALSE(judge_as_chain(scene, right, tolerance).judgement.passes());
  for (Eigen::Index i = 1; i < chain.cols(); ++i) chain(2, i) = i % 2 == 0 ? 1e-3 : -1e-3;
  ShapeCheck wavy = compared();
  EXPECT_GT(wavy.polyline_length_m, 1 + tolerance.allowed_m);
  EXPECT_FALSE(judge_as_chain(scene, wavy, tolerance).judgement.passes());
  wavy.polyline_length_m = 1;
  EXPECT_TRUE(judge_as_chain(scene, wavy, tolerance).judgement.passes());
}

// From points that are crushed a search may end in a polygon with crushed segments, which is no
// chain.
TEST(ChainVerdict, AChainAtRestHasSegmentsOfItsOwnLength) {
  Shape shape;
  for (const double factor : {1e-6, 1e-3, 0.1, 1.0}) {
    shape.points = factor * hinged_chain(std::vector<double>(32, 1.0 / 32), 1.0 / 32, 1, false);
    for (const OwnPolygon& chain : own_polygons(clamped(), shape, Springs::as_the_rod)) {
      const Matrix3Xd segments = chain.rest.points.rightCols(32) - chain.rest.points.leftCols(32);
      EXPECT_LT((32 * segments.colwise().norm().array() - 1).abs().maxCoeff(), 2e-3) << factor;
    }
  }
}

// The unit is named, whichever one the file was read in.
TEST(ChainVerdict, AFileReadInAnotherUnitFailsWithTheUnitAsCause) {
  const Scene scene = clamped();
  const Matrix3Xd chain = hinged_chain(std::vector<double>(32, 1.0 / 32), 1.0 / 32, 1, false);
  std::string text = "x,y,z\n";
  for (const auto& point : chain.colwise()) {
    text += fmt::format("{:.9g},{:.9g},{:.9g}\n", point.x(), point.y(), point.z());
  }
  for (const double unit : {1e-6, 1e-3, 0.01}) {
    const CheckResult result = check(
        scene, parse_shape(text, "m.csv", unit),
        {.tolerance = ShapeTolerance{.allowed_m = 0.02}, .shape = {.modulus = ModulusSearch::no}});
    EXPECT_EQ(result.judgement.verdict, ShapeVerdict::fail);
    ASSERT_FALSE(result.explanations.empty());
    EXPECT_TRUE(says(result.explanations.front().cause, {"the file is in metres, not in "}));
  }
}

// Points of the rod's length that are no equilibrium move to one.
TEST(ChainVerdict, SmoothCurvesAreNoChains) {
  std::mt19937 random(11);
  std::normal_distribution<double> curvature(0, 2);
  for (int i = 0; i < 10; ++i) {
    Matrix3Xd points = Matrix3Xd::Zero(3, 25);
    const double k[] = {curvature(random), curvature(random), curvature(random)};
    double angle = 0.35;
    for (Eigen::Index j = 1; j < points.cols(); ++j) {
      const double s = static_cast<double>(j) / 24;
      angle += (k[0] + k[1] * std::sin(3 * s) + k[2] * std::cos(7 * s)) / 24;
      points.col(j) = points.col(j - 1) + Vector3d(std::cos(angle), std::sin(angle), 0) / 24;
    }
    const CheckResult result = checked(clamped(), points, Explaining::no);
    EXPECT_EQ(result.judgement.verdict, ShapeVerdict::fail) << result.judgement.reason;
  }
}

Scene spatial_rod() {
  return parse_scene(
      "[rod]\nlength = 1\nbending_stiffness = 1\nmass_per_length = 2\n[[gripper]]\nat = 0\n"
      "position = [0, 0, 0]\ndirection = \"30 deg\"\n[[gripper]]\nat = 1\n"
      "position = [0.6, 0.15, 0.1]\ndirection = [1, -0.5, 0.3]\n",
      "between.toml");
}

// A chain whose distance from the rod does not decrease with shorter segments: one on the other
// side of the plane that an arch has left, and one of a mirrored cantilever, for which `plan` has a
// bound.
TEST(ChainVerdict, AChainThatDoesNotConvergeToTheRodIsNone) {
  const Scene scene = parse_scene(
      "[rod]\nlength = 1\nmass_per_length = 0.5\nbending_stiffness = 0.05\n[[gripper]]\nat = 0\n"
      "position = [0, 0, 0]\ndirection = \"90 deg\"\n[[gripper]]\nat = 1\nposition = [0.5, 0, 0]\n"
      "direction = \"-90 deg\"\n",
      "arch.toml");
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
    OwnPolygon like;
    like.clamp = each.clamp;
    Shape start = {each.arc_length, {}};
    start.points = rod.sample(start.arc_length).points;
    ASSERT_GT(start.points.row(2).cwiseAbs().maxCoeff(), 0.1);
    const std::optional<Shape> chain = chain_at_rest(scene, start, like);
    ASSERT_TRUE(chain);
    const ShapeTolerance tolerance{.allowed_m = each.allowed_m};
    ShapeCheck compared = check_shape(scene, made(chain->points), {.modulus = ModulusSearch::no});
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

Scene of_chain(Scene scene, int points, energy_model::JointLaw law) {
  scene.force_model.points = points;
  scene.force_model.joint_law = law;
  return scene;
}

// Each law of model chain that has the rod's stiffness for small angles, from coarse to fine,
// within half of what the chain is away from the rod. Springs of 0.7 times EI/h are the cause where
// they move the chain by more than is allowed.
TEST(ChainVerdict, HookeanChainsPassOrAreTooCoarseAndSoftOnesFail) {
  Scene rope = clamped();
  rope.scale_modulus(0.1);
  int passed = 0;
  int tried = 0;
  for (const Scene& scene : {clamped(), rope, spatial_rod()}) {
    for (const int points : {9, 25, 61}) {
      for (const energy_model::JointLaw law :
           {energy_model::JointLaw::hooke, energy_model::JointLaw::linear,
            energy_model::JointLaw::binormal}) {
        SCOPED_TRACE(scene.file + " " + std::to_string(points) + " " + to_string(law));
        const auto judged = [&](const Scene& solved, double allowed) {
          return check(scene, made(solve(of_chain(solved, points, law), Model::chain).shape.points),
                       {.tolerance = ShapeTolerance{.allowed_m = allowed},
                        .shape = {.modulus = ModulusSearch::no}});
        };
        const double away = judged(scene, 1).judgement.judged_m;
        const CheckResult right = judged(scene, away / 2);
        EXPECT_NE(right.judgement.verdict, ShapeVerdict::fail) << right.judgement.reason;
        passed += right.passes() ? 1 : 0;
        ++tried;
        if (law != energy_model::JointLaw::linear) continue;
        Scene soft = scene;
        soft.scale_modulus(0.7);
        const CheckResult other = judged(soft, std::max(away / 2, 2e-3));
        if (other.judgement.judged_m < 4 * std::max(away, 2e-3)) continue;
        EXPECT_EQ(other.judgement.verdict, ShapeVerdict::fail);
        ASSERT_FALSE(other.explanations.empty());
        const std::string& cause = other.explanations.front().cause;
        // The rod with 0.7 times the stiffness is next to a fine chain, but for discretisation.
        const std::size_t factor = cause.find("0.");
        ASSERT_NE(factor, std::string::npos) << cause;
        EXPECT_NEAR(std::stod(cause.substr(factor)), 0.7, 0.02) << cause;
        EXPECT_TRUE(cause.find("springs of 0.") != std::string::npos ||
                    cause.find("bending stiffness is 0.") != std::string::npos)
            << cause;
      }
    }
  }
  EXPECT_GE(passed, tried * 3 / 4);
}

// The force of a yielding floor on a point is that of a whole segment. With that of l/N the chain
// would be 4 % deeper in it.
TEST(ChainVerdict, AChainOnAYieldingFloorHasThatFloorsForces) {
  const std::string rod = "[rod]\nlength = 1\nbending_stiffness = 0.1\nmass_per_length = 2\n";
  const std::string clamp = "[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = [1, 0, 0]\n";
  const std::string floor =
      "[[obstacle]]\nshape = \"plane\"\npoint = [0, -0.05, 0]\nnormal = [0, 1, 0]\n"
      "stiffness = 400\n";
  const Scene scene =
      of_chain(parse_scene(rod + clamp + floor, "floor.toml"), 15, energy_model::JointLaw::hooke);
  const Shape shape = solve(scene, Model::chain).shape;
  ASSERT_LT(shape.points.row(1).minCoeff(), -0.08);
  const auto chains =
      own_polygons(scene, shape, Springs::as_the_rod, energy_model::JointLaw::hooke);
  const auto nearest = std::ranges::min_element(chains, {}, &OwnPolygon::rms_m);
  ASSERT_NE(nearest, chains.end());
  EXPECT_EQ(nearest->clamp, ChainClamp::middle);
  EXPECT_LT(nearest->rms_m, 5e-5);
}

// The laws of a chain of few segments differ by more than the twentieth of its length.
TEST(ChainVerdict, TheLawOfACoarseChainIsFoundFarFromTheOthers) {
  Scene upwards = clamped();
  upwards.grippers.front().direction = {std::cos(1.5), std::sin(1.5), 0};
  upwards.scale_modulus(0.02);
  const Scene scene = of_chain(upwards, 6, energy_model::JointLaw::binormal);
  const Shape shape = solve(scene, Model::chain).shape;
  const auto away_with = [&](std::optional<energy_model::JointLaw> law) {
    const auto chains = own_polygons(scene, shape, Springs::as_the_rod, law);
    const auto nearest = std::ranges::min_element(chains, {}, &OwnPolygon::rms_m);
    return nearest == chains.end() ? NAN : nearest->rms_m;
  };
  EXPECT_GT(away_with(energy_model::JointLaw::linear), 0.05);
  EXPECT_LT(away_with(std::nullopt), 1e-5);
}

Scene clamped_inside(const std::string& others) {
  return parse_scene(
      "[rod]\nlength = 1\nbending_stiffness = 0.1\nmass_per_length = 0.5\n[[gripper]]\nat = "
      "0.637\nposition = [0.5, 0, 0]\ndirection = \"50 deg\"\n" +
          others,
      "inside.toml");
}

// A clamp inside the rod holds the segment whose middle it is at, or the one behind its point. The
// segments of one span are not as long as those of another, neither in the file nor when they are
// bisected.
TEST(ChainVerdict, ChainsWithAClampInsideTheRodPassAndSoftOnesFail) {
  const std::string first = "[[gripper]]\nat = 0\nposition = [0, 0.1, 0]\n";
  for (const std::string others : {"", "hold = \"pin\"\n", "direction = \"20 deg\"\n"}) {
    Scene scene = clamped_inside(others.empty() ? "" : first + others);
    // Without weight, which the paper's points share equally.
    scene.gravity.setZero();
    for (const double at : {0.2, 1.0}) scene.loads.push_back({.at = at, .force = {0, -0.5, 0.2}});
    for (const Bookkeeping bookkeeping : {Bookkeeping::consistent, Bookkeeping::paper}) {
      SCOPED_TRACE(others + to_string(bookkeeping));
      const auto judged_at = [&](const Scene& solved, double allowed) {
        Scene chain = of_chain(solved, 27, energy_model::JointLaw::linear);
        chain.force_model.bookkeeping = bookkeeping;
        return check(scene, made(solve(chain, Model::chain).shape.points),
                     {.tolerance = ShapeTolerance{.allowed_m = allowed},
                      .explaining = Explaining::no,
                      .shape = {.modulus = ModulusSearch::no}})
            .judgement;
      };
      const double away = judged_at(scene, 1).judged_m;
      const ShapeJudgement right = judged_at(scene, away / 2);
      EXPECT_TRUE(right.passes()) << right.reason;
      Scene soft = scene;
      soft.scale_modulus(0.5);
      const ShapeJudgement other = judged_at(soft, std::max(away / 2, 2e-3));
      EXPECT_EQ(other.verdict, ShapeVerdict::fail) << other.reason;
    }
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
  Matrix3Xd points =
      solve(of_chain(scene, 13, energy_model::JointLaw::hooke), Model::chain).shape.points;
  const double away = checked(scene, points, Explaining::no).judgement.judged_m;
  points.rightCols<1>() += 1e-4 * (points.col(points.cols() - 1) - points.col(points.cols() - 2));
  const CheckResult result = check(scene, made(points),
                                   {.tolerance = ShapeTolerance{.allowed_m = away / 2},
                                    .explaining = Explaining::no,
                                    .shape = {.modulus = ModulusSearch::no}});
  EXPECT_NE(result.judgement.verdict, ShapeVerdict::fail) << result.judgement.reason;
}

// A rope with a Gamma of 1000 is bent within less than a coarse chain's first segment.
TEST(ChainVerdict, AChainOfAnotherOrderIsTooCoarse) {
  Scene rope = clamped();
  rope.scale_modulus(0.5 * 9.81 / 1000);
  for (const int segments : {6, 8}) {
    Shape start = {equal_arc_lengths(1, segments + 1), {}};
    start.points = solve_reference(rope, Model::energy).sample(start.arc_length).points;
    const std::optional<Shape> chain = chain_at_rest(rope, start, {});
    ASSERT_TRUE(chain);
    const CheckResult result = checked(rope, chain->points, Explaining::no);
    EXPECT_EQ(result.judgement.verdict, ShapeVerdict::undetermined);
    EXPECT_TRUE(says(result.judgement.reason, {"too coarse to judge", "mm = ", "segments"}));
  }
}

// The paper's joints have another stiffness with every number of segments.
TEST(ChainVerdict, AChainWithThePapersLawFailsWithItAsCause) {
  for (const Bookkeeping bookkeeping : {Bookkeeping::paper, Bookkeeping::consistent}) {
    Scene scene = clamped();
    scene.force_model.points = 25;
    scene.force_model.law = BendingLaw::paper;
    scene.force_model.bookkeeping = bookkeeping;
    const CheckResult result = checked(scene, solve(scene, Model::chain).shape.points);
    EXPECT_EQ(result.judgement.verdict, ShapeVerdict::fail);
    ASSERT_FALSE(result.explanations.empty());
    EXPECT_TRUE(says(result.explanations.front().cause, {"the paper's joint law"}));
  }
}

// Bodies begin at their joints: the last one's end is no body's begin, in any scene.
TEST(ChainVerdict, AMissingLastEndIsAppended) {
  const Matrix3Xd chain = hinged_chain(std::vector<double>(20, 0.05), 0.05, 1, false);
  const CheckResult result = checked(clamped(), chain.leftCols(20));
  EXPECT_TRUE(result.passes()) << result.judgement.reason;
  ASSERT_EQ(result.notes.size(), 1U);
  EXPECT_TRUE(says(result.notes[0], {"20 points", "end of the last one is appended"}));
  EXPECT_LT((result.check.alignment.shape.points.col(20) - chain.col(20)).norm(), 1e-4);
  // The first point is at the clamp, and many points are no shorter than the rod.
  EXPECT_TRUE(checked(clamped(), chain.rightCols(20)).notes.empty());
  const Matrix3Xd rod =
      solve_reference(clamped(), Model::energy).sample(equal_arc_lengths(1, 101)).points;
  EXPECT_TRUE(checked(clamped(), rod).notes.empty());
  EXPECT_EQ(checked(clamped(), rod.leftCols(100)).notes.size(), 1U);
}

// Three coordinates of a point say as much of three numbers as of one.
TEST(ChainVerdict, OneMeasuredPointIsJudgedByItsDistance) {
  const Vector3d tip =
      solve_reference(clamped(), Model::energy).sample(std::vector<double>{1}).points.col(0);
  Matrix3Xd points = Matrix3Xd::Zero(3, 2);
  points.col(1) = tip + Vector3d(0, 0.03, 0.04);
  const CheckResult result = checked(clamped(), points);
  EXPECT_EQ(result.judgement.verdict, ShapeVerdict::fail);
  EXPECT_NEAR(result.judgement.judged_m, 0.05, 2e-3);
  for (const Explanation& cause : result.explanations) EXPECT_LE(cause.numbers, 1) << cause.cause;
  points.col(1) = tip + Vector3d(0, 0.003, 0.004);
  EXPECT_LT(checked(clamped(), points).judgement.judged_m, 0.005 + 1e-9);
}

TEST(ChainVerdict, AFileThatPassesHasNoCauseAndNoHint) {
  const Matrix3Xd chain = hinged_chain(std::vector<double>(10, 0.1), 0.1, 1, false);
  const CheckResult result =
      check(clamped(), made(chain), {.tolerance = ShapeTolerance{.allowed_m = 0.01}});
  EXPECT_TRUE(result.passes());
  EXPECT_TRUE(result.explanations.empty());
  EXPECT_TRUE(result.check.hint.empty()) << result.check.hint;
  // E* would be that of the discretisation.
  ASSERT_TRUE(is_identified(result.check.effective_modulus.optimum));
  ASSERT_TRUE(result.supersedes_modulus);
  EXPECT_TRUE(says(result.supersedes_modulus->cause, {"a chain of 10 segments"}));
}

}  // namespace
}  // namespace dlo::compare
