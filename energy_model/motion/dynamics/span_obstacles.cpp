// Forces of obstacles on a moving span: of soft ones at its nodes, of rigid ones at the grid's
// points.

#include <algorithm>

#include "dynamics/span_dynamics.hpp"

namespace dlo::energy_model {

void SpanDynamics::collect_soft_contact_points() {
  soft_contact_points_.clear();
  for (const Span::SoftObstacle& obstacle : span_.soft_obstacles) {
    const ObstaclePose& place = drive_.obstacles[obstacle.index];
    for (Eigen::Index point = 0; point < points_.points(); ++point) {
      const double stiffness = obstacle.stiffness * points_.weights()[point];
      const Eigen::Vector3d at = position_.row(point).transpose();
      if (!(stiffness > 0) || !(obstacle.body.clearance(place.to_body_axes(at)) < 0)) continue;
      ContactPoint touch(obstacle, place, at);
      touch.push = stiffness * touch.depth;
      touch.kept = touch.push * touch.depth / 2;
      forces_.row(point) -= touch.force().transpose();
      soft_contact_points_.push_back(touch);
    }
  }
}

void SpanDynamics::collect_contact_points() {
  contact_points_.clear();
  if (grid_.empty()) return;
  for (std::size_t e = 0; e < nodes_.elements().size(); ++e) {
    const Eigen::Vector3d begin = position_.row(points_.begin(static_cast<Eigen::Index>(e)));
    for (const Span::Obstacle& obstacle : span_.rigid_obstacles) {
      grid_.find(e, obstacle, drive_.obstacles[obstacle.index], begin, t_, contact_points_);
    }
  }
  for (ContactPoint& touch : contact_points_) {
    const Eigen::Index begin = points_.begin(static_cast<Eigen::Index>(touch.element));
    const Eigen::Vector3d velocity = velocity_.row(begin).transpose() +
                                     grid_.points(touch.element).from_begin(touch.point, t_rate_);
    grid_.set_contact_force(-touch.normal.dot(velocity - touch.velocity), touch);
  }
}

/// Returns the derivatives by the tangents of the work of a force at a point of the grid.
Eigen::MatrixX3d SpanDynamics::tangent_gradient(const ContactPoint& touch,
                                                const Eigen::Vector3d& force) const {
  return grid_.points(touch.element).weights(touch.point) * force.transpose();
}

/// Adds the derivatives of the residual by the unknowns due to rigid contacts, with fixed normals.
/// @param derivative  ContactPoint::by_depth or ContactPoint::by_rate
void SpanDynamics::add_contact_derivatives(double ContactPoint::*derivative,
                                           Eigen::MatrixXd& matrix) {
  for (const ContactPoint& touch : contact_points_) {
    const Eigen::MatrixX3d tangents = tangent_gradient(touch, -touch.normal);
    const Eigen::VectorXd depth_gradient = frame_adjoint({&tangents, {}});
    matrix += touch.*derivative * depth_gradient * depth_gradient.transpose();
  }
}

std::vector<std::pair<std::size_t, Eigen::Vector3d>> SpanDynamics::obstacle_forces() const {
  std::vector<std::pair<std::size_t, Eigen::Vector3d>> result;
  for (const std::vector<ContactPoint>* touches : {&soft_contact_points_, &contact_points_}) {
    for (const ContactPoint& touch : *touches) result.emplace_back(touch.obstacle, touch.force());
  }
  return result;
}

double SpanDynamics::depth() const {
  double result = 0;
  for (const ContactPoint& touch : contact_points_) result = std::max(result, touch.depth);
  return result;
}

}  // namespace dlo::energy_model
