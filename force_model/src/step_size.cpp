#include "dlo/force_model/step_size.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "require.hpp"
#include "twisted_spans.hpp"

namespace dlo::force_model {
namespace {

using Points = Eigen::Ref<const Eigen::Matrix3Xd>;

/// First root of cos x cosh x = -1, of the first mode of a clamped-free rod.
constexpr double clamped_free_root = 1.8751040687119611;

double fastest_inner_mode(const Rod& rod, const Points& points) {
  const Eigen::VectorXd& L = rod.rest_lengths;
  double contraction = 0;
  double bending = 0;
  double previous_length = 0;
  Eigen::Vector3d previous = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < L.size(); ++i) {
    const Eigen::Vector3d segment = points.col(i + 1) - points.col(i);
    // A segment of almost zero length would require steps of almost zero length. The limit l_s
    // prevents its points from jumping.
    const double length = std::max(segment.norm(), 0.1 * L[i]);
    contraction = std::max(contraction, 4 * rod.c_c / std::min(L[i], length));
    if (i > 0) {
      const double mean = (L[i - 1] + L[i]) / 2;
      const double lever = std::min(length, previous_length);
      // A joint next to a segment of zero length has no angle; atan2(0, -0) would be pi.
      const bool directed = !previous.isZero(0) && !segment.isZero(0);
      const double alpha =
          directed ? std::atan2(previous.cross(segment).norm(), previous.dot(segment)) : 0;
      const Bending joint = bending_at(rod.bending, i);
      bending = std::max(bending, (16 * joint_stiffness(joint, mean, alpha) +
                                   4 * joint_moment(joint, mean, alpha) +
                                   4 * std::abs(natural_moment(rod.bending, i, mean))) /
                                      (lever * lever));
    }
    previous = segment;
    previous_length = length;
  }
  return contraction + bending;
}

/// Returns the bending stiffness for the slowest mode [N m^2]: hooke, that of the softest joint;
/// paper, M L / alpha at the moment M of the loads, which a folded joint limits; 0 without loads.
double equivalent_rigidity(const Rod& rod) {
  const bool is_uniform = rod.bending.stiffnesses.size() == 0;
  const double stiffness =
      is_uniform ? rod.bending.stiffness : rod.bending.stiffnesses.minCoeff();  // the slowest
  if (rod.bending.law == BendingLaw::hooke) return stiffness;
  const double L = rod.rest_lengths.mean();
  const double moment = rod.loads.colwise().norm().sum() * rod.length() / 2;
  const double full = joint_moment({rod.bending.law, stiffness}, L, 3.0);
  if (!(moment > 0 && full > 0)) return 0;
  const double alpha = 2 * std::asin(std::cbrt(std::min(1.0, moment / full)));
  return std::min(moment, full) * L / alpha;
}

}  // namespace

ModeBounds mode_bounds(const Rod& rod, const Points& points) {
  require_polygon("mode_bounds", points, rod.rest_lengths);
  ModeBounds modes;
  modes.fastest =
      fastest_inner_mode(rod, points) + fastest_twist_mode(rod, points) + constraint_stiffness(rod);
  const double per_length = clamped_free_root / rod.length();
  const double square = per_length * per_length;
  modes.slowest = square * square * equivalent_rigidity(rod) * rod.rest_lengths.mean();
  modes.slowest = std::clamp(modes.slowest, smallest_mode_ratio * modes.fastest, modes.fastest);
  return modes;
}

double constraint_stiffness(const Rod& rod) {
  double walls = 0;
  for (const Wall& wall : rod.walls) walls += wall.stiffness;
  for (const Solid& solid : rod.solids) walls += solid.stiffness;
  double grip = 0;
  for (const Grip& g : rod.grips) {
    if (g.hold == GripHold::spring) grip = std::max(grip, g.stiffness);
  }
  return walls + grip;
}

double largest_step_factor(double fastest, double c_h) {
  require_positive("largest_step_factor", "fastest", fastest);
  require(c_h >= 0 && c_h < 1, "largest_step_factor", "c_h", c_h, "in [0, 1)");
  return 2 * (1 + c_h) / fastest;
}

HeavyBall heavy_ball(const ModeBounds& modes) {
  require_positive("heavy_ball", "fastest", modes.fastest);
  require_positive("heavy_ball", "slowest", modes.slowest);
  const double high = std::sqrt(modes.fastest);
  const double low = std::sqrt(std::min(modes.slowest, modes.fastest));
  const double ratio = (high - low) / (high + low);
  return {.c_F = 4 / ((high + low) * (high + low)), .c_h = ratio * ratio};
}

}  // namespace dlo::force_model
