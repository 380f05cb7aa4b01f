#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "dlo/force_model/bending.hpp"
#include "dlo/force_model/environment.hpp"
#include "dlo/force_model/grip.hpp"
#include "dlo/force_model/twist.hpp"

namespace dlo::force_model {

/// Model of a rod with points P_0 .. P_n: all that exerts forces on the points.
struct Rod {
  Eigen::VectorXd rest_lengths;  ///< rest lengths of the n segments [m], each > 0
  double c_c = 0;                ///< stretch stiffness [N], >= 0
  Bending bending;               ///< law and stiffness of the joints
  /// Constant force on each point [N], 3 x (n+1): gravity and loads (Formula 5, constraint 1).
  Eigen::Matrix3Xd loads;
  std::vector<Wall> walls;         ///< each acts on every point
  std::vector<Grip> grips;         ///< rigid ones must not share points
  Twist twist = {};                ///< used between grips that hold frames
  std::vector<Solid> solids = {};  ///< obstacles that are not planes
  /// Masses of the points [kg], each >= 0, > 0 where no rigid grip holds the point. Only steps in
  /// real time (Integration) use them. Empty: no masses.
  Eigen::VectorXd masses = {};

  /// Whether there are walls or solids.
  [[nodiscard]] bool has_obstacles() const { return !walls.empty() || !solids.empty(); }
  /// Returns the number of points, N = n + 1.
  [[nodiscard]] Eigen::Index points() const { return rest_lengths.size() + 1; }
  /// Returns the sum of all rest lengths [m].
  [[nodiscard]] double length() const { return rest_lengths.sum(); }
};

/// Whether all forces are in the plane z = 0 if all points are. They are not for a rod between
/// grips that hold its frame, because of twist.
[[nodiscard]] bool is_planar(const Rod& rod);

/// Checks a rod. If two or more grips hold frames, the law must be hooke, the joints between them
/// must have torsional and bending stiffnesses > 0, and there must be no natural angles. A rod with
/// natural angles must be planar.
/// @throws std::invalid_argument naming the first member that is out of range
void check(const Rod& rod);

/// Returns the spans between grips that hold frames, along the rod; empty if there are fewer than
/// two such grips.
/// @throws std::invalid_argument as check
[[nodiscard]] std::vector<TwistedSpan> twisted_spans(const Rod& rod);

/// Computes the sum of all forces on each point (paper, Formula 6). Forces of spring grips are
/// included, those of rigid grips are not: on rigidly held points the result is the opposite of the
/// gripper's force.
/// @param points  positions [m], 3 x (n+1)
/// @param[out] forces  overwritten [N], 3 x (n+1)
/// @throws std::invalid_argument if a shape or number is out of range
void total_forces(const Rod& rod, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                  Eigen::Ref<Eigen::Matrix3Xd> forces);

/// Returns the force and torque of each grip on the rod in this shape, in the order of rod.grips.
/// @throws std::invalid_argument if a shape is wrong or two rigid grips hold the same point
[[nodiscard]] std::vector<GripReaction> grip_reactions(
    const Rod& rod, const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// Computes grip_reactions() without allocation, for real-time loops.
/// @param[out] forces     the total forces on the points [N], 3 x (n+1)
/// @param[out] reactions  as many as rod.grips
/// @throws std::invalid_argument as the function above
void grip_reactions(const Rod& rod, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                    Eigen::Ref<Eigen::Matrix3Xd> forces, std::span<GripReaction> reactions);

/// Energies of a shape [J]. `load` is the potential of gravity and loads, with its zero at the
/// origin.
struct RodEnergy {
  double bending = 0;  ///< energy of the joints
  double stretch = 0;  ///< energy of the segments
  double load = 0;     ///< potential of gravity and loads
  double contact = 0;  ///< energy of walls, solids and spring grips
  double twist = 0;    ///< energy between grips that hold frames

  /// Returns the sum of all energies [J].
  [[nodiscard]] double total() const { return bending + stretch + load + contact + twist; }
};

/// Computes the energies of a shape. @param points  [m], 3 x (n+1). @throws std::invalid_argument
/// if a shape or number is out of range
[[nodiscard]] RodEnergy energy(const Rod& rod, const Eigen::Ref<const Eigen::Matrix3Xd>& points);

}  // namespace dlo::force_model
