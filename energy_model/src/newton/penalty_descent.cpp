#include "newton/penalty_descent.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "linear/free_directions.hpp"

namespace dlo::energy_model {
namespace {

/// A region this small ends a minimum: the multipliers may move on.
constexpr double least_penalty_radius = 1e-9;
/// Miss of the constraints from which Newton's method takes over [l].
constexpr double close_enough = 1e-7;
constexpr int most_updates = 40;

class PenaltyDescent {
 public:
  PenaltyDescent(SpanSolution& solution, const TrustRegionOptions& options)
      : solution_(solution), model_(*solution.model), options_(options) {}

  void run() {
    const Eigen::Index n = model_.size();
    const Eigen::Index m = model_.constraints();
    mu_ = solution_.multipliers;
    if (mu_.size() != m) mu_.setZero(m);
    gradient_.resize(n);
    residual_.resize(m);
    jacobian_.resize(m, n);
    kappa_ = std::max(100 * (1 + options_.load), 10 * options_.stiffness);
    evaluate();
    double missed = residual_.norm();
    for (int update = 0; update < most_updates; ++update) {
      if (!minimise(std::min(1e-2, missed))) break;
      mu_ = forces();
      const double miss = residual_.norm();
      if (miss <= close_enough) return finish(SolveStatus::converged);
      if (miss > missed / 4) kappa_ = std::min(largest_kappa(), 10 * kappa_);
      missed = miss;
    }
    if (out_of_time()) return finish(SolveStatus::time_limit);
    finish(SolveStatus::failed);
    solution_.fail("the grips' positions could not be met from this start");
  }

 private:
  [[nodiscard]] double largest_kappa() const {
    return 1e7 * (1 + options_.load + options_.stiffness / 1e3);
  }
  [[nodiscard]] bool out_of_time() const {
    return options_.deadline != nullptr && options_.deadline->passed();
  }
  [[nodiscard]] Eigen::VectorXd forces() const { return mu_ - kappa_ * residual_; }

  void evaluate() {
    solution_.energy = model_.value(solution_.x, gradient_);
    model_.constraint(residual_, jacobian_);
    ++solution_.evaluations;
    value_ = solution_.energy - mu_.dot(residual_) + kappa_ / 2 * residual_.squaredNorm();
  }

  /// Minimum of the penalised energy for the present mu and kappa, so well that its gradient is
  /// `precision` of its forces. @return whether it was reached
  [[nodiscard]] bool minimise(double precision) {
    evaluate();
    double radius = std::min(first_radius, radius_);
    for (int i = 0; i < options_.max_iterations; ++i) {
      if (out_of_time()) return false;
      const Eigen::VectorXd nu = forces();
      slope_ = gradient_ - jacobian_.transpose() * nu;
      const bool flat = slope_.norm() <= precision * 1e-3 * (1 + options_.load + nu.norm());
      model_.hessian(nu, hessian_);
      hessian_.noalias() += kappa_ * jacobian_.transpose() * jacobian_;
      if (!step(radius, flat)) return true;
      const double predicted = -(slope_.dot(step_) + step_.dot(hessian_ * step_) / 2);
      const Eigen::VectorXd before_x = solution_.x;
      const double before = value_;
      solution_.x += step_;
      evaluate();
      const double rounding = 1e-13 * (1 + std::abs(before));
      const double ratio = (before - value_ + rounding) / (predicted + rounding);
      const double length = step_.norm();
      if (!(ratio > 0.1)) {
        solution_.x = before_x;
        evaluate();
        radius = std::min(radius, length) / 4;
        if (radius < least_penalty_radius) return true;
      } else if (ratio > 0.75 && length > 0.9 * radius) {
        radius = std::min(largest_radius, 2 * radius);
      }
      radius_ = radius;
    }
    return false;
  }

  /// Into step_: the minimum of the quadratic model in the region. @return whether there is a way
  /// down
  [[nodiscard]] bool step(double radius, bool flat) {
    const double size = hessian_.diagonal().cwiseAbs().maxCoeff();
    double shift = 0;
    double low = 0;
    double high = -1;
    for (int i = 0; i < 40; ++i) {
      shifted_ = hessian_;
      shifted_.diagonal().array() += shift;
      llt_.compute(shifted_);
      if (llt_.info() != Eigen::Success) {
        low = shift;
        shift = high < 0 ? std::max(1e-3, 4 * shift) : (low + high) / 2;
        if (shift > 1e3 * size) return false;
        continue;
      }
      step_ = -slope_;
      llt_.solveInPlace(step_);
      const double length = step_.norm();
      if (shift == 0 && length <= radius) return !flat;
      // A flat point that is no minimum is left in any direction that falls.
      if (length <= 1.1 * radius &&
          (length >= 0.5 * radius || i > 12 || shift - low < 1e-3 * shift)) {
        if (length < 0.5 * radius) add_falling(shift, radius);
        return true;
      }
      // Newton's step on 1/|p| (Moré and Sorensen).
      Eigen::VectorXd half = step_;
      llt_.matrixL().solveInPlace(half);
      const double grow = std::pow(length / half.norm(), 2) * (length - radius) / radius;
      if (length > radius) {
        low = std::max(low, shift);
      } else {
        high = shift;
      }
      shift += grow;
      if (!(shift > low)) shift = high < 0 ? std::max(1e-3, 2 * low) : (low + high) / 2;
      if (high > 0 && shift > high) shift = (low + high) / 2;
    }
    if (step_.norm() > radius) step_ *= radius / step_.norm();
    return true;
  }

  /// To the region's edge along the direction of lowest curvature, by inverse iteration.
  void add_falling(double shift, double radius) {
    if (!(shift > 0)) return;
    Eigen::VectorXd v = Eigen::VectorXd::LinSpaced(step_.size(), 1, 2);
    for (int i = 0; i < 4; ++i) {
      llt_.solveInPlace(v);
      v.normalize();
    }
    if (!(v.dot(hessian_ * v) < -neutral)) return;
    if (v.dot(slope_) > 0) v = -v;
    const double along = step_.dot(v);
    step_ += (std::sqrt(along * along + radius * radius - step_.squaredNorm()) - along) * v;
  }

  void finish(SolveStatus status) {
    solution_.multipliers = mu_;
    solution_.residual = slope_.norm();
    solution_.finish(status);
  }

  SpanSolution& solution_;
  SpanEnergy& model_;
  const TrustRegionOptions& options_;
  double kappa_ = 0;
  double value_ = 0;
  double radius_ = first_radius;
  Eigen::VectorXd mu_, gradient_, residual_, slope_, step_;
  Eigen::MatrixXd jacobian_, hessian_, shifted_;
  Eigen::LLT<Eigen::MatrixXd> llt_;
};

}  // namespace

void descend_by_penalty(SpanSolution& solution, const TrustRegionOptions& options) {
  PenaltyDescent(solution, options).run();
}

}  // namespace dlo::energy_model
