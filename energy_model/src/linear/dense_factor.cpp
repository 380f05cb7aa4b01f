#include "linear/dense_factor.hpp"

#include <algorithm>

#include "linear/dense_kernel.hpp"

namespace dlo::energy_model {

bool DenseFactor::compute(const Eigen::MatrixXd& a) {
  const Eigen::Index n = a.rows();
  lower_.resize((n + padding - 1) / padding * padding, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    double* const column = lower_.data() + j * lower_.rows();
    std::fill_n(std::copy_n(a.data() + j * n, n, column), lower_.rows() - n, 0.0);
  }
  return dense_kernel().factor({lower_.data(), n, n, lower_.rows()});
}

void DenseFactor::solve(Eigen::VectorXd& x) const {
  const Eigen::Index n = lower_.cols();
  dense_kernel().solve({lower_.data(), n, n, lower_.rows()}, x.data());
}

}  // namespace dlo::energy_model
