#include "strain/grip_rows.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "base/spin.hpp"
#include "frames/position_operator.hpp"

namespace dlo::energy_model {

void GripRows::reset(const Span& span, const std::vector<Element>& elements,
                     const LegendreTable& table) {
  axes_ = span.planar ? 2 : 3;
  holds_ = span.holds;
  reach_.resize(std::ssize(elements) * table.nodes.size(), std::ssize(holds_));
  reach_signs_.clear();
  directions_.clear();
  if (holds_.empty()) return;
  const PositionOperator reach(span, elements, table);
  const auto add = [&](Eigen::Index hold, Eigen::Index element, const Eigen::Vector3d& to) {
    // A planar shape bends about d1.
    const Eigen::Matrix3d frame = frame_along(to, Span::d1(to));
    directions_.push_back({hold, element, to, frame.col(0)});
    if (!span.planar) directions_.push_back({hold, element, to, frame.col(1)});
  };
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    const Span::Hold& held = holds_[static_cast<std::size_t>(j)];
    const Eigen::Index before = elements_before(elements, held.at);
    reach_.col(j) = reach.begin(before);
    reach_signs_.push_back(reach.signs(held.at));
    if (held.direction) add(j, before - 1, *held.direction);
  }
  if (!span.end_direction) return;
  const Eigen::Index hold = std::ssize(holds_) - 1;
  const Eigen::Index element = std::ssize(elements) - 1;
  add(hold, element, *span.end_direction);
  if (!span.twist) return;
  directions_.push_back({.hold = hold, .element = element, .of_d1 = true});
  turn_end_clamp(*span.end_direction, span.twist->end_d1);
}

void GripRows::reset_in_plane(const PlanarFrames& frames) {
  direction_derivatives_.resize(directions(), frames.by_unknown().cols());
  for (Eigen::Index i = 0; i < directions(); ++i) {
    DirectionRow& row = directions_[static_cast<std::size_t>(i)];
    direction_derivatives_.row(i) = frames.angle_derivatives_after(row.element);
    row.angle = frames.angle_towards(row.to, row.element);
  }
}

void GripRows::turn_end_clamp(const Eigen::Vector3d& direction, const Eigen::Vector3d& d1) {
  const Eigen::Matrix3d frame = frame_along(direction, d1);
  directions_.back().to = frame.col(0);
  directions_.back().across = frame.col(1);
}

DirectionResidual GripRows::residual_of(const DirectionRow& row, const SpatialPoint& at) {
  const Eigen::Matrix3d frame = at.frames.frame_after(at.state, row.element);
  Eigen::Vector3d p = frame.col(2);
  if (row.of_d1) p = std::cos(at.psi) * frame.col(0) + std::sin(at.psi) * frame.col(1);
  const Eigen::Vector3d& to = row.to;
  const double n = row.across.dot(p);
  const double d = 1 + to.dot(p);
  const Eigen::Vector3d gradient = 2 * (row.across / d - n / (d * d) * to);
  const Eigen::Matrix3d second =
      -2 / (d * d) * (row.across * to.transpose() + to * row.across.transpose()) +
      4 * n / (d * d * d) * to * to.transpose();
  const Eigen::Matrix3d turn = cross_matrix(p);
  return {2 * n / d, p.cross(gradient),
          spin_hessian(p, gradient) + turn.transpose() * second * turn};
}

void GripRows::constrain(const PlanarPoint& at, Eigen::Ref<Eigen::VectorXd> residual,
                         Eigen::Ref<Eigen::MatrixXd> jacobian) const {
  Eigen::Index row = 0;
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    const Eigen::Vector3d& offset = holds_[static_cast<std::size_t>(j)].offset;
    for (Eigen::Index axis = 0; axis < 2; ++axis, ++row) {
      residual[row] = at.tangents.col(axis).dot(reach_.col(j)) - offset[axis];
      at.frames.adjoint(reach_.col(j), axis, at.state);
      jacobian.row(row) = at.state.by_unknown.transpose();
    }
  }
  if (directions_.empty()) return;
  jacobian.bottomRows(directions()) = direction_derivatives_;
  residual.tail(directions()).noalias() = direction_derivatives_ * at.x;
  row = residual.size() - directions();
  for (const DirectionRow& direction_row : directions_) {
    residual[row++] += at.frames.start_theta() - direction_row.angle;
  }
}

void GripRows::constrain(const SpatialPoint& at, Eigen::Ref<Eigen::VectorXd> residual,
                         Eigen::Ref<Eigen::MatrixXd> jacobian) const {
  const Eigen::Index strains = at.strains();
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    const auto hold = static_cast<std::size_t>(j);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      residual[3 * j + axis] = at.tangents.col(axis).dot(reach_.col(j)) - holds_[hold].offset[axis];
    }
    at.frames.position_jacobian(reach_signs_[hold], at.state, jacobian.middleRows(3 * j, 3));
    if (at.twist_root > 0) jacobian.col(strains).segment<3>(3 * j).setZero();
  }
  if (!directions_.empty()) at.frames.end_rotation_jacobian(at.state);
  Eigen::Index row = residual.size() - directions();
  for (const DirectionRow& direction_row : directions_) {
    const DirectionResidual own = residual_of(direction_row, at);
    residual[row] = own.value;
    at.frames.couple_adjoint(direction_row.element, own.couple, at.state,
                             jacobian.row(row).head(strains));
    // Twist rotates d1 about the tangent.
    if (at.twist_root > 0) {
      jacobian(row, strains) =
          direction_row.of_d1 ? own.couple.dot(at.state.end_frame().col(2)) / at.twist_root : 0;
    }
    ++row;
  }
}

void GripRows::add_forces(const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                          Eigen::MatrixX3d& carried) const {
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    for (Eigen::Index axis = 0; axis < axes_; ++axis) {
      carried.col(axis) += multipliers[j * axes_ + axis] * reach_.col(j);
    }
  }
}

void GripRows::rotation_derivatives(const SpatialPoint& at,
                                    const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                    std::vector<Eigen::Vector3d>& couples,
                                    std::vector<Eigen::Matrix3d>& curvatures) const {
  for (Eigen::Vector3d& couple : couples) couple.setZero();
  for (Eigen::Matrix3d& curvature : curvatures) curvature.setZero();
  Eigen::Index row = multipliers.size() - directions();
  for (const DirectionRow& direction_row : directions_) {
    const double mu = multipliers[row++];
    const DirectionResidual own = residual_of(direction_row, at);
    couples[static_cast<std::size_t>(direction_row.element)] -= mu * own.couple;
    curvatures[static_cast<std::size_t>(direction_row.element)] -= mu * own.curvature;
  }
}

/// Uses that psi rotates d1 about the tangent t before the strains rotate it: the composition is
/// the sum of both rotation vectors plus half their cross product.
void GripRows::add_twist_hessian(const SpatialPoint& at, double factor,
                                 Eigen::MatrixXd& hessian) const {
  const Eigen::Index strains = at.strains();
  const Eigen::Vector3d t = at.state.end_frame().col(2);
  const DirectionResidual own = residual_of(directions_.back(), at);
  const Eigen::Vector3d turned = own.curvature * t;
  const Eigen::Vector3d mixed = factor / at.twist_root * (turned + t.cross(own.couple) / 2);
  auto column = hessian.col(strains).head(strains);
  column.noalias() = at.state.ends.transpose() * mixed;
  hessian.row(strains).head(strains) = column.transpose();
  hessian(strains, strains) += factor * t.dot(turned) / (at.twist_root * at.twist_root);
}

void GripRows::tilt_jacobian(const PlanarFrames& frames, Eigen::MatrixXd& jacobian) const {
  const Eigen::MatrixXd& angle = frames.by_unknown();
  jacobian.resize(reach_.cols() + directions(), angle.cols());
  jacobian.topRows(reach_.cols()).noalias() = reach_.transpose() * angle;
  jacobian.bottomRows(directions()) = direction_derivatives_;
}

double GripRows::gap(const Eigen::Matrix3Xd& tangents) const {
  double squared = 0;
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    const Span::Hold& hold = holds_[static_cast<std::size_t>(j)];
    squared += (tangents * reach_.col(j) - hold.offset).squaredNorm();
  }
  return std::sqrt(squared);
}

void GripRows::unwrap(const Eigen::Ref<const Eigen::VectorXd>& x, double start_theta) {
  for (Eigen::Index i = 0; i < directions(); ++i) {
    double& angle = directions_[static_cast<std::size_t>(i)].angle;
    angle = nearest_equivalent_angle(angle, start_theta + direction_derivatives_.row(i).dot(x));
  }
}

Eigen::Vector3d GripRows::torque(Eigen::Index hold, const Eigen::VectorXd& multipliers,
                                 const SpatialPoint* at) const {
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
  Eigen::Index row = multipliers.size() - directions();
  for (const DirectionRow& direction_row : directions_) {
    const double mu = multipliers[row++];
    if (direction_row.hold != hold) continue;
    if (at == nullptr) {
      torque.z() += mu;
    } else {
      torque += mu * residual_of(direction_row, *at).couple;
    }
  }
  return torque;
}

}  // namespace dlo::energy_model
