#include "dlo/compare/discretise.hpp"

#include <gtest/gtest.h>

#include "dlo/compare/error.hpp"
#include "dlo/compare/solve.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

using test::heavy_scene;

Scene paper_scene() { return paper_scenes().front(); }

TEST(PaperBendingStiffness, IsTable5) {
  const Scene scene = paper_scene();
  const double formula =
      paper_bending_stiffness(BendingRule::formula_21, scene.bending_stiffness(), 5, 0.5 / 15);
  EXPECT_NEAR(formula, 3574.96, 0.005);
  const Discretisation discretisation = discretise(scene, scene.force_model);
  EXPECT_DOUBLE_EQ(discretisation.parameters.c_b, formula);
  EXPECT_NEAR(discretisation.parameters.c_c, 659734, 0.5);
}

TEST(PaperBendingStiffness, MomentMatchedCarriesThePhysicalMoment) {
  const double EI = 0.165;
  const double k = 5;
  const double L = 0.03;
  const double c_b = paper_bending_stiffness(BendingRule::moment_matched, EI, k, L);
  const force_model::Bending bending{force_model::BendingLaw::paper, c_b};
  EXPECT_NEAR(force_model::joint_moment(bending, L, k * L), EI * k, 1e-14);
  EXPECT_NEAR(c_b * k * L, paper_bending_stiffness(BendingRule::formula_21, EI, k, L), 1e-9);
  EXPECT_THROW((void)paper_bending_stiffness(BendingRule::formula_21, EI, 200, L),
               std::invalid_argument);
}

TEST(Discretise, PaperBookkeepingStartsAtTheRodsEndWithEqualMasses) {
  Scene scene = heavy_scene(2, 0);
  scene.force_model.bookkeeping = Bookkeeping::paper;
  const Discretisation d = discretise(scene, scene.force_model);
  EXPECT_DOUBLE_EQ(d.arc_length.front(), 0);
  EXPECT_NEAR(d.arc_length.back(), 1, 1e-15);
  EXPECT_NEAR(d.rod.loads.row(1).sum(), scene.weight_per_length().y(), 1e-15);
  EXPECT_DOUBLE_EQ(d.rod.loads(1, 0), d.rod.loads(1, 15));
  EXPECT_EQ(d.rod.grips.front().first_point, 0);
}

TEST(Discretise, ConsistentBookkeepingHoldsTheMiddleOfASegment) {
  Scene scene = heavy_scene(2, 0);
  const Discretisation d = discretise(scene, scene.force_model);
  const double L = 1 / 14.5;
  EXPECT_NEAR(d.parameters.segment_length, L, 1e-16);
  EXPECT_NEAR(d.arc_length.front(), -L / 2, 1e-16);
  EXPECT_NEAR(d.arc_length.back(), 1, 1e-15);
  EXPECT_NEAR(d.rod.loads.row(1).sum(), scene.weight_per_length().y(), 1e-15);
  EXPECT_EQ(d.rod.loads.col(0).norm(), 0);
  EXPECT_NEAR(d.rod.loads(1, 15) / d.rod.loads(1, 14), 0.5, 1e-14);
  const Shape shape = d.shape(d.starts.front());
  EXPECT_EQ(shape.arc_length.front(), 0);
  EXPECT_LT(shape.points.col(0).norm(), 1e-16);
}

TEST(Discretise, LoadsKeepTheirForceAndMoment) {
  Scene scene = heavy_scene(0, 0);
  scene.gravity.setZero();
  scene.loads = {{0.37, {0, 2, 0}}, {1.0, {0, 0, 3}}};
  for (const Bookkeeping bookkeeping : {Bookkeeping::paper, Bookkeeping::consistent}) {
    scene.force_model.bookkeeping = bookkeeping;
    const Discretisation d = discretise(scene, scene.force_model);
    EXPECT_LT((d.rod.loads.rowwise().sum() - Eigen::Vector3d(0, 2, 3)).norm(), 1e-14);
    const Eigen::VectorXd s = Eigen::Map<const Eigen::VectorXd>(d.arc_length.data(), 16);
    EXPECT_NEAR(d.rod.loads.row(1) * s, 0.37 * 2, 1e-14);
    EXPECT_NEAR(d.rod.loads.row(2) * s, 3, 1e-14);
  }
}

TEST(Discretise, ClampAtTheEndIsTheMirrorOfAClampAtTheStart) {
  for (const Bookkeeping bookkeeping : {Bookkeeping::paper, Bookkeeping::consistent}) {
    Scene start = heavy_scene(3, 20);
    start.force_model.bookkeeping = bookkeeping;
    Scene end = start;
    end.grippers[0].at = 1;
    end.grippers[0].direction = -*start.grippers[0].direction;
    const Solution a = solve_chain(start, start.force_model);
    const Solution b = solve_chain(end, end.force_model);
    EXPECT_LT((a.shape.points - b.shape.points.rowwise().reverse()).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_NEAR(b.shape.arc_length.front(), 0, 1e-15);
    EXPECT_NEAR(b.shape.arc_length.back(), 1, 1e-15);
    const Solution force = solve_force(end, end.force_model);
    EXPECT_LT((force.shape.points - b.shape.points).colwise().norm().maxCoeff(), 1e-6);
  }
}

TEST(Discretise, SaysWhatTheForceModelDoesNotKnow) {
  Scene scene = heavy_scene(1, 0);
  scene.grippers[0].at = 0.3;
  EXPECT_THROW((void)discretise(scene, scene.force_model), InputError);
  scene = heavy_scene(1, 0);
  scene.grippers.push_back(scene.grippers[0]);
  EXPECT_THROW((void)discretise(scene, scene.force_model), InputError);
}

}  // namespace
}  // namespace dlo::compare
