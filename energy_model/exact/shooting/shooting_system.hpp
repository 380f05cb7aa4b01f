#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <algorithm>
#include <string>
#include <vector>

#include "base/deadline.hpp"
#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/rod_flow.hpp"

namespace dlo::energy_model {

using Triplets = std::vector<Eigen::Triplet<double>>;

struct ShootingOptions {
  double tolerance = 1e-13;          ///< local error of the integrator, see integrate_rod()
  Motion motion = Motion::in_space;  ///< in the plane: nodes stay in the span's plane
  int max_iterations = 60;           ///< largest number of Newton steps
  Deadline deadline{};               ///< a result after the deadline is a failure
};

/// Unknowns of Newton's method.
struct ShootingPoint {
  Eigen::VectorXd s;            ///< arc lengths of the nodes
  std::vector<RodState> nodes;  ///< cross-sections at the nodes
  std::vector<double> forces;   ///< forces of the contacts of the mesh
};

/// Equations of multiple shooting and their derivatives. The span is integrated from every node of
/// the mesh to the next, where r, R, m and n are continuous except for the loads at the node; loads
/// that follow the rod are rotated by R. Where a position is prescribed, n is free. At a clamp two
/// components of R are prescribed and two of m are free, at one that holds the frame all three; at
/// a free end m = n = 0. R of neighbouring nodes is compared by the logarithm of the remaining
/// rotation. At each node the unknowns are r, a spin of R, m and n: in the plane two components of
/// positions and forces and one of spins and moments, in space three of each.
///
/// Where a rod touches a body, n jumps by an unknown force along its normal. A point that may slide
/// and the ends of a part that lies have unknown arc lengths; the other nodes keep their relative
/// positions between them and their neighbours. At a touched point the gap is zero, and the slope
/// too if the point may slide. Where the rod begins to lie, lying_conditions() hold. Redundant
/// conditions, as for a clamp that holds the rod on the body on which it lies, give more equations
/// than unknowns.
///
/// A round rod without a clamp has a zero mode, rotation about its own tangent. The condition that
/// the first node's frame does not rotate replaces that of its torque, which is the torque at the
/// other end.
///
/// The equations are well posed for soft rods if the intervals are not much longer than |n|^(-1/2),
/// the length over which errors grow by a factor e.
class ShootingSystem {
 public:
  /// @param span, mesh  have to outlive the system
  /// @param start       cross-sections, one for each node of the mesh
  ShootingSystem(const RodSpan& span, const RodMesh& mesh, const ClampFrames& frames,
                 const ShootingOptions& options, const std::vector<RodState>& start);

  [[nodiscard]] Eigen::Index unknowns() const { return unknowns_; }
  [[nodiscard]] Eigen::Index equations() const { return equations_; }  ///< not less than unknowns()
  [[nodiscard]] bool out_of_time() const { return deadline_.passed(); }

  /// Returns the size of gaps that counts as closed. Integrator steps change discontinuously as the
  /// nodes move, so that gaps cannot be closed below the tolerance.
  [[nodiscard]] double closed_gap_tolerance() const { return std::max(1e-11, 10 * tolerance_); }

  /// Returns the initial guess, projected to the plane if the motion is restricted to it.
  [[nodiscard]] ShootingPoint start() const;

  [[nodiscard]] ShootingPoint moved(const ShootingPoint& point, const Eigen::VectorXd& step) const;

  /// Evaluates all equations, and their derivatives on request. Units: m in sqrt(force), n in
  /// force.
  /// @return false if the integrator failed or the deadline has passed
  [[nodiscard]] bool evaluate(const ShootingPoint& point, Eigen::VectorXd& equations,
                              Triplets* derivatives) const;

  /// Returns the share of a step, at most 1, that rotates tangents by at most 0.5 rad and moves a
  /// contact by at most 0.3 of the distance to the next fixed node or contact.
  [[nodiscard]] double allowed_step_share(const ShootingPoint& point,
                                          const Eigen::VectorXd& step) const;

  /// Returns the largest gap; infinity if evaluate() fails. A tangent that points backwards at a
  /// clamp counts as a gap too.
  [[nodiscard]] double gap(const ShootingPoint& point) const;

 private:
  struct Block {
    Eigen::Index column;
    Eigen::MatrixXd values;
  };
  struct Rows;

  [[nodiscard]] Eigen::Index spin_index() const { return positions_.cols(); }
  [[nodiscard]] Eigen::Index m_index() const { return positions_.cols() + turns_.cols(); }
  [[nodiscard]] Eigen::Index n_index() const { return positions_.cols() + 2 * turns_.cols(); }
  [[nodiscard]] Eigen::Index unknowns_per_node() const {
    return 2 * (positions_.cols() + turns_.cols());
  }

  /// Position of a node and width of its interval, relative to the part between two nodes whose arc
  /// lengths are unknown or fixed.
  struct Share {
    Eigen::Index before = 0;
    Eigen::Index after = 0;
    double begin = 0;
    double width = 0;
  };

  [[nodiscard]] RodState in_plane(const RodState& state) const;
  void number_contacts();
  void share_arc_lengths();

  /// Returns the contact at a node; null: none.
  [[nodiscard]] const RodContact* contact_at(Eigen::Index node) const;

  /// Adds the conditions of a clamp for the frame of node i.
  /// @return directions in which the moment is free, one per column: all at a clamp that holds the
  /// frame, those across its direction at another clamp, none without a clamp
  Eigen::Matrix3Xd frame_equations(const RodState& node, Eigen::Index i, Rows& rows) const;

  /// Adds the conditions at the start: position and direction of a clamp, or balance of moment and
  /// force with the load there.
  void start_equations(const ShootingPoint& point, Rows& rows) const;

  [[nodiscard]] RodVariation variation_by(Eigen::Index placed) const;
  [[nodiscard]] bool interval_equations(const ShootingPoint& point, Eigen::Index i,
                                        Rows& rows) const;

  /// Returns the derivatives of the equations at the end of interval i by the arc lengths of the
  /// nodes that determine its width.
  [[nodiscard]] std::vector<Block> width_derivatives(Eigen::Index i,
                                                     const Eigen::VectorXd& by_width) const;

  /// Adds the conditions of a contact at a node, and of the begin of a part that lies, for the
  /// cross-section there.
  void contact_equations(const RodState& node, Eigen::Index i, Rows& rows) const;

  struct ContactForceTerm;
  [[nodiscard]] ContactForceTerm contact_force_at(const ShootingPoint& point, Eigen::Index i) const;

  const RodSpan& span_;
  const RodMesh& mesh_;
  double tolerance_;
  Deadline deadline_;
  double rate_;                                // unit of m; its square is the unit of n
  Eigen::Matrix3Xd positions_;                 // axes of positions and forces, one per column
  Eigen::Matrix3Xd turns_;                     // axes of spins and moments, one per column
  std::vector<const RodSpan::Clamp*> clamps_;  // clamp at each node; null: none
  ClampFrames frames_;                         // frame at each node
  std::vector<RodState> start_;
  Eigen::Index unknowns_ = 0;
  Eigen::Index equations_ = 0;
  std::vector<Eigen::Index> contacts_;    // contact at each node; -1: none
  std::vector<Eigen::Index> arc_length_;  // unknown of each node's arc length; -1: none
  std::vector<Eigen::Index> force_;       // unknown of each contact's force
  std::vector<Share> shares_;             // share of each interval; empty: no arc length is unknown
};

/// Outcome of solve_shooting(), which solves the equations of multiple shooting by Newton's method.
struct [[nodiscard]] ShootingResult {
  bool converged = false;
  std::string message = "Newton's method reached its iteration limit";
  int integrations = 0;
};

/// Whether the rod has nearly zero modes, such as a buckle that slides along a twisted rod: steps
/// along them are then suppressed.
enum class Modes { stiff, nearly_zero };

/// Solves the equations of multiple shooting by Newton's method. Steps are damped until the next
/// simplified step is shorter (Deuflhard's natural monotonicity). If there is no such step, because
/// of a zero mode or nearly one, a Levenberg step reduces the gaps.
ShootingResult solve_shooting(const ShootingSystem& system, ShootingPoint& point,
                              int max_iterations, Modes modes);

}  // namespace dlo::energy_model
