#include "linear/newton_system.hpp"

#include <algorithm>

#include "linear/free_directions.hpp"

namespace dlo::energy_model {

void NewtonSystem::compute(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian) {
  hessian_ = hessian;
  jacobian_ = jacobian;
  orthogonal_.reset();
  free_.compute(hessian, jacobian);
  if (!free_.has_solutions()) lu_.compute(whole());
}

Eigen::MatrixXd NewtonSystem::whole() const {
  const Eigen::Index n = hessian_.rows();
  const Eigen::Index m = jacobian_.rows();
  Eigen::MatrixXd system(n + m, n + m);
  system << hessian_, -jacobian_.transpose(), jacobian_, Eigen::MatrixXd::Zero(m, m);
  return system;
}

void NewtonSystem::solve(const Eigen::VectorXd& right, Eigen::VectorXd& step) {
  if (free_.has_solutions()) {
    free_.solve(right, step);
  } else {
    step = lu_.solve(right);
  }
}

bool NewtonSystem::is_met(const Eigen::VectorXd& right, const Eigen::VectorXd& step,
                          double longest) {
  const Eigen::Index n = hessian_.rows();
  const Eigen::Index m = jacobian_.rows();
  left_ = right;
  left_.head(n).noalias() -= hessian_ * step.head(n);
  left_.head(n).noalias() += jacobian_.transpose() * step.tail(m);
  left_.tail(m).noalias() -= jacobian_ * step.head(n);
  return left_.norm() <= 1e-6 * right.norm() && step.head(n).norm() <= longest;
}

Eigen::VectorXd NewtonSystem::minimum_norm_step(const Eigen::VectorXd& right) {
  if (!orthogonal_) {
    const Eigen::MatrixXd system = whole();
    orthogonal_.emplace(system.rows(), system.cols());
    orthogonal_->setThreshold(neutral / std::max(1.0, system.cwiseAbs().maxCoeff()));
    orthogonal_->compute(system);
  }
  return orthogonal_->solve(right);
}

}  // namespace dlo::energy_model
