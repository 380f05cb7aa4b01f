#include "strain/soft_contact.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "frames/position_operator.hpp"

namespace dlo::energy_model {

bool is_on_ridge(const obstacle::Gap& gap) { return std::abs(gap.gradient.z()) > 0.5; }

void SoftContact::reset(const TermSetup& setup) {
  obstacles_ = setup.span.soft_obstacles;
  planar_ = setup.span.planar;
  if (obstacles_.empty()) return;
  const PositionOperator reach(setup.span, setup.elements, setup.table);
  weights_ = setup.weights;
  const Eigen::Index Q = setup.table.nodes.size();
  position_.resize(weights_.size(), weights_.size());
  for (Eigen::Index e = 0; e < std::ssize(setup.elements); ++e) {
    const PointOperator along = reach.along(e);
    for (Eigen::Index q = 0; q < Q; ++q) {
      position_.row(e * Q + q) = along.weights(q + 1).transpose();
    }
  }
}

std::vector<SoftContact::PenetratingNode> SoftContact::penetrating_nodes(
    const Eigen::MatrixX3d& tangents) const {
  std::vector<PenetratingNode> result;
  if (obstacles_.empty()) return result;
  const Eigen::MatrixX3d points = position_ * tangents;
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    for (Eigen::Index q = 0; q < weights_.size(); ++q) {
      const Eigen::Vector3d point = points.row(q);
      if (obstacles_[i].body.clearance(point) >= 0) continue;
      result.push_back(
          {i, q, obstacles_[i].body.gap(point), obstacles_[i].stiffness * weights_[q]});
    }
  }
  return result;
}

void SoftContact::evaluate(SpanPoint& at) const {
  for (const PenetratingNode& node : penetrating_nodes(at.t)) {
    at.energy += node.energy();
    at.force.noalias() += position_.row(node.node).transpose() * node.force().transpose();
  }
}

/// Returns the second derivatives of a node's energy by its position. On a ridge, where faces on
/// both sides of a planar span are equally close, the force has a component out of the plane that
/// changes its sign there: the energy decreases linearly to both sides. It is replaced by the
/// quadratic decrease that is equal at a short distance.
Eigen::Matrix3d SoftContact::energy_hessian(const PenetratingNode& at) const {
  constexpr double ridge_width = 1e-3;
  const Eigen::Vector3d& normal = at.gap.gradient;
  Eigen::Matrix3d result = normal * normal.transpose() + at.gap.value * at.gap.hessian;
  if (planar_ && is_on_ridge(at.gap)) result(2, 2) = 1 + 2 * at.gap.value / ridge_width;
  return at.stiffness * result;
}

void SoftContact::add_hessian(const SpanPoint& at, const std::array<Eigen::MatrixXd, 3>& tangents,
                              Eigen::Ref<Eigen::MatrixXd> hessian) const {
  const std::vector<PenetratingNode> nodes = penetrating_nodes(at.t);
  if (nodes.empty()) return;
  Eigen::MatrixXd reach(std::ssize(nodes), position_.cols());
  for (std::size_t p = 0; p < nodes.size(); ++p) {
    reach.row(static_cast<Eigen::Index>(p)) = position_.row(nodes[p].node);
  }
  // By axis: displacements of the nodes by the unknowns, and the resulting forces.
  std::array<Eigen::MatrixXd, 3> moved;
  for (std::size_t axis = 0; axis < 3; ++axis) moved[axis].noalias() = reach * tangents[axis];
  std::array<Eigen::MatrixXd, 3> pushed = moved;
  for (std::size_t p = 0; p < nodes.size(); ++p) {
    const Eigen::Matrix3d by = energy_hessian(nodes[p]);
    const auto row = static_cast<Eigen::Index>(p);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      pushed[static_cast<std::size_t>(axis)].row(row) = by(axis, 0) * moved[0].row(row) +
                                                        by(axis, 1) * moved[1].row(row) +
                                                        by(axis, 2) * moved[2].row(row);
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    hessian.noalias() += moved[axis].transpose() * pushed[axis];
  }
}

void SoftContact::add_energies(const TermSetup& /*setup*/, const SpanPoint& at,
                               Energies& energies) const {
  for (const PenetratingNode& node : penetrating_nodes(at.t)) energies.contact += node.energy();
}

std::vector<Eigen::Vector3d> SoftContact::forces(const SpanPoint& at) const {
  std::vector<Eigen::Vector3d> forces(obstacles_.size(), Eigen::Vector3d::Zero());
  for (const PenetratingNode& node : penetrating_nodes(at.t)) forces[node.obstacle] += node.force();
  return forces;
}

}  // namespace dlo::energy_model
