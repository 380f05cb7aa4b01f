// Tests of scenes with several grips, or one inside the rod, in the models that work on a polygon.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "../../sanitized.hpp"
#include "../../says.hpp"
#include "dlo/compare/chain.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"
#include "scenes.hpp"
#include "solve/polygon_solution.hpp"

namespace dlo::compare {
namespace {

using Eigen::Vector3d;

Scene spatial_clamps() { return two_clamps(5, {0.6, 0.1, 0.2}, {0.5, 0.3, -0.6}); }

Scene clamp_inside() {
  Scene scene = heavy_scene(8, 20);
  scene.grippers[0].at = 0.37;
  return scene;
}

Scene clamp_and_pin() {
  Scene scene = heavy_scene(6, 10);
  scene.grippers.push_back({.at = 0.613, .position = {0.5, 0.05, 0}});
  return scene;
}

Scene two_pins() {
  Scene scene = heavy_scene(6, 0);
  scene.grippers = {{.at = 0.21, .position = {0, 0, 0}}, {.at = 0.83, .position = {0.5, 0.1, 0}}};
  return scene;
}

Scene loaded_clamps() {
  Scene scene = two_clamps(3, {0.8, 0, 0});
  scene.loads = {{0.413, {0.5, -4, 0}}};
  return scene;
}

Scene three_clamps() {
  Scene scene = two_clamps(10, {0.8, 0, 0});
  scene.grippers.push_back(
      {.at = 0.44, .position = {0.35, 0.02, 0}, .direction = Vector3d(1, 0.2, 0).normalized()});
  return scene;
}

/// Returns a rod between two clamps that sags onto a compliant floor.
Scene yielding_floor() {
  Scene scene = two_clamps(30, {0.9, 0.2, 0});
  scene.obstacles = {{.stiffness = 20000 * scene.bending_stiffness()}};
  return scene;
}

/// Replaces a shape that leaves the plane z = 0 of its scene by its mirror image, which has the
/// same energy, if that is on the side of the given points.
void choose_nearer_mirror_image(const Eigen::Matrix3Xd& points, Solution& solution) {
  if (solution.shape.points.row(2).dot(points.row(2)) >= 0) return;
  solution.shape.points.row(2) *= -1;
  for (auto& gripper : solution.grippers) {
    gripper.force.z() *= -1;
    gripper.torque.head<2>() *= -1;
  }
}

/// Segment length [m] of a chain and its errors against the energy model. The error of the shape is
/// an RMS [m]; those of forces and torques are divided by the largest force and torque, if it is
/// not zero.
struct Errors {
  double segment = 0;
  double shape = 0;
  double force = 0;
  double torque = 0;
};

Errors chain_errors(Scene scene, const energy_model::Equilibrium& reference, int points) {
  scene.force_model.points = points;
  // The energy model does not stretch; a hundred times AE stretches by less than 1e-7.
  scene.force_model.c_c = 100 * scene.axial_stiffness();
  Solution chain = solve_chain(scene, scene.force_model);
  const std::vector<double> s = chain.shape.arc_length;
  const Eigen::Matrix3Xd expected_points = reference.sample(s).points;
  if (scene.planar()) choose_nearer_mirror_image(expected_points, chain);
  Errors errors;
  errors.segment = chain.parameters.segment_length;
  errors.shape = rms(s, chain.shape.points - expected_points);
  double largest_force = 0;
  double largest_torque = 0;
  for (std::size_t i = 0; i < chain.grippers.size(); ++i) {
    const energy_model::Reaction& expected = reference.grips[i];
    errors.force = std::max(errors.force, (chain.grippers[i].force - expected.force).norm());
    errors.torque = std::max(errors.torque, (chain.grippers[i].torque - expected.torque).norm());
    largest_force = std::max(largest_force, expected.force.norm());
    largest_torque = std::max(largest_torque, expected.torque.norm());
  }
  errors.force /= largest_force;
  if (largest_torque > 0) errors.torque /= largest_torque;
  return errors;
}

struct NamedScene {
  const char* name;
  Scene scene;
};

class SceneOfGrips : public testing::TestWithParam<NamedScene> {};

TEST_P(SceneOfGrips, ChainConvergesToTheEnergyModelAtSecondOrder) {
  const Scene& scene = GetParam().scene;
  const energy_model::Equilibrium reference = solve_reference(scene, Model::energy);
  // The two N differ by a factor of four, because the positions of grips and loads between points
  // vary with N.
  const Errors coarse = chain_errors(scene, reference, 24);
  const Errors fine = chain_errors(scene, reference, 96);
  const auto convergence_order_of = [&](double Errors::*error) {
    return std::log(coarse.*error / fine.*error) / std::log(coarse.segment / fine.segment);
  };
  EXPECT_NEAR(convergence_order_of(&Errors::shape), 2, 0.2);
  EXPECT_LT(fine.shape, 2e-4);
  EXPECT_LT(chain_errors(scene, reference, 64).shape, 5e-4);
  // The force of a single gripper equals the total load, for any shape.
  if (scene.grippers.size() > 1) EXPECT_GT(convergence_order_of(&Errors::force), 1.7);
  EXPECT_LT(fine.force, 2e-3);
  if (coarse.torque > 0) EXPECT_GT(convergence_order_of(&Errors::torque), 1.7);
  EXPECT_LT(fine.torque, 5e-3);
}

TEST_P(SceneOfGrips, ForceModelRestsInTheChainsPolygon) {
  for (const Bookkeeping bookkeeping : {Bookkeeping::consistent, Bookkeeping::paper}) {
    Scene scene = GetParam().scene;
    scene.force_model.bookkeeping = bookkeeping;
    const Solution chain = solve_chain(scene, scene.force_model);
    const Solution force = solve_force(scene, scene.force_model);
    EXPECT_LT((chain.shape.points - force.shape.points).colwise().norm().maxCoeff(), 1e-6);
    EXPECT_NEAR(force.energy.total(), chain.energy.total(), 1e-9 * std::abs(chain.energy.bending));
    // The force model stops 1e-7 l from rest, where its stiff segments still exert forces.
    for (std::size_t i = 0; i < chain.grippers.size(); ++i) {
      const double size = chain.grippers[i].force.norm();
      EXPECT_LT((chain.grippers[i].force - force.grippers[i].force).norm(), 1e-3 * size);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Of, SceneOfGrips,
                         testing::Values(NamedScene{"spatial_clamps", spatial_clamps()},
                                         NamedScene{"clamp_inside", clamp_inside()},
                                         NamedScene{"clamp_and_pin", clamp_and_pin()},
                                         NamedScene{"two_pins", two_pins()},
                                         NamedScene{"loaded_clamps", loaded_clamps()},
                                         NamedScene{"three_clamps", three_clamps()},
                                         NamedScene{"yielding_floor", yielding_floor()}),
                         [](const auto& instance) { return instance.param.name; });

TEST(Walls, RigidOnesAreEnteredByLessThanTheStretchOfTheRod) {
  Scene scene = yielding_floor();
  scene.obstacles[0].stiffness = std::numeric_limits<double>::infinity();
  // The steps to rest grow as the square of the points.
  scene.force_model.points = test::sanitized ? 24 : 48;
  const SolveOptions long_limit{.time_limit = 300};
  const Solution chain = solve_chain(scene, scene.force_model, long_limit);
  const double weight = scene.weight_per_length().norm() * scene.length;
  EXPECT_LT(-chain.shape.points.row(1).minCoeff(), weight / scene.axial_stiffness() * scene.length);
  ASSERT_EQ(chain.obstacles.size(), 1);
  EXPECT_GT(chain.obstacles[0].y(), 0.1 * weight);
  const Solution force = solve_force(scene, scene.force_model, long_limit);
  EXPECT_LT((chain.shape.points - force.shape.points).colwise().norm().maxCoeff(), 1e-6);
  EXPECT_NEAR(chain.obstacles[0].y(), force.obstacles[0].y(), 1e-3 * weight);
}

// A rod on a rigid floor may come to rest only by steps without momentum, with which it creeps.
// Before this was fixed, rounding determined which numbers of points did not come to rest.
TEST(Walls, EveryNumberOfPointsComesToRestOnARigidOne) {
  Scene scene = yielding_floor();
  scene.obstacles[0].stiffness = std::numeric_limits<double>::infinity();
  const int most = test::sanitized ? 25 : 50;
  for (int points = most - 6; points <= most; ++points) {
    scene.force_model.points = points;
    const Solution force =
        solve_force(scene, scene.force_model, {.max_steps = 1'000'000, .time_limit = 300});
    EXPECT_LT(force.steps, 1'000'000) << points;
  }
}

// A clamp in the middle of a segment holds a point beyond the rod's end.
TEST(Walls, AHeldPointHasNoEnergyOfContact) {
  Scene scene = heavy_scene(1, 0);
  scene.force_model = {
      .points = 11, .law = BendingLaw::hooke, .bookkeeping = Bookkeeping::consistent};
  for (const obstacle::Body& body :
       {obstacle::Body::sphere({-0.1, 0, 0}, 0.09),
        obstacle::Body::half_space({-0.01, 0, 0}, Vector3d::UnitX())}) {
    scene.obstacles = {{.body = body}};
    for (const Model model : {Model::chain, Model::force}) {
      const Solution solution = solve(scene, model);
      EXPECT_EQ(solution.energy.contact, 0);
      EXPECT_EQ(solution.obstacles.front().norm(), 0);
    }
  }
}

// A wire pushed against a wall, which its tip slides along.
TEST(Walls, ATipAgainstAWallIsWhereOtherModelsHaveIt) {
  Scene scene = parse_scene(R"(
rod = { length = "30 cm", diameter = "0.5 mm", material = "copper" }
gripper = [{ at = 0, position = [0, 0, 0], direction = "0 deg" }]
obstacle = [{ point = ["25 cm", 0, 0], normal = [-1, 0, 0] }]
force_model = { law = "hooke", bookkeeping = "consistent" }
)",
                            "copper.toml");
  const Solution energy = solve(scene, Model::energy);
  ASSERT_EQ(energy.contacts.size(), 1);
  EXPECT_EQ(energy.contacts[0].kind, energy_model::ContactKind::tip);
  EXPECT_EQ(energy.contacts[0].obstacle, 0);
  // The rod's surface touches the wall, so its axis is half a diameter away from it.
  EXPECT_NEAR(energy.shape.points(0, 100), 0.25 - 0.25e-3, 1e-12);
  EXPECT_NEAR(energy.grippers[0].force.x(), -energy.contacts[0].force.x(), 1e-12);
  ASSERT_EQ(energy.tension.size(), energy.shape.arc_length.size());
  const Eigen::Vector3d tip = energy.shape.points.col(100) - energy.shape.points.col(99);
  EXPECT_NEAR(energy.tension.back(), energy.contacts[0].force.dot(tip.normalized()),
              2e-2 * energy.contacts[0].force.norm());
  // The deviation of the force model decreases with the square of the segment length.
  const SolveOptions long_limit{.time_limit = 300};  // sanitizer builds need this time
  scene.force_model.points = 12;
  const double coarse = compare(scene, long_limit).deviation.rms_over_length;
  scene.force_model.points = 24;
  const Comparison fine = compare(scene, long_limit);
  EXPECT_LT(fine.deviation.rms_over_length, 4e-4);
  EXPECT_GT(coarse, 3.5 * fine.deviation.rms_over_length);
  EXPECT_NEAR(fine.effective_modulus.ratio, 1, 4e-2);
}

// A clamp on the floor points into it: no rod above the floor can leave it in this direction.
TEST(Walls, AShapeThatIsNotVerifiedIsShownOnlyToWhoAcceptsIt) {
  const Scene scene = parse_scene(R"(
rod = { length = "30 cm", diameter = "0.5 mm", material = "copper", torsional_stiffness = 2.76e-4 }
gripper = [{ at = 0, position = [0, 0, 0], direction = "-20 deg", roll = "0 deg" },
           { at = "30 cm", position = ["20 cm", 0, 0], direction = "0 deg", roll = "90 deg" }]
obstacle = [{ point = [0, "-0.25 mm", 0], normal = [0, 1, 0] }]
)",
                                  "copper.toml");
  EXPECT_TRUE(
      has_all(error_of<ConvergenceError>([&] { return solve_reference(scene, Model::energy); }),
              {"contacts did not converge"}));
  EXPECT_THROW((void)solve(scene, Model::energy), ConvergenceError);
  EXPECT_THROW((void)compare(scene), ConvergenceError);
  SolveOptions options;
  options.accept_unverified = true;
  const Solution shown = solve(scene, Model::energy, options);
  EXPECT_EQ(shown.status, energy_model::SolveStatus::not_verified);
  EXPECT_NEAR(shown.penetration, -shown.shape.points.row(1).minCoeff(), 1e-5);
  const Comparison comparison = compare(scene, options);
  EXPECT_TRUE(has_all(comparison.unverified, {"contacts did not converge"}));
  EXPECT_TRUE(std::isnan(comparison.effective_modulus.ratio));
}

TEST(PaperLaw, HasATorqueOfItsOwnWhereSegmentsDiffer) {
  Scene scene = two_pins();
  scene.force_model.law = BendingLaw::paper;
  const Solution chain = solve_chain(scene, scene.force_model);
  const Solution force = solve_force(scene, scene.force_model);
  const double apart = (chain.shape.points - force.shape.points).colwise().norm().maxCoeff();
  EXPECT_GT(apart, 1e-6);
  EXPECT_LT(apart, 1e-3);
}

// The pin is just above a rigid floor: a start that hangs straight down would be crushed on it.
TEST(Chain, LiesOnAFloorBelowItsPin) {
  Scene scene = heavy_scene(100, 0);
  scene.grippers = {{.at = 0, .position = {0, 0.02, 0}}};
  scene.obstacles = {Obstacle{}};
  double last = 0;
  for (const int points : {16, 64, 240}) {
    scene.force_model.points = points;
    const Solution chain = solve_chain(scene, scene.force_model);
    const double weight = 100 * scene.bending_stiffness();
    EXPECT_NEAR(chain.grippers[0].force.y() + chain.obstacles[0].y(), weight, 1e-6 * weight);
    const Eigen::Matrix3Xd& p = chain.shape.points;
    const Eigen::Index n = p.cols() - 1;
    EXPECT_NEAR((p.rightCols(n) - p.leftCols(n)).colwise().norm().sum(), 1, 1e-4);
    EXPECT_GT(p.row(1).minCoeff(), -1e-5);
    if (points > 16) EXPECT_NEAR(chain.grippers[0].force.y(), last, 0.02 * last);
    last = chain.grippers[0].force.y();
  }
}

TEST(Chain, StretchAboveAHundredthIsNoResultUnlessAskedFor) {
  // A clamp inside the rod, from which both ends hang or stand: w l / (E A) = Gamma d^2 / (16 l^2)
  // = 1.9 %.
  Scene scene = heavy_scene(30, -90);
  scene.grippers[0].at = 0.2;
  scene.material.youngs_modulus /= std::pow(0.1 / scene.diameter, 4);
  scene.material.density /= std::pow(0.1 / scene.diameter, 2);
  scene.diameter = 0.1;
  ASSERT_NEAR(scene.gamma(), 30, 1e-9);
  for (const auto solver : {&solve_chain, &solve_force}) {
    EXPECT_TRUE(
        has_all(error_of<ConvergenceError>([&] { return solver(scene, scene.force_model, {}); }),
                {"longer than at rest"}));
  }
  scene.force_model.c_c = scene.axial_stiffness();
  EXPECT_GT(solve_chain(scene, scene.force_model).energy.stretch, 0);
}

TEST(Force, RestsInTheStateOfTheChain) {
  // From the chain's own initial shape the force model would converge to an arch with 1.5 times the
  // energy.
  Scene scene =
      load_scene(std::string(DLO_DATA) + "/failures/chain_force_different_minima_N9.toml");
  for (const int points : {9, 17}) {
    scene.force_model.points = points;
    const Solution chain = solve_chain(scene, scene.force_model);
    const Solution force = solve_force(scene, scene.force_model);
    EXPECT_EQ(force.message, "at rest");
    EXPECT_NEAR(force.energy.bending, chain.energy.bending, 1e-4 * chain.energy.bending);
  }
}

TEST(Chain, FindsTheLowestOfTwoArches) {
  // Clamps that point up hold an arch against the weight only while it is light.
  for (const double gamma : {0.5, 20.0, 200.0}) {
    Scene scene = heavy_scene(gamma, 90);
    scene.grippers.push_back({.at = 1, .position = {0.3, 0, 0}, .direction = -Vector3d::UnitY()});
    scene.force_model.points = 64;
    const double energy = solve(scene, Model::energy).energy.total();
    const Solution chain = solve_chain(scene, scene.force_model);
    EXPECT_NEAR(chain.energy.total(), energy, 2e-3 * chain.energy.bending) << gamma;
  }
}

// Tests chains with and without stretch, and the force model at rest. The balance is lost if the
// last gripper's force or torque, or the load on the middle point, changes.
TEST(PolygonBalance, HoldsAndIsLostWithEveryForce) {
  for (const Scene& scene : {heavy_scene(8, 20), spatial_clamps(), yielding_floor()}) {
    for (const Model model : {Model::chain, Model::force}) {
      SCOPED_TRACE(to_string(model));
      const Solution solution = solve(scene, model, {});
      const force_model::Rod rod = discretise(scene, scene.force_model).rod;
      const Eigen::Matrix3Xd& points = solution.shape.points;
      const double allowed = model == Model::chain
                                 ? energy_model::allowed_imbalance
                                 : allowed_rest_imbalance(rod, points, solution.to_rest);
      const energy_model::Imbalance good = polygon_imbalance(rod, points, solution.grippers);
      EXPECT_LE(good.share(), allowed);
      EXPECT_EQ(balanced(scene, rod, points, solution.grippers, allowed, "chain").share,
                good.share());
      std::vector<GripperLoad> pulled = solution.grippers;
      pulled.back().force.y() += 3 * allowed * good.largest_force;
      const energy_model::Imbalance bad = polygon_imbalance(rod, points, pulled);
      EXPECT_GT(bad.share(), allowed);
      const std::string error = error_of<ConvergenceError>(
          [&] { return balanced(scene, rod, points, pulled, allowed, "chain"); });
      EXPECT_TRUE(has_all(error, {"unbalanced force"})) << error;
      std::vector<GripperLoad> turned = solution.grippers;
      turned.back().torque.z() += 3 * allowed * good.largest_moment;
      EXPECT_GT(polygon_imbalance(rod, points, turned).share(), allowed);
      force_model::Rod loaded = rod;
      loaded.loads.col(points.cols() / 2).y() += 3 * allowed * good.largest_force;
      EXPECT_GT(polygon_imbalance(loaded, points, solution.grippers).share(), allowed);
    }
  }
}

// A distance from rest of 1e-4 l does not determine the forces of a stiff polygon.
TEST(PolygonBalance, OfTheForceModelIsStatedWhereItIsCoarse) {
  const Scene scene = spatial_clamps();
  EXPECT_FALSE(has_all(solve(scene, Model::force).message, {"balanced within"}));
  const Solution coarse = solve(scene, Model::force, {.rest_tolerance = 1e-4});
  const std::string words = "balanced within ";
  const std::size_t at = coarse.message.find(words);
  ASSERT_NE(at, std::string::npos) << coarse.message;
  const force_model::Rod rod = discretise(scene, scene.force_model).rod;
  const double share = polygon_imbalance(rod, coarse.shape.points, coarse.grippers).share();
  EXPECT_NEAR(std::stod(coarse.message.substr(at + words.size())) / share, 1, 0.05);  // two digits
}

}  // namespace
}  // namespace dlo::compare
