#include "newton/augmented_lagrangian.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linear/reduced_hessian.hpp"
#include "linear/trust_region_step.hpp"

namespace dlo::energy_model {
namespace {

/// Trust-region radius that ends a minimisation; the multipliers are then updated.
constexpr double least_penalty_radius = 1e-9;
/// Norm of the constraints' residual from which Newton's method takes over [l].
constexpr double close_enough = 1e-7;
constexpr int most_updates = 40;

class AugmentedLagrangian {
 public:
  AugmentedLagrangian(SpanSolution& solution, const TrustRegionOptions& options)
      : solution_(solution), model_(*solution.model), options_(options) {}

  void run() {
    const Eigen::Index m = model_.constraints();
    mu_ = solution_.multipliers;
    if (mu_.size() != m) mu_.setZero(m);
    kappa_ = std::max(100 * (1 + options_.load), 10 * options_.stiffness);
    evaluate();
    double last_residual = here_.residual.norm();
    for (int update = 0; update < most_updates; ++update) {
      if (!minimise(std::min(1e-2, last_residual))) break;
      mu_ = forces();
      const double residual = here_.residual.norm();
      if (residual <= close_enough) return finish(SolveStatus::converged);
      if (residual > last_residual / 4) kappa_ = std::min(largest_kappa(), 10 * kappa_);
      last_residual = residual;
    }
    if (out_of_time()) return finish(SolveStatus::time_limit);
    finish(SolveStatus::failed);
    solution_.fail("no shape at the positions of the grips was found from this start");
  }

 private:
  [[nodiscard]] double largest_kappa() const {
    return 1e7 * (1 + options_.load + options_.stiffness / 1e3);
  }
  [[nodiscard]] bool out_of_time() const {
    return options_.deadline != nullptr && options_.deadline->passed();
  }
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
    for (int i = 0; i < options_.max_iterations; ++i) {
      if (out_of_time()) return false;
      const Eigen::VectorXd nu = forces();
      slope_ = here_.gradient - here_.jacobian.transpose() * nu;
      model_.hessian(here_, nu, hessian_);
      hessian_.noalias() += kappa_ * here_.jacobian.transpose() * here_.jacobian;
      reduced_.compute(hessian_, Eigen::MatrixXd(0, hessian_.cols()));
      const std::optional<Eigen::VectorXd> step = trust_region_step(
          reduced_, slope_,
          {.radius = radius,
           .gradient_tolerance = precision * 1e-3 * (1 + options_.load + nu.norm())});
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

void descend_by_augmented_lagrangian(SpanSolution& solution, const TrustRegionOptions& options) {
  AugmentedLagrangian(solution, options).run();
}

}  // namespace dlo::energy_model
