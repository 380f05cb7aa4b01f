#include "shooting/shooting_system.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace dlo::energy_model {
namespace {

void add_block(Triplets& triplets, Eigen::Index row, Eigen::Index column,
               const Eigen::Ref<const Eigen::MatrixXd>& block) {
  for (Eigen::Index i = 0; i < block.rows(); ++i) {
    for (Eigen::Index j = 0; j < block.cols(); ++j) {
      triplets.emplace_back(static_cast<int>(row + i), static_cast<int>(column + j), block(i, j));
    }
  }
}

/// Angle of a director about a node's tangent, from the node's first direction on.
double frame_angle(const ShootingNode& node, const Eigen::Vector3d& director) {
  return std::atan2(node.across.col(1).dot(director), node.across.col(0).dot(director));
}

/// Its change with the director, a row.
Eigen::RowVector3d frame_angle_rate(const ShootingNode& node, const Eigen::Vector3d& director) {
  const double x = node.across.col(0).dot(director);
  const double y = node.across.col(1).dot(director);
  return (x * node.across.col(1) - y * node.across.col(0)).transpose() / (x * x + y * y);
}

/// Its change as the node's tangent turns: the directions come along.
Eigen::RowVector2d frame_angle_by_turn(const ShootingNode& node, const Eigen::Vector3d& director) {
  const double x = node.across.col(0).dot(director);
  const double y = node.across.col(1).dot(director);
  return Eigen::RowVector2d(y, -x) * node.state.t.dot(director) / (x * x + y * y);
}

}  // namespace

ShootingSystem::ShootingSystem(const RodSpan& span, const RodMesh& mesh,
                               const ShootingOptions& options, double force)
    : span_(span),
      mesh_(mesh),
      tolerance_(options.tolerance),
      deadline_(options.deadline),
      frames_(options.frames),
      rate_(std::sqrt(force)) {
  if (options.planar) {
    axes_.resize(3, 2);
    axes_ << span.plane->x, span.plane->y;
  } else {
    axes_ = Eigen::Matrix3d::Identity();
  }
  layout_.d = axes_.cols();
  layout_.framed = frames_.has_value();
}

ShootingNode ShootingSystem::make_node(const RodState& state) const {
  ShootingNode node;
  node.state.t = (axes_ * (axes_.transpose() * state.t)).normalized();
  node.state.v = axes_ * (axes_.transpose() * state.v);
  node.state.v -= node.state.v.dot(node.state.t) * node.state.t;
  const Eigen::Vector3d& base = span_.holds.front().position;
  node.state.r = base + axes_ * (axes_.transpose() * (state.r - base));
  node.state.n = axes_ * (axes_.transpose() * state.n);
  const Eigen::Vector3d& t = node.state.t;
  node.across.resize(3, layout_.d - 1);
  if (layout_.d == 2) {
    node.across << span_.plane->x.cross(span_.plane->y).cross(t);
  } else {
    const Eigen::Vector3d first =
        frames_ ? (state.d - state.d.dot(t) * t).normalized() : t.unitOrthogonal();
    node.across << first, t.cross(first);
  }
  if (frames_) {
    node.state.torque = state.torque;
    node.state.d = node.across.col(0);
  }
  return node;
}

std::vector<ShootingNode> ShootingSystem::moved(const std::vector<ShootingNode>& nodes,
                                                const Eigen::VectorXd& step) const {
  std::vector<ShootingNode> result = nodes;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Eigen::VectorXd x =
        step.segment(static_cast<Eigen::Index>(i) * layout_.size(), layout_.size());
    const ShootingNode& from = nodes[i];
    RodState& state = result[i].state;
    state.r += axes_ * x.head(layout_.d);
    state.n += rate_ * rate_ * (axes_ * x.segment(layout_.n(), layout_.d));
    state.t = (from.state.t + from.across * x.segment(layout_.t(), layout_.d - 1)).normalized();
    state.v += rate_ * (from.across * x.segment(layout_.v(), layout_.d - 1));
    state.v -= state.v.dot(state.t) * state.t;
    Eigen::Matrix3Xd& across = result[i].across;
    for (Eigen::Index k = 0; k < across.cols(); ++k) {
      across.col(k) -= across.col(k).dot(state.t) * state.t;
      for (Eigen::Index j = 0; j < k; ++j) {
        across.col(k) -= across.col(k).dot(across.col(j)) * across.col(j);
      }
      across.col(k).normalize();
    }
    if (!frames_) continue;
    const Eigen::Matrix3Xd old = across;
    const double turn = x[layout_.frame()];
    across.col(0) = std::cos(turn) * old.col(0) + std::sin(turn) * old.col(1);
    across.col(1) = std::cos(turn) * old.col(1) - std::sin(turn) * old.col(0);
    state.d = across.col(0);
    state.torque += rate_ * x[layout_.torque()];
  }
  return result;
}

bool ShootingSystem::evaluate(const std::vector<ShootingNode>& nodes, Eigen::VectorXd& equations,
                              Triplets* derivatives) const {
  equations.resize(size());
  const Eigen::Index last = mesh_.intervals();
  Eigen::Index row = start_equations(nodes.front(), equations, derivatives);
  for (Eigen::Index i = 0; i < last; ++i) {
    if (deadline_.passed()) return false;
    if (!interval_equations(nodes, i, row, equations, derivatives)) return false;
    row += layout_.size();
  }
  end_equations(nodes.back(), row, equations, derivatives);
  return equations.allFinite();
}

double ShootingSystem::turn(const Eigen::VectorXd& step) const {
  double largest = 0;
  for (Eigen::Index i = 0; i < mesh_.s.size(); ++i) {
    largest =
        std::max(largest, step.segment(i * layout_.size() + layout_.t(), layout_.d - 1).norm());
  }
  return largest;
}

double ShootingSystem::gap(const std::vector<ShootingNode>& nodes) const {
  Eigen::VectorXd equations;
  if (!evaluate(nodes, equations, nullptr)) return INFINITY;
  double largest = equations.cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
    RodState end = nodes[i].state;
    RodIntegrals integrals;
    const auto k = static_cast<Eigen::Index>(i);
    if (!follow_rod(mesh_.section_of(k), mesh_.width(k), tolerance_, end, integrals)) {
      return INFINITY;
    }
    largest = std::max(largest, (end.t - nodes[i + 1].state.t).cwiseAbs().maxCoeff());
  }
  return largest;
}

Eigen::Index ShootingSystem::start_equations(const ShootingNode& node, Eigen::VectorXd& equations,
                                             Triplets* derivatives) const {
  const Eigen::Index d = layout_.d;
  const RodSpan::Hold* hold = mesh_.hold.front();
  const Eigen::Vector3d no_force = -mesh_.load.col(0);
  position_or_force(node, 0, 0, hold, no_force, equations, derivatives);
  direction_or_moment(node, d, 0, span_.start_direction, equations, derivatives);
  if (!frames_) return 2 * d - 1;
  frame_equation(node, 2 * d - 1, 0, frames_->start, equations, derivatives);
  return 2 * d;
}

void ShootingSystem::end_equations(const ShootingNode& node, Eigen::Index row,
                                   Eigen::VectorXd& equations, Triplets* derivatives) const {
  const Eigen::Index column = mesh_.intervals() * layout_.size();
  position_or_force(node, row, column, nullptr, Eigen::Vector3d::Zero(), equations, derivatives);
  direction_or_moment(node, row + layout_.d, column, span_.end_direction, equations, derivatives);
  if (!frames_) return;
  frame_equation(node, row + 2 * layout_.d - 1, column, frames_->end, equations, derivatives);
}

void ShootingSystem::position_or_force(const ShootingNode& node, Eigen::Index row,
                                       Eigen::Index column, const RodSpan::Hold* hold,
                                       const Eigen::Vector3d& force, Eigen::VectorXd& equations,
                                       Triplets* derivatives) const {
  const Eigen::Index d = layout_.d;
  equations.segment(row, d) =
      hold != nullptr
          ? Eigen::VectorXd(axes_.transpose() * (node.state.r - hold->position))
          : Eigen::VectorXd(axes_.transpose() * (node.state.n - force) / (rate_ * rate_));
  if (derivatives == nullptr) return;
  add_block(*derivatives, row, column + (hold != nullptr ? 0 : layout_.n()),
            Eigen::MatrixXd::Identity(d, d));
}

void ShootingSystem::direction_or_moment(const ShootingNode& node, Eigen::Index row,
                                         Eigen::Index column,
                                         const std::optional<Eigen::Vector3d>& direction,
                                         Eigen::VectorXd& equations, Triplets* derivatives) const {
  const Eigen::Index turns = layout_.d - 1;
  const Eigen::Matrix3Xd& across = node.across;
  equations.segment(row, turns) = direction
                                      ? Eigen::VectorXd(-across.transpose() * *direction)
                                      : Eigen::VectorXd(across.transpose() * node.state.v / rate_);
  if (derivatives == nullptr) return;
  const double rate = direction ? node.state.t.dot(*direction) : 1;
  add_block(*derivatives, row, column + (direction ? layout_.t() : layout_.v()),
            rate * Eigen::MatrixXd::Identity(turns, turns));
}

void ShootingSystem::frame_equation(const ShootingNode& node, Eigen::Index row, Eigen::Index column,
                                    const Eigen::Vector3d& director, Eigen::VectorXd& equations,
                                    Triplets* derivatives) const {
  equations[row] = frame_angle(node, director);
  if (derivatives == nullptr) return;
  add_block(*derivatives, row, column + layout_.t(), frame_angle_by_turn(node, director));
  add_block(*derivatives, row, column + layout_.frame(), Eigen::MatrixXd::Constant(1, 1, -1));
}

void ShootingSystem::twist_equations(const ShootingNode& node, const ShootingNode& next,
                                     Eigen::Index i, Eigen::Index row, const RodState& end,
                                     const RodVariation& change, Eigen::VectorXd& equations,
                                     Triplets* derivatives) const {
  const Eigen::Vector3d& director = end.d;
  equations[row + layout_.frame()] = frame_angle(next, director);
  equations[row + layout_.torque()] = (node.state.torque - next.state.torque) / rate_;
  if (derivatives == nullptr) return;
  const Eigen::RowVector3d rate = frame_angle_rate(next, director);
  const double rate_by_turn = rate.dot(end.t.cross(director));
  // The director turns about the tangent, and along with it.
  const double turn_by_torque = mesh_.width(i) / mesh_.section_of(i).torsion;
  const Eigen::RowVectorXd turns = change.turn + turn_by_torque * change.torque;
  const Eigen::RowVectorXd by_parameter =
      rate_by_turn * turns - rate.dot(end.t) * (director.transpose() * change.t);
  const Eigen::Index own = i * layout_.size();
  const Eigen::Index other = own + layout_.size();
  const Eigen::Index bends = layout_.n();  // of t, v and n
  add_block(*derivatives, row + layout_.frame(), own + layout_.t(), by_parameter.head(bends));
  const auto add = [&](Eigen::Index equation, Eigen::Index unknown, double value) {
    derivatives->emplace_back(static_cast<int>(row + equation), static_cast<int>(unknown), value);
  };
  add(layout_.frame(), own + layout_.frame(), rate_by_turn);
  add(layout_.frame(), own + layout_.torque(), by_parameter[bends]);
  add_block(*derivatives, row + layout_.frame(), other + layout_.t(),
            frame_angle_by_turn(next, director));
  add(layout_.frame(), other + layout_.frame(), -1);
  add(layout_.torque(), own + layout_.torque(), 1);
  add(layout_.torque(), other + layout_.torque(), -1);
  add_block(*derivatives, row, own + layout_.torque(), change.r.col(bends));
  add_block(*derivatives, row + layout_.t(), own + layout_.torque(),
            next.across.transpose() * change.t.col(bends));
  add_block(*derivatives, row + layout_.v(), own + layout_.torque(),
            mesh_.section_of(i).bending / rate_ * next.across.transpose() * change.v.col(bends));
}

bool ShootingSystem::interval_equations(const std::vector<ShootingNode>& nodes, Eigen::Index i,
                                        Eigen::Index row, Eigen::VectorXd& equations,
                                        Triplets* derivatives) const {
  const Eigen::Index d = layout_.d;
  const Eigen::Index turns = d - 1;
  const ShootingNode& node = nodes[static_cast<std::size_t>(i)];
  const ShootingNode& next = nodes[static_cast<std::size_t>(i + 1)];
  const RodSpan::Hold* hold = mesh_.hold[static_cast<std::size_t>(i + 1)];
  RodState end = node.state;
  RodIntegrals integrals;
  const Eigen::Index bends = 2 * turns + d;  // parameters: those of t, v and n
  RodVariation change(derivatives != nullptr ? bends + (frames_ ? 1 : 0) : 0);
  if (derivatives != nullptr) {
    change.t.leftCols(turns) = node.across;
    change.v.leftCols(turns) = -node.state.t * (node.state.v.transpose() * node.across);
    change.v.middleCols(turns, turns) = rate_ * node.across;
    change.n.middleCols(2 * turns, d) = rate_ * rate_ * axes_;
    if (frames_) change.torque[bends] = rate_;
  }
  if (!follow_rod(mesh_.section_of(i), mesh_.width(i), tolerance_, end, change, integrals)) {
    return false;
  }
  const double force = rate_ * rate_;
  // The moment is continuous: b v, with the stiffness on either side; across the tangent.
  const double before = mesh_.section_of(i).bending;
  const double after = mesh_.section_of(std::min(i + 1, mesh_.intervals() - 1)).bending;
  const Eigen::Vector3d bv = before * end.v - mesh_.pull.col(i + 1);
  equations.segment(row, d) = axes_.transpose() * (end.r - next.state.r);
  equations.segment(row + layout_.t(), turns) = next.across.transpose() * end.t;
  equations.segment(row + layout_.v(), turns) =
      next.across.transpose() * (bv - after * next.state.v) / rate_;
  if (hold != nullptr) {
    equations.segment(row + layout_.n(), d) = axes_.transpose() * (next.state.r - hold->position);
  } else {
    equations.segment(row + layout_.n(), d) =
        axes_.transpose() * (end.n - mesh_.load.col(i + 1) - next.state.n) / force;
  }
  if (frames_) twist_equations(node, next, i, row, end, change, equations, derivatives);
  if (derivatives == nullptr) return true;

  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(d, d);
  const Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(turns, turns);
  const Eigen::Index own = i * layout_.size();
  const Eigen::Index other = own + layout_.size();
  add_block(*derivatives, row, own, one);
  add_block(*derivatives, row, own + d, axes_.transpose() * change.r.leftCols(bends));
  add_block(*derivatives, row + layout_.t(), own + d,
            next.across.transpose() * change.t.leftCols(bends));
  add_block(*derivatives, row + layout_.v(), own + d,
            before / rate_ * next.across.transpose() * change.v.leftCols(bends));
  add_block(*derivatives, row, other, -one);
  // `across` turns with the next tangent, v keeps its components in it.
  add_block(*derivatives, row + layout_.t(), other + layout_.t(), -next.state.t.dot(end.t) * turn);
  add_block(*derivatives, row + layout_.v(), other + layout_.t(),
            -next.state.t.dot(bv) / rate_ * turn);
  add_block(*derivatives, row + layout_.v(), other + layout_.v(), -after * turn);
  if (hold != nullptr) {
    add_block(*derivatives, row + layout_.n(), other, one);
  } else {
    add_block(*derivatives, row + layout_.n(), own + layout_.n(), one);
    add_block(*derivatives, row + layout_.n(), other + layout_.n(), -one);
  }
  return true;
}

}  // namespace dlo::energy_model
