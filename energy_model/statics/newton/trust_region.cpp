#include "newton/trust_region.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "linear/reduced_hessian.hpp"
#include "linear/trust_region_step.hpp"
#include "newton/restore.hpp"

namespace dlo::energy_model {
namespace {

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
    if (!restore(solution_, here, loosest_gap, scratch_)) {
      solution_.multipliers = multipliers_;
      return solution_.fail("no shape at the positions of the grips was found from this start");
    }
    double radius = options_.radius;
    for (int i = 0; i < options_.max_iterations; ++i) {
      if (options_.deadline != nullptr && options_.deadline->passed()) {
        keep(here);
        return solution_.finish(SolveStatus::time_limit);
      }
      linearise(here);
      const std::optional<Eigen::VectorXd> step = best_step(radius);
      if (!step) {
        keep(here);
        return solution_.finish(SolveStatus::converged);
      }
      radius = try_step(here, *step, radius);
      if (radius < smallest_radius) break;
    }
    keep(here);
    // Newton's method may still converge from here.
    solution_.finish(SolveStatus::roundoff_limited);
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
                           .gradient_tolerance = options_.gradient_tolerance * (1 + options_.load),
                           .least_step = options_.nearest});
    if (!p) return std::nullopt;
    predicted_ = -(projected_gradient_.dot(*p) + p->dot(reduced_.matrix() * *p) / 2);
    length_ = p->norm();
    return reduced_.in_unknowns(*p);
  }

  /// Evaluates a step and accepts or rejects it. @return the next radius
  [[nodiscard]] double try_step(SpanPoint& here, const Eigen::VectorXd& step, double radius) {
    solution_.evaluate(here.x + step, trial_);
    const double gap = std::min(loosest_gap, std::max(1e-13, 1e-2 * length_ * length_));
    if (!restore(solution_, trial_, gap, scratch_)) return std::min(radius, length_) / 4;
    const double before = here.energy - multipliers_.dot(here.residual);
    const double after = trial_.energy - multipliers_.dot(trial_.residual);
    const double rounding = 1e-14 * (1 + std::abs(before) + multipliers_.norm());
    const double ratio = (before - after + rounding) / (predicted_ + rounding);
    if (!(ratio > 0.1)) return std::min(radius, length_) / 4;
    std::swap(here, trial_);
    if (ratio > 0.75 && length_ > 0.9 * radius) return std::min(largest_radius, 2 * radius);
    return ratio < 0.25 ? radius / 2 : radius;
  }

  void keep(const SpanPoint& here) {
    solution_.x = here.x;
    solution_.energy = here.energy;
    solution_.multipliers = multipliers_;
    solution_.residual = projected_gradient_.norm();
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

}  // namespace

void descend_in_trust_region(SpanSolution& solution, const TrustRegionOptions& options) {
  TrustRegionDescent(solution, options).run();
}

}  // namespace dlo::energy_model
