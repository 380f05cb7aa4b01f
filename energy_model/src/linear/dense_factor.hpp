#pragma once

#include <Eigen/Core>

namespace dlo::energy_model {

/// Cholesky's factor of a symmetric matrix, A = L L^T. Its buffer survives from one compute() to
/// the next.
class DenseFactor {
 public:
  /// @param a  of which the lower half is read
  /// @return whether it is positive definite, which solve() needs
  bool compute(const Eigen::MatrixXd& a);

  /// x to A^-1 x
  void solve(Eigen::VectorXd& x) const;

 private:
  Eigen::MatrixXd lower_;  // with rows that fill registers
};

}  // namespace dlo::energy_model
