#include "strain/soft_contact.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "strain/node_reach.hpp"

namespace dlo::energy_model {

void SoftContact::reset(const Span& span, const std::vector<Piece>& pieces,
                        const LegendreTable& table, const Eigen::VectorXd& nodes,
                        const Eigen::VectorXd& weights) {
  obstacles_ = span.soft_obstacles;
  if (!any()) return;
  weights_ = weights;
  const NodeReach reach(span, pieces, table, nodes, weights);
  const Eigen::Index Q = table.nodes.size();
  position_.resize(nodes.size(), nodes.size());
  for (Eigen::Index e = 0; e < std::ssize(pieces); ++e) {
    position_.middleRows(e * Q, Q) = reach.of_nodes(e).transpose();
  }
  pressed_.assign(obstacles_.size(), {});
}

double SoftContact::add(const Eigen::MatrixX3d& tangents, Eigen::MatrixX3d& force) {
  const Eigen::MatrixX3d points = position_ * tangents;
  double energy = 0;
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    const Span::SoftObstacle& obstacle = obstacles_[i];
    const double k = obstacle.stiffness;
    pressed_[i].clear();
    // p = max(0, -k d), energy p^2 / 2k, d the clearance
    for (Eigen::Index q = 0; q < weights_.size(); ++q) {
      const Eigen::Vector3d point = points.row(q);
      if (obstacle.body.clearance(point) >= 0) continue;
      pressed_[i].push_back({q, obstacle.body.gap(point)});
      const obstacle::Gap& gap = pressed_[i].back().gap;
      energy += weights_[q] * k * gap.value * gap.value / 2;
      const double push = -weights_[q] * k * gap.value;
      force.noalias() += push * position_.row(q).transpose() * gap.gradient.transpose();
    }
  }
  return energy;
}

void SoftContact::add_hessian(const std::array<Eigen::MatrixXd, 3>& tangents,
                              Eigen::Ref<Eigen::MatrixXd> hessian) const {
  Eigen::MatrixX3d moved(hessian.cols(), 3);
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    const double k = obstacles_[i].stiffness;
    for (const Pressed& at : pressed_[i]) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        moved.col(axis).noalias() = tangents[static_cast<std::size_t>(axis)].transpose() *
                                    position_.row(at.node).transpose();
      }
      const Eigen::Vector3d& normal = at.gap.gradient;
      const Eigen::Matrix3d spring =
          k * weights_[at.node] * (normal * normal.transpose() + at.gap.value * at.gap.hessian);
      hessian.noalias() += moved * spring * moved.transpose();
    }
  }
}

std::vector<Eigen::Vector3d> SoftContact::forces() const {
  std::vector<Eigen::Vector3d> forces;
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    forces.emplace_back(Eigen::Vector3d::Zero());
    for (const Pressed& at : pressed_[i]) forces.back() += push(i, at);
  }
  return forces;
}

Eigen::Vector3d SoftContact::moment(const Eigen::MatrixX3d& tangents) const {
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    for (const Pressed& at : pressed_[i]) {
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
