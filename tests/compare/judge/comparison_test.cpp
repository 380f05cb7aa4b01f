#include "dlo/compare/comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>

#include "dlo/compare/chain.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/force.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"
#include "judge/budget_shares.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

TEST(ChainAndForceModel, RestInTheSamePolygonWithThePhysicalStretchStiffness) {
  for (Scene scene : paper_scenes()) {
    for (const BendingLaw law : {BendingLaw::paper, BendingLaw::hooke}) {
      for (const Bookkeeping bookkeeping : {Bookkeeping::paper, Bookkeeping::consistent}) {
        scene.force_model.law = law;
        scene.force_model.bookkeeping = bookkeeping;
        const Solution chain = solve_chain(scene, scene.force_model);
        const Solution force = solve_force(scene, scene.force_model, {.rest_tolerance = 1e-8});
        EXPECT_LT((chain.shape.points - force.shape.points).colwise().norm().maxCoeff(),
                  1e-6 * scene.length)
            << scene.name << ", " << to_string(law) << ", " << to_string(bookkeeping);
      }
    }
  }
}

TEST(HookeChain, ConvergesAtFirstOrderWithThePapersBookkeeping) {
  Scene scene = heavy_scene(2, 0);
  scene.force_model.bookkeeping = Bookkeeping::paper;
  const energy_model::Equilibrium exact = solve_reference(scene, Model::exact);
  const auto error = [&](int points) {
    scene.force_model.points = points;
    const Shape shape = solve_chain(scene, scene.force_model).shape;
    return rms(shape.arc_length, shape.points - exact.sample(shape.arc_length).points);
  };
  EXPECT_NEAR(std::log2(error(64) / error(128)), 1, 0.1);
}

TEST(Deviation, OfAShiftedShapeIsTheShift) {
  const Scene scene = heavy_scene(1, 0);
  const energy_model::Equilibrium energy = solve_reference(scene, Model::energy);
  Shape shape;
  shape.arc_length = equal_arc_lengths(1, 21);
  shape.points = energy.sample(shape.arc_length).points;
  shape.points.row(2).array() += 0.01;
  const Deviation d = deviation(shape, energy.sample, straight_rod(scene, shape.arc_length), 20);
  EXPECT_NEAR(d.rms_m, 0.01, 1e-15);
  EXPECT_NEAR(d.max_m, 0.01, 1e-15);
  EXPECT_NEAR(d.tip_m, 0.01, 1e-15);
  EXPECT_NEAR(d.rms_over_length, 0.01, 1e-15);
  EXPECT_LT(d.angle_rms_rad, 1e-4);  // chords against tangents
  EXPECT_LT(d.curvature_rms_per_m, 1e-2);
}

TEST(Deviation, CurvatureOfAFlatShapeIsTheReferencesOwn) {
  // Gamma << 1: kappa = Gamma (1-s)^2 / 2, whose RMS over the rod is Gamma / sqrt 20
  const Scene scene = heavy_scene(0.01, 0);
  const std::vector<double> s = equal_arc_lengths(1, 401);
  const Shape straight = {s, straight_rod(scene, s).value()};
  const Deviation d =
      deviation(straight, solve_reference(scene, Model::energy).sample, straight.points, 400);
  EXPECT_NEAR(d.curvature_rms_per_m, 0.01 / std::sqrt(20.0), 2e-5);
  EXPECT_NEAR(d.rms_over_movement, 1, 1e-12);
}

TEST(Comparison, PaperRodIsFarFromItsModulusAndHookeIsNot) {
  Scene scene = paper_scenes().front();
  const Comparison paper = compare(scene);
  EXPECT_LT(paper.effective_modulus.ratio, 0.1);
  EXPECT_GT(paper.budget.law.rms_m, 10 * paper.budget.bookkeeping.rms_m);
  EXPECT_LT(paper.budget.stretch.rms_m, 1e-6 * scene.length);
  // Formula 21 with the `consistent` segment length gives another c_b; this is the interaction of
  // law and convention.
  EXPECT_NEAR(paper.budget.law.share + paper.budget.interaction.share, 1, 0.01);
  EXPECT_LT(paper.budget.interaction.rms_m, 0.15 * paper.budget.total_m);
  scene.force_model.law = BendingLaw::hooke;
  scene.force_model.bookkeeping = Bookkeeping::consistent;
  const Comparison hooke = compare(scene);
  EXPECT_NEAR(hooke.effective_modulus.ratio, 1, 0.01);
  EXPECT_LT(hooke.deviation.rms_over_length, 1e-4);
  EXPECT_EQ(hooke.budget.law.rms_m, 0);
  EXPECT_EQ(hooke.budget.bookkeeping.rms_m, 0);
  EXPECT_NEAR(hooke.budget.discretisation.rms_m, hooke.deviation.rms_m,
              0.02 * hooke.deviation.rms_m);
}

class BudgetOf : public testing::TestWithParam<std::tuple<double, BendingLaw, Bookkeeping>> {};

TEST_P(BudgetOf, AddsUpToTheTotal) {
  const auto [gamma, law, bookkeeping] = GetParam();
  for (const int points : {8, 16, 40}) {
    Scene scene = heavy_scene(gamma, 20);
    scene.force_model.law = law;
    scene.force_model.bookkeeping = bookkeeping;
    scene.force_model.points = points;
    // c_c is a hundredth of AE, with which the polygon comes to rest ten times sooner.
    scene.force_model.c_c = scene.axial_stiffness() / 100;
    const Comparison c = compare(scene);
    const Budget& b = c.budget;
    const double parts = test::sum_of_shares(b) - b.interaction.share;
    EXPECT_NEAR(test::sum_of_shares(b), 1, 1e-9) << points;
    // The total of the budget equals the deviation, except that the arc lengths at which shapes are
    // compared differ.
    EXPECT_NEAR(b.total_m, c.deviation.rms_m, 0.05 * c.deviation.rms_m) << points;
    // There is an interaction only if both the law and the convention differ from the reference.
    if (law == BendingLaw::hooke || bookkeeping == Bookkeeping::consistent) {
      EXPECT_NEAR(parts, 1, 0.01) << points;
      EXPECT_LT(b.interaction.rms_m, 0.02 * b.total_m + 1e-7) << points;
    }
    if (law == BendingLaw::hooke) EXPECT_EQ(b.law.rms_m, 0);
    if (bookkeeping == Bookkeeping::consistent) EXPECT_EQ(b.bookkeeping.rms_m, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, BudgetOf,
                         testing::Combine(testing::Values(0.2, 2.0, 20.0),
                                          testing::Values(BendingLaw::paper, BendingLaw::hooke),
                                          testing::Values(Bookkeeping::paper,
                                                          Bookkeeping::consistent)));

TEST(Budget, SaysHowFarFromRestTheShapeIs) {
  Scene scene = heavy_scene(2, 0);
  scene.force_model.c_c = scene.axial_stiffness() / 100;
  const Solution rest = solve_force(scene, scene.force_model, {.rest_tolerance = 1e-9});
  const Solution early = solve_force(scene, scene.force_model, {.rest_tolerance = 1e-3});
  const double distance = rms(rest.shape.arc_length, rest.shape.points - early.shape.points);
  const Comparison c = compare(scene, {.rest_tolerance = 1e-3});
  EXPECT_GT(distance, 1e-6);
  EXPECT_NEAR(c.budget.not_at_rest.rms_m, distance, 0.1 * distance);
}

TEST(Comparison, ComparesWithTheStateThatTheForceModelIsIn) {
  // A heavy rod between clamps that point upwards hangs out of its plane, to either side. The force
  // model and the energy model may find different ones of the two mirror images.
  Scene scene = heavy_scene(100, 30);
  scene.force_model.c_c = scene.axial_stiffness() / 100;
  scene.grippers.push_back(
      {.at = 1, .position = {0.6, 0, 0}, .direction = Eigen::Vector3d(1, -1, 0).normalized()});
  const Comparison c = compare(scene);
  EXPECT_EQ(c.state.stable, 2);
  EXPECT_EQ(c.state.others.front().stable, true);
  EXPECT_NEAR(c.state.others.front().energy_difference_J, 0, 1e-9 * std::abs(c.state.energy_J));
  EXPECT_EQ(static_cast<int>(c.state.others.size()), c.state.stable + c.state.unstable - 1);
  EXPECT_GT(c.state.others.front().rms_from_compared_m, 0.1);
  EXPECT_LT(c.deviation.rms_over_length, 0.01);
  EXPECT_NEAR(c.budget.discretisation.share, 1, 0.01);
  for (const UncomparedEquilibrium& other : c.state.others) {
    EXPECT_GT(other.rms_from_shape_m, 5 * c.deviation.rms_m);
  }
  EXPECT_TRUE(compare(heavy_scene(0.2, 0)).state.others.empty());
}

TEST(Comparison, TheBudgetBetweenTwoClampsAddsUp) {
  Scene scene = test::two_clamps(20, {0.7, 0, 0});
  scene.force_model.law = BendingLaw::paper;
  scene.force_model.bookkeeping = Bookkeeping::consistent;
  scene.force_model.c_c = scene.axial_stiffness() / 100;
  const Comparison c = compare(scene, {}, {}, ModulusSearch::no);
  EXPECT_EQ(c.effective_modulus.optimum, Optimum::none);
  EXPECT_EQ(c.effective_modulus.missing_reason, "skipped");
  const Budget& b = c.budget;
  EXPECT_NEAR(test::sum_of_shares(b), 1, 1e-9);
  EXPECT_NEAR(b.interaction.share, 0, 0.02);
  EXPECT_NEAR(b.total_m, c.deviation.rms_m, 0.05 * c.deviation.rms_m);
  EXPECT_EQ(b.bookkeeping.rms_m, 0);
  EXPECT_GT(b.law.rms_m, 3 * b.stretch.rms_m);
  EXPECT_TRUE(std::isnan(c.deviation.tip_m));
  EXPECT_TRUE(std::isnan(c.deviation.rms_over_movement));
  EXPECT_TRUE(std::isnan(c.undeformed_rms_over_length));
}

TEST(Solve, AllModelsAgreeOnForcesAndEnergies) {
  Scene scene = heavy_scene(1, -20);
  scene.force_model.points = 64;
  // A hundredth of AE: the strain w l / (c_c) stays below 3e-5 and rest comes ten times sooner.
  scene.force_model.c_c = scene.axial_stiffness() / 100;
  const Solution exact = solve(scene, Model::exact);
  for (const Model model : {Model::energy, Model::chain, Model::force}) {
    const Solution solution = solve(scene, model);
    const double size = exact.energy.total();
    const double tolerance = model == Model::energy ? 1e-9 : 2e-3;
    EXPECT_NEAR(solution.energy.total(), size, tolerance * std::abs(size)) << to_string(model);
    EXPECT_NEAR(solution.energy.bending, exact.energy.bending, 10 * tolerance * std::abs(size));
    // The force model stops 1e-7 l from rest, where its stiff segments still pull at the grip.
    const double force_tolerance = model == Model::force ? 1e-4 : 1e-12;
    EXPECT_LT((solution.grippers[0].force - exact.grippers[0].force).norm(),
              force_tolerance * exact.grippers[0].force.norm());
    EXPECT_LT((solution.grippers[0].torque - exact.grippers[0].torque).norm(),
              tolerance * exact.grippers[0].torque.norm())
        << to_string(model);
  }
}

TEST(Solve, TorquesAreAboutTheGripperWhereverItIs) {
  const Eigen::Vector3d away(3, -2, 1.5);  // four lengths: a lever from the origin is far off
  Scene one = heavy_scene(1, -20);
  one.force_model.points = 16;
  one.force_model.c_c = one.axial_stiffness() / 1000;
  Scene two = one;  // solved by the chain with stretch
  two.grippers.push_back({.at = 0.71 * one.length,
                          .position = Eigen::Vector3d(0.5, 0.1, 0.05) * one.length,
                          .where = "test"});

  for (const Scene& scene : {one, two}) {
    Scene far = scene;
    for (Gripper& gripper : far.grippers) gripper.position += away;
    for (const Model model : {Model::exact, Model::energy, Model::chain, Model::force}) {
      const std::vector<GripperLoad> here = solve(scene, model).grippers;
      const std::vector<GripperLoad> there = solve(far, model).grippers;
      for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
        EXPECT_LT((there[i].torque - here[i].torque).norm(), 1e-3 * here[0].torque.norm())
            << to_string(model);
      }
    }
  }
}

// The search of the energy model ends at a saddle. Started from the chain's shape it converges to
// the equilibrium on the table.
TEST(Solve, ACableBetweenClampsLiesOnATable) {
  const Scene scene = parse_scene(R"(
rod = { length = 2, diameter = "6 mm", material = "silicone" }
gripper = [{ at = 0, position = [0, 0, 0], direction = "0 deg" },
           { at = 2, position = [1.6, 0, 0], direction = "0 deg" }]
obstacle = [{ point = [0, -0.5, 0], normal = [0, 1, 0] }]
force_model = { points = 160 }
)",
                                  "table.toml");
  const Solution energy = solve(scene, Model::energy, {.time_limit = 300});
  EXPECT_GT(energy.shape.points.row(1).minCoeff(), -0.5 - 2e-3);
  // The table and the grippers bear the rod's weight.
  const double weight = scene.weight_per_length().norm() * scene.length;
  const double table = energy.obstacles[0].y();
  EXPECT_GT(table, 0.1 * weight);
  EXPECT_NEAR(table + energy.grippers[0].force.y() + energy.grippers[1].force.y(), weight,
              1e-3 * weight);
  EXPECT_NEAR(solve(scene, Model::chain).obstacles[0].y(), table, 0.02 * weight);
}

}  // namespace
}  // namespace dlo::compare
