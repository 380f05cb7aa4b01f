// Stress-free shapes that are said by a helix or by points in space.

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

#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solve.hpp"
#include "scene/scene_template.hpp"
#include "trajectory/trajectory_files.hpp"

namespace dlo::compare {
namespace {

constexpr double shaft_length = 0.24;

/// A shaft of 0.2 m, an arc of 80 1/m and one of 40 1/m, 0.02 m each.
Eigen::Vector3d on_shaft(double s) {
  const double a = 80 * std::clamp(s - 0.2, 0.0, 0.02);
  const double b = a + 40 * std::max(s - 0.22, 0.0);
  return {std::min(s, 0.2) + std::sin(a) / 80 + (std::sin(b) - std::sin(a)) / 40,
          (1 - std::cos(a)) / 80 + (std::cos(a) - std::cos(b)) / 40, 0};
}

constexpr double helix_radius = 0.02;
constexpr double helix_pitch = 0.0628;
constexpr double helix_length = 0.28;

/// Along z, which begins at (R, 0, 0).
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

/// Held by its first end where its rest shape begins.
Scene resting_scene(const RestShape& shape, double length) {
  Scene scene = bare_scene(length);
  scene.set_rest_shape(shape);
  Gripper clamp{.at = 0, .position = shape.begin, .direction = shape.first_frame.col(2)};
  clamp.frame = FrameHold{.d1 = shape.first_frame.col(0)};
  scene.grippers = {clamp};
  return scene;
}

/// The farthest that points at equal arc lengths of a curve are from a solved shape's.
double farthest(const Scene& scene, Model model,
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

TEST(RestShape, ArcsAreFoundWhereTheyAre) {
  // Neither the points nor anything else says where the arcs meet.
  for (const int count : {50, 137, 1000}) {
    const RestShape shape = fit_rest_shape(points_of(on_shaft, shaft_length, count), shaft_length);
    ASSERT_EQ(shape.arcs.size(), 3) << count;
    EXPECT_NEAR(shape.arcs[0].end, 0.2, 1e-8);
    EXPECT_NEAR(shape.arcs[1].end, 0.22, 1e-8);
    EXPECT_EQ(shape.arcs[2].end, shaft_length);
    EXPECT_NEAR(shape.arcs[1].curvature.y(), 80, 1e-5);
    EXPECT_NEAR(shape.arcs[2].curvature.y(), 40, 1e-5);
    EXPECT_EQ(shape.arcs[1].curvature.x(), 0);
    EXPECT_LT(shape.largest_error, 1e-9);
    EXPECT_EQ(shape.points, count);
  }
}

TEST(RestShape, ARodThatIsHeldByOneEndComesBackToTheStatedError) {
  const RestShape shaft = fit_rest_shape(points_of(on_shaft, shaft_length, 241), shaft_length);
  const Scene bent = resting_scene(shaft, shaft_length);
  EXPECT_TRUE(bent.planar());
  const RestShape helix = fit_rest_shape(points_of(on_helix, helix_length, 141), helix_length);
  EXPECT_GT(helix.arcs.size(), 8);
  EXPECT_LT(helix.largest_error, 5e-5 * helix_length);
  for (const Model model : {Model::energy, Model::exact}) {
    EXPECT_LT(farthest(bent, model, on_shaft), shaft.largest_error + 1e-9) << to_string(model);
    // Arc lengths of points are not known, and slide by no more than they are off.
    EXPECT_LT(farthest(resting_scene(helix, helix_length), model, on_helix),
              2 * helix.largest_error)
        << to_string(model);
  }
}

TEST(RestShape, NoiseIsSmoothed) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 1e-4);
  MeasuredShape points = points_of(on_shaft, shaft_length, 241);
  for (double& number : points.points.reshaped()) number += noise(random);
  const RestShape shape = fit_rest_shape(points, shaft_length);
  EXPECT_LT(shape.arcs.size(), 12);
  // Of two directions across the rod; what lies along it is not seen.
  EXPECT_NEAR(shape.rms_error, std::sqrt(2) * 1e-4, 2e-5);
  const Scene scene = resting_scene(shape, shaft_length);
  EXPECT_LT(farthest(scene, Model::energy, on_shaft), 5e-4);
}

TEST(RestShape, BeginsAtEitherEndWhereArcLengthsSaySo) {
  MeasuredShape forwards = points_of(on_shaft, shaft_length, 121);
  for (int i = 0; i <= 120; ++i) forwards.arc_length.push_back(shaft_length * i / 120);
  MeasuredShape backwards = forwards;
  backwards.points = forwards.points.rowwise().reverse();
  std::reverse(backwards.arc_length.begin(), backwards.arc_length.end());
  EXPECT_EQ(fit_rest_shape(backwards, shaft_length), fit_rest_shape(forwards, shaft_length));
}

TEST(RestShape, SectionsKeepTheirOwnStiffness) {
  const RestShape shape = fit_rest_shape(points_of(on_shaft, shaft_length, 121), shaft_length);
  Scene scene = bare_scene(shaft_length);
  scene.sections = {{.from = 0.1, .to = 0.21, .bending_stiffness = 5e-3, .mass_per_length = 0.02}};
  const double mass = scene.mass();
  scene.set_rest_shape(shape);
  ASSERT_EQ(scene.sections.size(), 5);
  EXPECT_NEAR(scene.mass(), mass, 1e-12);
  EXPECT_EQ(scene.sections[2].bending_stiffness, 5e-3);
  EXPECT_NEAR(scene.sections[2].natural_curvature->y(), 80, 1e-5);
  EXPECT_EQ(scene.sections[3].bending_stiffness, 1e-3);
  EXPECT_FALSE(scene.without_natural_strain().naturally_bent());
  EXPECT_FALSE(scene.without_natural_strain().rest_shape);
}

TEST(RestShape, IsReadFromAFileOrRows) {
  const std::string folder = testing::TempDir();
  std::ofstream points(folder + "rest_points.csv");
  std::string rows;
  for (int i = 0; i <= 60; ++i) {
    const Eigen::Vector3d p = on_shaft(shaft_length * i / 60);
    points.precision(17);
    points << p.x() << ',' << p.y() << ',' << p.z() << '\n';
    rows += (i > 0 ? ", [" : "[") + std::to_string(p.x()) + ", " + std::to_string(p.y()) + ", 0]";
  }
  points.close();
  const std::string head =
      "gravity = [0, 0, 0]\n[rod]\nlength = \"240 mm\"\nbending_stiffness = 1e-3\n"
      "mass_per_length = 0.01\n";
  const std::string clamp = "[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = \"0 deg\"\n";
  const std::string file = folder + "rest_scene.toml";
  const std::string text = head + "rest_shape = \"rest_points.csv\"\n" + clamp;
  std::ofstream(file) << text;
  const Scene scene = load_scene(file);
  EXPECT_LT(farthest(scene, Model::energy, on_shaft), 1e-8);
  EXPECT_EQ(trajectory_files(file), std::vector<std::string>{folder + "rest_points.csv"});
  EXPECT_EQ(load_scene_template(file).with({}).rest_shape->arcs, scene.rest_shape->arcs);
  const Scene in_rows = parse_scene(head + "rest_shape = [" + rows + "]\n" + clamp, "my.toml");
  EXPECT_LT(farthest(in_rows, Model::energy, on_shaft), 1e-5);
  EXPECT_GT(in_rows.rest_shape->largest_error, 1e-8);  // six decimals
}

std::string refusal(const std::string& rod) {
  try {
    (void)parse_scene("[rod]\nlength = 1\nbending_stiffness = 1\nmass_per_length = 1\n" + rod +
                          "[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = \"0 deg\"\n",
                      "my.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(RestShape, SaysWhatIsWrong) {
  const auto expect = [](const std::string& rod, const std::string& message) {
    EXPECT_NE(refusal(rod).find(message), std::string::npos) << refusal(rod);
  };
  expect("rest_shape = \"none.csv\"\n", "no such file beside the scene");
  expect("rest_shape = [[0, 0, 0], [0.5, 0, 0]]\n", "2 points (allowed: 5 or more");
  expect("rest_shape = [[0,0,0], [0.1,0,0], [0.2,0,0], [0.3,0,0], [0.4,0,0]]\n",
         "a curve 0.4 m long, the rod is 1 m long");
  expect("helix = { radius = 0.1, pitch = 0.1 }\nnatural_twist = 1\n",
         "given besides natural_twist");
  expect("rest_shape = \"a.csv\"\nhelix = { radius = 0.1, pitch = 0.1 }\n", "given besides helix");
  expect("helix = { radius = 0, pitch = 0.1 }\n", "helix.radius");
  expect("helix = { radius = 0.1 }\n", "helix.pitch");
}

Scene helix_scene(double pitch, double gravity) {
  Scene scene = bare_scene(helix_length);
  scene.gravity = {0, 0, -gravity};
  scene.natural_strain = helix_strain(helix_radius, pitch);
  const double c = pitch / (2 * std::numbers::pi);
  const Eigen::Vector3d t = Eigen::Vector3d(0, helix_radius, c).normalized();
  Gripper clamp{.at = 0, .position = {helix_radius, 0, 0}, .direction = t};
  // Towards the axis.
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
      EXPECT_LT(farthest(helix_scene(hand * helix_pitch, 0), model, curve), 1e-9 * helix_length)
          << to_string(model) << hand;
    }
  }
}

TEST(Helix, UnderGravityIsOneShapeOfTwoMethods) {
  const Scene scene = helix_scene(helix_pitch, 9.81);
  std::vector<double> s;
  for (int i = 0; i <= 60; ++i) s.push_back(scene.length * i / 60);
  const Eigen::Matrix3Xd energy = solve_reference(scene, Model::energy).sample(s).points;
  const Eigen::Matrix3Xd exact = solve_reference(scene, Model::exact).sample(s).points;
  EXPECT_LT((energy - exact).colwise().norm().maxCoeff(), 1e-7 * scene.length);
  // It is no rigid body.
  EXPECT_GT((energy.rightCols<1>() - on_helix(scene.length)).norm(), 1e-2 * scene.length);
}

TEST(Helix, IsAKeyOfTheRod) {
  const Scene scene = parse_scene(
      "[rod]\nlength = 0.3\nbending_stiffness = 1e-3\nmass_per_length = 0.01\n"
      "helix = { radius = \"2 cm\", pitch = \"-1 cm\" }\n"
      "[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = \"0 deg\"\n",
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
