// Tests of the example of a constraint in energy_model/doc/extend.md: the rod's end slides along a
// line.

#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <vector>

#include "dlo/energy_model/energy.hpp"
#include "frames/position_operator.hpp"
#include "linear/reduced_hessian.hpp"
#include "problem/split.hpp"
#include "problems.hpp"
#include "strain/span_energy.hpp"

namespace dlo::energy_model {
namespace {

// [page]
/// c = N . (r(L) - p), in the span's units and axes: the end stays on the line across N through p.
struct Slider {
  Eigen::Vector3d N, p;
  Eigen::VectorXd weights;  ///< of the tangents at the nodes: r(L) = tangents weights
};

double residual(const Slider& slider, const SpanPoint& at) {
  return slider.N.dot(at.tangents() * slider.weights - slider.p);
}

Eigen::RowVectorXd jacobian(const Slider& slider, const SpanEnergy& model, SpanPoint& at) {
  const std::array<Eigen::MatrixXd, 3> J = model.tangent_jacobian(at);
  return slider.weights.transpose() *
         (slider.N[0] * J[0] + slider.N[1] * J[1] + slider.N[2] * J[2]);
}

/// Returns the second derivative of c for a span in a plane. The second derivative of a tangent t
/// is -t a a^T, where a is the gradient of the tangent's angle.
Eigen::MatrixXd hessian(const Slider& slider, const SpanEnergy& model, SpanPoint& at) {
  const std::array<Eigen::MatrixXd, 3> J = model.tangent_jacobian(at);
  const Eigen::Matrix3Xd t = at.tangents();
  const Eigen::MatrixXd a = t.row(0).asDiagonal() * J[1] - t.row(1).asDiagonal() * J[0];
  const Eigen::VectorXd along = t.transpose() * slider.N;
  return -a.transpose() * slider.weights.cwiseProduct(along).asDiagonal() * a;
}

/// One step of Newton's method for L = E - mu c, which `system` factors.
void newton_step(const Slider& slider, const SpanEnergy& model, NewtonSystem& system,
                 Eigen::VectorXd& x, double& mu) {
  SpanPoint at = model.evaluated(x);
  const Eigen::RowVectorXd J = jacobian(slider, model, at);
  Eigen::VectorXd right(x.size() + 1);
  right << mu * J.transpose() - at.gradient, -residual(slider, at);
  Eigen::MatrixXd H;
  model.hessian(at, Eigen::VectorXd(), H);
  H -= mu * hessian(slider, model, at);
  system.compute(H, J);
  Eigen::VectorXd step;
  system.solve(right, step);
  x += step.head(x.size());
  mu += step[x.size()];
}
// [end of page]

Slider slider_of(const SpanEnergy& model, const PlacedSpan& placed) {
  std::vector<Element> elements;
  for (Eigen::Index i = 0; i < model.elements(); ++i) elements.push_back(model.element(i));
  const PositionOperator reach(placed.span, elements, model.table());
  return {placed.frame * Eigen::Vector3d(0.6, 0.8, 0), Eigen::Vector3d(0.2, 0.1, 0),
          reach.begin(model.elements())};
}

TEST(ExtendConstraint, DerivativesAreThoseOfTheResidual) {
  const PlacedSpan placed = split(test::heavy_cantilever(5, 20)).front();
  SpanEnergy model(placed.span, 24);
  const Slider slider = slider_of(model, placed);
  const Eigen::VectorXd x = 0.3 * Eigen::VectorXd::Random(model.size());
  SpanPoint here = model.evaluated(x);
  const Eigen::RowVectorXd first = jacobian(slider, model, here);
  const Eigen::MatrixXd second = hessian(slider, model, here);
  constexpr double h = 1e-4;  // error h^2, rounding 1e-16 / h
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Eigen::VectorXd by = h * Eigen::VectorXd::Unit(x.size(), i);
    SpanPoint ahead = model.evaluated(x + by);
    SpanPoint behind = model.evaluated(x - by);
    EXPECT_NEAR((residual(slider, ahead) - residual(slider, behind)) / (2 * h), first[i], 1e-7);
    const Eigen::RowVectorXd turned =
        jacobian(slider, model, ahead) - jacobian(slider, model, behind);
    EXPECT_LT((turned / (2 * h) - second.row(i)).norm(), 1e-7);
  }
}

// The multiplier is the force that the line exerts: a load of that size gives the same shape.
TEST(ExtendConstraint, MultiplierIsTheForceOfTheLine) {
  Problem problem = test::heavy_cantilever(5, 20);
  const PlacedSpan placed = split(problem).front();
  SpanEnergy model(placed.span, 24);
  const Slider slider = slider_of(model, placed);
  NewtonSystem system;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(model.size());
  double mu = 0;
  for (int i = 0; i < 20; ++i) newton_step(slider, model, system, x, mu);
  const SpanPoint at = model.evaluated(x);
  EXPECT_LT(std::abs(residual(slider, at)), 1e-12);
  const std::optional<double> smallest = system.reduced_hessian().smallest_eigenvalue_of_definite();
  ASSERT_TRUE(smallest.has_value());
  EXPECT_GT(*smallest, 0);
  problem.loads = {{1, mu * (placed.frame.transpose() * slider.N)}};
  const Equilibrium loaded = solve_energy(problem);
  ASSERT_EQ(loaded.status, SolveStatus::converged) << loaded.message;
  const Eigen::Vector3d end = placed.frame.transpose() * (at.tangents() * slider.weights);
  EXPECT_LT((loaded.sample(std::vector<double>{1}).points.col(0) - end).norm(), 1e-9);
}

}  // namespace
}  // namespace dlo::energy_model
