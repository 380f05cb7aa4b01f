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
  const Matrix3Xd right = exact_file(scene).points;
  Matrix3Xd wrong = right;
  wrong.rightCols<1>() = right.col(39) + Vector3d(-0.02, 0.1, 0);
  expect_cause("a hook", scene, file_shape(wrong), {"last point", "hook"});
  expect_cause("stretched", scene, file_shape(1.02 * right), {"stretched by 2 %"});
  expect_cause("much stretched", scene, file_shape(1.1 * right), {"stretched by 10 %"});
  expect_cause("compressed", scene, file_shape(right / 1.1), {"compressed"});
  expect_cause("shrunk", scene, file_shape(right / 1e3), {"the file is in km"});
  expect_cause("an unnamed unit", scene, file_shape(0.004 * right),
               {"the file is in units of 250"});
  expect_cause("cut off", scene, file_shape(right.leftCols(33)), {"cut off", "s = 0 to 0.8 m"});
  const auto axes = [&right](const Vector3d& x, const Vector3d& y, const Vector3d& z) {
    Matrix3d to;
    to << x, y, z;
    return file_shape(to * right);
  };
  const Vector3d x = Vector3d::UnitX();
  const Vector3d y = Vector3d::UnitY();
  const Vector3d z = Vector3d::UnitZ();
  expect_cause("mirrored", scene, axes(-x, y, z), {"mirrored", "x is the file's -x"});
  expect_cause("z up", scene, axes(x, z, -y), {"z is up in the file", "z is the file's -y"});
  expect_cause("y down", scene, axes(x, -y, z), {"y is down in the file"});
  expect_cause("mm", scene, file_shape(1000 * right), {"in mm"});
  expect_cause("cm", scene, file_shape(100 * right), {"in cm"});
  expect_cause("inches", scene, file_shape(right / 0.0254), {"in inches"});
  Matrix3Xd pixels = 800 * right;
  pixels.row(1) *= -1;
  pixels.colwise() += Vector3d(320, 240, 0);
  expect_cause("pixels", scene, file_shape(pixels), {"1.25 mm", "y down", "pixels"});
  // The vertical of an image is that of the scene, along y or along z.
  Scene z_up = scene;
  z_up.gravity = {0, 0, -9.81};
  z_up.grippers[0].direction = {std::cos(20 * degree), 0, std::sin(20 * degree)};
  expect_cause("pixels, z up", z_up, file_shape(pixels), {"1.25 mm", "y down", "pixels"});
  expect_cause("y down from a corner", scene, file_shape(pixels / 800),
               {"y is down", "another origin"});
  std::vector<Eigen::Index> rows(41);
  std::iota(rows.begin(), rows.end(), Eigen::Index{0});
  std::swap(rows[3], rows[30]);
  std::swap(rows[11], rows[20]);
  expect_cause("out of order", scene, file_shape(right(Eigen::all, rows)),
               {"out of order", "1, 2, 3, 31, 5, 6, .."});
  // A file of body positions has the begins of all segments, but not the end of the last segment.
  const Matrix3Xd joints = exact_file(scene, 7).points;
  expect_cause("no last point", scene, file_shape(joints.leftCols(6)),
               {"an end point is missing", "xpos"}, 2e-3);
  expect_cause("moved", scene, file_shape(right.colwise() + Vector3d(0, 0.015, 0)),
               {"another origin", "gripper is elsewhere", "-15"});
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 0.01);
  const Matrix3Xd noise = Matrix3Xd::NullaryExpr(3, 41, [&] { return normal(random); });
  expect_cause("noise", scene, file_shape(right + noise), {"noise"}, 0.01);
  MeasuredShape against = file_shape(right);
  against.arc_length = equal_arc_lengths(1, 41);
  EXPECT_TRUE(judge_shape(scene, against).judgement.passes());
}

// The origin is not at a gripper. A scale then moves both grippers, and a rotation about one of
// them leaves that one in place.
TEST(Explanation, NamesTheScaleAndTheRotationOfAFile) {
  Scene scene = between_clamps();
  for (Gripper& gripper : scene.grippers) gripper.position += Vector3d(0.2, -0.3, 0.1);
  const Matrix3Xd right = exact_file(scene).points;
  expect_cause("compressed", scene, file_shape(0.7 * right), {"compressed by 30 %"});
  expect_cause("shrunk", scene, file_shape(0.2 * right), {"the file is in units of 5.00"});
  for (std::size_t i = 0; i < 2; ++i) {
    for (const Vector3d& axis : {Vector3d(0, 0, 1), Vector3d(1, 2, -1)}) {
      const Matrix3d rotation =
          Eigen::AngleAxisd(12 * degree, axis.normalized()).toRotationMatrix();
      const Vector3d centre = scene.grippers[i].position;
      const Matrix3Xd wrong = (rotation * (right.colwise() - centre)).colwise() + centre;
      const std::vector<Explanation> found = judge_shape(scene, file_shape(wrong)).explanations;
      ASSERT_FALSE(found.empty());
      EXPECT_TRUE(
          has_all(found[0].cause, {"rotated by 12 deg about gripper " + std::to_string(i + 1)}));
      EXPECT_EQ(found[0].numbers, 3);
      EXPECT_LT(found[0].rms_m, 1e-3);
    }
  }
}

// The distance of a file that was read incorrectly has no meaning: the error of the file is
// reported first.
TEST(Explanation, AFileThatIsReadWronglyIsNamedFirst) {
  const Scene scene = clamped();
  const JudgedShape wrong = judge_shape(scene, file_shape(1000 * exact_file(scene).points));
  EXPECT_TRUE(has_all(wrong.judgement.reason,
                      {"mm if the file is in mm, not in metres; as it was read: "}));
  EXPECT_EQ(wrong.judgement.reason.find("RMS"), 0U) << wrong.judgement.reason;
  // In this case the scene is wrong too, not only the file.
  Scene softer = scene;
  softer.scale_modulus(0.3);
  const JudgedShape other = judge_shape(scene, exact_file(softer));
  EXPECT_TRUE(has_all(other.judgement.reason, {"; it would be "}));
}

TEST(Explanation, NamesWhatIsAnotherScene) {
  const Scene scene = clamped();
  const auto other = [&scene](const std::function<void(Scene&)>& change) {
    Scene changed = scene;
    change(changed);
    return exact_file(changed);
  };
  expect_cause("softer", scene, other([](Scene& s) { s.scale_modulus(0.5); }),
               {"bending stiffness is 0.5 times", "weight 2 times"});
  expect_cause("turned", scene, other([](Scene& s) {
                 s.grippers[0].direction = {std::cos(25 * degree), std::sin(25 * degree), 0};
               }),
               {"gripper 1 is rotated by 5 deg"});
  expect_cause("curved", scene,
               exact_file(clamped("natural_curvature = 1\ntorsional_stiffness = 1\n")),
               {"intrinsically curved, 1 1/m"});
  expect_cause("another gravity", scene, other([](Scene& s) {
                 s.gravity = {0, 0, -9.81};
               }),
               {"gravity is", "-9.81", "rotated by 90 deg"});
  Scene longer = scene;
  longer.length = 1.2;
  expect_cause("longer", scene, exact_file(longer), {"1.2 m long"});
  expect_cause("another rod", scene, other([](Scene& s) {
                 s.scale_modulus(3);
                 s.scale_density(0.4);
               }),
               {"bending stiffness is 7.5 times"});

  const Scene two = between_clamps();
  Scene moved = two;
  moved.grippers[1].position.y() += 0.03;
  expect_cause("moved gripper", two, exact_file(moved), {"gripper 2 is 30 mm away"});
  expect_cause("twisted", two,
               exact_file(between_clamps("torsional_stiffness = 0.76923\n", "roll = \"90 deg\"\n")),
               {"gripper 2 turns the rod", "90 deg (twist)"});
}

// The torque of a twisted rod is GJ times its twist, so that a wrong stiffness and a wrong angle
// are both causes.
TEST(Explanation, NamesAnotherTorsionalStiffness) {
  const auto twisted = [](double stiffness) {
    return between_clamps("torsional_stiffness = " + std::to_string(stiffness) + "\n",
                          "roll = \"200 deg\"\n");
  };
  const JudgedShape outcome = judge_shape(twisted(0.8), exact_file(twisted(0.4)), 1e-3);
  EXPECT_FALSE(outcome.judgement.passes());
  std::vector<Explanation> first = outcome.explanations;
  if (first.size() > 2) first.resize(2);
  const auto named = std::ranges::find_if(first, [](const Explanation& one) {
    return one.cause.find("torsional stiffness is 0.5 times") != std::string::npos;
  });
  ASSERT_NE(named, first.end()) << outcome.judgement.reason;
  EXPECT_LT(named->rms_m, 1e-4);
}

/// Returns a rod of 1 m whose ends are at (0, 0, 0) and (0.7, 0.1, 0) m, held as given: "hold =
/// \"pin\"" or a direction.
Scene gripped_rod(const std::string& first, const std::string& last) {
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
  expect_cause("a pin holds", gripped_rod(pin, pin), exact_file(gripped_rod(level, pin)),
               {"gripper 1 holds its direction, [1, 0, 0]", "a clamp, not a pin"}, 1e-5);
  expect_cause("the other one", gripped_rod(level, pin), exact_file(gripped_rod(level, up)),
               {"gripper 2 holds its direction, [0.766, 0.6428, 0]"}, 1e-5);
  expect_cause("both hold", gripped_rod(pin, pin), exact_file(gripped_rod(level, up)),
               {"the pins hold their directions, gripper 1 [1, 0, 0], gripper 2 [0.766"}, 1e-5);
  expect_cause("a clamp lets go", gripped_rod(level, pin), exact_file(gripped_rod(pin, pin)),
               {"gripper 1 lets the rod rotate: a pin, not a clamp"}, 1e-5);
  expect_cause("both let go", gripped_rod(level, up), exact_file(gripped_rod(pin, pin)),
               {"the clamps let the rod rotate: pins, not clamps"}, 1e-5);
}

TEST(Explanation, NoCauseIsListedTwice) {
  Scene turned = clamped();
  turned.gravity = {3, -9, 1};
  Matrix3Xd hooked = exact_file(clamped()).points;
  hooked.rightCols<1>() = hooked.col(39) + Vector3d(-0.02, 0.1, 0);
  const Matrix3Xd moved = exact_file(clamped()).points.colwise() + Vector3d(0, 0.03, 0);
  const Matrix3Xd mirrored = Vector3d(-1, 1, 1).asDiagonal() * exact_file(clamped()).points;
  // No cause explains the shape, and several directions of gravity explain half of the error.
  const Matrix3Xd right = exact_file(clamped()).points;
  Matrix3Xd wavy = Eigen::AngleAxisd(0.6, Vector3d::UnitZ()).toRotationMatrix() * right;
  wavy.row(2) += 0.05 * right.row(0);
  wavy.row(1).array() += 0.02 * (9 * right.row(0).array()).sin();
  for (const MeasuredShape& shape : {exact_file(turned), file_shape(hooked), file_shape(moved),
                                     file_shape(mirrored), file_shape(wavy)}) {
    const std::vector<Explanation> found = judge_shape(clamped(), shape, 1e-3).explanations;
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
  const Scene scene = clamped_arch(0.05);
  std::optional<MeasuredShape> planar;
  for (const energy_model::Equilibrium& state : reference_states(scene, {})) {
    const Matrix3Xd points = state.sample(equal_arc_lengths(1, 41)).points;
    const bool stands =
        points.row(2).cwiseAbs().maxCoeff() < 1e-9 && points.row(1).minCoeff() > -1e-9;
    if (!planar && stands && !energy_model::succeeded(state.status)) planar = file_shape(points);
  }
  ASSERT_TRUE(planar);
  expect_cause("planar", scene, *planar, {"stays in the scene's plane", "unstable"}, 1e-6);
  const ShapeCheck check = check_shape(scene, *planar);
  EXPECT_TRUE(check.effective_modulus.at_bifurcation);
  EXPECT_EQ(check.effective_modulus.optimum, Optimum::one_sided);
  // The fitted stiffness is the bifurcation: above it the planar arch is stable, below it is not.
  const auto stands = [](double stiffness) {
    const energy_model::Equilibrium rod = solve_reference(clamped_arch(stiffness), Model::energy);
    return rod.sample(equal_arc_lengths(1, 41)).points.row(2).cwiseAbs().maxCoeff() < 1e-6;
  };
  const double at = check.effective_modulus.ratio * 0.05;
  EXPECT_TRUE(stands(1.01 * at));
  EXPECT_FALSE(stands(0.99 * at));
  // For a stable arch the best stiffness is not at a bifurcation.
  Scene stiff = clamped_arch(0.2);
  const MeasuredShape right = exact_file(clamped_arch(0.3));
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
    const MeasuredShape shape = exact_file(changed);
    const ShapeCheck check = check_shape(scene, shape);
    EXPECT_TRUE(is_identified(check.effective_modulus.optimum));
    return cause_better_than_stiffness(check, explain_shape(scene, shape, check, {}));
  };
  EXPECT_FALSE(better([](Scene& s) { s.scale_modulus(0.5); }));
  const std::optional<Explanation> turned = better([](Scene& s) {
    s.grippers[0].direction = {std::cos(26 * degree), std::sin(26 * degree), 0};
    s.scale_modulus(1.02);
  });
  ASSERT_TRUE(turned);
  EXPECT_TRUE(has_all(turned->cause, {"gripper 1 is rotated"}));
}

TEST(Explanation, OfARightShapeThereIsNone) {
  const Scene scene = between_clamps();
  // The two ends of a rod between pins determine neither the rod nor its unstable equilibria.
  Matrix3Xd ends(3, 2);
  ends << 0, 0.7, 0, 0.1, 0, 0;
  const JudgedShape two =
      judge_shape(gripped_rod("hold = \"pin\"", "hold = \"pin\""), file_shape(ends));
  EXPECT_FALSE(two.judgement.passes());
  EXPECT_TRUE(two.explanations.empty());
  EXPECT_TRUE(judge_shape(scene, exact_file(scene)).judgement.passes());
  EXPECT_TRUE(judge_shape(scene, exact_file(scene, 9)).judgement.passes());
}

}  // namespace
}  // namespace dlo::compare
