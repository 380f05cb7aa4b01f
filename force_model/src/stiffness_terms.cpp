#include "stiffness_terms.hpp"

namespace dlo::force_model {

JointFactor joint_factor(const Bending& bending, double L, const Eigen::Vector3d& a,
                         const Eigen::Vector3d& b, double c, const Vector6d& slope_of_c) {
  JointFactor factor;
  if (bending.law == BendingLaw::paper) {
    const double a_length = a.norm();
    const double b_length = b.norm();
    const Eigen::Vector3d chord = a + b;
    const double ratio = a_length * b_length / chord.norm();
    Vector6d slope;
    slope.head<3>() = a / (a_length * a_length) - chord / chord.squaredNorm();
    slope.tail<3>() = b / (b_length * b_length) - chord / chord.squaredNorm();
    factor.S = bending.stiffness * (1 - c) * ratio;
    factor.slope = factor.S * slope - bending.stiffness * ratio * slope_of_c;
    return factor;
  }
  static const double fold_cosine = std::cos(hooke_fold_angle);
  if (c >= fold_cosine) {
    factor.S = 2 * bending.stiffness / L / (1 + c);
    factor.slope = -factor.S / (1 + c) * slope_of_c;
    return factor;
  }
  const double sine_squared = std::max(0.0, 1 - c * c);
  factor.S = 2 * bending.stiffness / L * std::tan(hooke_fold_angle / 2) / std::sqrt(sine_squared);
  factor.slope = factor.S * c / sine_squared * slope_of_c;
  return factor;
}

Eigen::Matrix3d second_of_direction_angle(const Eigen::Vector3d& s) {
  const double square = s.head<2>().squaredNorm();
  const double xy = 2 * s.x() * s.y();
  const double difference = s.y() * s.y() - s.x() * s.x();
  Eigen::Matrix3d result = Eigen::Matrix3d::Zero();
  result.topLeftCorner<2, 2>() << xy, difference, difference, -xy;
  return result / (square * square);
}

}  // namespace dlo::force_model
