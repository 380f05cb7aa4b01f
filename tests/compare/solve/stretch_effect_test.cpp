// Tests of the reported effect of stretch that a model neglects, against the elastic catenary.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "../../says.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solve.hpp"
#include "record/solution_fields.hpp"

namespace dlo::compare {
namespace {

using Eigen::Vector3d;

/// Returns a line of 100 m between two pins that are `apart` [m] on one level.
/// @param EA  [N]
/// @param EI  [N m^2]
Scene line(double EA, double apart, double EI = 1) {
  Scene scene;
  scene.gravity = {0, 0, -10};
  scene.length = 100;
  scene.given_bending_stiffness = EI;
  scene.given_mass_per_length = 2;
  scene.given_axial_stiffness = EA;
  scene.grippers = {{.at = 0, .position = {0, 0, 0}}, {.at = 100, .position = {apart, 0, 0}}};
  return scene;
}

/// Returns the tension at the pins, on one level, of a line without EI that stretches: with H at
/// the middle,
///     apart = H l / EA + 2 H / w asinh(w l / (2 H))   (Irvine, Cable Structures, ch. 1).
double tension_of(double EA, double w, double l, double apart) {
  double low = 1e-3;
  double high = 1e9;
  while (high / low > 1 + 1e-14) {
    const double H = std::sqrt(low * high);
    const double reach = H * l / EA + 2 * H / w * std::asinh(w * l / (2 * H));
    (reach < apart ? low : high) = H;
  }
  return std::hypot(low, w * l / 2);
}

TEST(StretchEffect, IsTheElasticCatenarysToFirstOrder) {
  // The neglected terms are of second order.
  for (const double EA : {4e6, 1e6}) {
    const Scene scene = line(EA, 98);
    const Solution solution = solve(scene, Model::energy);
    const double rigid = tension_of(1e30, 20, 100, 98);
    const double change = tension_of(EA, 20, 100, 98) / rigid - 1;
    EXPECT_NEAR(solution.stretch.strain, rigid / EA, 2e-2 * rigid / EA);
    EXPECT_NEAR(solution.stretch.tension, change, 5 * change * change + 1e-3 * std::abs(change))
        << EA;
    EXPECT_TRUE(neglects(solution, "stretch"));
  }
}

/// Returns a rubber rod of 1 m in one clamp.
Scene held_rubber(const Vector3d& direction) {
  Scene scene;
  scene.gravity = {0, 0, -9.81};
  scene.length = 1;
  scene.diameter = 0.005;
  scene.material = {.youngs_modulus = 3e6, .density = 1150};
  scene.grippers = {{.at = 0, .position = {0, 0, 0}, .direction = direction}};
  return scene;
}

// A rod that hangs straight under its weight: its displacement is u(s) = w (l s - s^2 / 2) / EA,
// and stretch does not change its tension w (l - s).
TEST(StretchEffect, OfARodThatHangsIsThatOfHookesLaw) {
  const Scene scene = held_rubber(-Vector3d::UnitZ());
  const double strain = scene.weight_per_length().norm() * scene.length / scene.axial_stiffness();
  const Solution solution = solve(scene, Model::energy, {.target = 1e-4});
  EXPECT_TRUE(neglects(solution, "stretch"));
  EXPECT_NEAR(solution.stretch.strain, strain, 1e-9 * strain);
  const double moved = strain * scene.length * std::sqrt(2.0 / 15);
  // The segment at the clamp, one of 96 of the polygon that estimates the response, does not
  // stretch.
  EXPECT_NEAR(solution.stretch.displacement_m, moved, 2.0 / 96 * moved);
  EXPECT_NEAR(solution.stretch.tension, 0, 1e-9);
}

// For a rod with free ends on both sides of a clamp the predicted change of the largest tension by
// stretch agrees with model exact with stretch within 5 %.
TEST(StretchEffect, OfOneClampIsThatOfTheRodThatStretches) {
  for (const Vector3d& direction : {Vector3d(1, 0, 0), Vector3d(1, 0, 1), Vector3d(1, 0, -2)}) {
    Scene scene = held_rubber(direction.normalized());
    scene.material.youngs_modulus = 1e7;  // first order
    scene.grippers[0].at = 0.2;
    const std::vector<double> s = equal_arc_lengths(scene.length, 801);
    const Solution rigid = solve(scene, Model::energy, {.target = 1e-5}, s);
    scene.stretch = Stretch::counted;
    const Solution stretched = solve(scene, Model::exact, {}, s);
    const auto largest = [](const std::vector<double>& tension) {
      return *std::max_element(tension.begin(), tension.end(),
                               [](double a, double b) { return std::abs(a) < std::abs(b); });
    };
    const double change = largest(stretched.tension) / largest(rigid.tension) - 1;
    EXPECT_NEAR(rigid.stretch.tension, change, 0.05 * std::abs(change) + 1e-6) << direction;
  }
}

TEST(StretchEffect, IsToldByTheShapeThatALongerRodHasWhereItLies) {
  Scene scene = line(4e5, 96, 200);
  scene.grippers[1].position.z() = 10;
  const Solution hangs = solve(scene, Model::energy);
  scene.obstacles.push_back({.body = obstacle::Body::half_space({0, 0, -4}, Vector3d::UnitZ())});
  const Solution lies = solve(scene, Model::energy);
  ASSERT_GT(lies.obstacles[0].z(), 0);
  EXPECT_TRUE(neglects(lies, "stretch"));
  EXPECT_LT(lies.stretch.tension, 0);
  EXPECT_GT(lies.stretch.displacement_m, 0);
  EXPECT_TRUE(neglects(hangs, "stretch"));
}

/// The strain v^2 tangential l / EA is 0.7 of the target.
TEST(StretchEffect, OfDragIsEstimatedFromHalfTheTarget) {
  Scene scene = line(1e4, 98);
  scene.length = 1;
  scene.gravity.setZero();
  scene.grippers = {{.at = 0, .direction = Vector3d::UnitX()}};
  scene.drag = energy_model::Drag{.velocity = {1, 0, 0}, .normal = 14, .tangential = 7};
  EXPECT_NEAR(solve(scene, Model::exact, {.target = 1e-3}).stretch.strain, 7e-4, 1e-9);
}

TEST(StretchEffect, IsSilentWhereItDoesNotMatter) {
  EXPECT_FALSE(neglects(solve(line(4e9, 98), Model::energy), "stretch"));
  Scene unknown = line(4e5, 98);
  unknown.given_axial_stiffness.reset();
  unknown.diameter = 0.02;
  const Solution solution = solve(unknown, Model::energy);
  EXPECT_FALSE(neglects(solution, "stretch"));
  EXPECT_TRUE(std::isnan(solution.stretch.strain));
}

void expect_same(const Solution& one, const Solution& other) {
  EXPECT_EQ(one.shape.points, other.shape.points);
  EXPECT_EQ(one.tension, other.tension);
  EXPECT_EQ(one.energy.stretch, other.energy.stretch);
  EXPECT_EQ(one.energy.total(), other.energy.total());
  EXPECT_EQ(one.grippers[0].force, other.grippers[0].force);
  EXPECT_EQ(one.grippers[0].torque, other.grippers[0].torque);
  EXPECT_EQ(one.neglected, other.neglected);
}

Solution solve_with(Scene scene, Stretch stretch, Model model) {
  scene.stretch = stretch;
  return solve(scene, model);
}

TEST(AutomaticStretch, IsThatOfAMooringLineWhichItMoves) {
  const Scene scene = line(4e5, 98, 200);
  const Solution decided = solve_with(scene, Stretch::automatic, Model::exact);
  // The decision is based on the displacement that is estimated from the shape without stretch. The
  // result contains this displacement.
  EXPECT_EQ(decided.stretch.displacement_m,
            solve_with(scene, Stretch::none, Model::exact).stretch.displacement_m);
  EXPECT_GT(decided.stretch.displacement_m, 1e-3 * scene.length);
  const Solution counted = solve_with(scene, Stretch::counted, Model::exact);
  EXPECT_FALSE(neglects(counted, "stretch"));
  EXPECT_GT(counted.energy.stretch, 0);
  EXPECT_THROW((void)solve_with(scene, Stretch::counted, Model::energy), InputError);
}

// Without stretch the tension of a line as long as the distance of its pins would be infinite, and
// a shorter line has no shape. Bending carries less than a thousandth of the force.
TEST(AutomaticStretch, TensionIsThatOfTheElasticCatenary) {
  for (const double apart : {98.0, 100.0, 100.5}) {
    const Scene scene = line(4e5, apart, apart < 100 ? 200 : 5e3);
    if (apart >= 100)
      EXPECT_THROW((void)solve_with(scene, Stretch::none, Model::exact), InputError);
    const Solution decided = solve_with(scene, Stretch::automatic, Model::exact);
    EXPECT_EQ(decided.stretch_decision, StretchDecision::counted);
    expect_same(decided, solve_with(scene, Stretch::counted, Model::exact));
    const double tension = tension_of(4e5, 20, 100, apart);
    EXPECT_NEAR(decided.grippers[1].force.norm() / tension, 1, 1e-3);
  }
}

TEST(AutomaticStretch, GoesByTheTarget) {
  // A mooring line of steel is moved by less than a permille, and by more than a millionth.
  Scene scene = line(4e8, 96, 200);
  for (const Model model : {Model::energy, Model::exact}) {
    const Solution decided = solve_with(scene, Stretch::automatic, model);
    EXPECT_EQ(decided.stretch_decision, StretchDecision::below_target);
    expect_same(decided, solve_with(scene, Stretch::none, model));
  }
  scene.stretch = Stretch::automatic;
  const Solution decided = solve(scene, Model::exact, {.target = 1e-6});
  EXPECT_EQ(decided.stretch_decision, StretchDecision::counted);
  EXPECT_GT(decided.energy.stretch, 0);
}

TEST(AutomaticStretch, IsSaidToMatterWhereTheModelHasNone) {
  Scene scene = line(4e5, 98, 200);
  const Solution energy = solve_with(scene, Stretch::automatic, Model::energy);
  EXPECT_EQ(energy.stretch_decision, StretchDecision::not_modelled);
  expect_same(energy, solve_with(scene, Stretch::none, Model::energy));
  EXPECT_TRUE(neglects(energy, "stretch"));
  scene.stretch = Stretch::automatic;
  EXPECT_EQ(solve_all(scene).solutions[0].stretch_decision, StretchDecision::not_modelled);
  EXPECT_EQ(solve_with(scene, Stretch::none, Model::energy).stretch_decision,
            StretchDecision::given);
}

TEST(AutomaticStretch, IsNotThatOfExactBesideAnObstacleOrOfACatenary) {
  Scene lies = line(4e5, 98, 200);
  lies.obstacles.push_back({.body = obstacle::Body::half_space({0, 0, -4}, Vector3d::UnitZ())});
  for (const Scene& scene : {lies, line(4e5, 98, 1e-4)}) {
    EXPECT_THROW((void)solve_with(scene, Stretch::counted, Model::exact), InputError);
    const Solution decided = solve_with(scene, Stretch::automatic, Model::exact);
    EXPECT_EQ(decided.stretch_decision, StretchDecision::not_modelled);
    EXPECT_TRUE(neglects(decided, "stretch"));
    expect_same(decided, solve_with(scene, Stretch::none, Model::exact));
  }
}

TEST(AutomaticStretch, IsOneOfThreeWordsAndNeedsAStiffnessThatIsKnown) {
  const auto read = [](const std::string& keys) {
    return parse_scene("[rod]\nlength = 1\nbending_stiffness = 0.1\nmass_per_length = 0.01\n" +
                           keys + "[[gripper]]\nat = 0\nposition = [0, 0, 0]\nhold = \"pin\"\n",
                       "text", materials());
  };
  const std::string known = "axial_stiffness = \"2 kN\"\n";
  EXPECT_EQ(read(known + "stretch = \"auto\"\n").stretch, Stretch::automatic);
  EXPECT_EQ(read(known + "stretch = true\n").stretch, Stretch::counted);
  EXPECT_EQ(read(known + "stretch = false\n").stretch, Stretch::none);
  for (const char* wrong : {"\"yes\"", "1", "\"true\""}) {
    EXPECT_TRUE(
        has_all(error_of<InputError>([&] { return read(known + "stretch = " + wrong + "\n"); }),
                {"allowed: true, false or \"auto\""}));
  }
  EXPECT_THROW((void)read("stretch = true\n"), InputError);
  EXPECT_THROW((void)read("stretch = \"auto\"\n"), InputError);
}

// A polygon whose segments are as stiff as the rod has no error by their stretch.
TEST(StretchReference, OfCompareStretchesAsTheForceModelDoes) {
  Scene scene = held_rubber(Vector3d(1, 0, -1).normalized());
  scene.force_model.points = 60;
  scene.stretch = Stretch::counted;
  const Comparison stretched = compare(scene);
  EXPECT_LT(stretched.budget.stretch.rms_m, 1e-6);
  scene.stretch = Stretch::none;
  const Comparison rigid = compare(scene);
  EXPECT_GT(rigid.budget.stretch.rms_m, 5e-4);
  EXPECT_NEAR(stretched.budget.discretisation.rms_m, rigid.budget.discretisation.rms_m,
              0.1 * rigid.budget.discretisation.rms_m);
}

// The rod may reach an obstacle only because it stretches.
TEST(StretchReference, IsRefusedWhereAnObstacleIsInReach) {
  Scene scene = held_rubber(-Vector3d::UnitZ());
  scene.stretch = Stretch::counted;
  const auto with_floor = [&](double z) {
    scene.obstacles = {{.body = obstacle::Body::half_space({0, 0, z}, Vector3d::UnitZ())}};
    return scene;
  };
  EXPECT_GT(solve_reference(with_floor(-1.1)).energy.stretch, 0);
  for (const double z : {-0.9, -1.001}) {
    EXPECT_TRUE(
        has_all(error_of<InputError>([&] { return solve_reference(with_floor(z)); }),
                {"rod.stretch = true", "in reach", "allowed: stretch = false", "chain or force"}))
        << z;
  }
}

TEST(StretchReference, IsNamedFirstWhereARodIsTaut) {
  EXPECT_TRUE(has_all(error_of<InputError>([] { return solve_reference(line(4e5, 100, 200)); }),
                      {"gripper.position", "(allowed: rod.stretch = true"}));
}

}  // namespace
}  // namespace dlo::compare
