#include "curved/curved_shooting.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "shooting/between_nodes.hpp"
#include "shooting/close_gaps.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {
namespace {

/// Newton's unknowns of a node, and the equations of an interval, in this order.
enum CurvedLayout : Eigen::Index { at_r = 0, at_spin = 3, at_m = 6, at_n = 9, per_node = 12 };

constexpr double widest_growth = 3;  // of an interval: its length times bending_force^(1/2)
/// Of the integrator for the second variation, whose elements are right to 1e-8.
constexpr double curved_variation_tolerance = 1e-10;

/// The part of a rotation b a^T that is odd: about its axis, the sine of its angle.
Eigen::Vector3d turn_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  for (Eigen::Index k = 0; k < 3; ++k) {
    turn += Eigen::Vector3d(a.col(k)).cross(Eigen::Vector3d(b.col(k))) / 2;
  }
  return turn;
}

/// Its derivative by a spin of b; that by a spin of a is less its transpose.
Eigen::Matrix3d turn_rate(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  const Eigen::Matrix3d product = b * a.transpose();
  return (product.trace() * Eigen::Matrix3d::Identity() - product) / 2;
}

/// The equations of multiple shooting of a curved rod.
class CurvedSystem {
 public:
  using Node = CurvedState;

  CurvedSystem(const CurvedRod& rod, const RodMesh& mesh, const ClampFrames& frames,
               const CurvedOptions& options, double force)
      : rod_(rod), mesh_(mesh), options_(options), rate_(std::sqrt(force)) {
    for (const double s : mesh.s) {
      const CurvedRod::Clamp* clamp = rod.clamp_at(s);
      clamps_.push_back(clamp);
      frames_.push_back(clamp == nullptr
                            ? std::nullopt
                            : frames[static_cast<std::size_t>(clamp - rod.clamps.data())]);
    }
  }

  [[nodiscard]] Eigen::Index size() const { return per_node * mesh_.s.size(); }
  [[nodiscard]] bool out_of_time() const { return options_.deadline.passed(); }
  [[nodiscard]] double closed() const { return std::max(1e-11, 10 * options_.tolerance); }

  [[nodiscard]] std::vector<CurvedState> moved(const std::vector<CurvedState>& nodes,
                                               const Eigen::VectorXd& step) const {
    std::vector<CurvedState> result = nodes;
    Eigen::Index at = 0;
    for (CurvedState& state : result) {
      state.r += step.segment<3>(at + at_r);
      state.R = rotation_by(step.segment<3>(at + at_spin)) * state.R;
      state.m += rate_ * step.segment<3>(at + at_m);
      state.n += rate_ * rate_ * step.segment<3>(at + at_n);
      at += per_node;
    }
    return result;
  }

  [[nodiscard]] double turn(const Eigen::VectorXd& step) const {
    double largest = 0;
    for (Eigen::Index at = 0; at < size(); at += per_node) {
      largest = std::max(largest, step.segment<3>(at + at_spin).norm());
    }
    return largest;
  }

  [[nodiscard]] bool evaluate(const std::vector<CurvedState>& nodes, Eigen::VectorXd& equations,
                              Triplets* derivatives) const {
    Rows rows{Eigen::VectorXd(size()), derivatives, 0};
    start_equations(nodes.front(), rows);
    for (Eigen::Index i = 0; i < mesh_.intervals(); ++i) {
      if (out_of_time() || !interval_equations(nodes, i, rows)) return false;
    }
    const Eigen::Index last = mesh_.intervals() * per_node;
    rows.add(nodes.back().n / (rate_ * rate_), {{last + at_n, Eigen::Matrix3d::Identity()}});
    rows.add(nodes.back().m / rate_, {{last + at_m, Eigen::Matrix3d::Identity()}});
    equations = rows.values;
    return equations.allFinite();
  }

  /// Largest gap, where rotations are compared as they are: what points backwards is far.
  [[nodiscard]] double gap(const std::vector<CurvedState>& nodes) const {
    Eigen::VectorXd equations;
    if (!evaluate(nodes, equations, nullptr)) return std::numeric_limits<double>::infinity();
    double largest = equations.cwiseAbs().maxCoeff();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (frames_[i]) largest = std::max(largest, (nodes[i].R - *frames_[i]).cwiseAbs().maxCoeff());
      if (clamps_[i] != nullptr) {
        largest = std::max(largest, (nodes[i].t() - clamps_[i]->direction).cwiseAbs().maxCoeff());
      }
      if (i + 1 == nodes.size()) break;
      CurvedState end = nodes[i];
      if (!follow(static_cast<Eigen::Index>(i), end)) {
        return std::numeric_limits<double>::infinity();
      }
      largest = std::max(largest, (end.R - nodes[i + 1].R).cwiseAbs().maxCoeff());
    }
    return largest;
  }

 private:
  struct Block {
    Eigen::Index column;
    Eigen::MatrixXd values;
  };
  /// Equations as they come.
  struct Rows {
    Eigen::VectorXd values;
    Triplets* derivatives;
    Eigen::Index row;

    void add(const Eigen::VectorXd& value, const std::vector<Block>& blocks) {
      values.segment(row, value.size()) = value;
      if (derivatives != nullptr) {
        for (const Block& block : blocks) {
          for (Eigen::Index i = 0; i < block.values.rows(); ++i) {
            for (Eigen::Index j = 0; j < block.values.cols(); ++j) {
              derivatives->emplace_back(static_cast<int>(row + i),
                                        static_cast<int>(block.column + j), block.values(i, j));
            }
          }
        }
      }
      row += value.size();
    }
  };

  [[nodiscard]] bool follow(Eigen::Index i, CurvedState& end) const {
    CurvedVariation none;
    CurvedIntegrals integrals;
    return follow_curved(mesh_.section_of(i), rod_.natural, mesh_.s[i], mesh_.width(i),
                         options_.tolerance, end, none, integrals);
  }

  /// What a clamp asks of the frame of node i.
  /// @return number of equations: 3, 2 or none without a clamp
  Eigen::Index frame_equations(const CurvedState& node, Eigen::Index i, Rows& rows) const {
    const auto index = static_cast<std::size_t>(i);
    const Eigen::Index column = i * per_node + at_spin;
    if (frames_[index]) {
      rows.add(turn_between(*frames_[index], node.R),
               {{column, turn_rate(*frames_[index], node.R)}});
      return 3;
    }
    if (clamps_[index] == nullptr) return 0;
    const Eigen::Matrix<double, 3, 2> across = across_of(*clamps_[index]);
    // d(b . t) = b . (spin x t) = (t x b) . spin
    Eigen::Matrix<double, 2, 3> rate;
    for (Eigen::Index k = 0; k < 2; ++k) {
      rate.row(k) = node.t().cross(Eigen::Vector3d(across.col(k))).transpose();
    }
    rows.add(across.transpose() * node.t(), {{column, rate}});
    return 2;
  }

  static Eigen::Matrix<double, 3, 2> across_of(const CurvedRod::Clamp& clamp) {
    Eigen::Matrix<double, 3, 2> across;
    const Eigen::Vector3d first = clamp.direction.unitOrthogonal();
    across << first, clamp.direction.cross(first);
    return across;
  }

  void start_equations(const CurvedState& node, Rows& rows) const {
    const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
    if (mesh_.hold.front() != nullptr) {
      rows.add(node.r - mesh_.hold.front()->position, {{at_r, one}});
    } else {
      rows.add((node.n + mesh_.load.col(0)) / (rate_ * rate_), {{at_n, one}});
    }
    const Eigen::Index held = frame_equations(node, 0, rows);
    if (held == 0) rows.add(node.m / rate_, {{at_m, one}});
    if (held != 2) return;
    const Eigen::RowVector3d direction = clamps_.front()->direction.transpose();
    rows.add(direction * node.m / rate_, {{at_m, direction}});
  }

  [[nodiscard]] bool interval_equations(const std::vector<CurvedState>& nodes, Eigen::Index i,
                                        Rows& rows) const {
    const CurvedState& node = nodes[static_cast<std::size_t>(i)];
    const CurvedState& next = nodes[static_cast<std::size_t>(i + 1)];
    const RodSpan::Hold* hold = mesh_.hold[static_cast<std::size_t>(i + 1)];
    const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
    const double force = rate_ * rate_;
    constexpr Eigen::Index parameters = 9;  // spin, m, n
    CurvedState end = node;
    CurvedVariation change(rows.derivatives != nullptr ? parameters : 0);
    if (rows.derivatives != nullptr) {
      change.spin.leftCols<3>() = one;
      change.m.middleCols<3>(3) = rate_ * one;
      change.n.rightCols<3>() = force * one;
    }
    CurvedIntegrals integrals;
    if (!follow_curved(mesh_.section_of(i), rod_.natural, mesh_.s[i], mesh_.width(i),
                       options_.tolerance, end, change, integrals)) {
      return false;
    }
    const Eigen::Index own = i * per_node;
    const Eigen::Index other = own + per_node;
    rows.add(end.r - next.r, {{own + at_r, one}, {own + at_spin, change.r}, {other + at_r, -one}});
    const Eigen::Matrix3d turns = turn_rate(next.R, end.R);
    rows.add(turn_between(next.R, end.R),
             {{own + at_spin, turns * change.spin}, {other + at_spin, -turns.transpose()}});
    if (hold != nullptr) {
      rows.add(next.r - hold->position, {{other + at_r, one}});
    } else {
      rows.add((end.n - mesh_.load.col(i + 1) - next.n) / force,
               {{own + at_n, one}, {other + at_n, -one}});
    }
    const Eigen::Index held = frame_equations(next, i + 1, rows);
    if (held == 3) return true;
    // What of the moment is continuous.
    const Eigen::MatrixXd kept =
        held == 0
            ? Eigen::MatrixXd(one)
            : Eigen::MatrixXd(clamps_[static_cast<std::size_t>(i + 1)]->direction.transpose());
    rows.add(kept * (end.m - next.m) / rate_,
             {{own + at_spin, kept * change.m / rate_}, {other + at_m, -kept}});
    return true;
  }

  const CurvedRod& rod_;
  const RodMesh& mesh_;
  const CurvedOptions& options_;
  double rate_;                                  // unit of m; its square is that of n
  std::vector<const CurvedRod::Clamp*> clamps_;  // at each node, null for none
  ClampFrames frames_;                           // at each node
};

void add_curved_energies(const CurvedRod& rod, const RodMesh& mesh, double tolerance,
                         CurvedEquilibrium& equilibrium) {
  for (Eigen::Index i = 0; i < mesh.s.size(); ++i) {
    CurvedState state = equilibrium.nodes[static_cast<std::size_t>(i)];
    equilibrium.energy.load -= mesh.load.col(i).dot(state.r);
    if (i == mesh.intervals()) break;
    CurvedVariation none;
    CurvedIntegrals integrals;
    if (!follow_curved(mesh.section_of(i), rod.natural, mesh.s[i], mesh.width(i), tolerance, state,
                       none, integrals)) {
      equilibrium.converged = false;
      equilibrium.message = "the integrator gave up on the energies";
      return;
    }
    equilibrium.energy.bending += integrals.bending;
    equilibrium.energy.twisting += integrals.twisting;
    equilibrium.energy.gravity += integrals.gravity;
    equilibrium.turns.push_back(integrals.turn);
  }
}

}  // namespace

double bending_force(const CurvedRod& rod, const std::vector<CurvedState>& states) {
  double force = 1;
  for (const CurvedState& state : states) {
    for (const RodSpan::Part& part : rod.span.parts) {
      const double b = part.section.stiffness().minCoeff();
      force = std::max({force, state.n.norm() / b, state.m.squaredNorm() / (b * b)});
    }
  }
  constexpr int probes = 16;
  for (int i = 0; i <= probes; ++i) {
    force = std::max(force, rod.natural(static_cast<double>(i) / probes).squaredNorm());
  }
  return force;
}

CurvedEquilibrium shoot_curved(const CurvedRod& rod, RodMesh mesh, std::vector<CurvedState> start,
                               const ClampFrames& frames, const CurvedOptions& options) {
  CurvedEquilibrium equilibrium;
  equilibrium.frames = frames;
  for (int level = 0; level < 3; ++level) {
    double force = std::max(1.0, total_load(rod.span));
    for (const CurvedState& state : start) {
      force = std::max({force, state.n.norm(), state.m.squaredNorm()});
    }
    const CurvedSystem system(rod, mesh, frames, options, force);
    std::vector<CurvedState> nodes = start;
    const ClosedGaps closed = close_gaps(system, nodes, options.max_iterations, false);
    equilibrium.converged = closed.converged;
    equilibrium.message = closed.message;
    equilibrium.shots += closed.shots;
    equilibrium.residual = system.gap(nodes);
    equilibrium.s = mesh.s;
    equilibrium.nodes = std::move(nodes);
    if (!equilibrium.converged) return equilibrium;
    if (!(equilibrium.residual <= system.closed())) {
      equilibrium.converged = false;
      equilibrium.message = "the rod does not close at a node";
      return equilibrium;
    }
    const double bends = bending_force(rod, equilibrium.nodes);
    const double longest =
        (mesh.s.tail(mesh.intervals()) - mesh.s.head(mesh.intervals())).maxCoeff();
    if (longest * std::sqrt(bends) <= widest_growth) break;
    mesh = make_mesh(rod.span, longest_interval(rod.span, bends));
    start = curved_states_at(equilibrium, rod, {mesh.s.begin(), mesh.s.end()}, options.tolerance);
  }
  add_curved_energies(rod, mesh, options.tolerance, equilibrium);
  if (!equilibrium.converged) return equilibrium;
  equilibrium.stability = curved_variation(
      rod, frames, bending_force(rod, equilibrium.nodes), [&](const std::vector<double>& s) {
        return curved_states_at(equilibrium, rod, s,
                                std::max(options.tolerance, curved_variation_tolerance));
      });
  if (equilibrium.stability.negative < 0) {
    equilibrium.converged = false;
    equilibrium.message = "the integrator gave up on the second variation";
  }
  return equilibrium;
}

std::vector<CurvedState> curved_states_at(const CurvedEquilibrium& equilibrium,
                                          const CurvedRod& rod, const std::vector<double>& s,
                                          double tolerance) {
  const auto follow = [&](Eigen::Index i, double from, double to, CurvedState& state) {
    const RodSection& section = section_at(rod.span, (equilibrium.s[i] + equilibrium.s[i + 1]) / 2);
    CurvedVariation none;
    CurvedIntegrals integrals;
    if (follow_curved(section, rod.natural, from, to - from, tolerance, state, none, integrals)) {
      return;
    }
    state.r.setConstant(std::numeric_limits<double>::quiet_NaN());
    state.R.setConstant(std::numeric_limits<double>::quiet_NaN());
  };
  return states_between(equilibrium.s, equilibrium.nodes, s, follow);
}

}  // namespace dlo::energy_model
