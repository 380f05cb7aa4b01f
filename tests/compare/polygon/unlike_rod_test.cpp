// Tests of polygons of rods with sections and of intrinsically curved rods, against the rod's
// differential equation and against each other.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/chain.hpp"
#include "dlo/compare/discretise.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/plan.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solve.hpp"

namespace dlo::compare {
namespace {

using test::error_of;
using test::says;

/// A metre of rod, clamped level at arc length 0.
Scene cantilever(double natural_curvature) {
  Scene scene;
  scene.name = "unlike";
  scene.file = "unlike.toml";
  scene.length = 1;
  scene.given_bending_stiffness = 0.2;
  scene.given_mass_per_length = 0.1;
  scene.natural_strain.y() = natural_curvature;
  scene.grippers = {
      {.at = 0, .position = {0, 0, 0}, .direction = Eigen::Vector3d(1, 0, 0), .frame = {}}};
  scene.force_model.law = BendingLaw::hooke;
  return scene;
}

std::vector<Section> two_sections() {
  return {{.from = 0.2, .to = 0.45, .bending_stiffness = 0.8, .mass_per_length = 0.4},
          {.from = 0.45, .to = 0.6, .bending_stiffness = 0.1, .mass_per_length = 0.05}};
}

/// The rod as a boundary value problem in the plane: with the angle a of the tangent,
///     a' = k + M / EI,  M' = W cos a,  M(l) = 0,
/// W the weight beyond s. Runge and Kutta's method, of which no step passes the end of a section,
/// and bisection over M(0).
class Continuous {
 public:
  explicit Continuous(const Scene& scene) : scene_(scene), curvature_(scene.natural_strain.y()) {
    double low = -5;
    double high = 5;
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      (run(middle) > 0 ? high : low) = middle;
    }
    (void)run((low + high) / 2);
  }

  [[nodiscard]] Eigen::Vector3d at(double s) const {
    const auto i = static_cast<std::size_t>(std::clamp(s * steps, 0.0, steps - 1.0));
    const double share = s * steps - static_cast<double>(i);
    return (1 - share) * points_[i] + share * points_[i + 1];
  }

 private:
  static constexpr int steps = 4000;

  // Angle, moment, x, y.
  [[nodiscard]] Eigen::Vector4d slope(double s, double EI, double w_beyond, double w,
                                      const Eigen::Vector4d& state, double from) const {
    const double W = w_beyond - w * (s - from);
    return {curvature_ + state[1] / EI, W * std::cos(state[0]), std::cos(state[0]),
            std::sin(state[0])};
  }

  double run(double moment) {
    Eigen::Vector4d state(0, moment, 0, 0);
    points_.assign(1, Eigen::Vector3d::Zero());
    constexpr double h = 1.0 / steps;
    for (int i = 0; i < steps; ++i) {
      const double s = h * i;
      const double EI = h / scene_.bending_compliance(s, s + h);
      const double w = scene_.weight_between(s, s + h).norm() / h;
      const double beyond = scene_.weight_between(s, scene_.length).norm();
      const auto f = [&](double at, const Eigen::Vector4d& y) {
        return slope(at, EI, beyond, w, y, s);
      };
      const Eigen::Vector4d k1 = f(s, state);
      const Eigen::Vector4d k2 = f(s + h / 2, state + h / 2 * k1);
      const Eigen::Vector4d k3 = f(s + h / 2, state + h / 2 * k2);
      const Eigen::Vector4d k4 = f(s + h, state + h * k3);
      state += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      points_.emplace_back(state[2], state[3], 0);
    }
    return state[1];
  }

  const Scene& scene_;
  double curvature_;
  std::vector<Eigen::Vector3d> points_;
};

double largest_error(const Continuous& rod, const Solution& solution) {
  double largest = 0;
  for (std::size_t i = 0; i < solution.shape.arc_length.size(); ++i) {
    const Eigen::Vector3d point = solution.shape.points.col(static_cast<Eigen::Index>(i));
    largest = std::max(largest, (point - rod.at(solution.shape.arc_length[i])).norm());
  }
  return largest;
}

TEST(UnlikeRod, ThePolygonConvergesToTheRodWithSecondOrder) {
  for (const bool sections : {false, true}) {
    for (const double curvature : {0.0, 3.0, -5.0}) {
      Scene scene = cantilever(curvature);
      if (sections) scene.sections = two_sections();
      const Continuous rod(scene);
      double first = 0;
      for (const int points : {20, 40, 80, 160}) {
        scene.force_model.points = points;
        const double error = largest_error(rod, solve(scene, Model::chain));
        if (first == 0) first = error;
        const double expected = first * std::pow(20.0 / points, 2);
        EXPECT_LT(error, 1.05 * expected) << sections << " " << curvature << " " << points;
      }
      EXPECT_LT(first, 0.005);
    }
  }
}

TEST(UnlikeRod, TheContinuousModelsAreTheRod) {
  for (const bool sections : {false, true}) {
    for (const double curvature : {3.0, -5.0}) {
      Scene scene = cantilever(curvature);
      if (sections) scene.sections = two_sections();
      const Continuous rod(scene);
      scene.force_model.points = 160;
      const double bending = solve(scene, Model::chain).energy.bending;
      for (const Model model : {Model::energy, Model::exact}) {
        const Solution solution = solve(scene, model);
        // The lines between the points of the reference are off by h^2 k / 8.
        EXPECT_LT(largest_error(rod, solution), 1e-6) << to_string(model) << sections << curvature;
        EXPECT_NEAR(solution.energy.bending, bending, 1e-3 * bending) << to_string(model);
      }
    }
  }
}

TEST(UnlikeRod, WithoutLoadsThePolygonLiesOnTheStressFreeCircle) {
  Scene scene = cantilever(2);
  scene.gravity.setZero();
  const Solution solution = solve(scene, Model::chain, {}, {0, 0.5, 1});
  EXPECT_NEAR(solution.energy.bending, 0, 1e-12);
  const double L = 1 / (scene.force_model.points - 1.5);
  const Eigen::Vector3d tip = solution.shape.points.rightCols<1>();
  const Eigen::Vector3d expected(std::sin(2) / 2, (1 - std::cos(2)) / 2, 0);
  EXPECT_LT((tip - expected).norm(), 0.5 * L * L * 4);
}

TEST(UnlikeRod, ForceModelAndChainComeToRestInTheSameShape) {
  for (const bool two_clamps : {false, true}) {
    Scene scene = cantilever(3);
    scene.sections = two_sections();
    if (two_clamps) {
      scene.grippers.push_back(
          {.at = 1, .position = {0.7, 0.1, 0}, .direction = Eigen::Vector3d(1, 0, 0), .frame = {}});
    }
    const Solution chain = solve(scene, Model::chain);
    const Solution force = solve(scene, Model::force);
    EXPECT_TRUE(force.neglected.empty());
    // The single clamp's chain does not stretch.
    const double stretch =
        two_clamps ? 0 : scene.mass() * scene.gravity.norm() / scene.axial_stiffness();
    EXPECT_LT((force.shape.points - chain.shape.points).cwiseAbs().maxCoeff(), 1e-6 + stretch);
    EXPECT_NEAR(force.energy.bending, chain.energy.bending, 1e-3 * chain.energy.bending);
    for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
      EXPECT_LT((force.grippers[i].torque - chain.grippers[i].torque).norm(), 1e-3);
    }
  }
}

TEST(UnlikeRod, CountedFromTheOtherEndIsTheSameRod) {
  for (const Model model : {Model::chain, Model::force}) {
    Scene scene = cantilever(3);
    scene.sections = {{.from = 0, .to = 0.3, .bending_stiffness = 0.8, .mass_per_length = 0.4}};
    Scene reversed = cantilever(-3);
    reversed.sections = {{.from = 0.7, .to = 1, .bending_stiffness = 0.8, .mass_per_length = 0.4}};
    reversed.grippers[0].at = 1;
    reversed.grippers[0].direction = Eigen::Vector3d(-1, 0, 0);
    const Eigen::Matrix3Xd points = solve(scene, model).shape.points;
    const Eigen::Matrix3Xd back = solve(reversed, model).shape.points.rowwise().reverse();
    EXPECT_LT((points - back).cwiseAbs().maxCoeff(), 1e-6) << to_string(model);
  }
}

Scene turned(Scene scene, const Eigen::Matrix3d& R, const Eigen::Vector3d& shift) {
  scene.gravity = R * scene.gravity;
  for (Gripper& gripper : scene.grippers) {
    gripper.position = R * gripper.position + shift;
    gripper.direction = R * *gripper.direction;
    // d2 is the plane's normal; the default would be that on the side of +z.
    gripper.frame = FrameHold{.d1 = R * Eigen::Vector3d(0, 1, 0)};
  }
  return scene;
}

TEST(UnlikeRod, MayLieInAnyPlane) {
  const Scene scene = cantilever(3);
  // d1 = normal x t is to the left of t.
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, 2, -3).normalized()).toRotationMatrix();
  const Eigen::Vector3d shift(0.1, -0.4, 0.7);
  const Scene other = turned(scene, R, shift);
  ASSERT_TRUE(other.planar());
  for (const Model model : {Model::energy, Model::chain, Model::force}) {
    const Solution here = solve(scene, model);
    const Solution there = solve(other, model);
    const Eigen::Matrix3Xd expected = (R * here.shape.points).colwise() + shift;
    EXPECT_LT((there.shape.points - expected).cwiseAbs().maxCoeff(), 1e-6) << to_string(model);
    EXPECT_LT((there.grippers[0].torque - R * here.grippers[0].torque).norm(), 1e-5);
    EXPECT_LT((there.grippers[0].force - R * here.grippers[0].force).norm(), 1e-5);
  }
  EXPECT_THROW((void)discretise(other, other.force_model), InputError);
}

TEST(UnlikeRod, SaysWhereNaturalCurvatureIsLeftOut) {
  const std::vector<std::string> curvature = {"natural curvature"};
  Scene scene = cantilever(3);
  for (const Model model : {Model::chain, Model::force}) {
    scene = cantilever(3);
    EXPECT_TRUE(solve(scene, model).neglected.empty());
    scene.force_model.law = BendingLaw::paper;
    const Solution paper = solve(scene, model);
    EXPECT_EQ(paper.neglected, curvature);
    const Scene straight = scene.without_natural_strain();
    EXPECT_EQ(solve(straight, model).shape.points, paper.shape.points);
    // In space points have no frame that it could point along.
    scene.force_model.law = BendingLaw::hooke;
    scene.natural_strain.x() = 1;
    EXPECT_EQ(solve(scene, model).neglected, curvature);
  }
  const Plan plan = make_plan(scene);
  EXPECT_GT(plan.bound("natural curvature"), -1);
  EXPECT_TRUE(std::isinf(plan.bound("polygon")));
}

TEST(UnlikeRod, RefusesJointsThatWouldFold) {
  Scene scene = cantilever(80);
  EXPECT_TRUE(says(error_of<InputError>([&] { return discretise(scene, scene.force_model); }),
                   {"force_model.points = 16", "5.52 rad", "80 1/m", "points or more"}));
  scene.force_model.points = 59;
  EXPECT_NO_THROW((void)discretise(scene, scene.force_model));
}

TEST(UnlikeRod, WeighsWhatItsSectionsDo) {
  for (const Bookkeeping bookkeeping : {Bookkeeping::paper, Bookkeeping::consistent}) {
    for (const BendingLaw law : {BendingLaw::paper, BendingLaw::hooke}) {
      Scene scene = cantilever(0);
      scene.sections = two_sections();
      scene.force_model.bookkeeping = bookkeeping;
      scene.force_model.law = law;
      const Discretisation polygon = discretise(scene, scene.force_model);
      EXPECT_NEAR(polygon.weights.row(1).sum(), -9.81 * scene.mass(), 1e-12);
      // A joint inside a section is as much stiffer as the section is.
      const force_model::Bending& bending = polygon.rod.bending;
      EXPECT_NEAR(bending.stiffnesses.maxCoeff(), 4 * bending.stiffness, 1e-12 * bending.stiffness);
      EXPECT_NEAR(bending.stiffnesses.minCoeff(), bending.stiffness / 2, 1e-12 * bending.stiffness);
    }
  }
}

TEST(UnlikeRod, TheExampleScenesSolve) {
  for (const std::string name : {"spring_hose", "spliced_cable"}) {
    const Scene scene = load_scene(std::string(DLO_DATA) + "/scenes/" + name + ".toml");
    for (const Model model : {Model::energy, Model::chain, Model::exact, Model::force}) {
      EXPECT_NO_THROW((void)solve(scene, model)) << name << " " << to_string(model);
    }
  }
}

}  // namespace
}  // namespace dlo::compare
