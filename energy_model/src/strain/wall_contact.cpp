#include "strain/wall_contact.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/legendre.hpp"

namespace dlo::energy_model {

void WallContact::reset(const Span& span, const std::vector<Piece>& pieces,
                        const LegendreTable& table, const Eigen::VectorXd& nodes,
                        const Eigen::VectorXd& weights) {
  walls_ = span.soft_walls;
  if (!any()) return;
  weights_ = weights;
  const Eigen::Index Q = table.nodes.size();
  position_.setZero(nodes.size(), nodes.size());
  for (std::size_t e = 0; e < pieces.size(); ++e) {
    const Eigen::Index row = static_cast<Eigen::Index>(e) * Q;
    position_.block(row, row, Q, Q) = pieces[e].length * table.integration;
    position_.block(row, 0, Q, row).rowwise() = weights.head(row).transpose();
  }
  // From the anchor instead of from the start.
  const Eigen::VectorXd to_anchor =
      (nodes.array() < span.anchor).select(weights, Eigen::VectorXd::Zero(nodes.size()));
  position_.rowwise() -= to_anchor.transpose();
  const auto count = static_cast<Eigen::Index>(walls_.size());
  pressure_.setZero(nodes.size(), count);
}

double WallContact::add(const Eigen::MatrixX3d& tangents, Eigen::MatrixX3d& force) {
  const Eigen::MatrixX3d points = position_ * tangents;
  double energy = 0;
  for (std::size_t i = 0; i < walls_.size(); ++i) {
    const Span::SoftWall& wall = walls_[i];
    const auto column = static_cast<Eigen::Index>(i);
    const double k = wall.stiffness;
    // p = max(0, -k d), energy p^2 / 2k, d the clearance
    pressure_.col(column) = (-k * ((points * wall.normal).array() + wall.offset)).cwiseMax(0.0);
    energy += weights_.dot(pressure_.col(column).cwiseAbs2()) / (2 * k);
    const Eigen::VectorXd push =
        position_.transpose() * weights_.cwiseProduct(pressure_.col(column));
    force.noalias() += push * wall.normal.transpose();
  }
  return energy;
}

void WallContact::add_hessian(const std::array<Eigen::MatrixXd, 3>& tangents,
                              Eigen::Ref<Eigen::MatrixXd> hessian) const {
  Eigen::MatrixXd depth(weights_.size(), hessian.cols());
  for (std::size_t i = 0; i < walls_.size(); ++i) {
    // k w (N . dr)(N . dr)^T of the nodes in contact
    const Eigen::Vector3d& normal = walls_[i].normal;
    depth.noalias() = position_ * (normal.x() * tangents[0] + normal.y() * tangents[1] +
                                   normal.z() * tangents[2]);
    const Eigen::VectorXd springs = (pressure_.col(static_cast<Eigen::Index>(i)).array() > 0)
                                        .select(walls_[i].stiffness * weights_.array(), 0.0);
    hessian.noalias() += depth.transpose() * springs.asDiagonal() * depth;
  }
}

std::vector<Eigen::Vector3d> WallContact::forces() const {
  std::vector<Eigen::Vector3d> forces;
  for (std::size_t i = 0; i < walls_.size(); ++i) {
    forces.emplace_back(weights_.dot(pressure_.col(static_cast<Eigen::Index>(i))) *
                        walls_[i].normal);
  }
  return forces;
}

Eigen::Vector3d WallContact::moment(const Eigen::MatrixX3d& tangents) const {
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  if (!any()) return moment;
  const Eigen::MatrixX3d points = position_ * tangents;
  for (std::size_t i = 0; i < walls_.size(); ++i) {
    const Eigen::Vector3d lever =
        points.transpose() * weights_.cwiseProduct(pressure_.col(static_cast<Eigen::Index>(i)));
    moment += lever.cross(walls_[i].normal);
  }
  return moment;
}

}  // namespace dlo::energy_model
