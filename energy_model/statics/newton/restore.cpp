#include "newton/restore.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linear/dense_products.hpp"

namespace dlo::energy_model {

bool restore(SpanSolution& solution, SpanPoint& point, double gap, RestoreScratch& scratch,
             double most_energy) {
  if (solution.model->constraints() == 0) return std::isfinite(point.energy);
  constexpr int most_steps = 60;
  constexpr double longest = 1;  // largest length of a step
  SpanPoint& trial = scratch.trial;
  Eigen::MatrixXd& square = scratch.square;
  Eigen::MatrixXd& normal = scratch.normal;
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
    if (!shorter) return false;
    std::swap(point, trial);
    mu = std::max(1e-15, mu * 1e-3);
  }
  return point.residual.norm() <= gap;
}

}  // namespace dlo::energy_model
