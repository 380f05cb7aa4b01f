// Tests of the directors of a rod in space from its strains, against closed forms and another
// integrator. span_energy_test.cpp tests their derivatives with those of the energy.

#include "frames/rod_frames.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "frames/fit_frames.hpp"
#include "frames/frame_spins.hpp"
#include "runge_kutta.hpp"

namespace dlo::energy_model {
namespace {

RodFrames::State evaluated(const RodFrames& frames, const Eigen::VectorXd& x) {
  RodFrames::State state;
  frames.resize(state);
  frames.evaluate(x, state);
  return state;
}

Eigen::VectorXd random_strains(Eigen::Index size, double largest) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-largest, largest);
  return Eigen::VectorXd::NullaryExpr(size, [&] { return uniform(random); });
}

TEST(RodFrames, OfAConstantStrainGoRoundACircle) {
  const std::vector<Piece> pieces = {{0, 0.4}, {0.4, 0.6}};
  constexpr int terms = 3;
  const RodFrames frames(pieces, terms, Eigen::Matrix3d::Identity(), false);
  const double curvature = 7;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * frames.columns());
  // u2, which turns about d2 = y; p_0 is 1 / sqrt(length).
  x[frames.columns()] = curvature * std::sqrt(0.4);
  x[frames.columns() + terms] = curvature * std::sqrt(0.6);
  const RodFrames::State state = evaluated(frames, x);
  const Eigen::Vector3d end = state.end_frame().col(2);
  EXPECT_NEAR(end.x(), std::sin(curvature), 1e-14);
  EXPECT_NEAR(end.y(), 0, 1e-14);
  EXPECT_NEAR(end.z(), std::cos(curvature), 1e-14);
}

/// The quaternion at the end of one piece of length 1 with these strains more than those of x, by
/// Runge-Kutta's fourth-order method.
/// @param x  coefficients of two fields or of three
Eigen::Quaterniond integrated(const Eigen::VectorXd& x, int fields, int steps,
                              const Eigen::Vector3d& natural = Eigen::Vector3d::Zero()) {
  const Eigen::Index K = x.size() / fields;
  Eigen::VectorXd values(K);
  Eigen::VectorXd integrals(K);
  const auto rate = [&](double s, const Eigen::Vector4d& q) {
    legendre(s, values, integrals);
    Eigen::Quaterniond u(0, natural.x(), natural.y(), natural.z());
    for (int field = 0; field < fields; ++field) {
      u.vec()[field] += values.dot(x.segment(field * K, K));
    }
    const Eigen::Quaterniond r = Eigen::Quaterniond(q[3], q[0], q[1], q[2]) * u;
    return Eigen::Vector4d(r.coeffs() / 2);
  };
  Eigen::Vector4d q(0, 0, 0, 1);
  const double h = 1.0 / steps;
  for (int i = 0; i < steps; ++i) q = test::runge_kutta(rate, i * h, q, h);
  return Eigen::Quaterniond(q).normalized();
}

TEST(RodFrames, AgreeWithAnotherIntegratorWhereTheRodWindsThirtyTimes) {
  constexpr int terms = 24;
  const RodFrames frames({{0, 1}}, terms, Eigen::Matrix3d::Identity(), false);
  Eigen::VectorXd x = random_strains(2 * frames.columns(), 1);
  // Smooth, and of |u| l = 30 in the mean.
  for (Eigen::Index k = 0; k < x.size(); ++k)
    x[k] *= std::exp(-0.5 * static_cast<double>(k % terms));
  x *= 30 / x.norm();
  const RodFrames::State state = evaluated(frames, x);
  const Eigen::Quaterniond exact = integrated(x, 2, 40000);
  EXPECT_LT(exact.angularDistance(state.panel_ends.back()), 1e-9);
  EXPECT_LT((state.q.rowwise().norm().array() - 1).abs().maxCoeff(), 1e-14);
}

TEST(RodFrames, OfAnIntrinsicallyCurvedAndTwistedRodAgreeWithItToo) {
  constexpr int terms = 24;
  const Eigen::Vector3d natural(2, -3, 4);
  const RodFrames frames({{0, 1}}, terms, Eigen::Matrix3d::Identity(), false,
                         {.coefficients = {natural}});
  ASSERT_EQ(frames.fields(), 3);
  Eigen::VectorXd x = random_strains(3 * frames.columns(), 1);
  for (Eigen::Index k = 0; k < x.size(); ++k)
    x[k] *= std::exp(-0.5 * static_cast<double>(k % terms));
  x *= 10 / x.norm();
  const RodFrames::State state = evaluated(frames, x);
  const Eigen::Quaterniond exact = integrated(x, 3, 40000, natural);
  EXPECT_LT(exact.angularDistance(state.panel_ends.back()), 1e-9);
  EXPECT_LT((state.q.rowwise().norm().array() - 1).abs().maxCoeff(), 1e-14);
}

TEST(RodFrames, FreeStartTurnsTheRodAsAWhole) {
  const RodFrames held({{0, 1}}, 6, Eigen::Matrix3d::Identity(), false);
  const RodFrames loose({{0, 1}}, 6, Eigen::Matrix3d::Identity(), true);
  const Eigen::VectorXd x = random_strains(12, 1);
  Eigen::VectorXd turned(14);
  const Eigen::Vector3d turn(1.1, -0.7, 0);
  turned << turn.x(), x.head(6), turn.y(), x.tail(6);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  const RodFrames::State a = evaluated(held, x);
  const RodFrames::State b = evaluated(loose, turned);
  const Eigen::MatrixX3d expected = a.t * R.transpose();
  EXPECT_LT((b.t.bottomRows(a.t.rows()) - expected).cwiseAbs().maxCoeff(), 1e-13);
}

// t' = omega x t and t'' = alpha x t + omega x t' of x + v time + a time^2 / 2.
TEST(RodFrames, SpinsAreThoseOfDifferences) {
  const std::vector<Piece> pieces = {{0, 0.3}, {0.3, 0.7}};
  for (const bool free_start : {false, true}) {
    const RodFrames frames(pieces, 5, Eigen::Matrix3d::Identity(), free_start);
    const Eigen::Index size = 2 * frames.columns();
    const Eigen::VectorXd all = random_strains(3 * size, 1);
    const Eigen::VectorXd x = all.head(size);
    const Eigen::VectorXd v = all.segment(size, size);
    const Eigen::VectorXd a = all.tail(size);
    const RodFrames::State now = evaluated(frames, x);
    const FrameSpins spins = frame_spins(frames, now, {v, a});
    const double h = 1e-3;
    const RodFrames::State after = evaluated(frames, x + h * v + h * h / 2 * a);
    const RodFrames::State before = evaluated(frames, x - h * v + h * h / 2 * a);
    const auto expect_spin = [&](const Eigen::Vector3d& t, const Eigen::Vector3d& later,
                                 const Eigen::Vector3d& earlier, const Eigen::Vector3d& omega,
                                 const Eigen::Vector3d& alpha) {
      const Eigen::Vector3d rate = omega.cross(t);
      EXPECT_LT((rate - (later - earlier) / (2 * h)).norm(), 1e-5) << free_start;
      const Eigen::Vector3d acceleration = alpha.cross(t) + omega.cross(rate);
      EXPECT_LT((acceleration - (later - 2 * t + earlier) / (h * h)).norm(), 1e-4) << free_start;
    };
    const Eigen::Index first = frames.turn_nodes();
    for (Eigen::Index q = 0; q < spins.velocities.rows(); ++q) {
      expect_spin(now.t.row(first + q), after.t.row(first + q), before.t.row(first + q),
                  spins.velocities.row(q), spins.accelerations.row(q));
    }
    expect_spin(now.end_frame().col(2), after.end_frame().col(2), before.end_frame().col(2),
                spins.end_velocity, spins.end_acceleration);
  }
}

TEST(RodFrames, AreFittedToTheirOwnTangents) {
  for (const bool free_start : {false, true}) {
    const std::vector<Piece> pieces = {{0, 0.3}, {0.3, 0.7}};
    const RodFrames frames(pieces, 10, Eigen::Matrix3d::Identity(), free_start);
    Eigen::VectorXd x = random_strains(2 * frames.columns(), 2);
    for (Eigen::Index k = 0; k < x.size(); ++k) {
      x[k] *= std::exp(-0.8 * static_cast<double>((k % frames.columns()) % 10));
    }
    const RodFrames::State state = evaluated(frames, x);
    const Eigen::Matrix3Xd tangents =
        state.t.bottomRows(state.t.rows() - frames.turn_nodes()).transpose();
    RodFrames::State scratch = state;
    const RodFrames::State fitted =
        evaluated(frames, fit(frames, tangents, most_fit_steps, scratch));
    EXPECT_LT((fitted.t.bottomRows(tangents.cols()) - tangents.transpose()).cwiseAbs().maxCoeff(),
              free_start ? 1e-3 : 1e-5)
        << "free start " << free_start;
  }
}

}  // namespace
}  // namespace dlo::energy_model
