#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/QR>
#include <optional>

#include "linear/reduced_hessian.hpp"

namespace dlo::energy_model {

/// The linear system of Newton's method under constraints,
///     H x - J^T mu = a,  J x = b,
/// factored on the directions that the constraints leave free where H is positive definite there,
/// as a whole where it is not. Buffers survive from one compute() to the next.
class NewtonSystem {
 public:
  /// @param[in,out] hessian  n x n, symmetric; taken over, so that it becomes another matrix
  /// @param jacobian         m x n
  void compute(Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian);

  /// Whether it has been computed of so many unknowns and constraints.
  [[nodiscard]] bool is_of(Eigen::Index unknowns, Eigen::Index constraints) const {
    return hessian().rows() == unknowns && jacobian_.rows() == constraints;
  }
  [[nodiscard]] const Eigen::MatrixXd& hessian() const {
    return jacobian_.rows() > 0 ? hessian_ : reduced_.unconstrained();
  }

  /// @param right      (a, b), n + m
  /// @param[out] step  (x, mu), another vector
  void solve(const Eigen::VectorXd& right, Eigen::VectorXd& step);

  /// Whether a step meets the system, to 1e-6 of its right side, and is no longer than this.
  [[nodiscard]] bool is_met(const Eigen::VectorXd& right, const Eigen::VectorXd& step,
                            double longest);

  /// The minimum-norm step, by least squares: it has no part along near-null modes.
  [[nodiscard]] Eigen::VectorXd minimum_norm_step(const Eigen::VectorXd& right);

  /// H on the free directions, of a system with constraints; of one without H itself.
  [[nodiscard]] ReducedHessian& reduced_hessian() { return reduced_; }
  [[nodiscard]] const ReducedHessian& reduced_hessian() const { return reduced_; }

 private:
  [[nodiscard]] Eigen::MatrixXd whole() const;

  Eigen::MatrixXd hessian_;  // only where there are constraints
  Eigen::MatrixXd jacobian_;
  ReducedHessian reduced_;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
  /// Of the whole system, once it was asked for.
  std::optional<Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>> orthogonal_;
  Eigen::VectorXd left_;
};

}  // namespace dlo::energy_model
