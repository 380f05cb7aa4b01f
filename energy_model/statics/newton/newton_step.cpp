#include "newton/newton_step.hpp"

#include <cmath>

#include "linear/reduced_hessian.hpp"
#include "newton/newton.hpp"

namespace dlo::energy_model {
namespace {

/// Maximum number of near-null modes that are deflated.
constexpr Eigen::Index most_near_null = 3;

/// Maximum number of updates; later steps are those of the factor.
constexpr Eigen::Index most_secants = 12;

/// Component of the next step along the last one, divided by the last one's length, above which the
/// update would lengthen the step too much. No more updates are made until the next factorisation.
constexpr double largest_share = 0.5;

}  // namespace

void NewtonBuffers::factor_at(SpanSolution& solution, SpanPoint& at) {
  solution.factor.reset();
  solution.model->hessian(at, solution.multipliers, hessian);
  // Buffers of the same size are reused.
  solution.factor = factors.take([&](const NewtonFactor& kept) {
    return kept.system.has_size(hessian.rows(), at.jacobian.rows());
  });
  solution.factor->system.compute(hessian, at.jacobian);
  solution.factor->scale = solution.scale_of_forces();
  solution.factor->x = solution.x;
  solution.factor->multipliers = solution.multipliers;
}

void NewtonStep::use_given_factor() {
  if (!options_.first_factor || !options_.first_factor->system.has_size(
                                    buffers_.gradient.size(), solution_.model->constraints())) {
    return;
  }
  factor_ = options_.first_factor;
  factor_point_ = FactorPoint::neighbour;
}

void NewtonStep::factor() {
  factor_.reset();
  buffers_.factor_at(solution_, *buffers_.here);
  factor_ = solution_.factor;
  factor_point_ = FactorPoint::this_point;
  buffers_.broyden.clear();
  if (options_.method == NewtonMethod::corrector && !is_minimum()) find_near_null_modes();
}

/// Finds orthonormal vectors that the system maps to less than `zero_eigenvalue_limit` of their
/// length, by inverse iteration; the step along them is undetermined. Multipliers are divided by
/// the scale of forces, as otherwise a constraint that grips hardly satisfy would count as such a
/// vector.
void NewtonStep::find_near_null_modes() {
  const Eigen::Index m = solution_.model->constraints();
  const Eigen::Index size = buffers_.gradient.size() + m;
  Eigen::MatrixXd& modes = buffers_.near_null_modes;
  modes.resize(size, 0);
  const Eigen::VectorXd seed = Eigen::VectorXd::LinSpaced(size, 1, 2).normalized();
  Eigen::VectorXd right;
  for (Eigen::Index found = 0; found < most_near_null; ++found) {
    Eigen::VectorXd v = seed;
    double shrinks = 1;
    for (int i = 0; i < 2; ++i) {
      v.tail(m) /= factor_->scale;
      right = v;
      factor_->system.solve(right, v);
      v.tail(m) /= factor_->scale;
      v -= modes * (modes.transpose() * v);
      shrinks = 1 / v.norm();
      v *= shrinks;
    }
    if (!(shrinks < zero_eigenvalue_limit)) return;
    modes.conservativeResize(Eigen::NoChange, found + 1);
    modes.col(found) = v;
  }
}

void NewtonStep::deflate() {
  auto multipliers = buffers_.step.tail(solution_.model->constraints());
  multipliers /= factor_->scale;
  const Eigen::MatrixXd& modes = buffers_.near_null_modes;
  buffers_.step -= modes * (modes.transpose() * buffers_.step);
  multipliers *= factor_->scale;
}

void NewtonStep::solve() {
  if (is_minimum()) {
    buffers_.step = -buffers_.gradient;
    factor_->system.reduced_hessian().solve_free(buffers_.step);
    return;
  }
  Eigen::VectorXd& right = buffers_.right;
  right.resize(buffers_.gradient.size() + solution_.model->constraints());
  right << -buffers_.gradient, -buffers_.here->residual;
  factor_->system.solve(right, buffers_.step);
  if (options_.method == NewtonMethod::corrector) deflate();
  // With a near-null mode the system is nearly singular; the minimum-norm step has no component
  // along that mode.
  if (options_.method == NewtonMethod::simplified ||
      factor_->system.is_solved_by(right, buffers_.step)) {
    return;
  }
  buffers_.step = factor_->system.minimum_norm_step(right);
}

void NewtonStep::solve_by_least_squares() {
  buffers_.right << -buffers_.gradient, -buffers_.here->residual;
  buffers_.step = factor_->system.minimum_norm_step(buffers_.right);
}

/// Applies Broyden's update with multipliers divided by the scale of forces.
void NewtonStep::update() {
  auto first_multipliers = buffers_.first_step.tail(solution_.model->constraints());
  auto multipliers = buffers_.step.tail(solution_.model->constraints());
  first_multipliers /= factor_->scale;
  multipliers /= factor_->scale;
  buffers_.broyden.update(buffers_.first_step, buffers_.step);
  multipliers *= factor_->scale;
}

double NewtonStep::smallest_eigenvalue() {
  constexpr int iterations = 2;
  const Eigen::Index n = buffers_.gradient.size();
  Eigen::VectorXd& mode = buffers_.lowest_mode;
  mode.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) mode[i] = 1 / static_cast<double>(1 + i);
  double grows = 1;
  for (int i = 0; i < iterations; ++i) {
    mode /= mode.norm();
    factor_->system.reduced_hessian().solve_free(mode);
    grows = mode.norm();
  }
  return 1 / grows;
}

double NewtonStep::norm_with_multipliers() const {
  const Eigen::Index m = solution_.model->constraints();
  if (m == 0) return step_norm();
  return std::hypot(step_norm(), buffers_.step.tail(m).norm() / solution_.scale_of_forces());
}

void BroydenSteps::update(const Eigen::VectorXd& last, Eigen::VectorXd& next) {
  if (count_ >= most_secants) return;
  if (steps_.rows() != last.size()) steps_.resize(last.size(), most_secants);
  steps_.col(count_) = last;
  for (Eigen::Index i = 0; i < count_; ++i) {
    next += steps_.col(i).dot(next) / steps_.col(i).squaredNorm() * steps_.col(i + 1);
  }
  const double share = last.dot(next) / last.squaredNorm();
  if (!(share < largest_share)) {
    count_ = most_secants;
    return;
  }
  next /= 1 - share;
  ++count_;
}

}  // namespace dlo::energy_model
