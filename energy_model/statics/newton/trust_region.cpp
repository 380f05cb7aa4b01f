#include "newton/trust_region.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "linear/dense_products.hpp"
#include "linear/reduced_hessian.hpp"

namespace dlo::energy_model {
namespace {

/// Largest and smallest accepted step length, divided by the radius.
constexpr double longest_accepted = 1.01;
constexpr double shortest_accepted = 0.75;
/// Distance of the bounds of mu, divided by the upper one, below which they count as equal.
constexpr double bound_tolerance = 1e-2;

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
    return high - low <= bound_tolerance * high || high <= rounding;
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
Eigen::VectorXd boundary_step(ReducedHessian& hessian, const Eigen::VectorXd& gradient,
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

/// Maximum number of steps of one minimisation, accepted or not.
constexpr int most_iterations = 100;
/// Radius below which a step changes the shape by less than rounding.
constexpr double smallest_radius = 1e-10;

class TrustRegionDescent {
 public:
  TrustRegionDescent(SpanSolution& solution, const TrustRegionOptions& options)
      : solution_(solution),
        model_(*solution.model),
        options_(options),
        // The solution needs one multiplier per constraint even if the first step fails.
        multipliers_(Eigen::VectorXd::Zero(model_.constraints())) {}

  void run() {
    SpanPoint here;
    solution_.evaluate(solution_.x, here);
    if (!restore_constraints(solution_, here, largest_constraint_residual, scratch_)) {
      solution_.multipliers = multipliers_;
      return solution_.fail("no shape at the positions of the grips was found from this start");
    }
    // Newton's method may still converge from where the steps or the radius have ended.
    SolveStatus status = SolveStatus::roundoff_limited;
    double radius = options_.radius;
    for (int i = 0; i < most_iterations && !(radius < smallest_radius); ++i) {
      if (options_.deadline.passed()) {
        status = SolveStatus::time_limit;
        break;
      }
      linearise(here);
      const std::optional<Eigen::VectorXd> step = best_step(radius);
      if (!step) {
        status = SolveStatus::converged;
        break;
      }
      radius = try_step(here, *step, radius);
    }
    solution_.x = here.x;
    solution_.energy = here.energy;
    solution_.multipliers = multipliers_;
    solution_.residual = projected_gradient_.norm();
    solution_.finish(status);
  }

 private:
  /// Computes multipliers, free directions, projected gradient and Hessian at a point.
  void linearise(SpanPoint& here) {
    reduced_.constrain(here.jacobian);
    if (reduced_.is_independent()) {
      ReducedHessian::Balance balance = reduced_.balance(here.gradient);
      multipliers_ = std::move(balance.multipliers);
      projected_gradient_ = std::move(balance.left);
    } else {
      balance_independent(here);
    }
    model_.hessian(here, multipliers_, hessian_);
    reduced_.compute(hessian_);
  }

  /// Balances the gradient with an independent subset of the constraints, which depend on each
  /// other for example for a straight rod.
  void balance_independent(const SpanPoint& here) {
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(here.jacobian.transpose());
    qr.setThreshold(1e-10);
    const Eigen::VectorXi rows = qr.colsPermutation().indices().head(qr.rank());
    reduced_.constrain(here.jacobian(rows, Eigen::all));
    ReducedHessian::Balance balance = reduced_.balance(here.gradient);
    multipliers_.setZero(here.residual.size());
    multipliers_(rows) = balance.multipliers;
    projected_gradient_ = std::move(balance.left);
  }

  /// Returns the step in the unknowns; std::nullopt if the point is already near a minimum.
  [[nodiscard]] std::optional<Eigen::VectorXd> best_step(double radius) {
    const std::optional<Eigen::VectorXd> p =
        trust_region_step(reduced_, projected_gradient_,
                          {.radius = radius,
                           .gradient_tolerance = handover_gradient * (1 + model_.load()),
                           .least_step = options_.nearest});
    if (!p) return std::nullopt;
    predicted_ = -(projected_gradient_.dot(*p) + p->dot(reduced_.matrix() * *p) / 2);
    length_ = p->norm();
    return reduced_.to_unknowns(*p);
  }

  /// Evaluates a step and accepts or rejects it. @return the next radius
  [[nodiscard]] double try_step(SpanPoint& here, const Eigen::VectorXd& step, double radius) {
    solution_.evaluate(here.x + step, trial_);
    const double gap =
        std::min(largest_constraint_residual, std::max(1e-13, 1e-2 * length_ * length_));
    if (!restore_constraints(solution_, trial_, gap, scratch_))
      return std::min(radius, length_) / 4;
    const double before = here.energy - multipliers_.dot(here.residual);
    const double after = trial_.energy - multipliers_.dot(trial_.residual);
    const double rounding = 1e-14 * (1 + std::abs(before) + multipliers_.norm());
    const double ratio = (before - after + rounding) / (predicted_ + rounding);
    if (!(ratio > 0.1)) return std::min(radius, length_) / 4;
    std::swap(here, trial_);
    if (ratio > 0.75 && length_ > 0.9 * radius) return std::min(largest_radius, 2 * radius);
    return ratio < 0.25 ? radius / 2 : radius;
  }

  SpanSolution& solution_;
  const SpanEnergy& model_;
  const TrustRegionOptions& options_;
  SpanPoint trial_;
  RestoreScratch scratch_;
  ReducedHessian reduced_;
  Eigen::VectorXd multipliers_, projected_gradient_;
  Eigen::MatrixXd hessian_;
  double predicted_ = 0;  // predicted decrease of E - lambda.c
  double length_ = 0;     // length of the step
};

/// Trust-region radius that ends a minimisation; the multipliers are then updated.
constexpr double least_penalty_radius = 1e-9;
/// Norm of the constraints' residual from which Newton's method takes over [l].
constexpr double newton_handover_residual = 1e-7;
constexpr int most_updates = 40;

class AugmentedLagrangian {
 public:
  AugmentedLagrangian(SpanSolution& solution, const TrustRegionOptions& options)
      : solution_(solution), model_(*solution.model), options_(options) {}

  void run() {
    const Eigen::Index m = model_.constraints();
    mu_ = solution_.multipliers;
    if (mu_.size() != m) mu_.setZero(m);
    kappa_ = std::max(100 * (1 + model_.load()), 10 * options_.stiffness);
    evaluate();
    double last_residual = here_.residual.norm();
    for (int update = 0; update < most_updates; ++update) {
      if (!minimise(std::min(1e-2, last_residual))) break;
      mu_ = forces();
      const double residual = here_.residual.norm();
      if (residual <= newton_handover_residual) return finish(SolveStatus::converged);
      if (residual > last_residual / 4)
        kappa_ = std::min(1e7 * (1 + model_.load() + options_.stiffness / 1e3), 10 * kappa_);
      last_residual = residual;
    }
    if (options_.deadline.passed()) return finish(SolveStatus::time_limit);
    finish(SolveStatus::failed);
    solution_.fail("no shape at the positions of the grips was found from this start");
  }

 private:
  [[nodiscard]] Eigen::VectorXd forces() const { return mu_ - kappa_ * here_.residual; }

  void evaluate() {
    solution_.evaluate(solution_.x, here_);
    solution_.energy = here_.energy;
    const Eigen::VectorXd& c = here_.residual;
    value_ = here_.energy - mu_.dot(c) + kappa_ / 2 * c.squaredNorm();
  }

  /// Minimises the penalised energy for the present mu and kappa until its gradient is below
  /// `precision` * 1e-3 of the forces, or the radius reaches its limit. @return whether either was
  /// reached
  [[nodiscard]] bool minimise(double precision) {
    evaluate();
    double radius = std::min(first_radius, radius_);
    for (int i = 0; i < most_iterations; ++i) {
      if (options_.deadline.passed()) return false;
      const Eigen::VectorXd nu = forces();
      slope_ = here_.gradient - here_.jacobian.transpose() * nu;
      model_.hessian(here_, nu, hessian_);
      hessian_.noalias() += kappa_ * here_.jacobian.transpose() * here_.jacobian;
      reduced_.compute(hessian_, Eigen::MatrixXd(0, hessian_.cols()));
      const std::optional<Eigen::VectorXd> step = trust_region_step(
          reduced_, slope_,
          {.radius = radius,
           .gradient_tolerance = precision * 1e-3 * (1 + model_.load() + nu.norm())});
      if (!step) return true;
      const double predicted = -(slope_.dot(*step) + step->dot(hessian_ * *step) / 2);
      const double before = value_;
      solution_.x += *step;
      std::swap(here_, before_);
      evaluate();
      const double rounding = 1e-13 * (1 + std::abs(before));
      const double ratio = (before - value_ + rounding) / (predicted + rounding);
      const double length = step->norm();
      if (!(ratio > 0.1)) {
        std::swap(here_, before_);
        solution_.x = here_.x;
        solution_.energy = here_.energy;
        value_ = before;
        radius = std::min(radius, length) / 4;
        if (radius < least_penalty_radius) return true;
      } else if (ratio > 0.75 && length > 0.9 * radius) {
        radius = std::min(largest_radius, 2 * radius);
      }
      radius_ = radius;
    }
    return false;
  }

  void finish(SolveStatus status) {
    solution_.multipliers = mu_;
    solution_.residual = slope_.norm();
    solution_.finish(status);
  }

  SpanSolution& solution_;
  const SpanEnergy& model_;
  const TrustRegionOptions& options_;
  double kappa_ = 0;
  double value_ = 0;
  double radius_ = first_radius;
  SpanPoint here_, before_;
  Eigen::VectorXd mu_, slope_;
  Eigen::MatrixXd hessian_;
  ReducedHessian reduced_;
};

}  // namespace

bool restore_constraints(SpanSolution& solution, SpanPoint& point, double gap,
                         RestoreScratch& scratch, double most_energy) {
  if (solution.model->constraints() == 0) return std::isfinite(point.energy);
  constexpr int most_steps = 60;
  constexpr double longest_step = 1;  // largest length of a step
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
      if (!(scratch.step.norm() <= longest_step)) continue;
      solution.evaluate(point.x - scratch.step, trial);
      shorter = trial.residual.norm() < 0.99 * size;
    }
    if (!shorter) return false;
    std::swap(point, trial);
    mu = std::max(1e-15, mu * 1e-3);
  }
  return point.residual.norm() <= gap;
}

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
  } else if (flat && hessian.factor_shifted(zero_eigenvalue_limit)) {
    return std::nullopt;
  }
  return boundary_step(hessian, gradient, region.radius, flat ? zero_eigenvalue_limit : 0);
}

void descend_in_trust_region(SpanSolution& solution, const TrustRegionOptions& options) {
  TrustRegionDescent(solution, options).run();
}

void descend_by_augmented_lagrangian(SpanSolution& solution, const TrustRegionOptions& options) {
  AugmentedLagrangian(solution, options).run();
}

}  // namespace dlo::energy_model
