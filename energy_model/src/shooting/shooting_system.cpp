#include "shooting/shooting_system.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace dlo::energy_model {
namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

/// The rotation b a^T by its axis, as long as its angle.
Eigen::Vector3d rotation_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  const Eigen::AngleAxisd rotation(Eigen::Matrix3d(b * a.transpose()));
  return rotation.angle() * rotation.axis();
}

/// Its derivative by a spin of b; that by a spin of a is less its transpose.
Eigen::Matrix3d rotation_rate(const Eigen::Vector3d& rotation) {
  const double angle = rotation.norm();
  const double half = angle / 2;
  // (1 - x cot x) / (2 x)^2 and its limit, whose next term is of the size of rounding.
  const double share =
      half < 1e-4 ? 1.0 / 12 : (1 - half * std::cos(half) / std::sin(half)) / (angle * angle);
  const Eigen::Matrix3d cross = cross_matrix(rotation);
  return Eigen::Matrix3d::Identity() - cross / 2 + share * cross * cross;
}

/// Two axes across a direction.
Eigen::Matrix<double, 3, 2> axes_across(const Eigen::Vector3d& direction) {
  Eigen::Matrix<double, 3, 2> axes;
  const Eigen::Vector3d first = direction.unitOrthogonal();
  axes << first, direction.cross(first);
  return axes;
}

double unit_of_force(const RodSpan& span, const std::vector<RodState>& start) {
  double force = std::max(1.0, total_load(span));
  for (const RodState& state : start) {
    force = std::max({force, state.n.norm(), state.m.squaredNorm()});
  }
  return force;
}

}  // namespace

/// Equations as they come.
struct ShootingSystem::Rows {
  struct Block {
    Eigen::Index column;
    Eigen::MatrixXd values;
  };
  Eigen::VectorXd values;
  Triplets* derivatives;
  Eigen::Index row;

  void add(const Eigen::VectorXd& value, const std::vector<Block>& blocks) {
    values.segment(row, value.size()) = value;
    if (derivatives != nullptr) {
      for (const Block& block : blocks) {
        for (Eigen::Index i = 0; i < block.values.rows(); ++i) {
          for (Eigen::Index j = 0; j < block.values.cols(); ++j) {
            derivatives->emplace_back(static_cast<int>(row + i), static_cast<int>(block.column + j),
                                      block.values(i, j));
          }
        }
      }
    }
    row += value.size();
  }
};

ShootingSystem::ShootingSystem(const RodSpan& span, const RodMesh& mesh, const ClampFrames& frames,
                               const ShootingOptions& options, const std::vector<RodState>& start)
    : span_(span),
      mesh_(mesh),
      tolerance_(options.tolerance),
      deadline_(options.deadline),
      rate_(std::sqrt(unit_of_force(span, start))),
      positions_(Eigen::Matrix3d::Identity()),
      turns_(Eigen::Matrix3d::Identity()) {
  const bool planar = options.motion == Motion::in_plane;
  if (planar) {
    positions_.resize(3, 2);
    positions_ << span.plane->x, span.plane->y;
    turns_ = span.plane->x.cross(span.plane->y);
  }
  for (const double s : mesh.s) {
    const RodSpan::Clamp* clamp = span.clamp_at(s);
    clamps_.push_back(clamp);
    frames_.push_back(clamp == nullptr
                          ? std::nullopt
                          : frames[static_cast<std::size_t>(clamp - span.clamps.data())]);
  }
  for (const RodState& state : start) {
    start_.push_back(planar ? in_plane(state) : state);
  }
}

RodState ShootingSystem::in_plane(const RodState& state) const {
  const auto projected = [&](const Eigen::Vector3d& v) {
    return Eigen::Vector3d(positions_ * (positions_.transpose() * v));
  };
  const Eigen::Vector3d& base = span_.holds.front().position;
  RodState result;
  result.r = base + projected(state.r - base);
  result.R = transported(state.R, projected(state.t()).normalized());
  result.m = turns_ * (turns_.transpose() * state.m);
  result.n = projected(state.n);
  return result;
}

std::vector<RodState> ShootingSystem::moved(const std::vector<RodState>& nodes,
                                            const Eigen::VectorXd& step) const {
  const Eigen::Index positions = positions_.cols();
  const Eigen::Index turns = turns_.cols();
  std::vector<RodState> result = nodes;
  Eigen::Index at = 0;
  for (RodState& state : result) {
    state.r += positions_ * step.segment(at, positions);
    state.R = rotation_by(turns_ * step.segment(at + spin_at(), turns)) * state.R;
    state.m += rate_ * (turns_ * step.segment(at + m_at(), turns));
    state.n += rate_ * rate_ * (positions_ * step.segment(at + n_at(), positions));
    at += per_node();
  }
  return result;
}

double ShootingSystem::turn(const std::vector<RodState>& nodes, const Eigen::VectorXd& step) const {
  double largest = 0;
  Eigen::Index at = spin_at();
  for (const RodState& node : nodes) {
    const Eigen::Vector3d spin = turns_ * step.segment(at, turns_.cols());
    largest = std::max(largest, spin.cross(node.t()).norm());
    at += per_node();
  }
  return largest;
}

bool ShootingSystem::evaluate(const std::vector<RodState>& nodes, Eigen::VectorXd& equations,
                              Triplets* derivatives) const {
  Rows rows{Eigen::VectorXd(size()), derivatives, 0};
  start_equations(nodes.front(), rows);
  for (Eigen::Index i = 0; i < mesh_.intervals(); ++i) {
    if (out_of_time() || !interval_equations(nodes, i, rows)) return false;
  }
  // Where a clamp holds the end, its conditions came in place of what is continuous elsewhere.
  const Eigen::Index last = mesh_.intervals() * per_node();
  const auto one = [](Eigen::Index size) { return Eigen::MatrixXd::Identity(size, size); };
  rows.add(positions_.transpose() * nodes.back().n / (rate_ * rate_),
           {{last + n_at(), one(positions_.cols())}});
  rows.add(turns_.transpose() * nodes.back().m / rate_, {{last + m_at(), one(turns_.cols())}});
  equations = std::move(rows.values);
  return equations.allFinite();
}

double ShootingSystem::gap(const std::vector<RodState>& nodes) const {
  Eigen::VectorXd equations;
  if (!evaluate(nodes, equations, nullptr)) return std::numeric_limits<double>::infinity();
  double largest = equations.cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (clamps_[i] == nullptr) continue;
    largest = std::max(largest, (nodes[i].t() - clamps_[i]->direction).cwiseAbs().maxCoeff());
  }
  return largest;
}

Eigen::Matrix3Xd ShootingSystem::frame_equations(const RodState& node, Eigen::Index i,
                                                 Rows& rows) const {
  const auto index = static_cast<std::size_t>(i);
  const Eigen::Index column = i * per_node() + spin_at();
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

void ShootingSystem::start_equations(const RodState& node, Rows& rows) const {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(positions_.cols(), positions_.cols());
  if (mesh_.hold.front() != nullptr) {
    rows.add(positions_.transpose() * (node.r - mesh_.hold.front()->position), {{0, one}});
  } else {
    const Eigen::Vector3d n = node.n + mesh_.load.col(0);
    rows.add(positions_.transpose() * n / (rate_ * rate_), {{n_at(), one}});
  }
  const Eigen::Index free = frame_equations(node, 0, rows).cols();
  if (free == turns_.cols()) return;
  if (free > 0) {
    const Eigen::RowVector3d direction = clamps_.front()->direction.transpose();
    rows.add(direction * node.m / rate_, {{m_at(), direction}});
  } else if (span_.clamps.empty() && span_.round() && turns_.cols() == 3) {
    const Eigen::Matrix<double, 3, 2> across = axes_across(start_.front().t());
    rows.add(across.transpose() * node.m / rate_, {{m_at(), across.transpose()}});
    const Eigen::Vector3d rotation = rotation_between(start_.front().R, node.R);
    const Eigen::RowVector3d tangent = start_.front().t().transpose();
    rows.add(tangent * rotation, {{spin_at(), tangent * rotation_rate(rotation)}});
  } else {
    rows.add(turns_.transpose() * node.m / rate_,
             {{m_at(), Eigen::MatrixXd::Identity(turns_.cols(), turns_.cols())}});
  }
}

bool ShootingSystem::interval_equations(const std::vector<RodState>& nodes, Eigen::Index i,
                                        Rows& rows) const {
  const Eigen::Index positions = positions_.cols();
  const Eigen::Index turns = turns_.cols();
  const RodState& node = nodes[static_cast<std::size_t>(i)];
  const RodState& next = nodes[static_cast<std::size_t>(i + 1)];
  const double force = rate_ * rate_;
  RodState end = node;
  RodVariation change(rows.derivatives != nullptr ? 2 * turns + positions : 0);
  if (rows.derivatives != nullptr) {
    change.spin.leftCols(turns) = turns_;
    change.m.middleCols(turns, turns) = rate_ * turns_;
    change.n.rightCols(positions) = force * positions_;
  }
  RodIntegrals integrals;
  if (!follow_rod(mesh_.section_of(i), span_.natural, mesh_.s[i], mesh_.width(i), tolerance_, end,
                  change, integrals)) {
    return false;
  }
  const Eigen::Index own = i * per_node();
  const Eigen::Index other = own + per_node();
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(positions, positions);
  rows.add(positions_.transpose() * (end.r - next.r),
           {{own, one}, {own + spin_at(), positions_.transpose() * change.r}, {other, -one}});
  const Eigen::Vector3d rotation = rotation_between(next.R, end.R);
  const Eigen::Matrix3d rate = rotation_rate(rotation);
  rows.add(turns_.transpose() * rotation,
           {{own + spin_at(), turns_.transpose() * rate * change.spin},
            {other + spin_at(), -turns_.transpose() * rate.transpose() * turns_}});
  if (const RodSpan::Hold* hold = mesh_.hold[static_cast<std::size_t>(i + 1)]) {
    rows.add(positions_.transpose() * (next.r - hold->position), {{other, one}});
  } else {
    rows.add(positions_.transpose() * (end.n - mesh_.load.col(i + 1) - next.n) / force,
             {{own + n_at(), one}, {other + n_at(), -one}});
  }
  const Eigen::Matrix3Xd free = frame_equations(next, i + 1, rows);
  if (free.cols() == turns) return true;
  // What of the moment is continuous, but for what pulls the tangent: m = ... - t x q.
  const Eigen::MatrixXd kept =
      free.cols() == 0
          ? Eigen::MatrixXd(turns_.transpose())
          : Eigen::MatrixXd(clamps_[static_cast<std::size_t>(i + 1)]->direction.transpose());
  const Eigen::Vector3d q = mesh_.pull.col(i + 1);
  const Eigen::Matrix3d by_spin =
      next.t() * q.transpose() - next.t().dot(q) * Eigen::Matrix3d::Identity();
  rows.add(kept * (end.m - next.t().cross(q) - next.m) / rate_,
           {{own + spin_at(), kept * change.m / rate_},
            {other + spin_at(), -kept * by_spin * turns_ / rate_},
            {other + m_at(), -kept * turns_}});
  return true;
}

}  // namespace dlo::energy_model
