#include "newton/trust_region.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "linear/free_directions.hpp"
#include "newton/restore.hpp"

namespace dlo::energy_model {
namespace {

/// A region this small moves the shape by less than rounding does.
constexpr double smallest_radius = 1e-10;
/// Solution of min g.p + p.diag(d) p / 2 in |p| <= radius for the eigenvalues d, growing.
Eigen::VectorXd step_in_region(const Eigen::VectorXd& d, const Eigen::VectorXd& g, double radius) {
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

class TrustRegionDescent {
 public:
  TrustRegionDescent(SpanSolution& solution, const TrustRegionOptions& options)
      : solution_(solution),
        model_(*solution.model),
        options_(options),
        // What is kept before the first step has as many of them, too.
        multipliers_(Eigen::VectorXd::Zero(model_.constraints())) {}

  void run() {
    PointOnSpan here;
    here.x = solution_.x;
    evaluate(solution_, here);
    if (!restore(solution_, here, loosest_gap)) {
      solution_.multipliers = multipliers_;
      return solution_.fail("the grips' positions could not be met from this start");
    }
    double radius = first_radius;
    for (int i = 0; i < options_.max_iterations; ++i) {
      if (options_.deadline != nullptr && options_.deadline->passed()) {
        keep(here);
        return solution_.finish(SolveStatus::time_limit);
      }
      linearise(here);
      const double slope = projected_gradient_.norm();
      const bool flat = slope <= options_.gradient_tolerance * (1 + options_.load);
      const std::optional<Eigen::VectorXd> step = best_step(radius, flat);
      if (!step) {
        keep(here);
        return solution_.finish(SolveStatus::converged);
      }
      radius = try_step(here, *step, radius);
      if (radius < smallest_radius) break;
    }
    keep(here);
    // Newton's method may still find it.
    solution_.finish(SolveStatus::roundoff_limited);
  }

 private:
  /// Multipliers, null space, projected gradient and Hessian at a point.
  void linearise(const PointOnSpan& here) {
    const Eigen::Index n = model_.size();
    const Eigen::Index m = model_.constraints();
    if (m > 0) {
      qr_.compute(here.jacobian.transpose());
      qr_.setThreshold(1e-10);
      multipliers_ = qr_.solve(here.gradient);
      // The model's Hessian is that of its last value().
      Eigen::VectorXd gradient(n);
      (void)model_.value(here.x, gradient);
      model_.hessian(multipliers_, hessian_);
      // Q^T H Q by its reflections, which are as few as the constraints; Q itself is as large as H.
      hessian_.applyOnTheLeft(qr_.householderQ().adjoint());
      hessian_.applyOnTheRight(qr_.householderQ());
      gradient = here.gradient;
      gradient.applyOnTheLeft(qr_.householderQ().adjoint());
      const Eigen::Index free = n - qr_.rank();
      projected_gradient_ = gradient.tail(free);
      projected_hessian_ = hessian_.bottomRightCorner(free, free);
    } else {
      multipliers_.resize(0);
      Eigen::VectorXd gradient(n);
      (void)model_.value(here.x, gradient);
      model_.hessian(multipliers_, projected_hessian_);
      projected_gradient_ = here.gradient;
    }
  }

  /// Step in the unknowns; nothing where the point is near a minimum already.
  [[nodiscard]] std::optional<Eigen::VectorXd> best_step(double radius, bool flat) {
    predicted_ = 0;
    if (projected_gradient_.size() == 0) return std::nullopt;
    llt_.compute(projected_hessian_);
    Eigen::VectorXd p;
    if (llt_.info() == Eigen::Success) {
      if (flat) return std::nullopt;
      p = -llt_.solve(projected_gradient_);
    }
    if (p.size() == 0 || !(p.norm() <= radius)) {
      eigen_.compute(projected_hessian_);
      if (flat && eigen_.eigenvalues()[0] > -neutral) return std::nullopt;
      p = eigen_.eigenvectors() *
          step_in_region(eigen_.eigenvalues(),
                         eigen_.eigenvectors().transpose() * projected_gradient_, radius);
    }
    predicted_ = -(projected_gradient_.dot(p) + p.dot(projected_hessian_ * p) / 2);
    length_ = p.norm();
    return in_unknowns(p);
  }

  /// A step in the null space of the constraints, in the unknowns.
  [[nodiscard]] Eigen::VectorXd in_unknowns(const Eigen::VectorXd& p) const {
    if (model_.constraints() == 0) return p;
    Eigen::VectorXd step = Eigen::VectorXd::Zero(model_.size());
    step.tail(p.size()) = p;
    step.applyOnTheLeft(qr_.householderQ());
    return step;
  }

  /// @return the next radius
  [[nodiscard]] double try_step(PointOnSpan& here, const Eigen::VectorXd& step, double radius) {
    PointOnSpan trial;
    trial.x = here.x + step;
    evaluate(solution_, trial);
    const double gap = std::min(loosest_gap, std::max(1e-13, 1e-2 * length_ * length_));
    if (!restore(solution_, trial, gap)) return std::min(radius, length_) / 4;
    const double before = here.energy - multipliers_.dot(here.residual);
    const double after = trial.energy - multipliers_.dot(trial.residual);
    const double rounding = 1e-14 * (1 + std::abs(before) + multipliers_.norm());
    const double ratio = (before - after + rounding) / (predicted_ + rounding);
    if (!(ratio > 0.1)) return std::min(radius, length_) / 4;
    here = std::move(trial);
    if (ratio > 0.75 && length_ > 0.9 * radius) return std::min(largest_radius, 2 * radius);
    return ratio < 0.25 ? radius / 2 : radius;
  }

  void keep(const PointOnSpan& here) {
    solution_.x = here.x;
    solution_.energy = here.energy;
    solution_.multipliers = multipliers_;
    solution_.residual = projected_gradient_.norm();
  }

  SpanSolution& solution_;
  SpanEnergy& model_;
  const TrustRegionOptions& options_;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr_;
  Eigen::LLT<Eigen::MatrixXd> llt_;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen_;
  Eigen::VectorXd multipliers_, projected_gradient_;
  Eigen::MatrixXd hessian_, projected_hessian_;
  double predicted_ = 0;  // fall of E - lambda.c
  double length_ = 0;     // of the step
};

}  // namespace

void descend_in_trust_region(SpanSolution& solution, const TrustRegionOptions& options) {
  TrustRegionDescent(solution, options).run();
}

}  // namespace dlo::energy_model
