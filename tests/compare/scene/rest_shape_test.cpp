// Tests of stress-free shapes that are given by a helix or by points in space.

#include "dlo/compare/rest_shape.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solve.hpp"
#include "scene_text.hpp"
#include "shape/write_vtk.hpp"

namespace dlo::compare {
namespace {

constexpr double shaft_length = 0.24;

/// Returns a point of a curve that consists of a straight shaft of 0.2 m, an arc of 80 1/m and one
/// of 40 1/m, 0.02 m each. @param s  arc length [m]
Eigen::Vector3d on_shaft(double s) {
  const double a = 80 * std::clamp(s - 0.2, 0.0, 0.02);
  const double b = a + 40 * std::max(s - 0.22, 0.0);
  return {std::min(s, 0.2) + std::sin(a) / 80 + (std::sin(b) - std::sin(a)) / 40,
          (1 - std::cos(a)) / 80 + (std::cos(a) - std::cos(b)) / 40, 0};
}

constexpr double helix_radius = 0.02;
constexpr double helix_pitch = 0.0628;
constexpr double helix_length = 0.28;

/// Returns a point of a helix along z, which begins at (R, 0, 0).
Eigen::Vector3d on_helix(double s) {
  const double c = helix_pitch / (2 * std::numbers::pi);
  const double angle = s / std::hypot(helix_radius, c);
  return {helix_radius * std::cos(angle), helix_radius * std::sin(angle), c * angle};
}

MeasuredShape points_of(const std::function<Eigen::Vector3d(double)>& curve, double length,
                        int count) {
  MeasuredShape shape;
  shape.file = "points.csv";
  shape.points.resize(3, count);
  for (int i = 0; i < count; ++i) shape.points.col(i) = curve(length * i / (count - 1));
  return shape;
}

Scene bare_scene(double length) {
  Scene scene;
  scene.file = "my.toml";
  scene.gravity.setZero();
  scene.length = length;
  scene.given_bending_stiffness = 1e-3;
  scene.given_mass_per_length = 0.01;
  return scene;
}

/// Returns a scene that is held by its first end where its rest shape begins.
Scene resting_scene(const RestShape& shape, double length) {
  Scene scene = bare_scene(length);
  scene.set_rest_shape(shape);
  Gripper clamp{.at = 0, .position = shape.begin, .direction = shape.first_frame.col(2)};
  clamp.frame = FrameHold{.d1 = shape.first_frame.col(0)};
  scene.grippers = {clamp};
  return scene;
}

/// Returns the largest distance between points of a curve and of a solved shape at equal arc
/// lengths.
double largest_distance_from_curve(const Scene& scene, Model model,
                                   const std::function<Eigen::Vector3d(double)>& curve) {
  std::vector<double> s;
  for (int i = 0; i <= 60; ++i) s.push_back(scene.length * i / 60);
  const Eigen::Matrix3Xd points = solve_reference(scene, model).sample(s).points;
  double most = 0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    most = std::max(most, (points.col(static_cast<Eigen::Index>(i)) - curve(s[i])).norm());
  }
  return most;
}

TEST(RestShape, ArcsOfEqualLengthHaveTheStrainsOfThePoints) {
  // The curvature changes at 10/12 and 11/12 of the length. Points contain neither that nor an arc
  // length.
  for (const int count : {50, 137, 1000}) {
    const RestShape shape = fit_rest_shape(points_of(on_shaft, shaft_length, count), shaft_length);
    ASSERT_EQ(shape.arcs.size(), 12) << count;
    EXPECT_NEAR(shape.arcs[9].end, 0.2, 1e-15);
    EXPECT_EQ(shape.arcs[11].end, shaft_length);
    for (std::size_t k = 0; k < 12; ++k) {
      EXPECT_EQ(shape.arcs[k].strain.x(), 0);
      EXPECT_NEAR(shape.arcs[k].strain.y(), k < 10 ? 0 : k < 11 ? 80 : 40, 1e-5) << k;
    }
    EXPECT_LT(shape.largest_error, 1e-9);
    EXPECT_EQ(shape.points, count);
  }
}

TEST(RestShape, TheStatedErrorHoldsIfTheCurvatureJumpsWithinAnArc) {
  const double length = 0.226;  // jumps at 0.885 and 0.973 of the length
  const RestShape shape = fit_rest_shape(points_of(on_shaft, length, 200), length);
  // An arc of length h with the mean curvature is off by at most the jump times h^2 / 8.
  EXPECT_LT(shape.largest_error, 80 * std::pow(length / 32, 2) / 8);
  EXPECT_LT(largest_distance_from_curve(resting_scene(shape, length), Model::energy, on_shaft),
            2 * shape.largest_error);
}

TEST(RestShape, ARodThatIsHeldByOneEndComesBackToTheStatedError) {
  const RestShape shaft = fit_rest_shape(points_of(on_shaft, shaft_length, 241), shaft_length);
  const Scene bent = resting_scene(shaft, shaft_length);
  EXPECT_TRUE(bent.planar());
  const RestShape helix = fit_rest_shape(points_of(on_helix, helix_length, 141), helix_length);
  EXPECT_GT(helix.arcs.size(), 8);
  EXPECT_LT(helix.largest_error, 5e-5 * helix_length);
  for (const Model model : {Model::energy, Model::exact}) {
    EXPECT_LT(largest_distance_from_curve(bent, model, on_shaft), shaft.largest_error + 1e-9)
        << to_string(model);
    // The arc lengths of the points are unknown: they may be shifted along the helix by as much as
    // the shape is inaccurate.
    EXPECT_LT(largest_distance_from_curve(resting_scene(helix, helix_length), model, on_helix),
              2 * helix.largest_error)
        << to_string(model);
  }
}

TEST(RestShape, SectionsKeepTheirOwnStiffness) {
  const RestShape shape = fit_rest_shape(points_of(on_shaft, shaft_length, 121), shaft_length);
  Scene scene = bare_scene(shaft_length);
  scene.sections = {{.from = 0.1, .to = 0.21, .bending_stiffness = 5e-3, .mass_per_length = 0.02}};
  const double mass = scene.mass();
  scene.set_rest_shape(shape);
  ASSERT_EQ(scene.sections.size(), 13);  // 12 arcs, one of them in two parts
  EXPECT_NEAR(scene.mass(), mass, 1e-12);
  EXPECT_EQ(scene.sections[10].bending_stiffness, 5e-3);
  EXPECT_NEAR(scene.sections[10].natural_curvature->y(), 80, 1e-5);
  EXPECT_EQ(scene.sections[11].bending_stiffness, 1e-3);
  EXPECT_FALSE(scene.without_natural_strain().naturally_bent());
  EXPECT_FALSE(scene.without_natural_strain().rest_shape);
}

TEST(RestShape, IsReadFromAFile) {
  const std::string folder = testing::TempDir();
  std::ofstream points(folder + "rest_points.csv");
  points.precision(17);
  for (int i = 0; i <= 60; ++i) {
    const Eigen::Vector3d p = on_shaft(shaft_length * i / 60);
    points << p.x() << ',' << p.y() << ',' << p.z() << '\n';
  }
  points.close();
  const std::string file = folder + "rest_scene.toml";
  std::ofstream(file) << "gravity = [0, 0, 0]\n[rod]\nlength = \"240 mm\"\n"
                         "bending_stiffness = 1e-3\nmass_per_length = 0.01\n"
                         "rest_shape = \"rest_points.csv\"\n"
                      << test::level_clamp;
  const Scene scene = load_scene(file);
  EXPECT_LT(largest_distance_from_curve(scene, Model::energy, on_shaft), 1e-8);
}

std::string refusal(const std::string& rod) {
  return test::scene_error("[rod]\nlength = 1\nbending_stiffness = 1\nmass_per_length = 1\n" + rod +
                           test::level_clamp);
}

TEST(RestShape, SaysWhatIsWrong) {
  const auto expect = [](const std::string& rod, const std::string& message) {
    EXPECT_TRUE(has_all(refusal(rod), {message}));
  };
  expect("rest_shape = \"none.csv\"\n", "no such file beside the scene");
  expect("rest_shape = [[0, 0, 0], [0.5, 0, 0]]\n", "2 points (allowed: 5 or more");
  expect("rest_shape = [[0,0,0], [0.1,0,0], [0.2,0,0], [0.3,0,0], [0.4,0,0]]\n",
         "a curve 0.4 m long, but the rod is 1 m long");
  expect("helix = { radius = 0.1, pitch = 0.1 }\nnatural_twist = 1\n",
         "given besides natural_twist");
  expect("rest_shape = \"a.csv\"\nhelix = { radius = 0.1, pitch = 0.1 }\n", "given besides helix");
  expect("helix = { radius = 0, pitch = 0.1 }\n", "helix.radius");
}

Scene helix_scene(double pitch, double gravity) {
  Scene scene = bare_scene(helix_length);
  scene.gravity = {0, 0, -gravity};
  scene.natural_strain = helix_strain(helix_radius, pitch);
  const double c = pitch / (2 * std::numbers::pi);
  const Eigen::Vector3d t = Eigen::Vector3d(0, helix_radius, c).normalized();
  Gripper clamp{.at = 0, .position = {helix_radius, 0, 0}, .direction = t};
  // d1 points to the axis of the helix.
  clamp.frame = FrameHold{.d1 = Eigen::Vector3d(-1, 0, 0)};
  scene.grippers = {clamp};
  return scene;
}

TEST(Helix, ReturnsItsOwnPointsOfEitherHand) {
  for (const double hand : {1, -1}) {
    const auto curve = [&](double s) {
      const Eigen::Vector3d p = on_helix(s);
      return Eigen::Vector3d(p.x(), p.y(), hand * p.z());
    };
    for (const Model model : {Model::energy, Model::exact}) {
      EXPECT_LT(largest_distance_from_curve(helix_scene(hand * helix_pitch, 0), model, curve),
                1e-9 * helix_length)
          << to_string(model) << hand;
    }
  }
}

/// Returns d1 at an arc length of the helix. d1 points to the axis, rotated about the tangent by
/// `extra` [1/m] times s.
Eigen::Vector3d d1_on_helix(double s, double extra) {
  const double c = helix_pitch / (2 * std::numbers::pi);
  const double a = s / std::hypot(helix_radius, c);
  const Eigen::Vector3d inward(-std::cos(a), -std::sin(a), 0);
  const Eigen::Vector3d t =
      Eigen::Vector3d(-helix_radius * std::sin(a), helix_radius * std::cos(a), c).normalized();
  return Eigen::AngleAxisd(extra * s, t) * inward;
}

MeasuredShape framed_helix(int count, double extra) {
  MeasuredShape shape = points_of(on_helix, helix_length, count);
  shape.d1.resize(3, count);
  for (int i = 0; i < count; ++i) {
    shape.arc_length.push_back(helix_length * i / (count - 1));
    shape.d1.col(i) = d1_on_helix(shape.arc_length.back(), extra);
  }
  return shape;
}

/// Returns a flat cable whose rest shape is a helix.
Scene flat_helix(const RestShape& shape) {
  Scene scene = resting_scene(shape, helix_length);
  scene.given_bending_stiffness_2 = 5e-3;
  return scene;
}

/// Returns the largest distance of points, and the largest angle of d1, between a solved shape and
/// the helix [m, rad].
Eigen::Vector2d largest_distance_from_helix(const Scene& scene, Model model, double extra) {
  const Solution solution = solve(scene, model, {}, equal_arc_lengths(helix_length, 61));
  Eigen::Vector2d most = Eigen::Vector2d::Zero();
  for (Eigen::Index i = 0; i <= 60; ++i) {
    const double s = solution.shape.arc_length[static_cast<std::size_t>(i)];
    const Eigen::Vector3d d1 = solution.d1.col(i);
    const Eigen::Vector3d truth = d1_on_helix(s, extra);
    most = most.cwiseMax(Eigen::Vector2d((solution.shape.points.col(i) - on_helix(s)).norm(),
                                         std::atan2(d1.cross(truth).norm(), d1.dot(truth))));
  }
  return most;
}

TEST(RestFrames, OfAHelixItselfMakeItOneArc) {
  const RestShape shape = fit_rest_shape(framed_helix(41, 0), helix_length);
  ASSERT_EQ(shape.arcs.size(), 1);
  EXPECT_LT((shape.arcs[0].strain - helix_strain(helix_radius, helix_pitch)).norm(), 1e-6);
  EXPECT_LT(shape.largest_error, 1e-10);
  EXPECT_LT(shape.largest_angle.value(), 1e-8);
  MeasuredShape bare = framed_helix(41, 0);
  bare.d1.resize(3, 0);
  EXPECT_FALSE(fit_rest_shape(bare, helix_length).largest_angle);
}

TEST(RestFrames, OfAFlatSectionThatTwistsOtherwiseComeBackToTheStatedErrors) {
  for (const double extra : {20.0, -35.0}) {
    const RestShape shape = fit_rest_shape(framed_helix(141, extra), helix_length);
    EXPECT_GT(shape.arcs.size(), 8);
    const Scene scene = flat_helix(shape);
    EXPECT_TRUE(scene.naturally_twisted());
    for (const Model model : {Model::energy, Model::exact}) {
      const Eigen::Vector2d away = largest_distance_from_helix(scene, model, extra);
      EXPECT_LT(away[0], 1.1 * shape.largest_error) << to_string(model) << extra;
      EXPECT_LT(away[1], 1.1 * shape.largest_angle.value()) << to_string(model) << extra;
    }
  }
}

TEST(RestFrames, ConvergeWithTheNumberOfPoints) {
  // The points determine 8, 16 and 32 arcs of constant strain. The remaining error of points is of
  // third order in the length of an arc, that of directions of second order.
  std::vector<Eigen::Vector2d> away;
  for (const int count : {22, 43, 86}) {
    const RestShape shape = fit_rest_shape(framed_helix(count, 20), helix_length);
    away.push_back(largest_distance_from_helix(flat_helix(shape), Model::exact, 20));
  }
  for (std::size_t i = 0; i + 1 < away.size(); ++i) {
    EXPECT_GT(std::log2(away[i][0] / away[i + 1][0]), 2.9);
    EXPECT_GT(std::log2(away[i][1] / away[i + 1][1]), 1.9);
  }
}

TEST(RestFrames, OfASolvedShapeAreReadAsItIsWritten) {
  const Scene scene = flat_helix(fit_rest_shape(framed_helix(41, 0), helix_length));
  const Solution solution = solve(scene, Model::exact, {}, equal_arc_lengths(helix_length, 41));
  const RestShape again = fit_rest_shape(
      parse_shape(vtk_polyline(solution.shape, {.d1 = solution.d1}, "a helix"), "shape.vtk"),
      helix_length);
  ASSERT_EQ(again.arcs.size(), 1);
  EXPECT_LT((again.arcs[0].strain - scene.natural_strain).norm(), 1e-6);
}

TEST(RestFrames, OfEitherEndAreTheSameRod) {
  MeasuredShape backwards = framed_helix(41, 20);
  const RestShape forwards = fit_rest_shape(backwards, helix_length);
  backwards.points = backwards.points.rowwise().reverse().eval();
  backwards.d1 = backwards.d1.rowwise().reverse().eval();
  std::reverse(backwards.arc_length.begin(), backwards.arc_length.end());
  EXPECT_EQ(fit_rest_shape(backwards, helix_length), forwards);
}

TEST(RestFrames, InThePlaneOfTheirPointsSayTheSideOfD2) {
  MeasuredShape points = points_of(on_shaft, shaft_length, 121);
  for (const double side : {1, -1}) {
    points.d1.resize(3, 121);
    for (int i = 0; i <= 120; ++i) {
      const Eigen::Vector3d ahead = on_shaft(shaft_length * i / 120 + 1e-8);
      const Eigen::Vector3d behind = on_shaft(shaft_length * i / 120 - 1e-8);
      points.d1.col(i) = side * Eigen::Vector3d::UnitZ().cross((ahead - behind).normalized());
    }
    const RestShape shape = fit_rest_shape(points, shaft_length);
    ASSERT_EQ(shape.arcs.size(), 12);
    EXPECT_EQ(shape.first_frame(2, 1), side);
    EXPECT_NEAR(shape.arcs[10].strain.y(), side * 80, 1e-5);
    EXPECT_EQ(shape.arcs[10].strain.x(), 0);
    EXPECT_LT(shape.largest_angle.value(), 1e-6);
    EXPECT_TRUE(resting_scene(shape, shaft_length).planar());
  }
}

TEST(RestFrames, SmoothNoise) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 1);
  MeasuredShape points = framed_helix(141, 0);
  for (Eigen::Index i = 0; i < 141; ++i) {
    const Eigen::Vector3d turn(noise(random), noise(random), noise(random));
    points.points.col(i) += 1e-4 * Eigen::Vector3d(noise(random), noise(random), noise(random));
    points.d1.col(i) = (points.d1.col(i) + 1e-2 * turn).normalized();
  }
  const RestShape shape = fit_rest_shape(points, helix_length);
  EXPECT_LT(shape.arcs.size(), 4);
  const Eigen::Vector2d away = largest_distance_from_helix(flat_helix(shape), Model::energy, 0);
  EXPECT_LT(away[0], 3e-4);
  EXPECT_LT(away[1], 2e-2);
  EXPECT_GT(shape.largest_angle.value(), 1e-2);
}

TEST(RestFrames, SayWhatIsWrong) {
  const auto expect = [](const std::string& text, const std::string& message) {
    EXPECT_TRUE(has_all(
        error_of<InputError>([&] { return fit_rest_shape(parse_shape(text, "mine.csv"), 0.4); }),
        {message}));
  };
  const std::string head = "x,y,z,d1_x,d1_y,d1_z\n0,0,0,0,0,1\n0.1,0,0,0,0,1\n0.2,0,0,";
  const std::string tail = "\n0.3,0,0,0,0,1\n0.4,0,0,0,0,1\n";
  expect(head + "0,0,0.9" + tail,
         "mine.csv:4: point 3: d1 = [0, 0, 0.9] of norm 0.9 (allowed: 1 within 0.001)");
  expect(head + "0.6,0,0.8" + tail,
         "mine.csv:4: point 3: d1 is 36.9 degrees off the cross-section (allowed: up to 5,");
  expect(head + ",," + tail, "mine.csv:4: d1_x = \"\" is not a number (allowed: d1 in every row");
  expect(head + "0,0,-1" + tail, "mine.csv: d1 rotates by a right angle or more to point 3");
  expect("x,y,d1_x,d1_z\n", "mine.csv:1: 2 of the columns d1_x, d1_y, d1_z (allowed: all");
  expect(R"({"points": [[0,0],[1,0]], "d1": [[0,1]]})",
         "d1: 1 vectors of 2 points (allowed: one a point, or none)");
  EXPECT_TRUE(has_all(refusal("rest_shape = [[0,0,0,0,0,1], [0.5,0,0]]\n"),
                      {"six with a vector in every"}));
}

TEST(Helix, IsAKeyOfTheRod) {
  const Scene scene = parse_scene(
      "[rod]\nlength = 0.3\nbending_stiffness = 1e-3\nmass_per_length = 0.01\n"
      "helix = { radius = \"2 cm\", pitch = \"-1 cm\" }\n" +
          test::level_clamp,
      "my.toml");
  EXPECT_EQ(scene.natural_strain, helix_strain(0.02, -0.01));
  EXPECT_LT(scene.natural_strain.z(), 0);
  EXPECT_EQ(helix_strain(0.5, 0), Eigen::Vector3d(0, 2, 0));
}

TEST(Helix, IsToldByModelsOfAPolygon) {
  Scene scene = helix_scene(helix_pitch, 9.81);
  scene.force_model.law = BendingLaw::hooke;
  EXPECT_EQ(solve(scene, Model::chain).neglected, std::vector<std::string>{"natural curvature"});
}

}  // namespace
}  // namespace dlo::compare
