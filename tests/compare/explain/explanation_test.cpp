// Tests of the diagnosis of shapes with a single error.

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
#include "judged_shape.hpp"

namespace dlo::compare {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double degree = std::numbers::pi / 180;

Scene between_clamps(const std::string& rod = "", const std::string& last = "") {
  return parse_scene(
      "[rod]\nlength = 1\nbending_stiffness = 1\nmass_per_length = 0.5\n" + rod +
          "[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = \"30 deg\"\n" +
          (last.empty() ? "" : "roll = 0\n") +
          "[[gripper]]\nat = 1\nposition = [0.7, 0.1, 0]\ndirection = \"-20 deg\"\n" + last,
      "between.toml");
}

TEST(Explanation, NamesWhatIsWrongWithAFile) {
  const Scene scene = clamped();
  const Matrix3Xd right = right_file(scene).points;
  Matrix3Xd wrong = right;
  wrong.rightCols<1>() = right.col(39) + Vector3d(-0.02, 0.1, 0);
  expect_named("a hook", scene, made(wrong), {"last point", "hook"});
  expect_named("stretched", scene, made(1.02 * right), {"stretched by 2 %"});
  expect_named("much stretched", scene, made(1.1 * right), {"stretched by 10 %"});
  expect_named("compressed", scene, made(right / 1.1), {"compressed"});
  expect_named("shrunk", scene, made(right / 1e3), {"the file is in km"});
  expect_named("an unnamed unit", scene, made(0.004 * right), {"the file is in units of 250"});
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
  // The vertical of an image is that of the scene, along y or along z.
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
  // A file of body positions has the begins of all segments, but not the end of the last segment.
  const Matrix3Xd joints = right_file(scene, 7).points;
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
  EXPECT_TRUE(judged(scene, against).judgement.passes());
}

// The origin is not at a gripper. A scale then moves both grippers, and a rotation about one of
// them leaves that one in place.
TEST(Explanation, NamesTheScaleAndTheRotationOfAFile) {
  Scene scene = between_clamps();
  for (Gripper& gripper : scene.grippers) gripper.position += Vector3d(0.2, -0.3, 0.1);
  const Matrix3Xd right = right_file(scene).points;
  expect_named("compressed", scene, made(0.7 * right), {"compressed by 30 %"});
  expect_named("shrunk", scene, made(0.2 * right), {"the file is in units of 5.00"});
  for (std::size_t i = 0; i < 2; ++i) {
    for (const Vector3d& axis : {Vector3d(0, 0, 1), Vector3d(1, 2, -1)}) {
      const Matrix3d rotation =
          Eigen::AngleAxisd(12 * degree, axis.normalized()).toRotationMatrix();
      const Vector3d centre = scene.grippers[i].position;
      const Matrix3Xd wrong = (rotation * (right.colwise() - centre)).colwise() + centre;
      const std::vector<Explanation> found = judged(scene, made(wrong)).explanations;
      ASSERT_FALSE(found.empty());
      EXPECT_TRUE(
          says(found[0].cause, {"rotated by 12 deg about gripper " + std::to_string(i + 1)}));
      EXPECT_EQ(found[0].numbers, 3);
      EXPECT_LT(found[0].rms_m, 1e-3);
    }
  }
}

// The distance of a file that was read incorrectly has no meaning: the error of the file is
// reported first.
TEST(Explanation, AFileThatIsReadWronglyIsNamedFirst) {
  const Scene scene = clamped();
  const JudgedShape wrong = judged(scene, made(1000 * right_file(scene).points));
  EXPECT_TRUE(
      says(wrong.judgement.reason, {"mm if the file is in mm, not in metres; as it was read: "}));
  EXPECT_EQ(wrong.judgement.reason.find("RMS"), 0U) << wrong.judgement.reason;
  // In this case the scene is wrong too, not only the file.
  Scene softer = scene;
  softer.scale_modulus(0.3);
  const JudgedShape other = judged(scene, right_file(softer));
  EXPECT_TRUE(says(other.judgement.reason, {"; it would be "}));
}

TEST(Explanation, NamesWhatIsAnotherScene) {
  const Scene scene = clamped();
  const auto other = [&scene](const std::function<void(Scene&)>& change) {
    Scene changed = scene;
    change(changed);
    return right_file(changed);
  };
  expect_named("softer", scene, other([](Scene& s) { s.scale_modulus(0.5); }),
               {"bending stiffness is 0.5 times", "weight 2 times"});
  expect_named("turned", scene, other([](Scene& s) {
                 s.grippers[0].direction = {std::cos(25 * degree), std::sin(25 * degree), 0};
               }),
               {"gripper 1 is rotated by 5 deg"});
  expect_named("curved", scene,
               right_file(clamped("natural_curvature = 1\ntorsional_stiffness = 1\n")),
               {"intrinsically curved, 1 1/m"});
  expect_named("another gravity", scene, other([](Scene& s) {
                 s.gravity = {0, 0, -9.81};
               }),
               {"gravity is", "-9.81", "rotated by 90 deg"});
  Scene longer = scene;
  longer.length = 1.2;
  expect_named("longer", scene, right_file(longer), {"1.2 m long"});
  expect_named("another rod", scene, other([](Scene& s) {
                 s.scale_modulus(3);
                 s.scale_density(0.4);
               }),
               {"bending stiffness is 7.5 times"});

  const Scene two = between_clamps();
  Scene moved = two;
  moved.grippers[1].position.y() += 0.03;
  expect_named("moved gripper", two, right_file(moved), {"gripper 2 is 30 mm away"});
  expect_named("twisted", two,
               right_file(between_clamps("torsional_stiffness = 0.76923\n", "roll = \"90 deg\"\n")),
               {"gripper 2 turns the rod", "90 deg (twist)"});
}

// The torque of a twisted rod is GJ times its twist, so that a wrong stiffness and a wrong angle
// are both causes.
TEST(Explanation, NamesAnotherTorsionalStiffness) {
  const auto twisted = [](double stiffness) {
    return between_clamps("torsional_stiffness = " + std::to_string(stiffness) + "\n",
                          "roll = \"200 deg\"\n");
  };
  const JudgedShape outcome = judged(twisted(0.8), right_file(twisted(0.4)), 1e-3);
  EXPECT_FALSE(outcome.judgement.passes());
  std::vector<Explanation> first = outcome.explanations;
  if (first.size() > 2) first.resize(2);
  const auto named = std::ranges::find_if(first, [](const Explanation& one) {
    return one.cause.find("torsional stiffness is 0.5 times") != std::string::npos;
  });
  ASSERT_NE(named, first.end()) << outcome.judgement.reason;
  EXPECT_LT(named->rms_m, 1e-4);
}

/// Returns a rod between two grippers 0.7 l apart, held as given: "hold = \"pin\"" or a direction.
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
  expect_named("a pin holds", held(pin, pin), right_file(held(level, pin)),
               {"gripper 1 holds its direction, [1, 0, 0]", "a clamp, not a pin"}, 1e-5);
  expect_named("the other one", held(level, pin), right_file(held(level, up)),
               {"gripper 2 holds its direction, [0.766, 0.6428, 0]"}, 1e-5);
  expect_named("both hold", held(pin, pin), right_file(held(level, up)),
               {"the pins hold their directions, gripper 1 [1, 0, 0], gripper 2 [0.766"}, 1e-5);
  expect_named("a clamp lets go", held(level, pin), right_file(held(pin, pin)),
               {"gripper 1 lets the rod rotate: a pin, not a clamp"}, 1e-5);
  expect_named("both let go", held(level, up), right_file(held(pin, pin)),
               {"the clamps let the rod rotate: pins, not clamps"}, 1e-5);
}

TEST(Explanation, NoCauseIsListedTwice) {
  Scene turned = clamped();
  turned.gravity = {3, -9, 1};
  Matrix3Xd hooked = right_file(clamped()).points;
  hooked.rightCols<1>() = hooked.col(39) + Vector3d(-0.02, 0.1, 0);
  const Matrix3Xd moved = right_file(clamped()).points.colwise() + Vector3d(0, 0.03, 0);
  const Matrix3Xd mirrored = Vector3d(-1, 1, 1).asDiagonal() * right_file(clamped()).points;
  // No cause explains the shape, and several directions of gravity explain half of the error.
  const Matrix3Xd right = right_file(clamped()).points;
  Matrix3Xd wavy = Eigen::AngleAxisd(0.6, Vector3d::UnitZ()).toRotationMatrix() * right;
  wavy.row(2) += 0.05 * right.row(0);
  wavy.row(1).array() += 0.02 * (9 * right.row(0).array()).sin();
  for (const MeasuredShape& shape :
       {right_file(turned), made(hooked), made(moved), made(mirrored), made(wavy)}) {
    const std::vector<Explanation> found = judged(clamped(), shape, 1e-3).explanations;
    ASSERT_FALSE(found.empty());
    const auto count_of = [&](const std::string& what) {
      return std::ranges::count_if(
          found, [&](const Explanation& one) { return one.cause.find(what) != std::string::npos; });
    };
    for (const char* what : {"gravity is", "lead", "axes", "mirrored", "in the file"}) {
      EXPECT_LE(count_of(what), 1) << what;
    }
    EXPECT_LE(count_of("gripper is elsewhere") + count_of("mm away, by"), 1);
  }
}

// The points are those of a planar solver, whose arch stays in its plane although the stable one
// has left it. The best fit among all stiffnesses is the one at which planar arches become stable,
// but it does not determine the material.
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
  expect_named("planar", scene, *planar, {"stays in the scene's plane", "unstable"}, 1e-6);
  const ShapeCheck check = check_shape(scene, *planar);
  EXPECT_TRUE(check.effective_modulus.at_bifurcation);
  EXPECT_EQ(check.effective_modulus.optimum, Optimum::one_sided);
  // The fitted stiffness is the bifurcation: above it the planar arch is stable, below it is not.
  const auto stands = [](double stiffness) {
    const energy_model::Equilibrium rod = solve_reference(arch(stiffness), Model::energy);
    return rod.sample(equal_arc_lengths(1, 41)).points.row(2).cwiseAbs().maxCoeff() < 1e-6;
  };
  const double at = check.effective_modulus.ratio * 0.05;
  EXPECT_TRUE(stands(1.01 * at));
  EXPECT_FALSE(stands(0.99 * at));
  // For a stable arch the best stiffness is not at a bifurcation.
  Scene stiff = arch(0.2);
  const MeasuredShape right = right_file(arch(0.3));
  const ShapeCheck other = check_shape(stiff, right);
  EXPECT_FALSE(other.effective_modulus.at_bifurcation);
  EXPECT_NEAR(other.effective_modulus.ratio, 1.5, 1e-3);
}

// E* of a rod that was rotated in its clamp explains a part of the deviation, and is no measure of
// the material.
TEST(Explanation, ACauseThatLeavesLessSupersedesTheStiffness) {
  const Scene scene = clamped();
  const auto better = [&scene](const std::function<void(Scene&)>& change) {
    Scene changed = scene;
    change(changed);
    const MeasuredShape shape = right_file(changed);
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

TEST(Explanation, OfARightShapeThereIsNone) {
  const Scene scene = between_clamps();
  // The two ends of a rod between pins determine neither the rod nor its unstable equilibria.
  Matrix3Xd ends(3, 2);
  ends << 0, 0.7, 0, 0.1, 0, 0;
  const JudgedShape two = judged(held("hold = \"pin\"", "hold = \"pin\""), made(ends));
  EXPECT_FALSE(two.judgement.passes());
  EXPECT_TRUE(two.explanations.empty());
  EXPECT_TRUE(judged(scene, right_file(scene)).judgement.passes());
  EXPECT_TRUE(judged(scene, right_file(scene, 9)).judgement.passes());
}

}  // namespace
}  // namespace dlo::compare
