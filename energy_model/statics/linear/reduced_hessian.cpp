#include "linear/reduced_hessian.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "linear/dense_products.hpp"

namespace dlo::energy_model {
namespace {

/// Smallest element of R's diagonal, divided by the largest one, with which constraints are
/// independent.
constexpr double independence_tolerance = 1e-10;

/// Returns the largest eigenvalue of a symmetric positive definite tridiagonal matrix, to a
/// relative 1e-9. Laguerre's method approaches it from above: for a polynomial with real roots it
/// converges to the largest one without passing it. The polynomial is the product of the pivots of
/// x - T.
/// @param off_diagonal  elements next to the diagonal
double largest_eigenvalue(const Eigen::Ref<const Eigen::VectorXd>& diagonal,
                          const Eigen::Ref<const Eigen::VectorXd>& off_diagonal) {
  const Eigen::Index n = diagonal.size();
  double x = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double before = i > 0 ? std::abs(off_diagonal[i - 1]) : 0;
    const double after = i + 1 < n ? std::abs(off_diagonal[i]) : 0;
    x = std::max(x, diagonal[i] + before + after);
  }
  if (n < 2) return x;
  constexpr int most_steps = 40;
  for (int step = 0; step < most_steps; ++step) {
    // Derivatives of log p: the sum of 1 / (x - root), and the sum of the squares of 1 / (x -
    // root).
    double sum = 0;
    double squares = 0;
    double pivot = 1;
    double slope = 0;
    double bend = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double b = i > 0 ? off_diagonal[i - 1] * off_diagonal[i - 1] / (pivot * pivot) : 0;
      const double next_bend = b * (bend - 2 * slope * slope / pivot);
      const double next = x - diagonal[i] - b * pivot;
      slope = 1 + b * slope;
      bend = next_bend;
      pivot = next;
      if (!(pivot > 0)) return x;
      sum += slope / pivot;
      squares += slope / pivot * (slope / pivot) - bend / pivot;
    }
    const auto order = static_cast<double>(n);
    const double root = std::sqrt(std::max(0.0, (order - 1) * (order * squares - sum * sum)));
    const double by = order / (sum + root);
    x -= by;
    if (!(by > 1e-9 * x)) break;
  }
  return x;
}

Eigen::Index padded(Eigen::Index rows) { return (rows + padding - 1) / padding * padding; }

}  // namespace

/// Factors J^T by Householder reflections, column by column.
void ReducedHessian::constrain(const Eigen::MatrixXd& jacobian) {
  n_ = jacobian.cols();
  constraints_ = std::min(jacobian.rows(), n_);
  reflections_ = jacobian.topRows(constraints_).transpose();
  tau_.resize(constraints_);
  diagonal_.resize(constraints_);
  triangle_.setZero(constraints_, constraints_);
  for (Eigen::Index i = 0; i < constraints_; ++i) {
    auto v = reflections_.col(i);
    triangle_.col(i).head(i) = v.head(i);
    v.head(i).setZero();
    const double size = v.norm();
    diagonal_[i] = v[i] > 0 ? -size : size;
    v[i] -= diagonal_[i];
    const double squared = v.squaredNorm();
    tau_[i] = squared > 0 ? 2 / squared : 0;
    for (Eigen::Index later = i + 1; later < constraints_; ++later) {
      auto column = reflections_.col(later);
      column -= (tau_[i] * v.dot(column)) * v;
    }
  }
  const double largest = constraints_ > 0 ? diagonal_.cwiseAbs().maxCoeff() : 1;
  independent_ = constraints_ == jacobian.rows() &&
                 (diagonal_.array().abs() > independence_tolerance * largest).all();
}

/// Factors Z^T H Z + mu. @return whether it is positive definite
bool ReducedHessian::factor(double mu, Eigen::MatrixXd& lower) const {
  const Eigen::Index free_count = free();
  lower.resize(padded(free_count), free_count);
  for (Eigen::Index j = 0; j < free_count; ++j) {
    const double* const from = rotated_hessian_.col(constraints_ + j).data() + constraints_;
    double* const column = lower.col(j).data();
    std::fill_n(std::copy_n(from, free_count, column), lower.rows() - free_count, 0.0);
    column[j] += mu;
  }
  return dense_kernel().factor({lower.data(), free_count, free_count, lower.rows()});
}

void ReducedHessian::reflect(Eigen::Index i, Vector& v) const {
  const auto w = reflections_.col(i);
  v -= (tau_[i] * w.dot(v)) * w;
}

/// Replaces v by Q^T v.
void ReducedHessian::turn(Vector v) const {
  for (Eigen::Index i = 0; i < constraints_; ++i) reflect(i, v);
}

/// Replaces v by Q v.
void ReducedHessian::apply_q(Vector v) const {
  for (Eigen::Index i = constraints_; i-- > 0;) reflect(i, v);
}

/// Replaces mu by R^-1 mu.
void ReducedHessian::solve_triangle(Vector mu) const {
  for (Eigen::Index i = constraints_; i-- > 0;) {
    mu[i] /= diagonal_[i];
    mu.head(i) -= mu[i] * triangle_.col(i).head(i);
  }
}

/// Replaces z by (L L^T)^-1 z.
void ReducedHessian::cholesky_solve(const Eigen::MatrixXd& lower, Vector z) const {
  dense_kernel().solve({lower.data(), free(), free(), lower.rows()}, z.data());
}

ReducedHessian::Balance ReducedHessian::balance(const Eigen::VectorXd& gradient) {
  rotated_right_ = gradient;
  turn(rotated_right_);
  Balance result{rotated_right_.head(constraints_), rotated_right_.tail(free())};
  solve_triangle(result.multipliers);
  return result;
}

void ReducedHessian::solve_free(Eigen::VectorXd& z) const { cholesky_solve(factor_, z); }

void ReducedHessian::reflect_and_factor() {
  n_ = rotated_hessian_.rows();
  scratch_.resize(n_);
  for (Eigen::Index i = 0; i < constraints_; ++i) {
    dense_kernel().reflect(result_columns(rotated_hessian_), reflections_.col(i).data(), tau_[i],
                           scratch_.data());
  }
  definite_ = factor(0, factor_);
}

void ReducedHessian::solve(const Eigen::VectorXd& right, Eigen::VectorXd& step) {
  const Eigen::Index free_count = free();
  step.resize(right.size());
  rotated_right_ = right.head(n_);
  turn(rotated_right_);
  auto x = step.head(n_);
  auto y = x.head(constraints_);
  auto z = x.tail(free_count);
  // R^T y = b
  for (Eigen::Index i = 0; i < constraints_; ++i) {
    y[i] = (right[n_ + i] - triangle_.col(i).head(i).dot(y.head(i))) / diagonal_[i];
  }
  z = rotated_right_.tail(free_count);
  z.noalias() -= rotated_hessian_.bottomLeftCorner(free_count, constraints_) * y;
  cholesky_solve(factor_, z);
  // R mu = (Q^T H Q) (y; z) - Q^T a, restricted to Y.
  auto mu = step.tail(constraints_);
  mu.noalias() = rotated_hessian_.leftCols(constraints_).transpose() * x;
  mu -= rotated_right_.head(constraints_);
  solve_triangle(mu);
  apply_q(x);
}

/// Runs Lanczos' method on the inverse with full reorthogonalisation. It ends when the largest
/// eigenvalue, which is computed at some of the steps, has changed by at most `settled` of itself,
/// after `most_steps`, or when no new direction is found.
ReducedHessian::Lanczos ReducedHessian::run_lanczos(double settled, Eigen::Index most_steps) {
  const auto is_time_to_check = [](Eigen::Index k) { return k == 4 || (k >= 8 && k % 6 == 2); };
  // A vector that orthogonalisation shortens by more than this factor is orthogonalised again: its
  // remaining components would grow by the same factor with each step.
  constexpr double much_shorter = 0.5;
  const Eigen::Index free_count = free();
  const Eigen::Index most = std::min(most_steps, free_count);
  krylov_.resize(free_count, most + 1);
  // This start vector has no symmetry, so that it has a component along every eigenvector.
  for (Eigen::Index i = 0; i < free_count; ++i) {
    krylov_(i, 0) = std::sin(1 + 1.7 * static_cast<double>(i));
  }
  krylov_.col(0).normalize();
  Lanczos result{Eigen::VectorXd(most), Eigen::VectorXd(most), 0};
  for (Eigen::Index k = 0; k < most; ++k) {
    auto next = krylov_.col(k + 1);
    next = krylov_.col(k);
    cholesky_solve(factor_, next);
    result.diagonal[k] = krylov_.col(k).dot(next);
    double size = next.norm();
    for (int pass = 0; pass < 2; ++pass) {
      scratch_.head(k + 1).noalias() = krylov_.leftCols(k + 1).transpose() * next;
      next.noalias() -= krylov_.leftCols(k + 1) * scratch_.head(k + 1);
      const double before = std::exchange(size, next.norm());
      if (size > much_shorter * before) break;
    }
    result.off_diagonal[k] = size;
    const bool last = k + 1 == most || !(size > 1e-12 * result.diagonal[k]);
    if (!last) next /= size;
    if (!is_time_to_check(k) && !last) continue;
    const double before = result.largest;
    result.largest = largest_eigenvalue(result.diagonal.head(k + 1), result.off_diagonal.head(k));
    const bool done = std::abs(result.largest - before) <= settled * result.largest;
    if (!done && !last) continue;
    result.diagonal.conservativeResize(k + 1);
    result.off_diagonal.conservativeResize(k);
    return result;
  }
  return result;
}

std::optional<double> ReducedHessian::smallest_eigenvalue_of_definite() {
  constexpr double slack = 0.01;
  constexpr double settled = 1e-4;  // between two checks; the later is accurate to its square
  constexpr Eigen::Index most_steps = 24;
  if (!definite_ || free() == 0) return std::nullopt;
  const double smallest = 1 / run_lanczos(settled, most_steps).largest;
  if (!factor_shifted(-(1 - slack) * smallest)) return std::nullopt;
  return smallest;
}

std::optional<Eigen::VectorXd> ReducedHessian::lowest_mode_of_definite() {
  constexpr double settled = 1e-12;
  constexpr Eigen::Index most_steps = 80;
  if (!definite_ || free() == 0) return std::nullopt;
  const Lanczos found = run_lanczos(settled, most_steps);
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen;
  eigen.computeFromTridiagonal(found.diagonal, found.off_diagonal);
  const Eigen::Index steps = found.diagonal.size();
  return Eigen::VectorXd(krylov_.leftCols(steps) * eigen.eigenvectors().col(steps - 1));
}

Eigen::MatrixXd ReducedHessian::matrix() const {
  return rotated_hessian_.bottomRightCorner(free(), free());
}

Eigen::VectorXd ReducedHessian::to_unknowns(const Eigen::VectorXd& v) const {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n_);
  x.tail(free()) = v;
  apply_q(x);
  return x;
}

Eigen::VectorXd smallest_eigenvalues(ReducedHessian& hessian, double above) {
  const std::optional<double> smallest = hessian.smallest_eigenvalue_of_definite();
  if (smallest && *smallest > above) return Eigen::VectorXd::Constant(1, *smallest);
  const Eigen::MatrixXd projected = hessian.matrix();
  if (projected.size() == 0) return {};
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(projected, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

Eigen::VectorXd eigenvector_by_magnitude(ReducedHessian& hessian, Eigen::Index index) {
  if (index == 0) {
    if (const std::optional<Eigen::VectorXd> mode = hessian.lowest_mode_of_definite()) {
      return hessian.to_unknowns(*mode);
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian.matrix());
  std::vector<Eigen::Index> order(static_cast<std::size_t>(eigen.eigenvalues().size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::ranges::stable_sort(order, {},
                           [&](Eigen::Index i) { return std::abs(eigen.eigenvalues()[i]); });
  return hessian.to_unknowns(eigen.eigenvectors().col(order.at(static_cast<std::size_t>(index))));
}

bool is_minimum(const Eigen::MatrixXd& hessian) {
  Eigen::MatrixXd shifted = hessian;
  shifted.diagonal().array() += zero_eigenvalue_limit;
  return Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(shifted).info() == Eigen::Success;
}

std::optional<Eigen::VectorXd> negative_curvature_direction(const ReducedHessian& hessian) {
  if (hessian.is_definite()) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian.matrix());
  if (eigen.eigenvalues().size() == 0 || eigen.eigenvalues()[0] > -zero_eigenvalue_limit)
    return std::nullopt;
  return hessian.to_unknowns(eigen.eigenvectors().col(0)).normalized();
}

void NewtonSystem::compute(Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian) {
  jacobian_ = jacobian;
  orthogonal_.reset();
  reduced_.constrain(jacobian);
  if (jacobian.rows() == 0) {
    reduced_.take(hessian);
  } else {
    hessian_.swap(hessian);
    reduced_.compute(hessian_);
  }
  if (!reduced_.has_solutions()) lu_.compute(whole());
}

Eigen::MatrixXd NewtonSystem::whole() const {
  const Eigen::Index n = hessian().rows();
  const Eigen::Index m = jacobian_.rows();
  Eigen::MatrixXd system(n + m, n + m);
  system << hessian(), -jacobian_.transpose(), jacobian_, Eigen::MatrixXd::Zero(m, m);
  return system;
}

void NewtonSystem::solve(const Eigen::VectorXd& right, Eigen::VectorXd& step) {
  if (reduced_.has_solutions()) {
    reduced_.solve(right, step);
  } else {
    step = lu_.solve(right);
  }
}

bool NewtonSystem::is_solved_by(const Eigen::VectorXd& right, const Eigen::VectorXd& step,
                                double longest) {
  const Eigen::Index n = hessian().rows();
  const Eigen::Index m = jacobian_.rows();
  left_ = right;
  left_.head(n).noalias() -= hessian() * step.head(n);
  left_.head(n).noalias() += jacobian_.transpose() * step.tail(m);
  left_.tail(m).noalias() -= jacobian_ * step.head(n);
  return left_.norm() <= 1e-6 * right.norm() && step.head(n).norm() <= longest;
}

Eigen::VectorXd NewtonSystem::minimum_norm_step(const Eigen::VectorXd& right) {
  if (!orthogonal_) {
    const Eigen::MatrixXd system = whole();
    orthogonal_.emplace(system.rows(), system.cols());
    orthogonal_->setThreshold(zero_eigenvalue_limit / std::max(1.0, system.cwiseAbs().maxCoeff()));
    orthogonal_->compute(system);
  }
  return orthogonal_->solve(right);
}

}  // namespace dlo::energy_model
