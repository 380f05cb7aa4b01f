#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/QR>
#include <optional>

#include "linear/reduced_hessian.hpp"

namespace dlo::energy_model {

/// The linear system of Newton's method under constraints,
///     H x - J^T mu = a,  J x = b.
/// If H is positive definite on the null space of J, and the rows of J are independent, the system
/// is factored there (ReducedHessian); otherwise it is factored as a whole. Buffers are kept from
/// one compute() to the next.
class NewtonSystem {
 public:
  /// Factors the system. @param[in,out] hessian  n x n, symmetric; its storage is swapped out, and
  /// its content is lost
  /// @param jacobian         m x n
  void compute(Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian);

  /// Whether the last compute() had these numbers of unknowns and constraints.
  [[nodiscard]] bool is_of(Eigen::Index unknowns, Eigen::Index constraints) const {
    return hessian().rows() == unknowns && jacobian_.rows() == constraints;
  }
  [[nodiscard]] const Eigen::MatrixXd& hessian() const {
    return jacobian_.rows() > 0 ? hessian_ : reduced_.unconstrained();
  }

  /// Solves the system.
  /// @param right      (a, b), n + m numbers
  /// @param[out] step  (x, mu); must not alias `right`
  void solve(const Eigen::VectorXd& right, Eigen::VectorXd& step);

  /// Whether a step solves the system to 1e-6 of the norm of `right`, and its x is no longer than
  /// `longest`.
  [[nodiscard]] bool is_met(const Eigen::VectorXd& right, const Eigen::VectorXd& step,
                            double longest);

  /// Returns the minimum-norm least-squares solution, which has no component along near-null modes.
  [[nodiscard]] Eigen::VectorXd minimum_norm_step(const Eigen::VectorXd& right);

  /// H on the directions that the constraints leave free; without constraints, H itself.
  [[nodiscard]] ReducedHessian& reduced_hessian() { return reduced_; }
  [[nodiscard]] const ReducedHessian& reduced_hessian() const { return reduced_; }

 private:
  [[nodiscard]] Eigen::MatrixXd whole() const;

  Eigen::MatrixXd hessian_;  // empty without constraints
  Eigen::MatrixXd jacobian_;
  ReducedHessian reduced_;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
  /// Orthogonal factorisation of the whole system; computed by the first minimum_norm_step().
  std::optional<Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>> orthogonal_;
  Eigen::VectorXd left_;
};

}  // namespace dlo::energy_model
