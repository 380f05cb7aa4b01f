// Tests of the example of a term in energy_model/doc/extend.md: a spring from the rod's end to a
// point.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>
#include <vector>

#include "dlo/energy_model/energy.hpp"
#include "frames/position_operator.hpp"
#include "problem/split.hpp"
#include "problems.hpp"
#include "strain/span_energy.hpp"

namespace dlo::energy_model {
namespace {

// [page]
/// E = k/2 |r(L) - p|^2, in the span's units (l, EI) and axes. r(L) is a sum over the tangents.
struct Tether {
  double k = 0;
  Eigen::Vector3d p;
  Eigen::VectorXd weights;  ///< of the tangents at the nodes: r(L) = tangents weights

  [[nodiscard]] Eigen::Vector3d stretch(const SpanPoint& at) const {
    return at.tangents() * weights - p;
  }
};

double value(const Tether& tether, const SpanPoint& at) {
  return tether.k / 2 * tether.stretch(at).squaredNorm();
}

Eigen::VectorXd gradient(const Tether& tether, const SpanEnergy& model, SpanPoint& at) {
  const std::array<Eigen::MatrixXd, 3> J = model.tangent_jacobian(at);
  const Eigen::Vector3d d = tether.k * tether.stretch(at);
  return (d[0] * J[0] + d[1] * J[1] + d[2] * J[2]).transpose() * tether.weights;
}

/// Returns the Hessian for a span in a plane, where a tangent's second derivative is -t a a^T with
/// the derivative a of its angle.
Eigen::MatrixXd hessian(const Tether& tether, const SpanEnergy& model, SpanPoint& at) {
  const std::array<Eigen::MatrixXd, 3> J = model.tangent_jacobian(at);
  const Eigen::Matrix3Xd t = at.tangents();
  const Eigen::MatrixXd a = t.row(0).asDiagonal() * J[1] - t.row(1).asDiagonal() * J[0];
  const Eigen::VectorXd along = t.transpose() * tether.stretch(at);
  Eigen::MatrixXd result = -a.transpose() * tether.weights.cwiseProduct(along).asDiagonal() * a;
  for (const Eigen::MatrixXd& axis : J) {
    const Eigen::VectorXd by_x = axis.transpose() * tether.weights;
    result += by_x * by_x.transpose();
  }
  return tether.k * result;
}
// [end of page]

struct TetheredRod {
  PlacedSpan placed;
  SpanEnergy model;
  Tether tether;
  SpanPoint at;

  explicit TetheredRod(const Problem& problem)
      : placed(split(problem).front()), model(placed.span, 24) {
    std::vector<Element> elements;
    for (Eigen::Index i = 0; i < model.elements(); ++i) elements.push_back(model.element(i));
    const PositionOperator reach(placed.span, elements, model.table());
    tether = {3, placed.frame * Eigen::Vector3d(0.9, 0.4, 0), reach.begin(model.elements())};
  }

  double evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& slope) {
    model.evaluate(x, at);
    slope = at.gradient + gradient(tether, model, at);
    return at.energy + value(tether, at);
  }

  Eigen::MatrixXd second_derivative() {
    Eigen::MatrixXd result;
    model.hessian(at, Eigen::VectorXd(), result);
    return result + hessian(tether, model, at);
  }
};

TEST(ExtendTerm, DerivativesAreThoseOfTheValue) {
  TetheredRod rod(test::heavy_cantilever(5, 20));
  Eigen::VectorXd slope;
  Eigen::VectorXd ahead;
  Eigen::VectorXd behind;
  const Eigen::VectorXd x = 0.3 * Eigen::VectorXd::Random(rod.model.size());
  (void)rod.evaluate(x, slope);
  const Eigen::MatrixXd second = rod.second_derivative();
  constexpr double h = 1e-4;  // error h^2, rounding 1e-16 / h
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Eigen::VectorXd by = h * Eigen::VectorXd::Unit(x.size(), i);
    const double change = rod.evaluate(x + by, ahead) - rod.evaluate(x - by, behind);
    EXPECT_NEAR(change / (2 * h), slope[i], 1e-6);
    EXPECT_LT(((ahead - behind) / (2 * h) - second.col(i)).norm(), 1e-6);
  }
}

// A rod at rest with the spring is also at rest under the force that the spring then exerts, by
// solve_energy().
TEST(ExtendTerm, RestsAsUnderItsForce) {
  Problem problem = test::heavy_cantilever(5, 20);
  TetheredRod rod(problem);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(rod.model.size());
  Eigen::VectorXd slope;
  for (int i = 0; i < 20; ++i) {
    (void)rod.evaluate(x, slope);
    x -= rod.second_derivative().ldlt().solve(slope);
  }
  (void)rod.evaluate(x, slope);
  ASSERT_LT(slope.norm(), 1e-10);
  const Eigen::Vector3d stretch = rod.tether.stretch(rod.at);
  problem.loads = {{1, -rod.tether.k * (rod.placed.frame.transpose() * stretch)}};
  const Equilibrium loaded = solve_energy(problem);
  ASSERT_EQ(loaded.status, SolveStatus::converged) << loaded.message;
  const Eigen::Vector3d end = rod.placed.frame.transpose() * (stretch + rod.tether.p);
  EXPECT_LT((loaded.sample(std::vector<double>{1}).points.col(0) - end).norm(), 1e-9);
}

}  // namespace
}  // namespace dlo::energy_model
