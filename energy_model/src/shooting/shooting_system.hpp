#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <vector>

#include "base/deadline.hpp"
#include "kirchhoff/rod_flow.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/boundary_value.hpp"
#include "shooting/close_gaps.hpp"

namespace dlo::energy_model {

/// A node and the directions in which its tangent can turn.
struct ShootingNode {
  RodState state;
  Eigen::Matrix3Xd across;  ///< 3 x 1 in the plane, 3 x 2 in space; the rod's frame if it is held
};

/// Newton's unknowns of a node, and the equations of an interval, in this order: r, t, v, n, and if
/// the rod's frame is held its turn about t and the torque M.
struct NodeLayout {
  Eigen::Index d;  ///< dimensions of space
  bool framed = false;
  [[nodiscard]] Eigen::Index t() const { return d; }
  [[nodiscard]] Eigen::Index v() const { return 2 * d - 1; }
  [[nodiscard]] Eigen::Index n() const { return 3 * d - 2; }
  [[nodiscard]] Eigen::Index frame() const { return 4 * d - 2; }
  [[nodiscard]] Eigen::Index torque() const { return 4 * d - 1; }
  [[nodiscard]] Eigen::Index size() const { return 4 * d - (framed ? 0 : 2); }
};

/// The equations of multiple shooting (see boundary_value.hpp) and their derivatives. Units: v and
/// M in sqrt(force), n in force.
class ShootingSystem {
 public:
  using Node = ShootingNode;

  /// @param span, mesh  have to outlive the system
  ShootingSystem(const RodSpan& span, const RodMesh& mesh, const ShootingOptions& options,
                 double force);

  [[nodiscard]] Eigen::Index size() const { return layout_.size() * mesh_.s.size(); }

  [[nodiscard]] bool out_of_time() const { return deadline_.passed(); }

  /// Gaps that count as closed: steps of the integrator come and go as the nodes move, so that
  /// they cannot be closed to less than its tolerance.
  [[nodiscard]] double closed() const { return std::max(1e-11, 10 * tolerance_); }

  /// Into the plane, onto |t| = 1 and v.t = 0, with directions across t, along its d if the frame
  /// is held.
  [[nodiscard]] ShootingNode make_node(const RodState& state) const;

  [[nodiscard]] std::vector<ShootingNode> moved(const std::vector<ShootingNode>& nodes,
                                                const Eigen::VectorXd& step) const;

  /// All equations, and their derivatives if asked for.
  /// @return false if the integrator gave up or the deadline has passed
  [[nodiscard]] bool evaluate(const std::vector<ShootingNode>& nodes, Eigen::VectorXd& equations,
                              Triplets* derivatives) const;

  /// Largest turn of a tangent in a step.
  [[nodiscard]] double turn(const Eigen::VectorXd& step) const;

  /// Largest gap, the part of the tangent's along itself included: what points backwards is far.
  [[nodiscard]] double gap(const std::vector<ShootingNode>& nodes) const;

 private:
  /// Position and direction of a clamp, or no moment and no force but the load.
  Eigen::Index start_equations(const ShootingNode& node, Eigen::VectorXd& equations,
                               Triplets* derivatives) const;

  void end_equations(const ShootingNode& node, Eigen::Index row, Eigen::VectorXd& equations,
                     Triplets* derivatives) const;

  void position_or_force(const ShootingNode& node, Eigen::Index row, Eigen::Index column,
                         const RodSpan::Hold* hold, const Eigen::Vector3d& force,
                         Eigen::VectorXd& equations, Triplets* derivatives) const;

  void direction_or_moment(const ShootingNode& node, Eigen::Index row, Eigen::Index column,
                           const std::optional<Eigen::Vector3d>& direction,
                           Eigen::VectorXd& equations, Triplets* derivatives) const;

  /// A held frame comes to the next node turned by M h / c; M stays.
  void twist_equations(const ShootingNode& node, const ShootingNode& next, Eigen::Index i,
                       Eigen::Index row, const RodState& end, const RodVariation& change,
                       Eigen::VectorXd& equations, Triplets* derivatives) const;

  /// The director at a clamp.
  void frame_equation(const ShootingNode& node, Eigen::Index row, Eigen::Index column,
                      const Eigen::Vector3d& director, Eigen::VectorXd& equations,
                      Triplets* derivatives) const;

  [[nodiscard]] bool interval_equations(const std::vector<ShootingNode>& nodes, Eigen::Index i,
                                        Eigen::Index row, Eigen::VectorXd& equations,
                                        Triplets* derivatives) const;

  const RodSpan& span_;
  const RodMesh& mesh_;
  double tolerance_;
  Deadline deadline_;
  std::optional<ShotFrames> frames_;
  double rate_;  // unit of v; its square is that of n
  Eigen::Matrix3Xd axes_;
  NodeLayout layout_{3};
};

}  // namespace dlo::energy_model
