// Tests of the force model's twist between grips that hold the rod's frame.

#include "dlo/force_model/twist.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "../differences.hpp"
#include "dlo/force_model/batch.hpp"
#include "dlo/force_model/simulation.hpp"
#include "dlo/force_model/step_size.hpp"
#include "dlo/force_model/tangent_stiffness.hpp"
#include "plain_simulation.hpp"
#include "polygons.hpp"
#include "twisted_rods.hpp"

namespace dlo::force_model {
namespace {

using std::numbers::pi;

TwistedSpan random_span(Eigen::Index segments) {
  return {.first_segment = 1,
          .last_segment = segments - 2,
          .first_d1 = {0.3, 1, -0.2},
          .last_d1 = {0.1, -0.4, 0.9},
          .compliance = 2.5,
          .angle = 4 * pi};
}

Eigen::Vector3d direction(const Eigen::Matrix3Xd& points, Eigen::Index segment) {
  return (points.col(segment + 1) - points.col(segment)).normalized();
}

TEST(Twist, IsTheRotationOfTheEndInTheBranchNearestToTheLast) {
  constexpr Eigen::Index n = 9;
  const Eigen::Matrix3Xd points = random_polygon(3, n, 0.05, 0.1);
  TwistedSpan span = random_span(n);
  const double theta = twist_angle(span, points);
  EXPECT_LT(std::abs(theta - span.angle), pi);
  for (const double turn : {0.7, 3.5, -9.0}) {
    TwistedSpan turned = span;
    turned.last_d1 = Eigen::AngleAxisd(turn, direction(points, span.last_segment)) * span.last_d1;
    turned.angle += turn;
    EXPECT_NEAR(twist_angle(turned, points), theta + turn, 1e-12);
    turned.first_d1 =
        Eigen::AngleAxisd(turn, direction(points, span.first_segment)) * span.first_d1;
    turned.angle = span.angle;
    EXPECT_NEAR(twist_angle(turned, points), theta, 1e-12);
  }
  // A planar polygon transports its normal.
  Eigen::Matrix3Xd planar = points;
  planar.row(2).setZero();
  span.first_d1 = span.last_d1 = Eigen::Vector3d::UnitZ();
  span.angle = 0;
  EXPECT_NEAR(twist_angle(span, planar), 0, 1e-14);
}

TEST(Twist, ForcesAreTheGradientOfTheEnergy) {
  constexpr Eigen::Index n = 12;
  const Eigen::Matrix3Xd points = random_polygon(5, n, 0.05, 0.2);
  const TwistedSpan span = random_span(n);
  // The end frames rotate with their segments, by the shortest rotation.
  const auto energy = [&](const Eigen::Matrix3Xd& moved) {
    TwistedSpan carried = span;
    carried.first_d1 = Eigen::Quaterniond::FromTwoVectors(direction(points, span.first_segment),
                                                          direction(moved, span.first_segment)) *
                       span.first_d1;
    carried.last_d1 = Eigen::Quaterniond::FromTwoVectors(direction(points, span.last_segment),
                                                         direction(moved, span.last_segment)) *
                      span.last_d1;
    return twist_energy(carried, moved);
  };
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, n + 1);
  add_twist_forces(span, points, forces);
  const Eigen::Matrix3Xd expected = difference_forces(energy, points, 1e-6);
  const double size = forces.cwiseAbs().maxCoeff();
  EXPECT_GT(size, 1);
  // Differences of step h are right to (h / L)^2 and eps E / h.
  EXPECT_LT((forces - expected).cwiseAbs().maxCoeff(), 1e-7 * size);
  EXPECT_EQ(forces.col(0), Eigen::Vector3d::Zero());
  EXPECT_EQ(forces.col(n), Eigen::Vector3d::Zero());
  Eigen::Matrix3Xd gradient(3, n + 1);
  twist_gradient(span, points, gradient);
  const double moment = twist_angle(span, points) / span.compliance;
  EXPECT_LT((forces + moment * gradient).cwiseAbs().maxCoeff(), 1e-14 * size);
}

TEST(Twist, AtRestTheGripsBalanceEachOtherAndBearIt) {
  TwistedRod twisted;
  twisted.turn = 2;
  twisted.GJ = 3;
  Simulation simulation(twisted.rod(), twisted.arch(), {});
  ASSERT_EQ(simulation.relax({.tolerance = 1e-10}).status, RelaxStatus::at_rest);
  const Rod& rod = simulation.rod();
  const Eigen::Matrix3Xd points = simulation.points();
  const std::vector<GripReaction> grips = grip_reactions(rod, points);
  const double scale = twisted.EI;
  EXPECT_LT((grips[0].force + grips[1].force).norm(), 1e-5 * scale);
  const Eigen::Vector3d arm = rod.grips[1].reference;
  EXPECT_LT((grips[0].torque + grips[1].torque + arm.cross(grips[1].force)).norm(), 1e-5 * scale);
  // The clamped segments are along x, so the torque about x is the twisting moment.
  const std::vector<TwistedSpan> spans = twisted_spans(rod);
  ASSERT_EQ(spans.size(), 1);
  EXPECT_NEAR(spans[0].compliance, twisted.length / twisted.GJ, 1e-14);
  const double moment = twist_angle(spans[0], points) / spans[0].compliance;
  EXPECT_NEAR(grips[1].torque.x(), moment, 1e-5 * scale);
  EXPECT_GT(moment, 1);
  // A part of the turn becomes writhe.
  EXPECT_LT(rod.twist.angles[0], 1.99);
  EXPECT_GT(points.row(2).cwiseAbs().maxCoeff(), 0.01);
  EXPECT_NEAR(energy(rod, points).twist, moment * moment * spans[0].compliance / 2, 1e-12);
}

TEST(Twist, NewtonsStepLeadsBackToRest) {
  TwistedRod twisted;
  twisted.turn = 3;
  twisted.points = 12;
  twisted.c_c = 100;
  Simulation simulation(twisted.rod(), twisted.arch(), {});
  ASSERT_EQ(simulation.relax({.tolerance = 1e-10}).status, RelaxStatus::at_rest);
  const Eigen::Matrix3Xd rest = simulation.points();
  Eigen::Matrix3Xd away = random_polygon(4, twisted.points - 1, 1, 0.3).array().sin();
  away.leftCols<2>().setZero();
  away.rightCols<2>().setZero();
  double last = 0;
  for (const double size : {4e-5, 2e-5, 1e-5}) {
    const EquilibriumCheck check = check_equilibrium(simulation.rod(), rest + size * away);
    ASSERT_GT(check.step.norm(), 0);
    const double missed = (check.step + size * away).norm();
    if (last > 0) {
      EXPECT_NEAR(last / missed, 4, 0.4);
    }
    last = missed;
  }
}

TEST(Twist, StepsCountItsStiffness) {
  for (const double GJ : {0.1, 1.0, 50.0}) {
    TwistedRod twisted;
    twisted.GJ = GJ;
    twisted.points = 14;
    twisted.turn = 6;
    twisted.c_c = 10;
    const Rod rod = twisted.rod();
    const Eigen::Matrix3Xd points = twisted.arch();
    const Eigen::Index free = 3 * (rod.points() - 4);
    Eigen::Matrix3Xd forces(3, twisted.points);
    const auto forces_at = [&](const Eigen::Matrix3Xd& p) {
      total_forces(rod, p, forces);
      return Eigen::VectorXd(forces.reshaped());
    };
    const Eigen::MatrixXd K = -difference_matrix(forces_at, points, 1e-6).block(6, 6, free, free);
    EXPECT_LT((K - K.transpose()).norm(), 1e-6 * K.norm());
    const double fastest =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues().maxCoeff();
    EXPECT_LT(fastest, mode_bounds(rod, points).fastest) << GJ;
    // A bound that neglects the twist would be too low here.
    Rod free_to_turn = rod;
    free_to_turn.grips[1].d1.reset();
    free_to_turn.twist.angles.resize(0);
    if (GJ == 50.0) {
      EXPECT_GT(fastest, mode_bounds(free_to_turn, points).fastest);
    }
  }
}

/// Returns M l / B at which a straight rod between clamps loses its stability, by bisection.
double buckling_moment(int points) {
  TwistedRod twisted;
  twisted.points = points;
  twisted.distance = twisted.length;
  twisted.GJ = 1;
  double low = 8;
  double high = 10;
  Eigen::Matrix3Xd straight(3, points);
  for (int i = 0; i < points; ++i) straight.col(i) << (i - 0.5) * twisted.segment(), 0, 0;
  while (high - low > 1e-9) {
    twisted.turn = (low + high) / 2;  // theta = M l / GJ
    const bool stable = check_equilibrium(twisted.rod(), straight).stable;
    (stable ? low : high) = twisted.turn;
  }
  return low;
}

TEST(Twist, AStraightClampedRodBucklesAtGreenhillsMoment) {
  // Greenhill (1883): tan(x) = x, x = M l / (2 B) = 4.493409458.
  constexpr double exact = 8.986818916;
  double last = 0;
  for (const int points : {22, 42, 82, 162}) {
    const double error = buckling_moment(points) - exact;
    if (last != 0) {
      EXPECT_NEAR(last / error, 4, 0.15) << points;
    }
    last = error;
  }
  EXPECT_LT(std::abs(last), 3e-3);
}

TEST(Twist, IsCountedThroughWholeTurns) {
  TwistedRod twisted;
  twisted.distance = 1.01;  // taut: it turns about itself only
  twisted.c_c = 1e5;
  Rod rod = twisted.rod();
  rod.twist.angles.resize(0);
  Eigen::Matrix3Xd straight(3, twisted.points);
  for (int i = 0; i < twisted.points; ++i) {
    straight.col(i) << (i - 0.5) * twisted.segment() * 1.01, 0, 0;
  }
  Simulation simulation(rod, straight, {});
  double turned = 0;
  for (int i = 0; i < 30; ++i) {
    turned += 0.7;
    simulation.move_grip(1, rod.grips[1].targets, rod.grips[1].reference,
                         Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitX()) * *rod.grips[0].d1);
    ASSERT_EQ(simulation.step().status, StepStatus::good);
  }
  EXPECT_NEAR(simulation.rod().twist.angles[0], turned, 1e-9);
  const std::vector<GripReaction> grips = grip_reactions(simulation.rod(), simulation.points());
  EXPECT_NEAR(grips[1].torque.x(), twisted.GJ * turned / twisted.length, 1e-9);
  // The frame rotates with the gripper.
  const Eigen::Matrix3d tilt(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ()));
  simulation.move_grip(1, tilt * rod.grips[1].targets, tilt * rod.grips[1].reference);
  const Eigen::Vector3d carried = *simulation.rod().grips[1].d1;
  const Eigen::Vector3d expected =
      tilt * Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitX()) * *rod.grips[0].d1;
  EXPECT_LT((carried - expected).norm(), 1e-12);
}

TEST(Twist, StepsAgreeWithPlainStepsOnEveryInstructionSet) {
  for (const InstructionSet set : available_instruction_sets()) {
    for (const int points : {4, 5, 8, 9, 20, 33, 64}) {
      TwistedRod twisted;
      twisted.points = points;
      twisted.turn = 1.5;
      twisted.c_c = 20;
      StepOptions options;
      options.instruction_set = set;
      Rod rod = twisted.rod();
      rod.loads.setRandom();
      test::PlainSimulation plain(rod, twisted.arch(), options);
      Simulation simulation(rod, twisted.arch(), options);
      for (int i = 0; i < 20; ++i) {
        ASSERT_EQ(plain.step().status, StepStatus::good);
        ASSERT_EQ(simulation.step().status, StepStatus::good);
        ASSERT_LT((simulation.points() - plain.points()).cwiseAbs().maxCoeff(), 1e-12 * (i + 1))
            << to_string(set) << ", " << points << " points, step " << i;
      }
    }
  }
}

TEST(Twist, PassesAPinAndAClampThatLeavesTheRodFree) {
  TwistedRod twisted;
  twisted.turn = 1;
  twisted.points = 21;
  Rod rod = twisted.rod();
  rod.grips.push_back({.first_point = 10, .targets = twisted.arch().col(10)});
  rod.grips.push_back({.first_point = 5, .targets = twisted.arch().middleCols(5, 2)});
  EXPECT_EQ(twisted_spans(rod).size(), 1);
  Simulation simulation(rod, twisted.arch(), {});
  EXPECT_EQ(simulation.relax().status, RelaxStatus::at_rest);
  // A third gripper with a frame divides the twisted span into two, in the order along the rod.
  rod.grips.back().d1 = Eigen::Vector3d::UnitZ();
  rod.twist.angles.resize(0);
  rod.twist.stiffnesses = Eigen::VectorXd::LinSpaced(19, 1, 2);
  const std::vector<TwistedSpan> spans = twisted_spans(rod);
  ASSERT_EQ(spans.size(), 2);
  EXPECT_EQ(spans[0].last_segment, 5);
  EXPECT_EQ(spans[1].first_segment, 5);
  const double L = twisted.segment();
  double compliance = 0;
  for (int i = 0; i < 5; ++i) compliance += L / rod.twist.stiffnesses[i];
  EXPECT_NEAR(spans[0].compliance, compliance, 1e-14);
}

TEST(Twist, OneFrameAloneChangesNothing) {
  const TwistedRod twisted;
  Rod framed = twisted.rod();
  framed.grips[1].d1.reset();
  framed.twist = {};
  Rod plain = framed;
  plain.grips[0].d1.reset();
  Simulation a(framed, twisted.arch(), {});
  Simulation b(plain, twisted.arch(), {});
  for (int i = 0; i < 100; ++i) {
    (void)a.step();
    (void)b.step();
  }
  EXPECT_EQ(a.points(), b.points());
}

TEST(Twist, IsRefusedWhereItIsNotHeldOrHasNoLaw) {
  const TwistedRod twisted;
  const auto refused = [&](const auto& change) {
    Rod rod = twisted.rod();
    change(rod);
    EXPECT_THROW(check(rod), std::invalid_argument);
    EXPECT_THROW(Simulation(rod, twisted.arch(), {}), std::invalid_argument);
  };
  EXPECT_NO_THROW(check(twisted.rod()));
  refused([](Rod& rod) { rod.twist.stiffness = 0; });
  refused([](Rod& rod) { rod.twist.stiffness = NAN; });
  refused([](Rod& rod) { rod.twist.stiffnesses.setOnes(3); });
  refused([](Rod& rod) { rod.twist.stiffnesses.setZero(18); });
  refused([](Rod& rod) { rod.twist.angles.setZero(2); });
  refused([](Rod& rod) { rod.twist.angles[0] = NAN; });
  refused([](Rod& rod) { rod.bending.law = BendingLaw::paper; });
  refused([](Rod& rod) { rod.bending.stiffness = 0; });
  refused([](Rod& rod) { rod.bending.natural_turns.setZero(18); });
  refused([](Rod& rod) { rod.grips[1].d1 = Eigen::Vector3d::UnitX(); });
  refused([](Rod& rod) { rod.grips[1].d1 = Eigen::Vector3d::Constant(NAN); });
  refused([](Rod& rod) { rod.grips[1].targets = rod.grips[1].targets.leftCols(1).eval(); });
  refused([](Rod& rod) {
    rod.grips[1].hold = GripHold::spring;
    rod.grips[1].stiffness = 100;
  });
  EXPECT_THROW(Batch({{twisted.rod(), twisted.arch(), {}}}), std::invalid_argument);
  TwistedSpan span = random_span(9);
  const Eigen::Matrix3Xd points = random_polygon(3, 9, 0.05, 0.1);
  Eigen::Matrix3Xd few(3, 4);
  EXPECT_THROW(add_twist_forces(span, points, few), std::invalid_argument);
  span.last_segment = 9;
  EXPECT_THROW((void)twist_angle(span, points), std::invalid_argument);
  span.last_segment = 1;
  EXPECT_THROW((void)twist_energy(span, points), std::invalid_argument);
  Simulation simulation(twisted.rod(), twisted.arch(), {});
  const Rod rod = twisted.rod();
  EXPECT_THROW(simulation.move_grip(1, rod.grips[1].targets, rod.grips[1].reference,
                                    Eigen::Vector3d::UnitX()),
               std::invalid_argument);
}

}  // namespace
}  // namespace dlo::force_model
