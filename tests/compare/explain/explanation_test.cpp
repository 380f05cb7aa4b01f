// Shapes that are wrong in one way, and what is said of them; chains that are right in theirs.

#include "dlo/compare/explanation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/scene_file.hpp"
#include "explain/own_polygon.hpp"
#include "hinged_chain.hpp"

namespace dlo::compare {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::HingedChain;
using test::says;

constexpr double degree = std::numbers::pi / 180;

Scene clamped(const std::string& rod = "") {
  return parse_scene("[rod]\nlength = 1\nbending_stiffness = 1\nmass_per_length = 0.5\n" + rod +
                         "[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = \"20 deg\"\n",
                     "clamped.toml");
}

Scene between_clamps(const std::string& rod = "", const std::string& last = "") {
  return parse_scene(
      "[rod]\nlength = 1\nbending_stiffness = 1\nmass_per_length = 0.5\n" + rod +
          "[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = \"30 deg\"\n" +
          (last.empty() ? "" : "roll = 0\n") +
          "[[gripper]]\nat = 1\nposition = [0.7, 0.1, 0]\ndirection = \"-20 deg\"\n" + last,
      "between.toml");
}

MeasuredShape shape_of(const Scene& scene, int count = 41) {
  const energy_model::Equilibrium rod = solve_reference(scene, Model::energy);
  MeasuredShape shape;
  shape.file = "mine.csv";
  shape.points = rod.sample(equal_arc_lengths(scene.length, count)).points;
  return shape;
}

MeasuredShape made(Matrix3Xd points) {
  MeasuredShape shape;
  shape.file = "mine.csv";
  shape.points = std::move(points);
  return shape;
}

struct Outcome {
  ShapeJudgement judgement;
  std::vector<Explanation> explanations;
};

Outcome judged(const Scene& scene, const MeasuredShape& shape, double share = 0.01,
               bool largest = false) {
  const ShapeCheckOptions options{.modulus = ModulusSearch::no};
  const ShapeCheck check = check_shape(scene, shape, options);
  const ShapeTolerance tolerance{.allowed_m = share * scene.length, .largest = largest};
  Outcome outcome;
  if (!judge(check, tolerance).pass) {
    outcome.explanations = explain_shape(scene, shape, check, options);
  }
  outcome.judgement =
      with_explanation(judge_with_chains(scene, check, tolerance), outcome.explanations, tolerance);
  return outcome;
}

/// Fails, and the best explanation has these words and leaves less than a tenth of the tolerance.
void expect_named(const std::string& what, const Scene& scene, const MeasuredShape& shape,
                  const std::vector<std::string>& words, double left_m = 1e-3) {
  SCOPED_TRACE(what);
  const Outcome outcome = judged(scene, shape);
  EXPECT_FALSE(outcome.judgement.pass);
  ASSERT_FALSE(outcome.explanations.empty()) << outcome.judgement.reason;
  const Explanation& best = outcome.explanations.front();
  for (const std::string& word : words) {
    EXPECT_TRUE(says(best.cause, {word}));
    EXPECT_TRUE(says(outcome.judgement.reason, {word}));
  }
  EXPECT_LT(best.rms_m, left_m);
}

TEST(Explanation, NamesWhatIsWrongWithAFile) {
  const Scene scene = clamped();
  const Matrix3Xd right = shape_of(scene).points;
  Matrix3Xd wrong = right;
  wrong.rightCols<1>() = right.col(39) + Vector3d(-0.02, 0.1, 0);
  expect_named("a hook", scene, made(wrong), {"last point", "hook"});
  expect_named("stretched", scene, made(1.02 * right), {"stretched by 2 %"});
  expect_named("much stretched", scene, made(1.1 * right), {"stretched by 10 %"});
  expect_named("compressed", scene, made(right / 1.1), {"compressed"});
  expect_named("cut off", scene, made(right.leftCols(33)), {"cut off", "s = 0 to 0.8 m"});
  const auto axes = [&right](const Vector3d& x, const Vector3d& y, const Vector3d& z) {
    Matrix3d to;
    to << x, y, z;
    return made(to * right);
  };
  const Vector3d x = Vector3d::UnitX();
  const Vector3d y = Vector3d::UnitY();
  const Vector3d z = Vector3d::UnitZ();
  expect_named("mirrored", scene, axes(-x, y, z), {"mirrored", "x is the file's -x"});
  expect_named("z up", scene, axes(x, z, -y), {"z is up in the file", "z is the file's -y"});
  expect_named("y down", scene, axes(x, -y, z), {"y is down in the file"});
  expect_named("mm", scene, made(1000 * right), {"in mm"});
  expect_named("cm", scene, made(100 * right), {"in cm"});
  expect_named("inches", scene, made(right / 0.0254), {"in inches"});
  Matrix3Xd pixels = 800 * right;
  pixels.row(1) *= -1;
  pixels.colwise() += Vector3d(320, 240, 0);
  expect_named("pixels", scene, made(pixels), {"1.25 mm", "y down", "pixels"});
  // A picture's vertical is the scene's, whichever that is.
  Scene z_up = scene;
  z_up.gravity = {0, 0, -9.81};
  z_up.grippers[0].direction = {std::cos(20 * degree), 0, std::sin(20 * degree)};
  expect_named("pixels, z up", z_up, made(pixels), {"1.25 mm", "y down", "pixels"});
  expect_named("y down from a corner", scene, made(pixels / 800), {"y is down", "another origin"});
  std::vector<Eigen::Index> rows(41);
  std::iota(rows.begin(), rows.end(), Eigen::Index{0});
  std::swap(rows[3], rows[30]);
  std::swap(rows[11], rows[20]);
  expect_named("out of order", scene, made(right(Eigen::all, rows)),
               {"out of order", "1, 2, 3, 31, 5, 6, .."});
  // Bodies of a chain begin at their joints: the last one's end is no body's begin.
  const Matrix3Xd joints = shape_of(scene, 7).points;
  expect_named("no last point", scene, made(joints.leftCols(6)),
               {"an end point is missing", "xpos"}, 2e-3);
  expect_named("moved", scene, made(right.colwise() + Vector3d(0, 0.015, 0)),
               {"another origin", "gripper is elsewhere", "-15"});
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 0.01);
  const Matrix3Xd noise = Matrix3Xd::NullaryExpr(3, 41, [&] { return normal(random); });
  expect_named("noise", scene, made(right + noise), {"noise"}, 0.01);
  MeasuredShape against = made(right);
  against.arc_length = equal_arc_lengths(1, 41);
  EXPECT_TRUE(judged(scene, against).judgement.pass);
}

// How far a file is that was read in a wrong way says nothing: what is wrong with it comes first.
TEST(Explanation, AFileThatIsReadWronglyIsNamedFirst) {
  const Scene scene = clamped();
  const Outcome wrong = judged(scene, made(1000 * shape_of(scene).points));
  EXPECT_TRUE(
      says(wrong.judgement.reason, {"mm if the file is in mm, not in metres; as it was read: "}));
  EXPECT_EQ(wrong.judgement.reason.find("RMS"), 0U) << wrong.judgement.reason;
  // Here the scene is wrong as well.
  Scene softer = scene;
  softer.scale_modulus(0.3);
  const Outcome other = judged(scene, shape_of(softer));
  EXPECT_TRUE(says(other.judgement.reason, {"; it would be "}));
}

TEST(Explanation, NamesWhatIsAnotherScene) {
  const Scene scene = clamped();
  const auto other = [&scene](const std::function<void(Scene&)>& change) {
    Scene changed = scene;
    change(changed);
    return shape_of(changed);
  };
  expect_named("softer", scene, other([](Scene& s) { s.scale_modulus(0.5); }),
               {"bending stiffness is 0.5 times", "weight 2 times"});
  expect_named("turned", scene, other([](Scene& s) {
                 s.grippers[0].direction = {std::cos(25 * degree), std::sin(25 * degree), 0};
               }),
               {"gripper 1 is rotated by 5 deg"});
  expect_named("curved", scene,
               shape_of(clamped("natural_curvature = 1\ntorsional_stiffness = 1\n")),
               {"intrinsically curved, 1 1/m"});
  expect_named("another gravity", scene, other([](Scene& s) {
                 s.gravity = {0, 0, -9.81};
               }),
               {"gravity is", "-9.81", "rotated by 90 deg"});
  Scene longer = scene;
  longer.length = 1.2;
  expect_named("longer", scene, shape_of(longer), {"1.2 m long"});
  expect_named("another rod", scene, other([](Scene& s) {
                 s.scale_modulus(3);
                 s.scale_density(0.4);
               }),
               {"bending stiffness is 7.5 times"});

  const Scene two = between_clamps();
  Scene moved = two;
  moved.grippers[1].position.y() += 0.03;
  expect_named("moved gripper", two, shape_of(moved), {"gripper 2 is 30 mm away"});
  expect_named("twisted", two,
               shape_of(between_clamps("torsional_stiffness = 0.76923\n", "roll = \"90 deg\"\n")),
               {"gripper 2 turns the rod", "90 deg (twist)"});
}

/// A rod between two grippers 0.7 l apart, held as said: "hold = \"pin\"" or a direction.
Scene held(const std::string& first, const std::string& last) {
  return parse_scene(
      "[rod]\nlength = 1\nbending_stiffness = 0.05\nmass_per_length = 0.5\n[[gripper]]\nat = "
      "0\nposition = [0, 0, 0]\n" +
          first + "\n[[gripper]]\nat = 1\nposition = [0.7, 0.1, 0]\n" + last + "\n",
      "held.toml");
}

TEST(Explanation, NamesAPinThatIsAClampAndTheReverse) {
  const std::string pin = "hold = \"pin\"";
  const std::string level = "direction = \"0 deg\"";
  const std::string up = "direction = \"40 deg\"";
  expect_named("a pin holds", held(pin, pin), shape_of(held(level, pin)),
               {"gripper 1 holds its direction, [1, 0, 0]", "a clamp, not a pin"}, 1e-5);
  expect_named("the other one", held(level, pin), shape_of(held(level, up)),
               {"gripper 2 holds its direction, [0.766, 0.6428, 0]"}, 1e-5);
  expect_named("both hold", held(pin, pin), shape_of(held(level, up)),
               {"the pins hold their directions, gripper 1 [1, 0, 0], gripper 2 [0.766"}, 1e-5);
  expect_named("a clamp lets go", held(level, pin), shape_of(held(pin, pin)),
               {"gripper 1 lets the rod rotate: a pin, not a clamp"}, 1e-5);
  expect_named("both let go", held(level, up), shape_of(held(pin, pin)),
               {"the clamps let the rod rotate: pins"}, 1e-5);
}

TEST(Explanation, NoCauseIsListedTwice) {
  Scene turned = clamped();
  turned.gravity = {3, -9, 1};
  Matrix3Xd hooked = shape_of(clamped()).points;
  hooked.rightCols<1>() = hooked.col(39) + Vector3d(-0.02, 0.1, 0);
  const Matrix3Xd moved = shape_of(clamped()).points.colwise() + Vector3d(0, 0.03, 0);
  const Matrix3Xd mirrored = Vector3d(-1, 1, 1).asDiagonal() * shape_of(clamped()).points;
  // Nothing explains it, and several directions of gravity explain half of it.
  const Matrix3Xd right = shape_of(clamped()).points;
  Matrix3Xd wavy = Eigen::AngleAxisd(0.6, Vector3d::UnitZ()).toRotationMatrix() * right;
  wavy.row(2) += 0.05 * right.row(0);
  wavy.row(1).array() += 0.02 * (9 * right.row(0).array()).sin();
  for (const MeasuredShape& shape :
       {shape_of(turned), made(hooked), made(moved), made(mirrored), made(wavy)}) {
    const std::vector<Explanation> found = judged(clamped(), shape, 1e-3).explanations;
    ASSERT_FALSE(found.empty());
    for (const char* what : {"gravity is", "lead", "axes", "mirrored", "in the file"}) {
      EXPECT_LE(std::count_if(found.begin(), found.end(),
                              [what](const Explanation& one) {
                                return one.cause.find(what) != std::string::npos;
                              }),
                1)
          << what;
    }
    const auto of_place = [](const Explanation& one) {
      return one.cause.find("gripper is elsewhere") != std::string::npos ||
             one.cause.find("mm away, by") != std::string::npos;
    };
    EXPECT_LE(std::count_if(found.begin(), found.end(), of_place), 1);
  }
}

/// An arch on two clamps that point up and down again; it stands if it is stiff, and falls out of
/// its plane if not.
Scene arch(double stiffness) {
  return parse_scene(
      "[rod]\nlength = 1\nmass_per_length = 0.5\nbending_stiffness = " + std::to_string(stiffness) +
          "\n[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = \"90 deg\"\n[[gripper]]\nat = "
          "1\nposition = [0.5, 0, 0]\ndirection = \"-90 deg\"\n",
      "arch.toml");
}

// A planar solver's arch stands where it should have fallen. The stiffness at which arches begin to
// stand fits best of all that are followed, and says nothing of the material.
TEST(Explanation, PlanarPointsOfARodThatHasLeftItsPlaneAreToldAsSuch) {
  const Scene scene = arch(0.05);
  std::optional<MeasuredShape> planar;
  for (const energy_model::Equilibrium& state : reference_states(scene, {})) {
    const Matrix3Xd points = state.sample(equal_arc_lengths(1, 41)).points;
    const bool stands =
        points.row(2).cwiseAbs().maxCoeff() < 1e-9 && points.row(1).minCoeff() > -1e-9;
    if (!planar && stands && !energy_model::succeeded(state.status)) planar = made(points);
  }
  ASSERT_TRUE(planar);
  expect_named("planar", scene, *planar, {"keeps to the scene's plane", "unstable"}, 1e-6);
  const ShapeCheck check = check_shape(scene, *planar);
  EXPECT_TRUE(check.effective_modulus.at_bifurcation);
  EXPECT_EQ(check.effective_modulus.optimum, Optimum::one_sided);
  // Where it begins to stand: its plane is stable above, and not below.
  const auto stands = [](double stiffness) {
    const energy_model::Equilibrium rod = solve_reference(arch(stiffness), Model::energy);
    return rod.sample(equal_arc_lengths(1, 41)).points.row(2).cwiseAbs().maxCoeff() < 1e-6;
  };
  const double at = check.effective_modulus.ratio * 0.05;
  EXPECT_TRUE(stands(1.01 * at));
  EXPECT_FALSE(stands(0.99 * at));
  // One that stands has its own.
  Scene stiff = arch(0.2);
  const MeasuredShape right = shape_of(arch(0.3));
  const ShapeCheck other = check_shape(stiff, right);
  EXPECT_FALSE(other.effective_modulus.at_bifurcation);
  EXPECT_NEAR(other.effective_modulus.ratio, 1.5, 1e-3);
}

// E* of a rod that was turned in its clamp explains a part of it, and is no measure of the
// material.
TEST(Explanation, AnotherReasonThatLeavesLessOutdoesTheStiffness) {
  const Scene scene = clamped();
  const auto better = [&scene](const std::function<void(Scene&)>& change) {
    Scene changed = scene;
    change(changed);
    const MeasuredShape shape = shape_of(changed);
    const ShapeCheck check = check_shape(scene, shape);
    EXPECT_TRUE(is_identified(check.effective_modulus.optimum));
    return better_than_stiffness(check, explain_shape(scene, shape, check, {}));
  };
  EXPECT_FALSE(better([](Scene& s) { s.scale_modulus(0.5); }));
  const std::optional<Explanation> turned = better([](Scene& s) {
    s.grippers[0].direction = {std::cos(26 * degree), std::sin(26 * degree), 0};
    s.scale_modulus(1.02);
  });
  ASSERT_TRUE(turned);
  EXPECT_TRUE(says(turned->cause, {"gripper 1 is rotated"}));
}

// A right chain of few hinges is percents away from the rod: it is called what it is, and passes;
// one with other springs does not.
TEST(Explanation, AChainOfHingesIsRightInItsOwnWay) {
  const Scene scene = clamped();
  for (const int segments : {10, 20, 40}) {
    SCOPED_TRACE(segments);
    const double h = 1.0 / segments;
    const std::vector<double> whole(static_cast<std::size_t>(segments), h);
    const Outcome hinged = judged(scene, made(HingedChain(whole, h, 1, false).points()));
    EXPECT_TRUE(hinged.judgement.pass) << hinged.judgement.reason;
    EXPECT_TRUE(says(hinged.judgement.reason, {"with a hinge at the clamp", "discretisation"}));
    const Outcome welded = judged(scene, made(HingedChain(whole, h, 1, true).points()));
    EXPECT_TRUE(welded.judgement.pass) << welded.judgement.reason;
    EXPECT_TRUE(says(welded.judgement.reason, {"welded"}));
    std::vector<double> half(static_cast<std::size_t>(segments) + 1, h);
    half.front() = half.back() = h / 2;
    const Outcome middle = judged(scene, made(HingedChain(half, h, 1, true).points()));
    EXPECT_TRUE(middle.judgement.pass) << middle.judgement.reason;
    EXPECT_TRUE(middle.explanations.empty());  // near the rod itself
    expect_named("half as stiff", scene, made(HingedChain(whole, h, 0.5, false).points()),
                 {"with a hinge at the clamp", "springs of 0.", "times EI/h"});
  }
}

// That is so whether or not anything is explained, and whatever else explains it.
TEST(Explanation, TheVerdictKnowsChainsWithoutAnyExplanation) {
  const Scene scene = clamped();
  const MeasuredShape right =
      made(HingedChain(std::vector<double>(20, 0.05), 0.05, 1, false).points());
  const ShapeCheck check = check_shape(scene, right, {.modulus = ModulusSearch::no});
  for (const bool largest : {false, true}) {
    const ShapeTolerance tolerance{.allowed_m = 0.01, .largest = largest};
    EXPECT_FALSE(judge(check, tolerance).pass);
    const ShapeJudgement alone = judge_with_chains(scene, check, tolerance);
    EXPECT_TRUE(alone.pass) << alone.reason;
    EXPECT_EQ(with_explanation(alone, explain_shape(scene, right, check, {}), tolerance).reason,
              alone.reason);
  }
  const MeasuredShape soft =
      made(HingedChain(std::vector<double>(20, 0.05), 0.05, 0.8, false).points());
  const ShapeCheck soft_check = check_shape(scene, soft, {.modulus = ModulusSearch::no});
  const ShapeJudgement alone = judge_with_chains(scene, soft_check, {.allowed_m = 1e-3});
  EXPECT_FALSE(alone.pass);
  const ShapeJudgement explained =
      with_explanation(alone, explain_shape(scene, soft, soft_check, {}), {.allowed_m = 1e-3});
  EXPECT_FALSE(explained.pass);
  EXPECT_EQ(explained.reason.find(alone.reason), 0);
}

// Its springs are EI/h, and linear in the angle: so they are called, where the angles are large
// enough for it to show.
TEST(Explanation, AChainsSpringsAreCalledByTheirLaw) {
  Scene rope = clamped();
  rope.scale_modulus(0.2);
  const HingedChain chain(std::vector<double>(20, 0.05), 0.05, 0.2, true);
  const Outcome outcome = judged(rope, made(chain.points()));
  EXPECT_TRUE(outcome.judgement.pass) << outcome.judgement.reason;
  EXPECT_TRUE(says(outcome.judgement.reason, {"its springs EI/h and linear in the angle"}));
  Shape shape;
  shape.points = chain.points();
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
  const Matrix3Xd right = HingedChain(lengths, 0.1, 1, true).points();
  const Outcome outcome = judged(clamped(), made(right), 0.002);
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
  Matrix3Xd points = HingedChain(std::vector<double>(20, 0.05), 0.05, 1, false).points();
  points.rightCols<1>() += Vector3d(0.003, 0.0045, 0);
  EXPECT_TRUE(judged(clamped(), made(points)).judgement.pass);
  EXPECT_FALSE(judged(clamped(), made(points), 0.01, true).judgement.pass);
}

TEST(Explanation, OfARightShapeThereIsNone) {
  const Scene scene = between_clamps();
  // The two ends of a rod between pins say nothing of it, nor of its unstable neighbours.
  Matrix3Xd ends(3, 2);
  ends << 0, 0.7, 0, 0.1, 0, 0;
  const Outcome two = judged(held("hold = \"pin\"", "hold = \"pin\""), made(ends));
  EXPECT_FALSE(two.judgement.pass);
  EXPECT_TRUE(two.explanations.empty());
  EXPECT_TRUE(judged(scene, shape_of(scene)).judgement.pass);
  EXPECT_TRUE(judged(scene, shape_of(scene, 9)).judgement.pass);
}

}  // namespace
}  // namespace dlo::compare
