#include "linear/trust_region_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linear/free_directions.hpp"

namespace dlo::energy_model {
namespace {

/// Largest and smallest accepted step length, divided by the radius.
constexpr double longest_accepted = 1.01;
constexpr double shortest_accepted = 0.75;
/// Distance of the bounds of mu, divided by the upper one, below which they count as equal.
constexpr double closed_bounds = 1e-2;

/// Bounds of mu. Up to `low`, H + mu is not positive definite or p is too long; from `high` on, p
/// is too short.
struct ShiftBounds {
  double low = 0;
  double high = std::numeric_limits<double>::infinity();
  double rounding = 0;  // magnitude up to which an eigenvalue may be rounding

  [[nodiscard]] double between(double mu) const {
    if (std::isinf(high)) return std::max(4 * mu, rounding);
    return low > 0.1 * high ? (low + high) / 2 : std::sqrt(std::max(low, 1e-4 * high) * high);
  }
  [[nodiscard]] bool are_closed() const {
    return high - low <= closed_bounds * high || high <= rounding;
  }
};

/// Extends p to a length along the eigenvector of the smallest eigenvalue of the factored matrix,
/// which is found by inverse iteration.
void extend_along_smallest(const ReducedHessian& hessian, double length, Eigen::VectorXd& p) {
  Eigen::VectorXd along = Eigen::VectorXd::LinSpaced(p.size(), 1, 2);
  for (int i = 0; i < 3; ++i) {
    along.normalize();
    hessian.solve_shifted(along);
  }
  along.normalize();
  const double part = p.dot(along);
  const double rest = std::sqrt(part * part + length * length - p.squaredNorm());
  p += (part < 0 ? -part - rest : rest - part) * along;
}

/// Computes the step if Newton's step is longer than the radius or H is not positive definite:
/// Newton's method on 1 / |p(mu)|, which is nearly linear in mu.
/// @param low  lower bound of mu
Eigen::VectorXd step_to_edge(ReducedHessian& hessian, const Eigen::VectorXd& gradient,
                             double radius, double low) {
  constexpr int most_steps = 60;
  const Eigen::VectorXd diagonal = hessian.diagonal();
  ShiftBounds bounds;
  bounds.rounding = std::numeric_limits<double>::epsilon() * diagonal.cwiseAbs().maxCoeff();
  double mu = 0;
  if (!hessian.is_definite()) {
    bounds.low = std::max(low, -diagonal.minCoeff());
    mu = 1.1 * bounds.low + gradient.norm() / radius;
  }
  // Steepest descent: returned if rounding spoils every other step.
  Eigen::VectorXd shorter = -radius * gradient.normalized();
  Eigen::VectorXd along;
  for (int step = 0; step < most_steps; ++step) {
    Eigen::VectorXd p = -gradient;
    const bool definite = hessian.factor_shifted(mu);
    if (definite) hessian.solve_shifted(p);
    const double size = definite ? p.norm() : std::numeric_limits<double>::infinity();
    if (!std::isfinite(size)) {
      bounds.low = mu;
      mu = bounds.between(mu);
      continue;
    }
    if (size <= longest_accepted * radius && (size >= shortest_accepted * radius || mu == 0)) {
      return p;
    }
    (size > radius ? bounds.low : bounds.high) = mu;
    if (size < radius) {
      shorter = p;
      if (bounds.are_closed()) {
        extend_along_smallest(hessian, radius, p);
        return p;
      }
    }
    along = p;
    hessian.solve_shifted(along);
    const double next = mu + size * size / p.dot(along) * (size - radius) / radius;
    mu = next > bounds.low && next < bounds.high ? std::max(next, bounds.rounding)
                                                 : bounds.between(mu);
  }
  return shorter;
}

}  // namespace

std::optional<Eigen::VectorXd> trust_region_step(ReducedHessian& hessian,
                                                 const Eigen::VectorXd& gradient,
                                                 const TrustRegion& region) {
  if (gradient.size() == 0) return std::nullopt;
  const bool flat = gradient.norm() <= region.gradient_tolerance;
  if (hessian.is_definite()) {
    if (flat) return std::nullopt;
    Eigen::VectorXd newton = -gradient;
    hessian.solve_free(newton);
    const double size = newton.norm();
    if (size <= region.least_step) return std::nullopt;
    if (size <= region.radius) return newton;
  } else if (flat && hessian.factor_shifted(neutral)) {
    return std::nullopt;
  }
  return step_to_edge(hessian, gradient, region.radius, flat ? neutral : 0);
}

}  // namespace dlo::energy_model
