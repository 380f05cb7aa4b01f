#include <Eigen/Geometry>
#include <cmath>
#include <utility>
#include <vector>

#include "base/spin.hpp"
#include "shooting/shooting_system.hpp"

namespace dlo::energy_model {
namespace {

/// Returns the rotation vector of b a^T: along its axis, as long as its angle [rad].
Eigen::Vector3d rotation_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  const Eigen::AngleAxisd rotation(Eigen::Matrix3d(b * a.transpose()));
  return rotation.angle() * rotation.axis();
}

/// Returns the derivative of rotation_between() by a spin of b. Its derivative by a spin of a is
/// minus the transpose.
Eigen::Matrix3d rotation_rate(const Eigen::Vector3d& rotation) {
  const double angle = rotation.norm();
  const double half = angle / 2;
  // (1 - x cot x) / (2 x)^2 and its limit, whose next term is of the size of rounding
  const double share =
      half < 1e-4 ? 1.0 / 12 : (1 - half * std::cos(half) / std::sin(half)) / (angle * angle);
  const Eigen::Matrix3d cross = cross_matrix(rotation);
  return Eigen::Matrix3d::Identity() - cross / 2 + share * cross * cross;
}

/// Returns two axes across a direction.
Eigen::Matrix<double, 3, 2> axes_across(const Eigen::Vector3d& direction) {
  Eigen::Matrix<double, 3, 2> axes;
  const Eigen::Vector3d first = direction.unitOrthogonal();
  axes << first, direction.cross(first);
  return axes;
}

/// Returns the jump of the moment by the pulls on the tangent and d1 of a node, and its derivative
/// by a spin.
std::pair<Eigen::Vector3d, Eigen::Matrix3d> jump_of_moment(const RodState& node,
                                                           const Eigen::Vector3d& on_tangent,
                                                           const Eigen::Vector3d& on_d1) {
  const Eigen::Vector3d t = node.t();
  const Eigen::Vector3d d1 = node.R.col(0);
  return {t.cross(on_tangent) + d1.cross(on_d1),
          t * on_tangent.transpose() + d1 * on_d1.transpose() -
              (t.dot(on_tangent) + d1.dot(on_d1)) * Eigen::Matrix3d::Identity()};
}

/// Returns a load that follows a cross-section in the axes of space, and its derivative by a spin.
std::pair<Eigen::Vector3d, Eigen::Matrix3d> rotated_load(const RodState& node,
                                                         const Eigen::Vector3d& local_load) {
  const Eigen::Vector3d load = node.R * local_load;
  return {load, -cross_matrix(load)};
}

}  // namespace

/// Equations and derivatives, in the order in which they are added.
struct ShootingSystem::Rows {
  Eigen::VectorXd values;
  Triplets* derivatives;
  Eigen::Index row;

  void add(const Eigen::VectorXd& value, const std::vector<Block>& blocks) {
    values.segment(row, value.size()) = value;
    if (derivatives != nullptr) {
      for (const Block& block : blocks) {
        for (Eigen::Index i = 0; i < block.values.rows(); ++i) {
          for (Eigen::Index j = 0; j < block.values.cols(); ++j) {
            if (block.values(i, j) == 0) continue;
            derivatives->emplace_back(static_cast<int>(row + i), static_cast<int>(block.column + j),
                                      block.values(i, j));
          }
        }
      }
    }
    row += value.size();
  }

  /// Adds combinations of the twelve components of a difference of states, or of its units.
  /// @param blocks  derivatives of the difference
  void add(const Combinations& combinations, const Difference& difference,
           const std::vector<Block>& blocks) {
    std::vector<Block> combined;
    if (derivatives != nullptr) {
      for (const auto& [column, values] : blocks)
        combined.push_back({column, combinations * values});
    }
    add(combinations * difference, combined);
  }
};

/// Returns combinations of three components of a difference of states.
/// @param first  0: r, 3: rotation, 6: m, 9: n
ShootingSystem::Combinations ShootingSystem::combine(Eigen::Index first,
                                                     const Eigen::MatrixX3d& rows) {
  Combinations result = Combinations::Zero(rows.rows(), 12);
  result.middleCols<3>(first) = rows;
  return result;
}

bool ShootingSystem::evaluate(const ShootingPoint& point, Eigen::VectorXd& equations,
                              Triplets* derivatives) const {
  Rows rows{Eigen::VectorXd(equations_), derivatives, 0};
  node_equations(point, 0, {}, {}, rows);
  for (Eigen::Index i = 0; i < mesh_.intervals(); ++i) {
    if (out_of_time() || !interval_equations(point, i, rows)) return false;
  }
  // At the last node n and m are zero. Where a clamp holds the end, its conditions have replaced
  // the continuity of n and m there.
  Difference last = Difference::Zero();
  last.tail<6>() << point.nodes.back().m, point.nodes.back().n;
  const std::vector<Block> by_last = {{mesh_.intervals() * unknowns_per_node(), basis_}};
  rows.add(combine(9, positions_.transpose() / (rate_ * rate_)), last, by_last);
  rows.add(combine(6, turns_.transpose() / rate_), last, by_last);
  equations = std::move(rows.values);
  return equations.allFinite();
}

Eigen::MatrixX3d ShootingSystem::frame_equations(const RodState& node, Eigen::Index i,
                                                 Rows& rows) const {
  const auto index = static_cast<std::size_t>(i);
  const Eigen::Index column = i * unknowns_per_node();
  const bool planar = turns_.cols() == 1;
  const auto add = [&](const Eigen::VectorXd& value, const Eigen::MatrixX3d& by_spin) {
    rows.add(value, {{column, by_spin * basis_.middleRows<3>(3)}});
  };
  const RodSpan::Clamp* clamp = clamps_[index];
  if (clamp == nullptr) {
    if (i > 0 || planar || !span_.clamps.empty() || !span_.round()) return turns_.transpose();
    const Eigen::Vector3d& t = start_.front().t();
    const Eigen::Vector3d rotation = rotation_between(start_.front().R, node.R);
    add(t.transpose() * rotation, t.transpose() * rotation_rate(rotation));
    return axes_across(t).transpose();
  }
  if (frames_[index] && !planar) {
    const Eigen::Vector3d rotation = rotation_between(*frames_[index], node.R);
    add(rotation, rotation_rate(rotation));
    return Eigen::MatrixX3d(0, 3);
  }
  const Eigen::Vector3d& direction = clamp->direction;
  const Eigen::Vector3d normal = turns_.col(0);
  const Eigen::MatrixX3d across = planar ? Eigen::MatrixX3d(normal.cross(direction).transpose())
                                         : Eigen::MatrixX3d(axes_across(direction).transpose());
  // d(b . t) = b . (spin x t)
  add(across * node.t(), -across * cross_matrix(node.t()));
  return planar ? Eigen::MatrixX3d(0, 3) : Eigen::MatrixX3d(direction.transpose());
}

void ShootingSystem::contact_equations(const RodState& node, Eigen::Index i, Rows& rows) const {
  const Eigen::Index column = i * unknowns_per_node();
  const RodContact* contact = contact_at(i);
  if (contact != nullptr && contact->touched) {
    const obstacle::Gap gap = contact->gap(node.r);
    rows.add(Eigen::VectorXd::Constant(1, gap.value),
             {{column, gap.gradient.transpose() * basis_.topRows<3>()}});
    if (contact->is_position_unknown) {
      rows.add(Eigen::VectorXd::Constant(1, gap.gradient.dot(node.t())),
               {{column, (gap.hessian * node.t()).transpose() * basis_.topRows<3>() +
                             node.t().cross(gap.gradient).transpose() * basis_.middleRows<3>(3)}});
    }
  }
  const Surface* surface = i < mesh_.intervals() ? mesh_.contacts.surface_of(i) : nullptr;
  if (surface == nullptr || (i > 0 && mesh_.contacts.surface_of(i - 1) != nullptr)) return;
  const LyingConditions lying = lying_conditions(*surface, mesh_.section_of(i), node);
  const Eigen::Vector4d unit(1, 1, 1 / rate_, 1 / (rate_ * rate_));
  rows.add(unit.cwiseProduct(lying.values),
           {{column, unit.asDiagonal() * lying.by_state * basis_}});
}

void ShootingSystem::node_equations(const ShootingPoint& point, Eigen::Index i,
                                    const RodState& before, std::vector<Block> by_before,
                                    Rows& rows) const {
  const RodState& node = point.nodes[static_cast<std::size_t>(i)];
  const Eigen::Index column = i * unknowns_per_node();
  contact_equations(node, i, rows);
  const auto [follows, follows_by_spin] = rotated_load(node, mesh_.follower_load.col(i));
  const auto [couple, couple_by_spin] = rotated_load(node, mesh_.follower_couple.col(i));
  // Jump of the moment by pulls on the tangent and d1: m = ... - t x q.
  const auto [jump, jump_by_spin] =
      jump_of_moment(node, mesh_.tangent_force.col(i), mesh_.d1_force.col(i));
  Difference difference = Difference::Zero();
  difference.segment<3>(6) = before.m - mesh_.couple.col(i) - couple - jump - node.m;
  difference.tail<3>() = before.n - mesh_.load.col(i) - follows - node.n;
  Eigen::Matrix<double, 12, 12> by_node = Eigen::Matrix<double, 12, 12>::Zero();
  by_node.bottomRightCorner<6, 6>() = -Eigen::Matrix<double, 6, 6>::Identity();
  by_node.block<3, 3>(6, 3) = -couple_by_spin - jump_by_spin;
  by_node.block<3, 3>(9, 3) = -follows_by_spin;
  if (const RodContact* contact = contact_at(i)) {
    const auto index = static_cast<std::size_t>(contacts_[static_cast<std::size_t>(i)]);
    const obstacle::Gap gap = contact->gap(node.r);
    difference.tail<3>() -= point.forces[index] * gap.gradient;
    by_node.block<3, 3>(9, 0) = -point.forces[index] * gap.hessian;
    by_before.push_back({force_[index], Difference::Zero()});
    by_before.back().values.bottomRows(3) = -rate_ * rate_ * gap.gradient;
  }
  if (rows.derivatives != nullptr) by_before.push_back({column, by_node * basis_});
  if (const RodSpan::Hold* hold = mesh_.hold[static_cast<std::size_t>(i)]) {
    rows.add(positions_.transpose() * (node.r - hold->position),
             {{column, positions_.transpose() * basis_.topRows<3>()}});
  } else {
    rows.add(combine(9, positions_.transpose() / (rate_ * rate_)), difference, by_before);
  }
  const Eigen::MatrixX3d continuous = frame_equations(node, i, rows);
  rows.add(combine(6, continuous / rate_), difference, by_before);
}

std::vector<ShootingSystem::Block> ShootingSystem::width_derivatives(
    Eigen::Index i, const Difference& by_width) const {
  std::vector<Block> blocks;
  if (shares_.empty()) return blocks;
  const Share& share = shares_[static_cast<std::size_t>(i)];
  const Eigen::Index before = arc_length_[static_cast<std::size_t>(share.before)];
  const Eigen::Index after = arc_length_[static_cast<std::size_t>(share.after)];
  if (before >= 0) blocks.push_back({before, -share.width * by_width});
  if (after >= 0) blocks.push_back({after, share.width * by_width});
  return blocks;
}

bool ShootingSystem::interval_equations(const ShootingPoint& point, Eigen::Index i,
                                        Rows& rows) const {
  const RodState& next = point.nodes[static_cast<std::size_t>(i + 1)];
  RodElement piece = rod_element(span_, mesh_, i);
  piece.begin = point.s[i];
  piece.length = point.s[i + 1] - point.s[i];
  // The end of an interval without a surface moves as its begin moves; on a surface the pressure
  // depends on r.
  const Eigen::Index shifts = piece.surface == nullptr ? positions_.cols() : 0;
  const Eigen::Index column = i * unknowns_per_node();
  RodState end = point.nodes[static_cast<std::size_t>(i)];
  RodVariation change(12, 0);
  if (rows.derivatives != nullptr) change = basis_.rightCols(unknowns_per_node() - shifts);
  if (!integrate_rod(piece, tolerance_, end, &change)) return false;
  const Eigen::Vector3d rotation = rotation_between(next.R, end.R);
  std::vector<Block> by_end;
  std::vector<Block> blocks;
  if (rows.derivatives != nullptr) {
    const Eigen::Matrix3d rate = rotation_rate(rotation);
    by_end = width_derivatives(
        i, rate_of({piece.section, piece.natural, point.s[i + 1], 0, piece.surface}, end));
    by_end.push_back({column, basis_.leftCols(shifts)});
    by_end.push_back({column + shifts, change});
    for (Block& block : by_end) {
      block.values.middleRows(3, 3) = rate * block.values.middleRows(3, 3);
    }
    blocks = by_end;
    blocks.push_back({column + unknowns_per_node(), -basis_});
    blocks.back().values.middleRows(3, 3) = -rate.transpose() * basis_.middleRows<3>(3);
  }
  Difference difference = Difference::Zero();
  difference.head<6>() << end.r - next.r, rotation;
  rows.add(basis_.leftCols(positions_.cols() + turns_.cols()).transpose(), difference, blocks);
  node_equations(point, i + 1, end, std::move(by_end), rows);
  return true;
}

}  // namespace dlo::energy_model
