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
};

bool ShootingSystem::evaluate(const ShootingPoint& point, Eigen::VectorXd& equations,
                              Triplets* derivatives) const {
  const std::vector<RodState>& nodes = point.nodes;
  Rows rows{Eigen::VectorXd(equations_), derivatives, 0};
  start_equations(point, rows);
  for (Eigen::Index i = 0; i < mesh_.intervals(); ++i) {
    if (out_of_time() || !interval_equations(point, i, rows)) return false;
  }
  // At the last node n and m are zero. Where a clamp holds the end, its conditions have replaced
  // the continuity of n and m there.
  const Eigen::Index last = mesh_.intervals() * unknowns_per_node();
  const auto one = [](Eigen::Index size) { return Eigen::MatrixXd::Identity(size, size); };
  rows.add(positions_.transpose() * nodes.back().n / (rate_ * rate_),
           {{last + n_index(), one(positions_.cols())}});
  rows.add(turns_.transpose() * nodes.back().m / rate_, {{last + m_index(), one(turns_.cols())}});
  equations = std::move(rows.values);
  return equations.allFinite();
}

Eigen::Matrix3Xd ShootingSystem::frame_equations(const RodState& node, Eigen::Index i,
                                                 Rows& rows) const {
  const auto index = static_cast<std::size_t>(i);
  const Eigen::Index column = i * unknowns_per_node() + spin_index();
  if (frames_[index] && turns_.cols() == 3) {
    const Eigen::Vector3d rotation = rotation_between(*frames_[index], node.R);
    rows.add(rotation, {{column, rotation_rate(rotation)}});
    return turns_;
  }
  if (clamps_[index] == nullptr) {
    Eigen::Matrix3Xd none(3, 0);
    return none;
  }
  const Eigen::Vector3d& direction = clamps_[index]->direction;
  Eigen::Matrix3Xd across = axes_across(direction);
  if (turns_.cols() == 1) across = Eigen::Vector3d(turns_.col(0)).cross(direction);
  // d(b . t) = b . (spin x t) = (t x b) . spin
  Eigen::Matrix3Xd rate(3, across.cols());
  for (Eigen::Index k = 0; k < across.cols(); ++k) {
    rate.col(k) = node.t().cross(Eigen::Vector3d(across.col(k)));
  }
  rows.add(across.transpose() * node.t(), {{column, rate.transpose() * turns_}});
  return turns_.cols() == 1 ? turns_ : across;
}

/// Force that a contact subtracts from n, and its derivatives.
struct ShootingSystem::ContactForceTerm {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  std::vector<Block> by;  // derivatives of minus the force, in its unit

  /// Returns the blocks of the balance of forces together with those of this force.
  [[nodiscard]] std::vector<Block> with(std::vector<Block> blocks) const {
    blocks.insert(blocks.end(), by.begin(), by.end());
    return blocks;
  }
};

ShootingSystem::ContactForceTerm ShootingSystem::contact_force_at(const ShootingPoint& point,
                                                                  Eigen::Index i) const {
  ContactForceTerm push;
  const RodContact* contact = contact_at(i);
  if (contact == nullptr) return push;
  const auto index = static_cast<std::size_t>(contacts_[static_cast<std::size_t>(i)]);
  const obstacle::Gap gap = contact->gap(point.nodes[static_cast<std::size_t>(i)].r);
  push.force = point.forces[index] * gap.gradient;
  push.by = {{force_[index], -positions_.transpose() * gap.gradient},
             {i * unknowns_per_node(), -point.forces[index] / (rate_ * rate_) *
                                           (positions_.transpose() * gap.hessian * positions_)}};
  return push;
}

void ShootingSystem::contact_equations(const RodState& node, Eigen::Index i, Rows& rows) const {
  const Eigen::Index column = i * unknowns_per_node();
  const RodContact* contact = contact_at(i);
  if (contact != nullptr && contact->touched) {
    const obstacle::Gap gap = contact->gap(node.r);
    rows.add(Eigen::VectorXd::Constant(1, gap.value),
             {{column, gap.gradient.transpose() * positions_}});
    if (contact->is_position_unknown) {
      rows.add(Eigen::VectorXd::Constant(1, gap.gradient.dot(node.t())),
               {{column, (gap.hessian * node.t()).transpose() * positions_},
                {column + spin_index(), node.t().cross(gap.gradient).transpose() * turns_}});
    }
  }
  const Surface* surface = i < mesh_.intervals() ? mesh_.contacts.surface_of(i) : nullptr;
  if (surface == nullptr || (i > 0 && mesh_.contacts.surface_of(i - 1) != nullptr)) return;
  const LyingConditions lying = lying_conditions(*surface, mesh_.section_of(i), node);
  const Eigen::Vector4d unit(1, 1, 1 / rate_, 1 / (rate_ * rate_));
  const ByState by = unit.asDiagonal() * lying.by_state;
  rows.add(unit.cwiseProduct(lying.values),
           {{column, by.leftCols<3>() * positions_},
            {column + spin_index(), by.middleCols<3>(3) * turns_},
            {column + m_index(), rate_ * by.middleCols<3>(6) * turns_},
            {column + n_index(), rate_ * rate_ * by.rightCols<3>() * positions_}});
}

void ShootingSystem::start_equations(const ShootingPoint& point, Rows& rows) const {
  const RodState& node = point.nodes.front();
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(positions_.cols(), positions_.cols());
  contact_equations(node, 0, rows);
  if (mesh_.hold.front() != nullptr) {
    rows.add(positions_.transpose() * (node.r - mesh_.hold.front()->position), {{0, one}});
  } else {
    const ContactForceTerm push = contact_force_at(point, 0);
    const auto [follows, by_spin] = rotated_load(node, mesh_.follower_load.col(0));
    const Eigen::Vector3d n = node.n + mesh_.load.col(0) + follows + push.force;
    const double force = rate_ * rate_;
    rows.add(-positions_.transpose() * n / force,
             push.with({{spin_index(), -positions_.transpose() * by_spin * turns_ / force},
                        {n_index(), -one}}));
  }
  const Eigen::Index free = frame_equations(node, 0, rows).cols();
  const auto [follows, by_spin] = rotated_load(node, mesh_.follower_couple.col(0));
  const Eigen::Vector3d m = node.m + mesh_.couple.col(0) + follows;
  const Eigen::MatrixXd turned = by_spin * turns_ / rate_;
  if (free == turns_.cols()) return;
  if (free > 0) {
    const Eigen::RowVector3d direction = clamps_.front()->direction.transpose();
    rows.add(direction * m / rate_, {{spin_index(), direction * turned}, {m_index(), direction}});
  } else if (span_.clamps.empty() && span_.round() && turns_.cols() == 3) {
    const Eigen::Matrix<double, 3, 2> across = axes_across(start_.front().t());
    rows.add(across.transpose() * m / rate_,
             {{spin_index(), across.transpose() * turned}, {m_index(), across.transpose()}});
    const Eigen::Vector3d rotation = rotation_between(start_.front().R, node.R);
    const Eigen::RowVector3d tangent = start_.front().t().transpose();
    rows.add(tangent * rotation, {{spin_index(), tangent * rotation_rate(rotation)}});
  } else {
    rows.add(turns_.transpose() * m / rate_,
             {{spin_index(), turns_.transpose() * turned},
              {m_index(), Eigen::MatrixXd::Identity(turns_.cols(), turns_.cols())}});
  }
}

std::vector<ShootingSystem::Block> ShootingSystem::width_derivatives(
    Eigen::Index i, const Eigen::VectorXd& by_width) const {
  std::vector<Block> blocks;
  if (shares_.empty()) return blocks;
  const Share& share = shares_[static_cast<std::size_t>(i)];
  const Eigen::Index before = arc_length_[static_cast<std::size_t>(share.before)];
  const Eigen::Index after = arc_length_[static_cast<std::size_t>(share.after)];
  if (before >= 0) blocks.push_back({before, -share.width * by_width});
  if (after >= 0) blocks.push_back({after, share.width * by_width});
  return blocks;
}

/// Returns the derivatives of a node's state by its own unknowns.
/// @param placed  number of the unknowns of its position to include, from the first on
RodVariation ShootingSystem::variation_by(Eigen::Index placed) const {
  const Eigen::Index turns = turns_.cols();
  RodVariation change(placed + 2 * turns + positions_.cols());
  change.r.leftCols(placed) = positions_.leftCols(placed);
  change.spin.middleCols(placed, turns) = turns_;
  change.m.middleCols(placed + turns, turns) = rate_ * turns_;
  change.n.rightCols(positions_.cols()) = rate_ * rate_ * positions_;
  return change;
}

bool ShootingSystem::interval_equations(const ShootingPoint& point, Eigen::Index i,
                                        Rows& rows) const {
  const Eigen::Index positions = positions_.cols();
  const RodState& node = point.nodes[static_cast<std::size_t>(i)];
  const RodState& next = point.nodes[static_cast<std::size_t>(i + 1)];
  const double force = rate_ * rate_;
  RodElement piece = rod_element(span_, mesh_, i);
  piece.begin = point.s[i];
  piece.length = point.s[i + 1] - point.s[i];
  // The end of an interval without a surface moves as its begin moves; on a surface the pressure
  // depends on r.
  const Eigen::Index placed = piece.surface != nullptr ? positions : 0;
  RodState end = node;
  RodVariation change = rows.derivatives != nullptr ? variation_by(placed) : RodVariation(0);
  if (!integrate_rod(piece, tolerance_, end, change)) return false;
  const RodRate by_width =
      rate_of({piece.section, piece.natural, point.s[i + 1], 0, piece.surface}, end);
  const Eigen::Index own_index = i * unknowns_per_node();
  const Eigen::Index other = own_index + unknowns_per_node();
  const Eigen::Index from = own_index + (placed > 0 ? 0 : spin_index());
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(positions, positions);
  std::vector<Block> moved = width_derivatives(i, positions_.transpose() * by_width.r);
  moved.push_back({from, positions_.transpose() * change.r});
  moved.push_back({other, -one});
  if (placed == 0) moved.push_back({own_index, one});
  rows.add(positions_.transpose() * (end.r - next.r), moved);
  const Eigen::Vector3d rotation = rotation_between(next.R, end.R);
  const Eigen::Matrix3d rate = rotation_rate(rotation);
  std::vector<Block> turned = width_derivatives(i, turns_.transpose() * rate * by_width.spin);
  turned.push_back({from, turns_.transpose() * rate * change.spin});
  turned.push_back({other + spin_index(), -turns_.transpose() * rate.transpose() * turns_});
  rows.add(turns_.transpose() * rotation, turned);
  contact_equations(next, i + 1, rows);
  if (const RodSpan::Hold* hold = mesh_.hold[static_cast<std::size_t>(i + 1)]) {
    rows.add(positions_.transpose() * (next.r - hold->position), {{other, one}});
  } else {
    const ContactForceTerm push = contact_force_at(point, i + 1);
    const auto [follows, by_spin] = rotated_load(next, mesh_.follower_load.col(i + 1));
    std::vector<Block> pulled = width_derivatives(i, positions_.transpose() * by_width.n / force);
    pulled.push_back({from, positions_.transpose() * change.n / force});
    pulled.push_back({other + spin_index(), -positions_.transpose() * by_spin * turns_ / force});
    pulled.push_back({other + n_index(), -one});
    const Eigen::Vector3d added = mesh_.load.col(i + 1) + follows + push.force;
    rows.add(positions_.transpose() * (end.n - added - next.n) / force,
             push.with(std::move(pulled)));
  }
  const Eigen::Matrix3Xd free = frame_equations(next, i + 1, rows);
  if (free.cols() == turns_.cols()) return true;
  // Components of the moment that are continuous, except for the jump by pulls on the tangent and
  // d1: m = ... - t x q.
  const Eigen::MatrixXd kept =
      free.cols() == 0
          ? Eigen::MatrixXd(turns_.transpose())
          : Eigen::MatrixXd(clamps_[static_cast<std::size_t>(i + 1)]->direction.transpose());
  const auto [jump, by_spin] =
      jump_of_moment(next, mesh_.tangent_force.col(i + 1), mesh_.d1_force.col(i + 1));
  const auto [follows, follows_by_spin] = rotated_load(next, mesh_.follower_couple.col(i + 1));
  std::vector<Block> bent = width_derivatives(i, kept * by_width.m / rate_);
  bent.push_back({from, kept * change.m / rate_});
  bent.push_back({other + spin_index(), -kept * (by_spin + follows_by_spin) * turns_ / rate_});
  bent.push_back({other + m_index(), -kept * turns_});
  rows.add(kept * (end.m - mesh_.couple.col(i + 1) - follows - jump - next.m) / rate_, bent);
  return true;
}

}  // namespace dlo::energy_model
