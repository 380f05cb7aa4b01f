// Tests of the directors of a rod in space from its strains, against another integrator.
// span_energy_test.cpp tests their derivatives with those of the energy.

#include "frames/rod_frames.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "runge_kutta.hpp"

namespace dlo::energy_model {
namespace {

/// Returns the quaternion at the end of one element of length 1, by Runge-Kutta's fourth-order
/// method. The strains are those of x plus `natural`.
/// @param x  coefficients of two fields or of three
Eigen::Quaterniond integrated(const Eigen::VectorXd& x, int fields, int steps,
                              const Eigen::Vector3d& natural) {
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

/// Compares the end of a rod of smooth random strains, of |u| l = `size` in the mean, with the
/// other integrator.
void expect_as_integrated(int fields, double size, const NaturalStrains& natural) {
  constexpr int terms = 24;
  const RodFrames frames({{0, 1}}, terms, Eigen::Matrix3d::Identity(), false, natural);
  ASSERT_EQ(frames.fields(), fields);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::VectorXd x(fields * frames.columns());
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    x[k] = uniform(random) * std::exp(-0.5 * static_cast<double>(k % terms));
  }
  x *= size / x.norm();
  RodFrames::State state;
  frames.resize(state);
  frames.evaluate(x, state);
  const Eigen::Vector3d strain =
      natural.coefficients.empty() ? Eigen::Vector3d::Zero() : natural.coefficients.front();
  const Eigen::Quaterniond exact = integrated(x, fields, 40000, strain);
  EXPECT_LT(exact.angularDistance(state.panel_ends.back()), 1e-9);
  EXPECT_LT((state.q.rowwise().norm().array() - 1).abs().maxCoeff(), 1e-14);
}

TEST(RodFrames, AgreeWithAnotherIntegratorWhereTheRodRotatesByThirtyRadians) {
  expect_as_integrated(2, 30, {});
}

TEST(RodFrames, OfAnIntrinsicallyCurvedAndTwistedRodAgreeWithItToo) {
  expect_as_integrated(3, 10, {.coefficients = {{2, -3, 4}}});
}

}  // namespace
}  // namespace dlo::energy_model
