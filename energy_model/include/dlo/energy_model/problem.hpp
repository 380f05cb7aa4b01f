#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "dlo/energy_model/drag.hpp"
#include "dlo/energy_model/status.hpp"
#include "dlo/obstacle/body.hpp"

namespace dlo::energy_model {

/// Condition that keeps a clamped cross-section from rotating about its direction.
struct FrameHold {
  /// First director of the rod's frame at the clamp, of which only the part across the direction is
  /// used. None: d1 of the first clamp that holds the rod's frame, transported by the shortest
  /// rotation of that clamp's direction into this one's (held_d1() in turns.hpp).
  std::optional<Eigen::Vector3d> d1;
  double roll = 0;  ///< rotation from d1 about the direction, whole turns counted [rad]
};

/// A grip at one arc length: a clamp (position and direction) or a pin (position). A clamp leaves
/// the twist free unless it holds the frame too; the first clamp of a rod with material directors
/// always holds it.
struct Grip {
  double at = 0;                                       ///< arc length [m], 0 .. length
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  /// Tangent of a clamp, along growing arc length, any length > 0.
  std::optional<Eigen::Vector3d> direction;
  std::optional<FrameHold> frame;  ///< frame that a clamp holds; a pin has none
};

/// A force and a couple at one arc length.
///
/// The couple of a dead load keeps its axis. It has a potential only in a plane: minus torque times
/// the angle of the tangent. `energy` accepts it across the plane of a rod without obstacles and
/// with at most one clamp that holds a frame, and any couple at a clamp. `exact` accepts any couple
/// on a rod without obstacles; out of the plane stability is not judged.
///
/// A load that follows the rod has no potential: only `exact` accepts it, neither at a clamp nor
/// with obstacles.
struct Load {
  double at = 0;                                     ///< arc length [m], 0 .. length
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< [N]
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< [N m]
  /// Whether force and couple rotate with the cross-section. They are then given along its d1, d2
  /// and tangent, which Problem defines; a round straight rod is treated as if it had material
  /// directors.
  bool follows = false;
};

/// A dead force per length in addition to the weight, linear along an interval.
struct LineLoad {
  double begin = 0;                                    ///< arc length [m], 0 .. length
  double end = 0;                                      ///< arc length [m], > begin
  Eigen::Vector3d at_begin = Eigen::Vector3d::Zero();  ///< force per length at `begin` [N/m]
  Eigen::Vector3d at_end = Eigen::Vector3d::Zero();    ///< force per length at `end` [N/m]

  /// Returns the derivative of the force per length by arc length [N/m^2].
  [[nodiscard]] Eigen::Vector3d slope() const { return (at_end - at_begin) / (end - begin); }
  /// Returns the force on the rod between two arc lengths [N]; negative if `to` is less than
  /// `from`.
  [[nodiscard]] Eigen::Vector3d force_between(double from, double to) const;
};

/// A body that the rod's axis may not enter.
struct Obstacle {
  obstacle::Body body;  ///< [m], without sharp edges
  /// Force per depth and per length of rod within the body [N/m^2], > 0; infinite: rigid.
  double stiffness = std::numeric_limits<double>::infinity();
};

/// An interval of the rod with another cross-section.
struct Section {
  double begin = 0;                ///< arc length [m]
  double end = 0;                  ///< arc length [m], > begin
  double bending_stiffness = 0;    ///< EI [N m^2], > 0; about d1 if bending_stiffness_2 is given
  double torsional_stiffness = 0;  ///< GJ [N m^2]; > 0 if that of the Problem is
  Eigen::Vector3d weight_per_length = Eigen::Vector3d::Zero();  ///< rho A g [N/m]
  /// EI about d2 [N m^2], > 0; none: the section is round, with the same EI about every axis
  /// across.
  std::optional<double> bending_stiffness_2 = std::nullopt;
  /// Curvature of the stress-free shape about d1 and d2 [1/m], constant in the section. None: that
  /// of Problem::natural_strains. If a section has its own curvature or twist,
  /// Problem::natural_strains must not be empty.
  std::optional<Eigen::Vector2d> natural_curvature = std::nullopt;
  /// Constant twist of the stress-free shape [rad/m]; none: that of Problem::natural_strains.
  std::optional<double> natural_twist = std::nullopt;
};

/// A rod and everything that acts on it. The rod is inextensible unless axial_stiffness is given.
/// It is round, or has two bending stiffnesses about the principal axes d1 and d2 of its section,
/// as a ribbon or a flat cable. SI units, any right-handed axes.
///
/// Two neighbouring clamps with frames fix the sum of twist and writhe between them (held_turns()
/// in turns.hpp); energy_model/doc/search.md describes how a solver gets there. A rod that
/// has_material_directors() has d1 and d2 fixed to its material. The first clamp along the rod
/// holds them: at its FrameHold::d1, or else d2 is the normal of the plane that grips, weight,
/// obstacles and, without natural strains, loads share (natural_normal()), on the side of +z (of +y
/// if the plane contains z, of +x if it contains y and z), so that a strain u2 > 0 bends the rod to
/// the left; the roll of the clamp is added. Without a clamp the directors are free to rotate. A
/// later clamp holds them only if it has a frame.
struct Problem {
  double length = 0;             ///< l [m], > 0
  double bending_stiffness = 0;  ///< EI [N m^2], > 0; about d1 if bending_stiffness_2 is given
  /// GJ [N m^2]; > 0 if two clamps hold frames or the rod has_material_directors().
  double torsional_stiffness = 0;
  Eigen::Vector3d weight_per_length = Eigen::Vector3d::Zero();  ///< rho A g [N/m]
  std::vector<Grip> grips;                                      ///< one or more
  std::vector<Load> loads;                                      ///< may be empty
  std::vector<LineLoad> line_loads;  ///< may be empty; overlapping ones are added
  std::optional<Drag> drag;          ///< drag on the whole rod; `exact` only
  std::vector<Obstacle> obstacles;   ///< may be empty
  /// Intervals with another cross-section, by arc length, not overlapping.
  std::vector<Section> sections;
  /// Strains u of the stress-free shape about d1, d2 and the tangent t. t' = u2 d1 - u1 d2, and u3
  /// > 0 rotates d1 towards d2. Coefficients of Legendre's polynomials P_j(2 s/l - 1) [1/m]. Empty:
  /// straight, sections too. Not empty: torsional_stiffness > 0.
  std::vector<Eigen::Vector3d> natural_strains;
  /// EI about d2 [N m^2], > 0. None: round, with the same EI about every axis across. Given:
  /// torsional_stiffness > 0.
  std::optional<double> bending_stiffness_2 = std::nullopt;
  /// Whether the rod is confined to the plane of grips and forces, as between two plates: shapes
  /// out of the plane are excluded, and stability is judged in the plane. Only `energy`, without
  /// obstacles and with at most one clamp that holds a frame.
  bool confined_to_plane = false;
  /// EA [N], > 0, of the whole rod: r' = (1 + N/EA) t, N the tension. Arc lengths, weight, loads
  /// per length and strains refer to the unstretched rod. None: inextensible. Only `exact` accepts
  /// it, without obstacles and if all loads have a potential.
  std::optional<double> axial_stiffness = std::nullopt;
};

/// Whether d1 and d2 are fixed to the rod's material. They are if natural_strains is not empty
/// (even if all are zero), or if the rod or one of its sections has bending_stiffness_2 (equal to
/// bending_stiffness or not). A round straight rod has none.
[[nodiscard]] bool has_material_directors(const Problem& problem);

/// Whether a load has a couple.
[[nodiscard]] bool has_couples(const Problem& problem);

/// Whether all loads have a potential, so that an energy determines stability: no drag and no load
/// that follows the rod. Couples, on clamps too, have to be across the plane of the rod. Fewer than
/// two clamps may then hold frames, and material directors have to bend about d2 alone.
[[nodiscard]] bool has_potential(const Problem& problem);

/// Throws if a load is of a kind that has no potential (drag, a load that follows the rod), for
/// solve_energy() and other functions that need one.
/// @throws std::invalid_argument naming the function, the load and solve_exact()
void require_dead_loads(const Problem& problem, const char* function);

/// Checks the ranges of the members, but not whether the rod reaches from grip to grip.
/// @throws std::invalid_argument naming a member out of range, its value and its range
void check(const Problem& problem);

/// Energies [J]. Gravity and loads are zero if their points are at the first of Problem::grips.
/// Couples are zero if the tangent has the direction of the clamp before the load (else of the one
/// after it; without a clamp up to a constant). Out of a plane couples have no energy.
struct Energies {
  double bending = 0;   ///< int 1/2 (EI_1 u1^2 + EI_2 u2^2) ds, with u beyond the natural strains
  double twisting = 0;  ///< int 1/2 GJ tau^2 ds, tau the twist per length beyond the natural one
  double gravity = 0;   ///< potential of the rod's weight
  double load = 0;      ///< potential of loads, at points and per length
  double stretch = 0;   ///< int N^2 / (2 EA) ds, if axial_stiffness is given
  double contact = 0;   ///< energy of yielding obstacles: int 1/2 k d^2 ds, d the depth

  /// Returns the sum of all energies [J].
  [[nodiscard]] double total() const {
    return bending + twisting + gravity + load + stretch + contact;
  }
};

/// Force and torque of a gripper on the rod, the torque about the gripper's position.
struct Reaction {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< [N]
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< [N m]
};

/// Twist of a part of the rod whose ends hold frames. The torque is constant along the part if the
/// rod is round and intrinsically straight.
struct TwistedPart {
  double begin = 0;  ///< arc length [m]
  double end = 0;    ///< arc length [m]
  /// Rotation of the frame at the end from the frame transported there without twist [rad].
  double angle = 0;
  double torque = 0;  ///< torque about the tangent at the end [N m]
};

/// Samples of a shape at given arc lengths.
struct Samples {
  std::vector<double> arc_length;  ///< [m], M
  Eigen::Matrix3Xd points;         ///< [m], 3 x M
  Eigen::Matrix3Xd tangents;       ///< unit, along growing arc length [-], 3 x M
  Eigen::Matrix3Xd curvature;      ///< derivative of the tangent by arc length [1/m], 3 x M
  /// First director of the rod's material, unit and across the tangent, 3 x M. It is given for a
  /// rod that has_material_directors(), by solve_energy(), simulate() and taut_line() for a round
  /// straight rod that clamps twist, and by solve_exact() for one with a load that follows it along
  /// d1 or d2. Clamps that hold a frame have d1 where they hold it. A part whose frame no clamp
  /// holds is not twisted, and a frame without d1 at the begin is arbitrary. Empty for other rods.
  Eigen::Matrix3Xd d1;
};

/// Returns M arc lengths from 0 to `length`, equally spaced [m].
/// @throws std::invalid_argument unless M >= 2 and `length` is finite and > 0
[[nodiscard]] std::vector<double> equal_arc_lengths(double length, Eigen::Index count);

}  // namespace dlo::energy_model
