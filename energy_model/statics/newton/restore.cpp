#include "newton/restore.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linear/dense_products.hpp"

namespace dlo::energy_model {
namespace {

/// Smallest residual at which a bend is added; near the solution it would lead away from it.
constexpr double least_bent_gap = 1e-3;

/// Adds a perturbation without any symmetry, mainly in the lower coefficients of every element.
void bend(SpanSolution& solution, SpanPoint& point, int which) {
  Eigen::VectorXd x = point.x;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const auto order = static_cast<double>(k % solution.model->terms());
    x[k] += 0.3 * std::sin(which + 1.7 * static_cast<double>(k)) / (1 + order * order);
  }
  solution.evaluate(x, point);
}

}  // namespace

bool restore(SpanSolution& solution, SpanPoint& point, double gap, RestoreScratch& scratch,
             double most_energy) {
  if (solution.model->constraints() == 0) return std::isfinite(point.energy);
  constexpr int most_steps = 60;
  constexpr double longest = 1;  // largest length of a step
  constexpr int most_bends = 3;
  SpanPoint& trial = scratch.trial;
  Eigen::MatrixXd& square = scratch.square;
  Eigen::MatrixXd& normal = scratch.normal;
  int bends = 0;
  double mu = 1e-12;
  for (int i = 0; i < most_steps; ++i) {
    const double size = point.residual.norm();
    if (!std::isfinite(size) || point.energy > most_energy) return false;
    if (size <= gap) return true;
    square.resize(point.residual.size(), point.residual.size());
    multiply_symmetric(point.jacobian, point.jacobian, square);
    const double scale = square.diagonal().maxCoeff();
    bool shorter = false;
    for (; mu < 1e3 && !shorter; mu *= 10) {
      normal = square;
      normal.diagonal().array() += mu * scale;
      if (scratch.factor.compute(normal).info() != Eigen::Success) continue;
      scratch.along = point.residual;
      scratch.factor.solveInPlace(scratch.along);
      scratch.step.noalias() = point.jacobian.transpose() * scratch.along;
      if (!(scratch.step.norm() <= longest)) continue;
      solution.evaluate(point.x - scratch.step, trial);
      shorter = trial.residual.norm() < 0.99 * size;
    }
    if (shorter) {
      std::swap(point, trial);
      mu = std::max(1e-15, mu * 1e-3);
      continue;
    }
    if (size < least_bent_gap || bends++ == most_bends) return false;
    bend(solution, point, bends);
    mu = 1e-3;
  }
  return point.residual.norm() <= gap;
}

}  // namespace dlo::energy_model
