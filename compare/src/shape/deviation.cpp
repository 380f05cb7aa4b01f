#include "dlo/compare/deviation.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "shape/shape_measure.hpp"

namespace dlo::compare {
namespace {

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

double segment_angle_rms(const Shape& shape, const Reference& reference) {
  const std::vector<double>& s = shape.arc_length;
  std::vector<double> middle;
  for (std::size_t i = 0; i + 1 < s.size(); ++i) middle.push_back((s[i] + s[i + 1]) / 2);
  const energy_model::Samples samples = reference(middle);
  double sum = 0;
  for (std::size_t i = 0; i + 1 < s.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const double angle = angle_between(shape.points.col(column + 1) - shape.points.col(column),
                                       samples.tangents.col(column));
    sum += angle * angle * (s[i + 1] - s[i]);
  }
  return std::sqrt(sum / (s.back() - s.front()));
}

double curvature_rms(const Shape& shape, const energy_model::Samples& samples) {
  const std::vector<double>& s = shape.arc_length;
  double sum = 0;
  double length = 0;
  for (std::size_t i = 1; i + 1 < s.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const double share = joint_length(shape, i);
    // The binormal includes the sense of rotation: a bend to the wrong side contributes both
    // curvatures.
    const Eigen::Vector3d expected =
        samples.tangents.col(column).cross(samples.curvature.col(column));
    sum += (joint_curvature(shape, i) - expected).squaredNorm() * share;
    length += share;
  }
  return length > 0 ? std::sqrt(sum / length) : 0;
}

}  // namespace

double rms(const std::vector<double>& arc_length, const Eigen::Matrix3Xd& difference) {
  if (arc_length.size() < 2 || difference.cols() != static_cast<Eigen::Index>(arc_length.size())) {
    throw std::invalid_argument("rms: needs two or more points, one per arc length");
  }
  double sum = 0;
  for (std::size_t i = 0; i + 1 < arc_length.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    sum += (arc_length[i + 1] - arc_length[i]) / 2 *
           (difference.col(column).squaredNorm() + difference.col(column + 1).squaredNorm());
  }
  return std::sqrt(sum / (arc_length.back() - arc_length.front()));
}

Deviation deviation(const Shape& shape, const Reference& reference,
                    const std::optional<Eigen::Matrix3Xd>& straight,
                    std::optional<Eigen::Index> tip) {
  const energy_model::Samples samples = reference(shape.arc_length);
  const Eigen::Matrix3Xd difference = shape.points - samples.points;
  Deviation result;
  Eigen::Index worst = 0;
  result.max_m = std::sqrt(difference.colwise().squaredNorm().maxCoeff(&worst));
  result.max_at_m = shape.arc_length[static_cast<std::size_t>(worst)];
  // A mean cannot exceed the maximum, except by rounding.
  result.rms_m = std::min(rms(shape.arc_length, difference), result.max_m);
  result.tip_m = tip ? difference.col(*tip).norm() : NAN;
  result.rms_over_length = result.rms_m / (shape.arc_length.back() - shape.arc_length.front());
  const double movement = straight ? rms(shape.arc_length, samples.points - *straight) : 0;
  // A rod that did not move has no displacement to divide by.
  const double length = shape.arc_length.back() - shape.arc_length.front();
  result.rms_over_movement = movement > 1e-9 * length ? result.rms_m / movement : NAN;
  result.angle_rms_rad = segment_angle_rms(shape, reference);
  result.curvature_rms_per_m = curvature_rms(shape, samples);
  return result;
}

double distance(const Shape& shape, const Reference& reference) {
  return rms(shape.arc_length, shape.points - reference(shape.arc_length).points);
}

std::optional<Eigen::Matrix3Xd> straight_rod(const Scene& scene, const std::vector<double>& s) {
  const Gripper& grip = scene.grippers.front();
  if (scene.grippers.size() > 1 || !grip.direction) return std::nullopt;
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(s.size()));
  for (std::size_t i = 0; i < s.size(); ++i) {
    points.col(static_cast<Eigen::Index>(i)) = grip.position + (s[i] - grip.at) * *grip.direction;
  }
  return points;
}

double distance_from_straight(const Scene& scene, const Shape& shape) {
  const std::optional<Eigen::Matrix3Xd> straight = straight_rod(scene, shape.arc_length);
  return straight ? rms(shape.arc_length, *straight - shape.points) : NAN;
}

std::optional<Eigen::Index> free_tip(const Scene& scene, const std::vector<double>& s) {
  const auto is_free = [&](double at) {
    return std::ranges::find(scene.grippers, at, &Gripper::at) == scene.grippers.end();
  };
  const double near = 1e-9 * scene.length;
  if (is_free(scene.length) && s.back() >= scene.length - near) {
    return static_cast<Eigen::Index>(s.size()) - 1;
  }
  if (is_free(0) && s.front() <= near) return 0;
  return std::nullopt;
}

Deviation shape_deviation(const Scene& scene, const Shape& shape, const Reference& reference) {
  return deviation(shape, reference, straight_rod(scene, shape.arc_length),
                   free_tip(scene, shape.arc_length));
}

}  // namespace dlo::compare
