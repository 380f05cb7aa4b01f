#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "dlo/force_model/bending.hpp"
#include "dlo/force_model/environment.hpp"
#include "dlo/force_model/grip.hpp"
#include "dlo/force_model/twist.hpp"

namespace dlo::force_model {

/// Everything that makes forces on the points P_0 .. P_n of a rod.
struct Rod {
  Eigen::VectorXd rest_lengths;    ///< of the n segments [m], each > 0
  double c_c = 0;                  ///< stretch stiffness [N], >= 0
  Bending bending;                 ///< law and stiffness of the joints
  Eigen::Matrix3Xd loads;          ///< constant force on each point: gravity and loads (Formula 5,
                                   ///< constraint 1) [N], 3 x (n+1)
  std::vector<Wall> walls;         ///< each acts on every point
  std::vector<Grip> grips;         ///< rigid ones hold points of their own
  Twist twist = {};                ///< of use between grips that hold frames
  std::vector<Solid> solids = {};  ///< obstacles that are not planes
  /// Of the points [kg], each >= 0; only steps in real time (Integration) ask for them, and then
  /// for > 0 where no rigid grip holds the point. Empty: none.
  Eigen::VectorXd masses = {};

  /// Whether there are walls or solids.
  [[nodiscard]] bool touches_anything() const { return !walls.empty() || !solids.empty(); }
  /// N = n + 1.
  [[nodiscard]] Eigen::Index points() const { return rest_lengths.size() + 1; }
  /// Of all segments at rest [m].
  [[nodiscard]] double length() const { return rest_lengths.sum(); }
};

/// Whether no force can leave the plane z = 0 if all points lie in it; a rod between grips that
/// hold its frame can, by twist.
[[nodiscard]] bool is_planar(const Rod& rod);

/// Two grips that hold frames ask for law hooke, stiffnesses > 0 (also of bending, between them)
/// and no natural turns.
/// @throws std::invalid_argument naming the first member that is out of range
void check(const Rod& rod);

/// What grips that hold frames twist, along the rod; empty if there are fewer than two.
/// @throws std::invalid_argument as check
[[nodiscard]] std::vector<TwistedSpan> twisted_spans(const Rod& rod);

/// Sum of all forces on each point (paper, Formula 6), those of spring grips included, those of
/// rigid grips not: on rigidly held points the result is minus what the gripper has to exert.
/// @param points  positions [m], 3 x (n+1)
/// @param[out] forces  overwritten [N], 3 x (n+1)
/// @throws std::invalid_argument if a shape or number is out of range
void total_forces(const Rod& rod, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                  Eigen::Ref<Eigen::Matrix3Xd> forces);

/// What each grip exerts on the rod in this shape, in the order of rod.grips.
/// @throws std::invalid_argument if a shape is wrong or two rigid grips hold the same point
[[nodiscard]] std::vector<GripReaction> grip_reactions(
    const Rod& rod, const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// The same without an allocation, for a loop that may not wait for one.
/// @param[out] forces     the total forces on the points [N], 3 x (n+1)
/// @param[out] reactions  as many as rod.grips
/// @throws std::invalid_argument as above
void grip_reactions(const Rod& rod, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                    Eigen::Ref<Eigen::Matrix3Xd> forces, std::span<GripReaction> reactions);

/// Energies of a shape [J]; gravity and loads count as `load`, with their zero at the origin.
struct RodEnergy {
  double bending = 0;  ///< of the joints
  double stretch = 0;  ///< of the segments
  double load = 0;     ///< of gravity and loads
  double contact = 0;  ///< walls, solids and spring grips
  double twist = 0;    ///< between grips that hold frames

  /// Of all [J].
  [[nodiscard]] double total() const { return bending + stretch + load + contact + twist; }
};

/// @param points  [m], 3 x (n+1). @throws std::invalid_argument if a shape or number is out of
/// range
[[nodiscard]] RodEnergy energy(const Rod& rod, const Eigen::Ref<const Eigen::Matrix3Xd>& points);

}  // namespace dlo::force_model
