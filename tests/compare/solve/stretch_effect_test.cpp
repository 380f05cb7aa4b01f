// Tests of the reported effect of stretch that a model neglects, against the elastic catenary.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "../../says.hpp"
#include "dlo/compare/check.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/plan.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/shape_check.hpp"
#include "dlo/compare/solve.hpp"
#include "record/solution_fields.hpp"

namespace dlo::compare {
namespace {

using Eigen::Vector3d;
using test::error_of;
using test::says;

/// A line of 100 m between two pins, in the units that a file would have.
Scene line(double EA, double apart) {
  Scene scene;
  scene.gravity = {0, 0, -10};
  scene.length = 100;
  scene.given_bending_stiffness = 1;
  scene.given_mass_per_length = 2;
  scene.given_axial_stiffness = EA;
  scene.grippers = {{.at = 0, .position = {0, 0, 0}}, {.at = 100, .position = {apart, 0, 0}}};
  return scene;
}

/// Tension at the pins, on one level, of a line without EI that stretches: with H at the middle,
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

/// A rubber rod of 1 m in one clamp.
Scene held_rubber(const Vector3d& direction) {
  Scene scene;
  scene.gravity = {0, 0, -9.81};
  scene.length = 1;
  scene.diameter = 0.005;
  scene.material = {.youngs_modulus = 3e6, .density = 1150};
  scene.grippers = {{.at = 0, .position = {0, 0, 0}, .direction = direction}};
  return scene;
}

// It hangs straight under its weight: u(s) = w (l s - s^2 / 2) / EA, tension w (l - s) as before.
TEST(StretchEffect, OfARodThatHangsIsThatOfHookesLaw) {
  const Scene scene = held_rubber(-Vector3d::UnitZ());
  const double strain = scene.weight_per_length().norm() * scene.length / scene.axial_stiffness();
  const Solution solution = solve(scene, Model::energy, {.target = 1e-4});
  EXPECT_TRUE(neglects(solution, "stretch"));
  EXPECT_NEAR(solution.stretch.strain, strain, 1e-9 * strain);
  const double moved = strain * scene.length * std::sqrt(2.0 / 15);
  // The clamp's segment of the polygon that answers, one of 96, does not stretch.
  EXPECT_NEAR(solution.stretch.moved_m, moved, 2.0 / 96 * moved);
  EXPECT_NEAR(solution.stretch.tension, 0, 1e-9);
}

// Between grips or beyond the last one, the predicted change of the largest tension by stretch
// agrees with model exact with stretch.
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
  Scene scene = line(4e5, 96);
  scene.given_bending_stiffness = 200;
  scene.grippers[1].position.z() = 10;
  const Solution hangs = solve(scene, Model::energy);
  scene.obstacles.push_back({.body = obstacle::Body::half_space({0, 0, -4}, Vector3d::UnitZ())});
  const Solution lies = solve(scene, Model::energy);
  ASSERT_GT(lies.obstacles[0].z(), 0);
  EXPECT_TRUE(neglects(lies, "stretch"));
  EXPECT_LT(lies.stretch.tension, 0);
  EXPECT_GT(lies.stretch.moved_m, 0);
  EXPECT_TRUE(neglects(hangs, "stretch"));
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

TEST(StretchEffect, IsNotAskedOfARodThatStretches) {
  Scene scene = line(4e5, 98);
  scene.given_bending_stiffness = 200;
  scene.stretch = Stretch::counted;
  const Solution solution = solve(scene, Model::exact);
  EXPECT_FALSE(neglects(solution, "stretch"));
  EXPECT_GT(solution.energy.stretch, 0);
  EXPECT_THROW((void)solve(scene, Model::energy), InputError);
  EXPECT_THROW((void)make_plan(scene).bound("stretch"), std::invalid_argument);
  const double tension = tension_of(4e5, 20, 100, 98);
  EXPECT_NEAR(solution.grippers[1].force.norm() / tension, 1, 1e-3);
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

Solution with(Scene scene, Stretch stretch, Model model) {
  scene.stretch = stretch;
  return solve(scene, model);
}

/// A steel wire of 0.2 m on a clamp, level.
Scene cantilever() {
  return parse_scene(R"([rod]
length = 0.2
diameter = "1 mm"
material = "spring_steel"
[[gripper]]
at = 0
position = [0, 0, 0]
direction = "0 deg"
)",
                     "cantilever", materials());
}

TEST(AutomaticStretch, IsThatOfAMooringLineWhichItMoves) {
  Scene scene = line(4e5, 98);
  scene.given_bending_stiffness = 200;
  const Solution decided = with(scene, Stretch::automatic, Model::exact);
  EXPECT_EQ(decided.stretch_decision, StretchDecision::counted);
  expect_same(decided, with(scene, Stretch::counted, Model::exact));
  // The estimate that decided it is that of the shape without.
  EXPECT_EQ(decided.stretch.moved_m, with(scene, Stretch::none, Model::exact).stretch.moved_m);
  EXPECT_GT(decided.stretch.moved_m, 1e-3 * scene.length);
  const double tension = tension_of(4e5, 20, 100, 98);
  EXPECT_NEAR(decided.grippers[1].force.norm() / tension, 1, 1e-3);
}

TEST(AutomaticStretch, IsNeglectedByAShortCantilever) {
  for (const Model model : {Model::energy, Model::exact}) {
    const Solution decided = with(cantilever(), Stretch::automatic, model);
    EXPECT_EQ(decided.stretch_decision, StretchDecision::below_target);
    expect_same(decided, with(cantilever(), Stretch::none, model));
  }
}

TEST(AutomaticStretch, GoesByTheTarget) {
  // A mooring line of steel is moved by less than a permille, and by more than a millionth.
  Scene scene = line(4e8, 96);
  scene.given_bending_stiffness = 200;
  scene.stretch = Stretch::automatic;
  EXPECT_EQ(solve(scene, Model::exact).stretch_decision, StretchDecision::below_target);
  SolveOptions strict;
  strict.target = 1e-6;
  const Solution decided = solve(scene, Model::exact, strict);
  EXPECT_EQ(decided.stretch_decision, StretchDecision::counted);
  EXPECT_GT(decided.energy.stretch, 0);
}

TEST(AutomaticStretch, IsSaidToMatterWhereTheModelHasNone) {
  Scene scene = line(4e5, 98);
  scene.given_bending_stiffness = 200;
  const Solution energy = with(scene, Stretch::automatic, Model::energy);
  EXPECT_EQ(energy.stretch_decision, StretchDecision::not_modelled);
  expect_same(energy, with(scene, Stretch::none, Model::energy));
  EXPECT_TRUE(neglects(energy, "stretch"));
  scene.stretch = Stretch::automatic;
  EXPECT_EQ(solve_all(scene).solutions[0].stretch_decision, StretchDecision::not_modelled);
  EXPECT_EQ(with(scene, Stretch::none, Model::energy).stretch_decision, StretchDecision::given);
}

TEST(AutomaticStretch, IsNotThatOfExactBesideAnObstacleOrOfACatenary) {
  Scene lies = line(4e5, 98);
  lies.given_bending_stiffness = 200;
  lies.obstacles.push_back({.body = obstacle::Body::half_space({0, 0, -4}, Vector3d::UnitZ())});
  Scene soft = line(4e5, 98);
  soft.given_bending_stiffness = 1e-4;
  for (const Scene& scene : {lies, soft}) {
    EXPECT_THROW((void)with(scene, Stretch::counted, Model::exact), InputError);
    const Solution decided = with(scene, Stretch::automatic, Model::exact);
    EXPECT_EQ(decided.stretch_decision, StretchDecision::not_modelled);
    EXPECT_TRUE(neglects(decided, "stretch"));
    expect_same(decided, with(scene, Stretch::none, Model::exact));
  }
}

// Without stretch its weight would pull it infinitely hard, or it does not reach.
TEST(AutomaticStretch, IsThatOfALineThatGripsHoldTaut) {
  for (const double apart : {100.0, 100.5}) {
    Scene scene = line(4e5, apart);
    scene.given_bending_stiffness = 5e3;
    EXPECT_THROW((void)with(scene, Stretch::none, Model::exact), InputError);
    const Solution decided = with(scene, Stretch::automatic, Model::exact);
    EXPECT_EQ(decided.stretch_decision, StretchDecision::counted);
    expect_same(decided, with(scene, Stretch::counted, Model::exact));
    // Its EI carries less than a thousandth of the force.
    const double tension = tension_of(4e5, 20, 100, apart);
    EXPECT_NEAR(decided.grippers[1].force.norm() / tension, 1, 1e-3);
  }
}

TEST(AutomaticStretch, IsOneOfThreeWords) {
  const auto read = [](const std::string& value) {
    return parse_scene(
        "[rod]\nlength = 1\nbending_stiffness = 0.1\nmass_per_length = 0.01\n"
        "axial_stiffness = \"2 kN\"\nstretch = " +
            value + "\n[[gripper]]\nat = 0\nposition = [0, 0, 0]\nhold = \"pin\"\n",
        "text", materials());
  };
  EXPECT_EQ(read("\"auto\"").stretch, Stretch::automatic);
  EXPECT_EQ(read("true").stretch, Stretch::counted);
  EXPECT_EQ(read("false").stretch, Stretch::none);
  for (const char* wrong : {"\"yes\"", "1", "\"true\""}) {
    EXPECT_TRUE(says(error_of<InputError>([&] { return read(wrong); }),
                     {"allowed: true, false or \"auto\""}));
  }
}

TEST(StretchEffect, NeedsAStiffnessThatIsKnown) {
  const std::string text =
      "[rod]\nlength = 1\nbending_stiffness = 0.1\nmass_per_length = 0.01\nstretch = true\n";
  const std::string gripper = "[[gripper]]\nat = 0\nposition = [0, 0, 0]\nhold = \"pin\"\n";
  EXPECT_THROW((void)parse_scene(text + gripper, "text", materials()), InputError);
  const Scene scene =
      parse_scene(text + "axial_stiffness = \"2 kN\"\n" + gripper, "text", materials());
  EXPECT_EQ(scene.stretch, Stretch::counted);
  EXPECT_EQ(scene.axial_stiffness(), 2000);
  const std::string open = text.substr(0, text.size() - 5) + "\"auto\"\n";
  EXPECT_THROW((void)parse_scene(open + gripper, "text", materials()), InputError);
}

/// A line as long as its pins are apart, which hangs by its stretch alone.
Scene taut_line() {
  Scene scene = line(300, 1);
  scene.length = 1;
  scene.given_bending_stiffness = 5e-3;
  scene.given_mass_per_length = 10;
  scene.grippers[1].at = 1;
  scene.stretch = Stretch::counted;
  return scene;
}

/// Its points without EI: with V = w (s - l/2) and T = (H^2 + V^2)^(1/2),
///     dx/ds = H / T + H / EA,  dz/ds = V / T + V / EA.
MeasuredShape elastic_catenary(const Scene& scene, int count) {
  const double EA = scene.axial_stiffness();
  const double w = scene.weight_per_length().norm();
  const double half = w * scene.length / 2;
  const double top = tension_of(EA, w, scene.length, scene.grippers[1].position.x());
  const double H = std::sqrt(top * top - half * half);
  const auto x = [&](double V) { return H / w * std::asinh(V / H) + H * V / (w * EA); };
  const auto z = [&](double V) { return std::hypot(H, V) / w + V * V / (2 * w * EA); };
  MeasuredShape shape{"catenary", Eigen::Matrix3Xd::Zero(3, count),
                      equal_arc_lengths(scene.length, count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const double V = w * shape.arc_length[static_cast<std::size_t>(i)] - half;
    shape.points.col(i) = Vector3d(x(V) - x(-half), 0, z(V) - z(-half));
  }
  return shape;
}

TEST(StretchReference, IsTheElasticCatenary) {
  const Scene scene = taut_line();
  EXPECT_EQ(reference_model(scene), Model::exact);
  const MeasuredShape catenary = elastic_catenary(scene, 41);
  ASSERT_LT((catenary.points.rightCols<1>() - Vector3d::UnitX()).norm(), 1e-9);
  EXPECT_LT(catenary.points.row(2).minCoeff(), -0.1);
  const ShapeCheck check = check_shape(scene, catenary, {.modulus = ModulusSearch::no});
  // The moment that bends it is of the order of EI / T = 1e-4 m^2.
  EXPECT_LT(check.deviation.max_m, 1e-3);
}

TEST(StretchReference, OfARodThatHangsIsLongerByHookesLaw) {
  Scene scene = held_rubber(-Vector3d::UnitZ());
  const double w = scene.weight_per_length().norm();
  const std::vector<double> s = equal_arc_lengths(1, 21);
  MeasuredShape hangs{"hangs", Eigen::Matrix3Xd::Zero(3, 21), s};
  for (std::size_t i = 0; i < s.size(); ++i) {
    hangs.points(2, static_cast<Eigen::Index>(i)) =
        -s[i] - w * (s[i] - s[i] * s[i] / 2) / scene.axial_stiffness();
  }
  EXPECT_GT(check_shape(scene, hangs).deviation.rms_m, 5e-4);
  scene.stretch = Stretch::counted;
  const ShapeCheck check = check_shape(scene, hangs);
  EXPECT_LT(check.deviation.max_m, 1e-9);
  EXPECT_NEAR(check.effective_modulus.ratio, 1, 1e-5);
  EXPECT_TRUE(shape_near({s, hangs.points}, scene, 1e-6).near);
}

// A polygon whose segments are as stiff as the rod has no error by their stretch.
TEST(StretchReference, OfCompareStretchesAsTheForceModelDoes) {
  Scene scene = held_rubber(Vector3d(1, 0, -1).normalized());
  scene.force_model.law = BendingLaw::hooke;
  scene.force_model.bookkeeping = Bookkeeping::consistent;
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

// By its stretch it may reach one that it would not reach without.
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
        says(error_of<InputError>([&] { return solve_reference(with_floor(z)); }),
             {"rod.stretch = true", "in reach", "allowed: stretch = false", "chain or force"}))
        << z;
  }
}

TEST(StretchReference, IsNamedFirstWhereARodIsTaut) {
  Scene scene = taut_line();
  scene.stretch = Stretch::none;
  EXPECT_TRUE(says(error_of<InputError>([&] { return solve_reference(scene); }),
                   {"gripper.position", "(allowed: rod.stretch = true"}));
}

}  // namespace
}  // namespace dlo::compare
