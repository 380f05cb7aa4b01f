#include "strain/wall_contact.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/legendre.hpp"

namespace dlo::energy_model {

void WallContact::reset(const Span& span, const std::vector<Piece>& pieces,
                        const LegendreTable& table, const Eigen::VectorXd& nodes,
                        const Eigen::VectorXd& weights) {
  walls_ = span.walls;
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
  contact_.setZero(nodes.size(), count);
  pressure_.setZero(nodes.size(), count);
  // Stiff enough that the multipliers settle in a few rounds, soft enough for Newton's method.
  rigid_stiffness_ = 1e6 * (1 + span.total_load()) / (span.length * span.length);
}

double WallContact::stiffness(std::size_t wall) const {
  return std::isfinite(walls_[wall].stiffness) ? walls_[wall].stiffness : rigid_stiffness_;
}

double WallContact::add(const Eigen::MatrixX3d& tangents, Eigen::MatrixX3d& force) {
  points_ = position_ * tangents;
  double energy = 0;
  for (std::size_t i = 0; i < walls_.size(); ++i) {
    const Span::Wall& wall = walls_[i];
    const auto column = static_cast<Eigen::Index>(i);
    const double k = stiffness(i);
    // p = max(0, lambda - k d), energy (p^2 - lambda^2) / 2k, d the clearance
    pressure_.col(column) =
        (contact_.col(column).array() - k * ((points_ * wall.normal).array() + wall.offset))
            .cwiseMax(0.0);
    energy += (weights_.array() *
               (pressure_.col(column).array().square() - contact_.col(column).array().square()))
                  .sum() /
              (2 * k);
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
                                        .select(stiffness(i) * weights_.array(), 0.0);
    hessian.noalias() += depth.transpose() * springs.asDiagonal() * depth;
  }
}

double WallContact::violation() const {
  double largest = 0;
  for (std::size_t i = 0; i < walls_.size(); ++i) {
    if (std::isfinite(walls_[i].stiffness)) continue;
    const auto column = static_cast<Eigen::Index>(i);
    const double change = (pressure_.col(column) - contact_.col(column)).cwiseAbs().maxCoeff();
    largest = std::max(largest, change / rigid_stiffness_);
  }
  return largest;
}

double WallContact::update() {
  const double before = violation();
  for (std::size_t i = 0; i < walls_.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    if (std::isinf(walls_[i].stiffness)) contact_.col(column) = pressure_.col(column);
  }
  return before;
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
