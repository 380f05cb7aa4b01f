#include "dlo/compare/shape_check.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "../../sanitized.hpp"
#include "../../says.hpp"
#include "dlo/compare/alignment.hpp"
#include "dlo/compare/check.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"
#include "measured_shapes.hpp"
#include "rope_beside_peg.hpp"
#include "scenes.hpp"
#include "shape/curve.hpp"
#include "solve/states.hpp"

namespace dlo::compare {
namespace {

// compare() for the force model's shape and check_shape() for its points and arc lengths report the
// same deviations and E*.
TEST(ShapeCheck, AgreesWithCompareOnTheSameShape) {
  Scene scene = heavy_scene(3, 10);
  scene.force_model.law = BendingLaw::paper;
  scene.force_model.c_c = scene.axial_stiffness() / 100;
  const Comparison comparison = compare(scene);
  const Shape& shape = comparison.force.shape;
  const ShapeCheck check = check_shape(scene, {"f", shape.points, shape.arc_length});
  const Deviation& a = check.deviation;
  const Deviation& b = comparison.deviation;
  EXPECT_NEAR(a.rms_m, b.rms_m, 1e-9);
  EXPECT_NEAR(a.max_m, b.max_m, 1e-9);
  EXPECT_NEAR(a.tip_m, b.tip_m, 1e-9);
  EXPECT_NEAR(a.angle_rms_rad, b.angle_rms_rad, 1e-9);
  EXPECT_NEAR(check.effective_modulus.ratio / comparison.effective_modulus.ratio, 1, 1e-5);
  EXPECT_NEAR(check.modulus, check.effective_modulus.ratio * 210e9, 1);
}

TEST(ShapeCheck, FindsTheModulusInAnyFrameFromEitherEnd) {
  const Scene scene = heavy_scene(4, 0);
  Scene soft = with_modulus_times(0.4, scene);
  std::mt19937 random(11);
  for (const bool backwards : {false, true}) {
    const MeasuredShape truth = exact_shape(soft, test::uneven_arc_lengths(random, 12, 1));
    MeasuredShape moved{"m", test::random_pose(random).applied(truth.points), {}};
    if (backwards) moved = test::reversed(moved);
    const ShapeCheck check = check_shape(scene, moved, {.pose = PoseFreedom::rigid});
    EXPECT_NEAR(check.effective_modulus.ratio, 0.4, 1e-3);
    EXPECT_LT(check.effective_modulus.rms_m, 1e-6);
    EXPECT_GT(check.deviation.rms_m, 1e-3);
    EXPECT_TRUE(check.is_rotation_determined);
  }
}

// One frame is better than another if the shape is nearer to the rod in it. Nearest points do not
// include differences along the rod: a wrong shape could be moved along it until its points are
// beyond an end.
TEST(ShapeCheck, AFrameByNearestPointsIsNeverWorseThanByLengthsAlongThePoints) {
  constexpr std::array<std::array<double, 2>, 3> rods = {{{140, 0}, {40, 60}, {40, -80}}};
  std::mt19937 random(20);
  for (std::size_t i = 0; i < 108; ++i) {
    SCOPED_TRACE(i);
    const double stiffer = std::array{0.5, 1.5, 3.0}[i / 12 % 3];
    if (test::sanitized && stiffer != 1.5) continue;
    const Scene scene = heavy_scene(rods[i / 36][0], rods[i / 36][1]);
    Scene other = with_modulus_times(stiffer, scene);
    const int count = std::array{9, 20}[i / 6 % 2];
    const Eigen::Matrix3Xd points =
        std::array{0.98, 1.0, 1.03}[i % 3] * exact_shape(other, equal_arc_lengths(1, count)).points;
    const RigidMotion turned{
        Eigen::AngleAxisd(random() % 6, Eigen::Vector3d::UnitY()).toRotationMatrix(),
        Eigen::Vector3d(0.3, -0.2, 1)};
    const double noise = std::array{0.0, 5e-3}[i / 3 % 2];
    const MeasuredShape seen{"seen", test::with_noise(turned.applied(points), noise, random), {}};
    for (const PoseFreedom pose : {PoseFreedom::upright, PoseFreedom::rigid}) {
      const auto distance = [&](ArcLengths rule) {
        const ShapeCheckOptions options{
            .pose = pose, .arc_lengths = rule, .modulus = ModulusSearch::no};
        return check_shape(scene, seen, options).whole_rod_rms_m;
      };
      EXPECT_LE(distance(ArcLengths::nearest), (1 + 1e-9) * distance(ArcLengths::chord));
    }
  }
}

// A file that is cut off is compared in the rod's frame: its points coincide with a part of the
// rod.
TEST(ShapeCheck, AFileThatIsCutOffKeepsItsFrame) {
  const Scene scene = heavy_scene(140, 0);
  for (const double seen : {0.99, 0.975, 0.9, 0.5}) {
    std::vector<double> s = equal_arc_lengths(1, 41);
    for (double& at : s) at *= seen;
    const RigidMotion turned{Eigen::AngleAxisd(2, Eigen::Vector3d::UnitY()).toRotationMatrix(),
                             Eigen::Vector3d(0.3, -0.2, 1)};
    const MeasuredShape cut{"cut", turned.applied(exact_shape(scene, s).points), {}};
    const ShapeCheck check =
        check_shape(scene, cut, {.pose = PoseFreedom::upright, .modulus = ModulusSearch::no});
    EXPECT_EQ(check.alignment.arc_lengths, ArcLengths::nearest) << seen;
    EXPECT_LT(check.deviation.rms_m, 1e-6) << seen;
    EXPECT_NEAR(check.observed_share, seen, 1e-4) << seen;
  }
}

// The chain hangs farther out than the rod, so that the point of the rod nearest to its tip is not
// the rod's tip.
TEST(ShapeCheck, TheEndsOfAFileAsLongAsTheRodAreTheRods) {
  Scene scene = heavy_scene(1000, 0);
  scene.force_model.points = 12;
  const MeasuredShape chain{"chain", solve(scene, Model::chain).shape.points, {}};
  for (const MeasuredShape& file : {chain, test::reversed(chain)}) {
    const ShapeCheck check = check_shape(scene, file, {.modulus = ModulusSearch::no});
    EXPECT_EQ(check.alignment.arc_lengths, ArcLengths::nearest);
    EXPECT_EQ(check.reference.arc_length.front(), 0);
    EXPECT_DOUBLE_EQ(check.reference.arc_length.back(), 1);
    EXPECT_DOUBLE_EQ(check.observed_share, 1);
  }
}

// Between clamps that lean up a heavy rod hangs out of its plane, to either side. Neither side is
// wrong, and the modulus is the one of the shape's own side.
TEST(ShapeCheck, ComparesWithTheStateThatTheShapeIsIn) {
  Scene scene = heavy_scene(100, 30);
  scene.grippers.push_back(
      {.at = 1, .position = {0.6, 0, 0}, .direction = Eigen::Vector3d(1, -1, 0).normalized()});
  Scene soft = with_modulus_times(0.8, scene);
  MeasuredShape shape = test::energy_model_shape(soft, equal_arc_lengths(1, 31));
  for (const double side : {1, -1}) {
    shape.points.row(2) *= side;
    const ShapeCheck check = check_shape(scene, shape);
    EXPECT_EQ(check.state.stable, 2);
    EXPECT_GT(check.state.others.front().rms_from_shape_m, 3 * check.deviation.rms_m);
    EXPECT_NEAR(check.effective_modulus.ratio, 0.8, 1e-5);
    EXPECT_LT(check.effective_modulus.rms_m, 1e-6);
  }
}

TEST(ShapeCheck, SaysWhereItIsWorst) {
  const Scene scene = heavy_scene(2, -10);
  MeasuredShape shape = exact_shape(scene, equal_arc_lengths(1, 11));
  shape.points(2, 7) += 0.02;
  for (const ArcLengths rule : {ArcLengths::chord, ArcLengths::nearest}) {
    const ShapeCheck along = check_shape(scene, shape, {.arc_lengths = rule});
    EXPECT_NEAR(along.deviation.max_m, 0.02, 1e-3);
    EXPECT_NEAR(along.deviation.max_at_m, 0.7, 1e-3);
    EXPECT_EQ(along.worst_point, 8);
    const ShapeCheck back = check_shape(scene, test::reversed(shape), {.arc_lengths = rule});
    EXPECT_NEAR(back.deviation.max_at_m, 0.7, 1e-3);
    EXPECT_EQ(back.worst_point, 4);
    EXPECT_TRUE(back.alignment.reversed);
    EXPECT_TRUE(back.is_direction_determined);
  }
}

TEST(ShapeCheck, MeasuresWhatIsSeenAndWhatIsMissing) {
  const Scene scene = heavy_scene(5, 0);
  const MeasuredShape shape = exact_shape(scene, {0.1, 0.2, 0.3, 0.65, 0.7, 0.8});
  const ShapeCheck check = check_shape(scene, shape);
  EXPECT_EQ(check.alignment.arc_lengths, ArcLengths::nearest);
  EXPECT_NEAR(check.alignment.shape.arc_length.front(), 0.1, 1e-6);
  EXPECT_NEAR(check.alignment.shape.arc_length.back(), 0.8, 1e-6);
  EXPECT_NEAR(check.largest_gap_m, 0.35, 1e-6);
  EXPECT_NEAR(check.largest_gap_at_m, 0.3, 1e-6);
  EXPECT_LT(check.deviation.rms_m, 1e-8);
  EXPECT_TRUE(std::isnan(check.deviation.tip_m));
  EXPECT_TRUE(std::isnan(check.deviation.angle_rms_rad));
}

// Gamma << 1: y = Gamma (6 s^2 - 4 s^3 + s^4) / 24.
TEST(ShapeCheck, MovementIsTheRmsWayFromStraight) {
  const double gamma = 0.01;
  const Scene scene = heavy_scene(gamma, 0);
  const ShapeCheck check = check_shape(scene, exact_shape(scene, equal_arc_lengths(1, 401)));
  // The mean of s^4 (6 - 4 s + s^2)^2 is 104/45.
  EXPECT_NEAR(check.movement_m, gamma / 24 * std::sqrt(104.0 / 45), 1e-4 * gamma);
}

TEST(ShapeCheck, TheRotationOfAStraightShapeIsNotIdentifiable) {
  const Scene scene = heavy_scene(1e-4, 0);
  const ShapeCheck check = check_shape(scene, exact_shape(scene, equal_arc_lengths(1, 11)),
                                       {.pose = PoseFreedom::rigid});
  EXPECT_LT(check.deviation.rms_m, 1e-4);
  MeasuredShape line{"line", Eigen::Matrix3Xd::Zero(3, 5), {}};
  line.points.row(2) = Eigen::RowVectorXd::LinSpaced(5, 0, 1);
  EXPECT_FALSE(check_shape(scene, line, {.pose = PoseFreedom::rigid}).is_rotation_determined);
}

CheckResult check_points(const Scene& scene, const Eigen::Matrix3Xd& points, double share,
                         double of_deflection = 0) {
  return check(scene, {"mine.csv", points, {}},
               {.tolerance = ShapeTolerance{.allowed_m = share * scene.length,
                                            .deflection_share = of_deflection},
                .explaining = Explaining::no,
                .shape = {.modulus = ModulusSearch::no}});
}

// Without points in the first quarter of a soft rod's length, a shape may follow the bend there or
// cut it.
TEST(ShapeCheck, AFileWithoutPointsAtTheBendIsUndetermined) {
  const Scene scene = heavy_scene(100, 0);
  std::vector<double> s = equal_arc_lengths(1, 101);
  EXPECT_TRUE(check_points(scene, exact_shape(scene, s).points, 0.005).passes());
  std::erase_if(s, [](double at) { return at > 0 && at < 0.25; });
  const CheckResult result = check_points(scene, exact_shape(scene, s).points, 0.005);
  EXPECT_EQ(result.judgement.verdict, ShapeVerdict::undetermined) << result.judgement.reason;
  EXPECT_LT(result.judgement.judged_m, 1e-3);
}

TEST(ShapeCheck, AFileNearAnUnverifiedEquilibriumIsUndetermined) {
  const Scene scene = heavy_scene(10, 0);
  ShapeCheck check = check_shape(scene, exact_shape(heavy_scene(5, 0), equal_arc_lengths(1, 21)));
  ASSERT_EQ(judge(check, {.allowed_m = 0.01}).verdict, ShapeVerdict::fail);
  check.unverified.emplace();
  check.unverified->rms_m = 0.002;
  check.unverified->max_m = 0.02;
  EXPECT_EQ(judge(check, {.allowed_m = 0.01}).verdict, ShapeVerdict::undetermined);
  EXPECT_EQ(judge(check, {.allowed_m = 0.01, .largest = true}).verdict, ShapeVerdict::fail);
  EXPECT_EQ(judge(check, {.allowed_m = 0.001}).verdict, ShapeVerdict::fail);
}

// The distance over the whole rod includes parts that the file lacks.
TEST(ShapeCheck, IsJudgedOverTheWholeRodUnlessAPartIsAsked) {
  const Scene scene = heavy_scene(10, 0);
  ShapeCheck check = check_shape(scene, exact_shape(scene, equal_arc_lengths(1, 21)));
  check.whole_rod_rms_m = 0.02;
  EXPECT_EQ(judge(check, {.allowed_m = 0.01}).verdict, ShapeVerdict::fail);
  EXPECT_EQ(judge(check, {.allowed_m = 0.01, .part = true}).verdict, ShapeVerdict::pass);
}

// A cantilever of small Gamma sags at its tip by Gamma l / 8.
TEST(Significance, APassThatAStraightLineWouldHaveTooSaysSo) {
  constexpr double gamma = 0.08;
  const Scene scene = heavy_scene(gamma, 0);
  const Eigen::Matrix3Xd right = exact_shape(scene, equal_arc_lengths(1, 21)).points;
  Eigen::Matrix3Xd half = right;
  half.row(1) /= 2;
  Eigen::Matrix3Xd line = Eigen::Matrix3Xd::Zero(3, 21);
  line.row(0) = Eigen::RowVectorXd::LinSpaced(21, 0, 1);
  for (const Eigen::Matrix3Xd& points : {right, half, line}) {
    const CheckResult passed = check_points(scene, points, 0.01);
    EXPECT_TRUE(passed.passes());
    EXPECT_EQ(passed.judgement.significant, false);
    EXPECT_NEAR(passed.deflection_m, gamma / 8, 1e-3 * gamma / 8);
    EXPECT_TRUE(
        test::has_all(passed.judgement.reason,
                      {"; not significant for stiffness or weight: the rod without weight and "
                       "loads would pass too"}));
    EXPECT_EQ(other_stiffness_within(passed), "");
  }
  EXPECT_EQ(check_points(scene, right, 0.01, 0.05).judgement.significant, true);
  EXPECT_FALSE(check_points(scene, half, 0.01, 0.05).passes());
  const Scene heavy = heavy_scene(10, 0);
  const CheckResult bent =
      check_points(heavy, exact_shape(heavy, equal_arc_lengths(1, 21)).points, 0.01);
  EXPECT_EQ(bent.judgement.significant, true);
}

// A force F at the tip and a line load w bend a cantilever by F l^3 / (3 EI) and w l^4 / (8 EI).
TEST(Significance, IsThatOfEveryKindOfLoad) {
  Scene tip = heavy_scene(0, 0);
  const double unit = tip.bending_stiffness();
  tip.loads = {{.at = 1, .force = {0, 0.06 * unit, 0}}};
  Scene line = heavy_scene(0, 0);
  line.distributed_loads = {{.from = 0, .to = 1, .force_per_length = {{0, 0.16 * unit, 0}}}};
  for (const Scene& scene : {tip, line}) {
    const CheckResult passed =
        check_points(scene, exact_shape(scene, equal_arc_lengths(1, 21)).points, 0.005);
    EXPECT_EQ(passed.judgement.significant, true);
    EXPECT_NEAR(passed.deflection_m, 0.02, 1e-3 * 0.02);
  }
}

// Without a deflection by weight and loads there is no fraction of it, and weight and loads do not
// determine the stiffness.
TEST(Significance, OfARodThatHangsStraightThereIsNoDeflection) {
  const Scene scene = heavy_scene(10, -90);
  const Eigen::Matrix3Xd points = exact_shape(scene, equal_arc_lengths(1, 21)).points;
  EXPECT_EQ(check_points(scene, points, 0.01).judgement.significant, false);
  EXPECT_TRUE(test::has_all(
      test::error_of<InputError>([&] { return check_points(scene, points, 0.01, 0.05); }),
      {"a tolerance of deflection", "1e-06 of its length"}));
}

TEST(Significance, TheTrivialShapeKeepsNaturalCurvatureAndGrippers) {
  Scene scene = heavy_scene(20, 0);
  scene.natural_strain.y() = 1.5;
  const energy_model::Equilibrium loaded = solve_reference(scene, Model::energy);
  const std::optional<TrivialShape> trivial = trivial_shape(scene, loaded);
  ASSERT_TRUE(trivial);
  // The rod without weight and loads is an arc of radius 1/1.5 m that bends to the left.
  const Eigen::Vector3d tip = trivial->rod.sample(std::vector{1.0}).points.col(0);
  EXPECT_LT((tip - Eigen::Vector3d(std::sin(1.5), 1 - std::cos(1.5), 0) / 1.5).norm(), 1e-8);
  EXPECT_GE(trivial->deflection_m, (tip - loaded.sample(std::vector{1.0}).points.col(0)).norm());
}

TEST(ShapeCheck, UprightNeedsGravity) {
  Scene scene = heavy_scene(1, 0);
  const MeasuredShape shape = exact_shape(scene, equal_arc_lengths(1, 11));
  scene.gravity.setZero();
  EXPECT_THROW((void)check_shape(scene, shape, {.pose = PoseFreedom::upright}), InputError);
}

/// Returns `count` points on a line from corner to corner.
Eigen::Matrix3Xd along_corners(const Eigen::Matrix3Xd& corners, int count) {
  Shape line{{0}, corners};
  for (Eigen::Index i = 1; i < corners.cols(); ++i) {
    line.arc_length.push_back(line.arc_length.back() +
                              (corners.col(i) - corners.col(i - 1)).norm());
  }
  return resample(line, equal_arc_lengths(line.arc_length.back(), count)).points;
}

// The pin carries the load and the weight of the rope between the heights of its ends. A chain of
// straight lines over the peg is a few millimetres from that rope, from whichever end it begins,
// and far from the one that hangs next to the peg.
TEST(ShapeCheck, TheReferenceIsTheStableEquilibriumNearThePoints) {
  const Scene scene = parse_scene(test::rope_beside_peg, "rope.toml");
  Eigen::Matrix3Xd corners(3, 5);
  corners << -0.35, -0.01, 0.03, 0.043, 0.043, 0.06, 0.043, 0.03, 0, -0.59, 0, 0, 0, 0, 0;
  const Eigen::Matrix3Xd points = along_corners(corners, 41);
  const SolveOptions options;
  std::vector<energy_model::Equilibrium> states =
      all_equilibria(scene, solve_reference(scene, Model::energy), options);
  for (const bool backwards : {false, true}) {
    const MeasuredShape shape{
        "rope", backwards ? Eigen::Matrix3Xd(points.rowwise().reverse()) : points, {}};
    const ShapeCheck check = check_shape(scene, shape, {.modulus = ModulusSearch::no});
    EXPECT_LT(check.deviation.rms_m, 5e-3);
    EXPECT_GT(check.state.energy_above_lowest_J(), 0.1);
    EXPECT_EQ(check.state.rank, 2);
    const double fall = 0.06 - check.rod.sample(std::array{1.0}).points(1, 0);
    EXPECT_NEAR(check.rod.grips[0].force.norm(), 9.81 * (1.5 + 0.06 * fall), 1e-5);
    EXPECT_EQ(check.rod.contacts.size(), 1);
  }
  // An equilibrium that a search of the scene does not find is found by a search from the points.
  std::erase_if(states, [](const auto& state) { return !state.contacts.empty(); });
  ASSERT_EQ(states.size(), 1);
  const Shape aligned = aligned_by_grippers({"rope", points, {}}, scene, ArcLengths::nearest);
  const std::optional<energy_model::Equilibrium> near = equilibrium_near(scene, aligned, options);
  ASSERT_TRUE(near);
  EXPECT_EQ(insert_equilibrium(scene, *near, states), 1U);
  EXPECT_EQ(insert_equilibrium(scene, *near, states), std::nullopt);
  EXPECT_EQ(states.size(), 2);
}

}  // namespace
}  // namespace dlo::compare
