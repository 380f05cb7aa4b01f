#include "base/fit_angle.hpp"

namespace dlo::energy_model {

FittedAngle fit_angle(const LegendreTable& table, const std::vector<double>& turns,
                      const Eigen::VectorXd& angles, std::optional<double> start) {
  const Eigen::Index Q = table.nodes.size();
  const Eigen::Index K = table.fit.rows() - 1;
  const auto count = static_cast<Eigen::Index>(turns.size());
  // Every piece on its own, with the angle where it begins; then p_0 makes them meet.
  Eigen::MatrixXd own(K + 1, count);
  for (Eigen::Index e = 0; e < count; ++e) {
    own.col(e).noalias() = table.fit * angles.segment(e * Q, Q);
  }
  const double end = own(0, count - 1) + own(1, count - 1);
  if (start) own(0, 0) = *start;
  FittedAngle fitted{own(0, 0), Eigen::VectorXd(K * count)};
  for (Eigen::Index e = 0; e < count; ++e) {
    own(1, e) = (e + 1 < count ? own(0, e + 1) : end) - own(0, e);
    fitted.coefficients.segment(e * K, K) = own.col(e).tail(K) / turns[static_cast<std::size_t>(e)];
  }
  return fitted;
}

}  // namespace dlo::energy_model
