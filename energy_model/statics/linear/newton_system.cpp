#include "linear/newton_system.hpp"

#include <algorithm>

#include "linear/free_directions.hpp"

namespace dlo::energy_model {

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

bool NewtonSystem::is_met(const Eigen::VectorXd& right, const Eigen::VectorXd& step,
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
    orthogonal_->setThreshold(neutral / std::max(1.0, system.cwiseAbs().maxCoeff()));
    orthogonal_->compute(system);
  }
  return orthogonal_->solve(right);
}

}  // namespace dlo::energy_model
