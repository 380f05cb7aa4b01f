#include "strain/soft_contact.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "frames/position_operator.hpp"

namespace dlo::energy_model {

void SoftContact::reset(const Span& span, const std::vector<Piece>& pieces,
                        const LegendreTable& table) {
  obstacles_ = span.soft_obstacles;
  if (!any()) return;
  const PositionOperator reach(span, pieces, table);
  weights_ = reach.weights();
  const Eigen::Index Q = table.nodes.size();
  position_.resize(weights_.size(), weights_.size());
  for (Eigen::Index e = 0; e < std::ssize(pieces); ++e) {
    const PointsReach along = reach.along(e);
    for (Eigen::Index q = 0; q < Q; ++q) {
      position_.row(e * Q + q) = along.weights(q + 1).transpose();
    }
  }
}

void SoftContact::look(const Eigen::MatrixX3d& tangents, Place& place,
                       Eigen::MatrixX3d& force) const {
  place.resize(obstacles_.size());
  const Eigen::MatrixX3d points = position_ * tangents;
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    const Span::SoftObstacle& obstacle = obstacles_[i];
    place[i].clear();
    // p = max(0, -k d), energy p^2 / 2k, d the clearance
    for (Eigen::Index q = 0; q < weights_.size(); ++q) {
      const Eigen::Vector3d point = points.row(q);
      if (obstacle.body.clearance(point) >= 0) continue;
      place[i].push_back({q, obstacle.body.gap(point)});
      force.noalias() += position_.row(q).transpose() * push(i, place[i].back()).transpose();
    }
  }
}

void SoftContact::add_hessian(const Place& place, const std::array<Eigen::MatrixXd, 3>& tangents,
                              Eigen::Ref<Eigen::MatrixXd> hessian) const {
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    if (place[i].empty()) continue;
    const double k = obstacles_[i].stiffness;
    const Eigen::Index count = std::ssize(place[i]);
    Eigen::MatrixXd reach(count, position_.cols());
    for (Eigen::Index p = 0; p < count; ++p) {
      reach.row(p) = position_.row(place[i][static_cast<std::size_t>(p)].node);
    }
    // For points within the obstacle, by axis: their displacements by the unknowns, and the
    // resulting forces.
    std::array<Eigen::MatrixXd, 3> moved;
    for (std::size_t axis = 0; axis < 3; ++axis) moved[axis].noalias() = reach * tangents[axis];
    std::array<Eigen::MatrixXd, 3> pushed = moved;
    for (Eigen::Index p = 0; p < count; ++p) {
      const Pressed& at = place[i][static_cast<std::size_t>(p)];
      const Eigen::Vector3d& normal = at.gap.gradient;
      const Eigen::Matrix3d spring =
          k * weights_[at.node] * (normal * normal.transpose() + at.gap.value * at.gap.hessian);
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        pushed[static_cast<std::size_t>(axis)].row(p) = spring(axis, 0) * moved[0].row(p) +
                                                        spring(axis, 1) * moved[1].row(p) +
                                                        spring(axis, 2) * moved[2].row(p);
      }
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      hessian.noalias() += moved[axis].transpose() * pushed[axis];
    }
  }
}

namespace {

/// Returns the resistance to leaving the plane, divided by the stiffness, of a body that is
/// symmetric about the plane. On a ridge, where faces on both sides are equally close, the force
/// has a component out of the plane that changes its sign there: the energy decreases linearly to
/// both sides. It is replaced by the quadratic decrease that is equal at a short distance.
double tilt_spring(const obstacle::Gap& gap) {
  constexpr double way = 1e-3;
  if (is_on_ridge(gap)) return 1 + 2 * gap.value / way;
  return gap.value * gap.hessian(2, 2);
}

}  // namespace

bool is_on_ridge(const obstacle::Gap& gap) { return std::abs(gap.gradient.z()) > 0.5; }

void SoftContact::add_tilt_hessian(const Place& place, const Eigen::MatrixXd& angle,
                                   Eigen::MatrixXd& hessian) const {
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    if (place[i].empty()) continue;
    const Eigen::Index count = std::ssize(place[i]);
    Eigen::MatrixXd reach(count, position_.cols());
    Eigen::VectorXd spring(count);
    for (Eigen::Index p = 0; p < count; ++p) {
      const Pressed& at = place[i][static_cast<std::size_t>(p)];
      reach.row(p) = position_.row(at.node);
      spring[p] = obstacles_[i].stiffness * weights_[at.node] * tilt_spring(at.gap);
    }
    const Eigen::MatrixXd moved = reach * angle;
    hessian.noalias() += moved.transpose() * spring.asDiagonal() * moved;
  }
}

double SoftContact::energy(const Place& place) const {
  double energy = 0;
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    for (const Pressed& at : place[i]) {
      energy += weights_[at.node] * obstacles_[i].stiffness * at.gap.value * at.gap.value / 2;
    }
  }
  return energy;
}

std::vector<Eigen::Vector3d> SoftContact::forces(const Place& place) const {
  std::vector<Eigen::Vector3d> forces;
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    forces.emplace_back(Eigen::Vector3d::Zero());
    for (const Pressed& at : place[i]) forces.back() += push(i, at);
  }
  return forces;
}

Eigen::Vector3d SoftContact::moment(const Place& place, const Eigen::MatrixX3d& tangents) const {
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    for (const Pressed& at : place[i]) {
      const Eigen::Vector3d point = tangents.transpose() * position_.row(at.node).transpose();
      moment += point.cross(push(i, at));
    }
  }
  return moment;
}

Eigen::Vector3d SoftContact::push(std::size_t obstacle, const Pressed& at) const {
  return -obstacles_[obstacle].stiffness * weights_[at.node] * at.gap.value * at.gap.gradient;
}

}  // namespace dlo::energy_model
