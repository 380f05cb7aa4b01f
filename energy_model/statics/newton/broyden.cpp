#include "newton/broyden.hpp"

namespace dlo::energy_model {
namespace {

/// Maximum number of updates; later steps are those of the factor.
constexpr Eigen::Index most_secants = 12;

/// Component of the next step along the last one, divided by the last one's length, above which the
/// update would lengthen the step too much. No more updates are made until the next factorisation.
constexpr double largest_share = 0.5;

}  // namespace

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
