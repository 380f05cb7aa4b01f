#include "newton/region_step.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "linear/free_directions.hpp"

namespace dlo::energy_model {
namespace {

/// Solution of min g.p + p.diag(d) p / 2 in |p| <= radius for the eigenvalues d, growing.
Eigen::VectorXd step_by_eigenvalues(const Eigen::VectorXd& d, const Eigen::VectorXd& g,
                                    double radius) {
  const auto step = [&](double shift) {
    return Eigen::VectorXd(-g.array() / (d.array() + shift).max(1e-300));
  };
  const double scale = std::max(1.0, d.cwiseAbs().maxCoeff());
  if (d[0] > 1e-12 * scale) {
    Eigen::VectorXd newton = step(0);
    if (newton.norm() <= radius) return newton;
  }
  // |p(shift)| falls from beyond the radius to zero as the shift grows above -d_0.
  double low = std::max(0.0, -d[0]);
  const double least = low + 1e-12 * scale;
  if (step(least).norm() < radius) {
    // Hard case: no pull along the lowest curvature; it is followed to the edge.
    Eigen::VectorXd p = step(least);
    const double rest = std::sqrt(std::max(0.0, radius * radius - p.squaredNorm()));
    if (d[0] < -neutral) p[0] += p[0] < 0 ? -rest : rest;
    return p;
  }
  double high = low + g.norm() / radius + 1e-12 * scale;
  for (int i = 0; i < 60 && high - low > 1e-3 * high; ++i) {
    const double middle = (low + high) / 2;
    (step(middle).norm() > radius ? low : high) = middle;
  }
  return step(high);
}

}  // namespace

std::optional<Eigen::VectorXd> region_step(FreeHessian& hessian, const Eigen::VectorXd& gradient,
                                           double radius, bool flat, double nearest) {
  if (gradient.size() == 0) return std::nullopt;
  Eigen::VectorXd p = -gradient;
  if (hessian.is_definite()) {
    if (flat) return std::nullopt;
    hessian.solve_free(p);
    if (p.norm() <= nearest) return std::nullopt;
    if (p.norm() <= radius) return p;
    p = -gradient;
  }
  if (!flat && hessian.solve_within(radius, p)) return p;
  // What lies between flat and falling takes its eigenvalues.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian.matrix());
  if (flat && eigen.eigenvalues()[0] > -neutral) return std::nullopt;
  return eigen.eigenvectors() * step_by_eigenvalues(eigen.eigenvalues(),
                                                    eigen.eigenvectors().transpose() * gradient,
                                                    radius);
}

}  // namespace dlo::energy_model
