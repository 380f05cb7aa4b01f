#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <algorithm>
#include <vector>

#include "base/deadline.hpp"
#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/rod_flow.hpp"

namespace dlo::energy_model {

using Triplets = std::vector<Eigen::Triplet<double>>;

struct ShootingOptions {
  double tolerance = 1e-13;          ///< of the integrator, see follow_rod
  Motion motion = Motion::in_space;  ///< in the plane: stay in the span's
  int max_iterations = 60;           ///< Newton steps
  Deadline deadline{};               ///< the result is a failure once it has passed
};

/// What Newton's method moves.
struct ShootingPoint {
  Eigen::VectorXd s;            ///< of the nodes
  std::vector<RodState> nodes;  ///< there
  std::vector<double> forces;   ///< of the contacts of the mesh
};

/// The equations of multiple shooting and their derivatives: the span is integrated from every node
/// of the mesh to the next, and r, R, m and n meet there but for what nodes add, R times what
/// follows the rod. Where a position is given n is free; at a clamp two of R and two of m, at one
/// that holds the frame all three; at a free end m = n = 0. Between neighbouring nodes R is
/// compared by the logarithm of the rotation that is left. At each node Newton moves r, a spin of
/// R, m and n: in the plane two of positions and forces and one of spins and moments, which is
/// three and three in space.
///
/// Where a rod touches a body, n falls by an unknown force along its normal; a point that may slide
/// and the ends of what lies are at unknown arc lengths, between which and their neighbours the
/// other nodes keep their shares. At a point that is touched the gap is zero, and the slope if it
/// may slide; where the rod begins to lie, lying_conditions() hold. What says one thing twice, as
/// where a clamp holds the rod on what it lies on, is an equation too many.
///
/// A rod that is round and not clamped has a zero mode, rotation around its own line: the first
/// node's frame does not, in place of its torque, which is that at the other end.
///
/// Well posed for soft rods as long as the intervals are not much longer than |n|^(-1/2), over
/// which errors grow e-fold.
class ShootingSystem {
 public:
  /// @param span, mesh  have to outlive the system
  /// @param start       one for each node of the mesh
  ShootingSystem(const RodSpan& span, const RodMesh& mesh, const ClampFrames& frames,
                 const ShootingOptions& options, const std::vector<RodState>& start);

  [[nodiscard]] Eigen::Index unknowns() const { return unknowns_; }
  [[nodiscard]] Eigen::Index equations() const { return equations_; }  ///< no less
  [[nodiscard]] bool out_of_time() const { return deadline_.passed(); }

  /// Gaps that count as closed: steps of the integrator come and go as the nodes move, so that
  /// they cannot be closed to less than its tolerance.
  [[nodiscard]] double closed() const { return std::max(1e-11, 10 * tolerance_); }

  /// The start, in the plane if it has to stay there.
  [[nodiscard]] ShootingPoint start() const { return {mesh_.s, start_, start_forces()}; }

  [[nodiscard]] ShootingPoint moved(const ShootingPoint& point, const Eigen::VectorXd& step) const;

  /// All equations, and their derivatives if asked for. Units: m in sqrt(force), n in force.
  /// @return false if the integrator gave up or the deadline has passed
  [[nodiscard]] bool evaluate(const ShootingPoint& point, Eigen::VectorXd& equations,
                              Triplets* derivatives) const;

  /// The part of a step, at most all of it, that turns tangents by 0.5 and moves a contact by 0.3
  /// of the way to the next grip, load or contact.
  [[nodiscard]] double allowed_part(const ShootingPoint& point, const Eigen::VectorXd& step) const;

  /// Largest gap, that of what points backwards at a clamp included.
  [[nodiscard]] double gap(const ShootingPoint& point) const;

 private:
  struct Block {
    Eigen::Index column;
    Eigen::MatrixXd values;
  };
  struct Rows;

  [[nodiscard]] Eigen::Index spin_at() const { return positions_.cols(); }
  [[nodiscard]] Eigen::Index m_at() const { return positions_.cols() + turns_.cols(); }
  [[nodiscard]] Eigen::Index n_at() const { return positions_.cols() + 2 * turns_.cols(); }
  [[nodiscard]] Eigen::Index per_node() const { return 2 * (positions_.cols() + turns_.cols()); }

  /// An interval's part of the way between two nodes whose arc lengths move or are fixed.
  struct Share {
    Eigen::Index before = 0;
    Eigen::Index after = 0;
    double begin = 0;
    double width = 0;
  };

  [[nodiscard]] RodState in_plane(const RodState& state) const;
  [[nodiscard]] std::vector<double> start_forces() const;
  void number_contacts();
  void share_arc_lengths();

  /// The contact at a node; null: none.
  [[nodiscard]] const RodContact* contact_at(Eigen::Index node) const;

  /// What a clamp asks of the frame of node i.
  /// @return directions in which the moment is free: all of them at a clamp that holds the frame,
  /// those across its direction at another one, none without a clamp; one a column
  Eigen::Matrix3Xd frame_equations(const RodState& node, Eigen::Index i, Rows& rows) const;

  /// Position and direction of a clamp, or no moment and no force but the load.
  void start_equations(const ShootingPoint& point, Rows& rows) const;

  [[nodiscard]] RodVariation variation_by(Eigen::Index placed) const;
  [[nodiscard]] bool interval_equations(const ShootingPoint& point, Eigen::Index i,
                                        Rows& rows) const;

  /// Derivatives of what ends interval i by the arc lengths of the nodes that its width follows.
  [[nodiscard]] std::vector<Block> with_width(Eigen::Index i,
                                              const Eigen::VectorXd& by_width) const;

  /// What a contact at a node, and the begin of what lies, ask of the cross-section there.
  void contact_equations(const RodState& node, Eigen::Index i, Rows& rows) const;

  struct Push;
  [[nodiscard]] Push push_at(const ShootingPoint& point, Eigen::Index i) const;

  const RodSpan& span_;
  const RodMesh& mesh_;
  double tolerance_;
  Deadline deadline_;
  double rate_;                                // unit of m; its square is that of n
  Eigen::Matrix3Xd positions_;                 // axes of positions and forces, one a column
  Eigen::Matrix3Xd turns_;                     // axes of spins and moments
  std::vector<const RodSpan::Clamp*> clamps_;  // at each node, null for none
  ClampFrames frames_;                         // at each node
  std::vector<RodState> start_;
  Eigen::Index unknowns_ = 0;
  Eigen::Index equations_ = 0;
  std::vector<Eigen::Index> contacts_;    // at each node, -1: none
  std::vector<Eigen::Index> arc_length_;  // unknown of each node, -1: it is none of its own
  std::vector<Eigen::Index> force_;       // unknown of each contact
  std::vector<Share> shares_;             // of each interval; empty: none moves
};

}  // namespace dlo::energy_model
