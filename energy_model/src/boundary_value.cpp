#include "boundary_value.hpp"

#include <Eigen/Geometry>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <Eigen/SparseQR>
#include <algorithm>
#include <cmath>
#include <optional>

namespace dlo::energy_model {
namespace {

constexpr double largest_turn = 0.5;    // of a tangent in one Newton step [rad]
constexpr double smallest_part = 1e-3;  // of a Newton step
constexpr double last_step = 1e-9;      // Newton's next one is of the size of rounding

using Triplets = std::vector<Eigen::Triplet<double>>;

/// A node and the directions in which its tangent can turn.
struct Node {
  RodState state;
  Eigen::Matrix3Xd across;  // 3 x 1 in the plane, 3 x 2 in space
};

/// Newton's unknowns of a node, and the equations of an interval, in this order: r, t, v, n.
struct Layout {
  Eigen::Index d;  // dimensions of space
  [[nodiscard]] Eigen::Index t() const { return d; }
  [[nodiscard]] Eigen::Index v() const { return 2 * d - 1; }
  [[nodiscard]] Eigen::Index n() const { return 3 * d - 2; }
  [[nodiscard]] Eigen::Index size() const { return 4 * d - 2; }
};

void add_block(Triplets& triplets, Eigen::Index row, Eigen::Index column,
               const Eigen::Ref<const Eigen::MatrixXd>& block) {
  for (Eigen::Index i = 0; i < block.rows(); ++i) {
    for (Eigen::Index j = 0; j < block.cols(); ++j) {
      triplets.emplace_back(static_cast<int>(row + i), static_cast<int>(column + j), block(i, j));
    }
  }
}

class System {
 public:
  System(const RodSpan& span, const RodMesh& mesh, const ShootingOptions& options, double force)
      : span_(span), mesh_(mesh), tolerance_(options.tolerance), rate_(std::sqrt(force)) {
    if (options.planar) {
      axes_.resize(3, 2);
      axes_ << span.plane->x, span.plane->y;
    } else {
      axes_ = Eigen::Matrix3d::Identity();
    }
    layout_.d = axes_.cols();
  }

  [[nodiscard]] Eigen::Index size() const { return layout_.size() * mesh_.s.size(); }

  /// Gaps that count as closed: steps of the integrator come and go as the nodes move, so that
  /// they cannot be closed to less than its tolerance.
  [[nodiscard]] double closed() const { return std::max(1e-11, 10 * tolerance_); }

  /// Into the plane, onto |t| = 1 and v.t = 0, with directions across t.
  [[nodiscard]] Node make_node(const RodState& state) const {
    Node node;
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
      const Eigen::Vector3d first = t.unitOrthogonal();
      node.across << first, t.cross(first);
    }
    return node;
  }

  [[nodiscard]] std::vector<Node> moved(const std::vector<Node>& nodes,
                                        const Eigen::VectorXd& step) const {
    std::vector<Node> result = nodes;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const Eigen::VectorXd x =
          step.segment(static_cast<Eigen::Index>(i) * layout_.size(), layout_.size());
      const Node& from = nodes[i];
      RodState& state = result[i].state;
      state.r += axes_ * x.head(layout_.d);
      state.n += rate_ * rate_ * (axes_ * x.tail(layout_.d));
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
    }
    return result;
  }

  /// All equations, and their derivatives if asked for.
  /// @return false if the integrator gave up
  [[nodiscard]] bool evaluate(const std::vector<Node>& nodes, Eigen::VectorXd& equations,
                              Triplets* derivatives) const {
    equations.resize(size());
    const Eigen::Index last = mesh_.intervals();
    Eigen::Index row = start_equations(nodes.front(), equations, derivatives);
    for (Eigen::Index i = 0; i < last; ++i) {
      if (!interval_equations(nodes, i, row, equations, derivatives)) return false;
      row += layout_.size();
    }
    end_equations(nodes.back(), row, equations, derivatives);
    return equations.allFinite();
  }

  /// Largest turn of a tangent in a step.
  [[nodiscard]] double turn(const Eigen::VectorXd& step) const {
    double largest = 0;
    for (Eigen::Index i = 0; i < mesh_.s.size(); ++i) {
      largest =
          std::max(largest, step.segment(i * layout_.size() + layout_.t(), layout_.d - 1).norm());
    }
    return largest;
  }

  /// Largest gap, the part of the tangent's along itself included: what points backwards is far.
  [[nodiscard]] double gap(const std::vector<Node>& nodes) const {
    Eigen::VectorXd equations;
    if (!evaluate(nodes, equations, nullptr)) return INFINITY;
    double largest = equations.cwiseAbs().maxCoeff();
    for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
      RodState end = nodes[i].state;
      RodIntegrals integrals;
      const auto k = static_cast<Eigen::Index>(i);
      if (!follow_rod(span_.weight, mesh_.s[k + 1] - mesh_.s[k], tolerance_, end, integrals)) {
        return INFINITY;
      }
      largest = std::max(largest, (end.t - nodes[i + 1].state.t).cwiseAbs().maxCoeff());
    }
    return largest;
  }

 private:
  /// Position and direction of a clamp, or no moment and no force but the load.
  Eigen::Index start_equations(const Node& node, Eigen::VectorXd& equations,
                               Triplets* derivatives) const {
    const Eigen::Index d = layout_.d;
    const RodSpan::Hold* hold = mesh_.hold.front();
    const Eigen::Vector3d no_force = -mesh_.load.col(0);
    position_or_force(node, 0, 0, hold, no_force, equations, derivatives);
    direction_or_moment(node, d, 0, span_.start_direction, equations, derivatives);
    return 2 * d - 1;
  }

  void end_equations(const Node& node, Eigen::Index row, Eigen::VectorXd& equations,
                     Triplets* derivatives) const {
    const Eigen::Index column = mesh_.intervals() * layout_.size();
    position_or_force(node, row, column, nullptr, Eigen::Vector3d::Zero(), equations, derivatives);
    direction_or_moment(node, row + layout_.d, column, span_.end_direction, equations, derivatives);
  }

  void position_or_force(const Node& node, Eigen::Index row, Eigen::Index column,
                         const RodSpan::Hold* hold, const Eigen::Vector3d& force,
                         Eigen::VectorXd& equations, Triplets* derivatives) const {
    const Eigen::Index d = layout_.d;
    equations.segment(row, d) =
        hold != nullptr
            ? Eigen::VectorXd(axes_.transpose() * (node.state.r - hold->position))
            : Eigen::VectorXd(axes_.transpose() * (node.state.n - force) / (rate_ * rate_));
    if (derivatives == nullptr) return;
    add_block(*derivatives, row, column + (hold != nullptr ? 0 : layout_.n()),
              Eigen::MatrixXd::Identity(d, d));
  }

  void direction_or_moment(const Node& node, Eigen::Index row, Eigen::Index column,
                           const std::optional<Eigen::Vector3d>& direction,
                           Eigen::VectorXd& equations, Triplets* derivatives) const {
    const Eigen::Index turns = layout_.d - 1;
    const Eigen::Matrix3Xd& across = node.across;
    equations.segment(row, turns) =
        direction ? Eigen::VectorXd(-across.transpose() * *direction)
                  : Eigen::VectorXd(across.transpose() * node.state.v / rate_);
    if (derivatives == nullptr) return;
    const double rate = direction ? node.state.t.dot(*direction) : 1;
    add_block(*derivatives, row, column + (direction ? layout_.t() : layout_.v()),
              rate * Eigen::MatrixXd::Identity(turns, turns));
  }

  [[nodiscard]] bool interval_equations(const std::vector<Node>& nodes, Eigen::Index i,
                                        Eigen::Index row, Eigen::VectorXd& equations,
                                        Triplets* derivatives) const {
    const Eigen::Index d = layout_.d;
    const Eigen::Index turns = d - 1;
    const Node& node = nodes[static_cast<std::size_t>(i)];
    const Node& next = nodes[static_cast<std::size_t>(i + 1)];
    const RodSpan::Hold* hold = mesh_.hold[static_cast<std::size_t>(i + 1)];
    RodState end = node.state;
    RodIntegrals integrals;
    RodVariation change(derivatives != nullptr ? 2 * turns + d : 0);
    if (derivatives != nullptr) {
      change.t.leftCols(turns) = node.across;
      change.v.leftCols(turns) = -node.state.t * (node.state.v.transpose() * node.across);
      change.v.middleCols(turns, turns) = rate_ * node.across;
      change.n.rightCols(d) = rate_ * rate_ * axes_;
    }
    if (!follow_rod(span_.weight, mesh_.s[i + 1] - mesh_.s[i], tolerance_, end, change,
                    integrals)) {
      return false;
    }
    const double force = rate_ * rate_;
    equations.segment(row, d) = axes_.transpose() * (end.r - next.state.r);
    equations.segment(row + layout_.t(), turns) = next.across.transpose() * end.t;
    equations.segment(row + layout_.v(), turns) =
        next.across.transpose() * (end.v - next.state.v) / rate_;
    if (hold != nullptr) {
      equations.segment(row + layout_.n(), d) = axes_.transpose() * (next.state.r - hold->position);
    } else {
      equations.segment(row + layout_.n(), d) =
          axes_.transpose() * (end.n - mesh_.load.col(i + 1) - next.state.n) / force;
    }
    if (derivatives == nullptr) return true;

    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(d, d);
    const Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(turns, turns);
    const Eigen::Index own = i * layout_.size();
    const Eigen::Index other = own + layout_.size();
    add_block(*derivatives, row, own, one);
    add_block(*derivatives, row, own + d, axes_.transpose() * change.r);
    add_block(*derivatives, row + layout_.t(), own + d, next.across.transpose() * change.t);
    add_block(*derivatives, row + layout_.v(), own + d, next.across.transpose() * change.v / rate_);
    add_block(*derivatives, row, other, -one);
    // `across` turns with the next tangent, v keeps its components in it.
    add_block(*derivatives, row + layout_.t(), other + layout_.t(),
              -next.state.t.dot(end.t) * turn);
    add_block(*derivatives, row + layout_.v(), other + layout_.t(),
              -next.state.t.dot(end.v) / rate_ * turn);
    add_block(*derivatives, row + layout_.v(), other + layout_.v(), -turn);
    if (hold != nullptr) {
      add_block(*derivatives, row + layout_.n(), other, one);
    } else {
      add_block(*derivatives, row + layout_.n(), own + layout_.n(), one);
      add_block(*derivatives, row + layout_.n(), other + layout_.n(), -one);
    }
    return true;
  }

  const RodSpan& span_;
  const RodMesh& mesh_;
  double tolerance_;
  double rate_;  // unit of v; its square is that of n
  Eigen::Matrix3Xd axes_;
  Layout layout_{3};
};

double largest_force(const RodSpan& span, const std::vector<RodState>& nodes) {
  double force = std::max(1.0, total_load(span));
  for (const RodState& node : nodes) {
    force = std::max({force, node.n.norm(), node.v.squaredNorm()});
  }
  return force;
}

using Solver = Eigen::SparseQR<Eigen::SparseMatrix<double>, Eigen::NaturalOrdering<int>>;

Eigen::SparseMatrix<double> matrix_of(const Triplets& triplets, Eigen::Index rows,
                                      Eigen::Index columns) {
  Eigen::SparseMatrix<double> matrix(rows, columns);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  matrix.makeCompressed();
  return matrix;
}

/// Newton's step, as much of it as makes the next simplified one shorter.
/// @return its largest component; nothing if there is no such part or it does not close the gaps
std::optional<double> newton_step(const System& system, const Triplets& derivatives,
                                  const Eigen::VectorXd& equations, std::vector<Node>& nodes,
                                  int& shots) {
  Solver solver(matrix_of(derivatives, system.size(), system.size()));
  if (solver.info() != Eigen::Success) return std::nullopt;
  const Eigen::VectorXd step = -solver.solve(equations);
  const double largest = step.lpNorm<Eigen::Infinity>();
  Eigen::VectorXd trial_equations;
  if (largest < last_step) {
    nodes = system.moved(nodes, step);
    ++shots;
    const bool closed = system.evaluate(nodes, trial_equations, nullptr) &&
                        trial_equations.norm() < system.closed();
    return closed ? std::optional(largest) : std::nullopt;
  }
  double part = std::min(1.0, largest_turn / std::max(system.turn(step), 1e-300));
  for (; part > smallest_part; part /= 2) {
    const std::vector<Node> trial = system.moved(nodes, part * step);
    ++shots;
    if (!system.evaluate(trial, trial_equations, nullptr)) continue;
    const Eigen::VectorXd next = solver.solve(trial_equations);
    if (next.norm() > (1 - part / 4) * step.norm()) continue;
    nodes = trial;
    return part * largest;
  }
  return std::nullopt;
}

/// Levenberg's step with a weight of the order of the gaps: it makes them smaller and moves nothing
/// that can move for nothing, where Newton's step is not defined.
std::optional<double> levenberg_step(const System& system, Triplets derivatives,
                                     const Eigen::VectorXd& equations, std::vector<Node>& nodes,
                                     int& shots) {
  const Eigen::Index size = system.size();
  const std::size_t own = derivatives.size();
  Eigen::VectorXd right = Eigen::VectorXd::Zero(2 * size);
  right.head(size) = -equations;
  Eigen::VectorXd trial_equations;
  for (double weight = equations.norm(); weight < 1e6; weight *= 8) {
    derivatives.resize(own);
    for (Eigen::Index i = 0; i < size; ++i) {
      derivatives.emplace_back(static_cast<int>(size + i), static_cast<int>(i), std::sqrt(weight));
    }
    Solver solver(matrix_of(derivatives, 2 * size, size));
    if (solver.info() != Eigen::Success) return std::nullopt;
    const Eigen::VectorXd step = solver.solve(right);
    ++shots;
    const std::vector<Node> trial = system.moved(nodes, step);
    if (system.turn(step) > largest_turn || !system.evaluate(trial, trial_equations, nullptr) ||
        trial_equations.norm() > equations.norm()) {
      continue;
    }
    nodes = trial;
    return step.lpNorm<Eigen::Infinity>();
  }
  return std::nullopt;
}

}  // namespace

ShootingResult shoot(const RodSpan& span, const RodMesh& mesh, const std::vector<RodState>& start,
                     const ShootingOptions& options) {
  const System system(span, mesh, options, largest_force(span, start));
  std::vector<Node> nodes;
  nodes.reserve(start.size());
  for (const RodState& state : start) nodes.push_back(system.make_node(state));
  ShootingResult result;
  result.message = "Newton's method took too many steps";
  Eigen::VectorXd equations;
  for (int iteration = 0; iteration < options.max_iterations && !result.converged; ++iteration) {
    Triplets derivatives;
    ++result.shots;
    if (!system.evaluate(nodes, equations, &derivatives)) {
      result.message = "the integrator gave up";
      break;
    }
    std::optional<double> step = newton_step(system, derivatives, equations, nodes, result.shots);
    if (!step) step = levenberg_step(system, derivatives, equations, nodes, result.shots);
    if (!step) {
      result.message = "Newton's method found no shorter step";
      break;
    }
    result.converged = *step < last_step;
  }
  result.residual = system.gap(nodes);
  for (const Node& node : nodes) result.nodes.push_back(node.state);
  if (!result.converged) return result;
  result.converged = result.residual <= system.closed();
  result.message = result.converged ? "converged" : "the rod does not close at a node";
  return result;
}

}  // namespace dlo::energy_model
