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

/// Keeps a clamped cross-section from rotating about its direction.
struct FrameHold {
  /// First director of the rod's frame there, of which the part across the direction counts; none:
  /// that of the first clamp that holds the frame, carried here by the shortest rotation of that
  /// clamp's direction into this one's (held_d1() in turns.hpp).
  std::optional<Eigen::Vector3d> d1;
  double roll = 0;  ///< turned on from there about the direction, whole turns counted [rad]
};

/// Holds the rod at one arc length: a clamp (position and direction) or a pin (position). A clamp
/// leaves the twist free unless it holds the frame too.
struct Grip {
  double at = 0;                                       ///< arc length [m], 0 .. length
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  std::optional<Eigen::Vector3d> direction;            ///< along growing arc length, any length > 0
  std::optional<FrameHold> frame;                      ///< of a clamp
};

/// A force and a couple. Dead, a couple keeps its axis; it has a potential in a plane alone, minus
/// torque times the tangent's angle: `energy` takes it across the plane of the rod, of what touches
/// nothing and holds no frame. `exact` takes any; out of the plane nobody judges stability.
///
/// What follows the rod has none: `exact` alone takes it, where no clamp is.
struct Load {
  double at = 0;                                     ///< arc length [m], 0 .. length
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< [N]
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< [N m]
  /// Whether both turn with the section, given along its d1, d2 and tangent: where these are says
  /// Problem, of a round straight rod as if it had material directors.
  bool follows = false;
};

/// A dead force per length besides the weight, linear along its part.
struct LineLoad {
  double begin = 0;                                    ///< arc length [m], 0 .. length
  double end = 0;                                      ///< arc length [m], > begin
  Eigen::Vector3d at_begin = Eigen::Vector3d::Zero();  ///< [N/m]
  Eigen::Vector3d at_end = Eigen::Vector3d::Zero();    ///< [N/m]

  /// By which it grows [N/m^2].
  [[nodiscard]] Eigen::Vector3d slope() const { return (at_end - at_begin) / (end - begin); }
  /// Of what lies between two arc lengths [N]; negative where `to` comes first.
  [[nodiscard]] Eigen::Vector3d between(double from, double to) const;
};

/// A body that the rod's axis may not enter.
struct Obstacle {
  obstacle::Body body;  ///< [m]
  /// Force per depth and per length of rod within the body [N/m^2], > 0; infinite: rigid.
  double stiffness = std::numeric_limits<double>::infinity();
};

/// A part of the rod whose section is another one.
struct Section {
  double begin = 0;                ///< arc length [m]
  double end = 0;                  ///< arc length [m], > begin
  double bending_stiffness = 0;    ///< EI [N m^2], > 0; about d1 where bending_stiffness_2 is given
  double torsional_stiffness = 0;  ///< GJ [N m^2]; > 0 where Problem's has to be
  Eigen::Vector3d weight_per_length = Eigen::Vector3d::Zero();  ///< rho A g [N/m]
  /// EI about d2 [N m^2], > 0; none: the section is round, EI is that about every axis across.
  std::optional<double> bending_stiffness_2 = std::nullopt;
  /// Curvature of the stress-free shape about d1 and d2 [1/m], the same all along it; none: as
  /// Problem::natural_strains say, which are not empty where a section has its own.
  std::optional<Eigen::Vector2d> natural_curvature = std::nullopt;
  std::optional<double> natural_twist = std::nullopt;  ///< the same of the twist [rad/m]
};

/// A rod, inextensible but where axial_stiffness is given, round or of two bending stiffnesses
/// about the principal axes d1 and d2 of its section, as a ribbon or a flat cable has them; SI
/// units, any right-handed axes.
///
/// Two neighbouring clamps with frames fix the twist and writhe between them (held_turns() in
/// turns.hpp); energy_model/doc/search.md says how a solver comes there. A rod that
/// has_material_directors() has d1 and d2 fixed to its material. The first clamp along it holds
/// them: at its FrameHold::d1, or else d2 is the normal of the plane that grips and forces share,
/// on the side of +z (+y, +x where the plane holds those), so that a strain u2 > 0 bends the rod to
/// the left; its roll turns them on. Where no clamp holds the rod they are free. A later clamp
/// holds them only if it has a frame.
struct Problem {
  double length = 0;               ///< l [m], > 0
  double bending_stiffness = 0;    ///< EI [N m^2], > 0; about d1 where bending_stiffness_2 is given
  double torsional_stiffness = 0;  ///< GJ [N m^2]; > 0 where two clamps hold frames
  Eigen::Vector3d weight_per_length = Eigen::Vector3d::Zero();  ///< rho A g [N/m]
  std::vector<Grip> grips;                                      ///< one or more
  std::vector<Load> loads;                                      ///< may be empty
  std::vector<LineLoad> line_loads;                             ///< may be empty; they add up
  std::optional<Drag> drag;                                     ///< on all of it; `exact` alone
  std::vector<Obstacle> obstacles;                              ///< may be empty
  std::vector<Section> sections;  ///< where it is another one, by arc length, none over another
  /// Strains u of the stress-free shape about d1, d2 and the tangent t, of which t' = u2 d1 - u1 d2
  /// and u3 turns d1 towards d2: coefficients of Legendre's polynomials P_j(2 s/l - 1) [1/m].
  /// Empty: straight, sections too. Not empty: torsional_stiffness > 0.
  std::vector<Eigen::Vector3d> natural_strains;
  /// EI about d2 [N m^2], > 0; none: round, EI is that about every axis across. Given:
  /// torsional_stiffness > 0.
  std::optional<double> bending_stiffness_2 = std::nullopt;
  /// The rod moves in the plane of grips and forces alone, as between two plates: shapes beside it
  /// are none, and stability is judged in it. Only `energy`, without obstacles and held frames.
  bool confined_to_plane = false;
  /// EA [N], > 0, of all of the rod: r' = (1 + N/EA) t, N the tension. Arc lengths, weight and
  /// loads per length and strains are those of the unstretched rod. None: it does not stretch.
  /// `exact` alone takes it, of a rod that touches nothing.
  std::optional<double> axial_stiffness = std::nullopt;
};

/// Whether d1 and d2 are fixed to the rod's material: it is not intrinsically straight, or it or
/// one of its sections has two bending stiffnesses, were they equal. A round straight rod has none.
[[nodiscard]] bool has_material_directors(const Problem& problem);

/// Whether a load has a couple.
[[nodiscard]] bool has_couples(const Problem& problem);

/// Whether all loads have a potential, so that an energy says what is stable: no drag, none that
/// follows the rod, no couple but across the plane of a rod that keeps to one and is not twisted.
[[nodiscard]] bool has_potential(const Problem& problem);

/// Whether solve_energy() and what else needs a potential has to refuse loads whose kind has none.
/// @throws std::invalid_argument naming the function, the load and solve_exact()
void require_dead_loads(const Problem& problem, const char* function);

/// Whether each member is in its range. That the rod reaches from grip to grip is for the solvers
/// to ask.
/// @throws std::invalid_argument naming the first member that is not, its value and its range
void check(const Problem& problem);

/// Energies [J]; gravity and loads are zero where their points sit at the first grip, couples where
/// the tangent has the direction of the clamp before (else of that after; without a clamp up to a
/// constant). Out of a plane couples have none.
struct Energies {
  double bending = 0;   ///< int 1/2 (EI_1 u1^2 + EI_2 u2^2) ds, of what is not natural of u
  double twisting = 0;  ///< int 1/2 GJ tau^2 ds, tau the twist per length that is not natural
  double gravity = 0;   ///< of the rod's weight
  double load = 0;      ///< of loads, at points and per length
  double contact = 0;   ///< of obstacles that yield: int 1/2 k d^2 ds, d the depth
  double stretch = 0;   ///< int N^2 / (2 EA) ds, where axial_stiffness is given

  /// Of all [J].
  [[nodiscard]] double total() const {
    return bending + twisting + gravity + load + contact + stretch;
  }
};

/// What a gripper exerts on the rod, the torque about the gripper's position.
struct Reaction {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< [N]
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< [N m]
};

/// Twist of a part of the rod whose ends hold frames. The torque is the same all along where the
/// rod is round and intrinsically straight.
struct TwistedPart {
  double begin = 0;   ///< arc length [m]
  double end = 0;     ///< arc length [m]
  double angle = 0;   ///< by which the frame at the end is turned ahead of transport [rad]
  double torque = 0;  ///< about the tangent, at the end [N m]
};

/// A shape at given arc lengths.
struct Samples {
  std::vector<double> arc_length;  ///< [m], M
  Eigen::Matrix3Xd points;         ///< [m], 3 x M
  Eigen::Matrix3Xd tangents;       ///< unit, along growing arc length [-], 3 x M
  Eigen::Matrix3Xd curvature;      ///< derivative of the tangent by arc length [1/m], 3 x M
  /// First director of the rod's material, unit and across the tangent, 3 x M: of a rod that
  /// has_material_directors(), from solve_energy() of a round straight one that clamps twist, and
  /// from solve_exact() of one that a load follows along d1 or d2.
  /// Clamps that hold a frame have it where they hold it; what holds none is not twisted, and a
  /// frame without d1 at the begin has any. Empty of others.
  Eigen::Matrix3Xd d1;
};

/// M arc lengths from 0 to `length`, equally spaced [m]. @throws std::invalid_argument unless M >=
/// 2
[[nodiscard]] std::vector<double> equal_arc_lengths(double length, Eigen::Index count);

}  // namespace dlo::energy_model
