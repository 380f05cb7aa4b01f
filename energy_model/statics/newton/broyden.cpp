#include "newton/broyden.hpp"

namespace dlo::energy_model {
namespace {

/// Steps that are made use of; later ones are as the factor gives them.
constexpr Eigen::Index most_secants = 12;

/// Share of the last step along itself above which the update would make the next one much longer:
/// it is time for another factor.
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
