#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/alignment.hpp"
#include "dlo/compare/compared_state.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/effective_modulus.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::compare {

/// How a shape is compared.
struct ShapeCheckOptions {
  PoseFreedom pose = PoseFreedom::known;           ///< what is unknown of its frame
  ArcLengths arc_lengths = ArcLengths::automatic;  ///< where its arc lengths come from
  ModulusSearch modulus = ModulusSearch::yes;      ///< whether E*/E is looked for
  SolveOptions solve;                              ///< limits of the solvers
};

/// An equilibrium to which a search from a file's points converged, but whose stability or contacts
/// could not be verified.
struct UnverifiedState {
  double rms_m = 0;     ///< RMS deviation of the file from it, as ShapeCheck::whole_rms_m
  double max_m = 0;     ///< largest deviation, as ShapeCheck::whole_max_m
  std::string message;  ///< of the solver
};

/// A measured shape against the energy model of its scene.
struct ShapeCheck {
  std::string scene;              ///< its name
  std::string file;               ///< the shape's name
  double gamma = 0;               ///< w l^3 / (EI) [-]
  double length_m = 0;            ///< l of the rod
  double stretched_length_m = 0;  ///< length of the reference: l but for a rod that stretches
  Alignment alignment;            ///< the shape as laid on the reference
  ComparedState state;            ///< the stable one that the shape comes nearest to
  Shape reference;                ///< the energy model at the alignment's arc lengths
  energy_model::Equilibrium rod;  ///< all of it
  std::vector<energy_model::Equilibrium> other_rods;  ///< the other stable equilibria
  /// Empty if the search from the file's points found a verified equilibrium or was not needed.
  std::optional<UnverifiedState> unverified;
  /// Of all points from the reference, each with the longer of the rod's arc length and the
  /// polyline's own between its neighbours; parts of the rod that are missing at the ends do not
  /// count. RMS over length is of the whole rod. For `nearest` distances are from the nearest
  /// points in order, but where points go on past an end the file is longer than the rod, and the
  /// excess is spread along it. Tangent and curvature only for given arc lengths: NaN.
  Deviation deviation;
  double excess_m = 0;  ///< `nearest`: by which the file is longer than the rod, past its ends
  /// RMS and largest deviation of the file as the whole rod: what is missing of the rod at an end
  /// counts with its distance from the outermost point.
  double whole_rms_m = 0;
  double whole_max_m = 0;        ///< the largest of those
  std::vector<RodPart> between;  ///< parts longer than 1e-3 l between neighbouring points
  std::string hint;              ///< what looks wrong: a clause, or empty
  long worst_point = 0;          ///< of the largest deviation, counted from 1 as in the file
  Eigen::Vector3d worst_position = Eigen::Vector3d::Zero();  ///< in the scene's frame [m]
  double movement_m = 0;         ///< RMS way of the reference from straight, same stretch; or NaN
  double polyline_length_m = 0;  ///< of the points as they are
  double seen_share = 0;         ///< arc length from the first point to the last, over l [-]
  double largest_gap_m = 0;      ///< largest arc length between neighbours
  double largest_gap_at_m = 0;   ///< where it begins
  long measured_points = 0;  ///< of the file's, those that are not where a gripper holds the rod
  bool direction_is_clear = false;  ///< the other direction fits at least 5 % worse
  /// The points lie so nearly on a line that nothing tells how the shape is turned about it.
  bool turn_is_clear = true;
  EffectiveModulus effective_modulus;  ///< aligned anew for each modulus, in the same state
  NamedValue stiffness;                ///< Scene::stiffness
  /// E* [Pa], of a rod that is given by EI that [N m^2]; NaN without one.
  double modulus = std::numeric_limits<double>::quiet_NaN();
};

/// Solves the scene with the energy model and compares the shape with the nearest stable state.
/// @throws InputError, ConvergenceError
[[nodiscard]] ShapeCheck check_shape(const Scene& scene, const MeasuredShape& shape,
                                     const ShapeCheckOptions& options = {});

/// Equilibrium of a scene without weight and loads, the shape that depends on neither stiffness nor
/// weight: grippers, obstacles and natural curvature stay.
struct TrivialShape {
  energy_model::Equilibrium rod;  ///< stable
  double deflection_m = 0;        ///< largest distance from the rod with weight and loads [m]
};

/// Finds the trivial shape that belongs to an equilibrium: weight and loads are removed, and the
/// solver starts from that equilibrium. Empty if no stable one is found.
[[nodiscard]] std::optional<TrivialShape> trivial_shape(const Scene& scene,
                                                        const energy_model::Equilibrium& loaded,
                                                        const SolveOptions& options = {});

/// Returns the deflection, for a tolerance that is a share of it [m].
/// @throws InputError if it is below 1e-6 of the length, ConvergenceError without a trivial shape
[[nodiscard]] double required_deflection(const Scene& scene,
                                         const std::optional<TrivialShape>& trivial);

/// Compares the trivial shape with the equilibrium that a shape was compared with, at the shape's
/// arc lengths and by the same options, without E*/E.
/// @param check  of check_shape()
[[nodiscard]] ShapeCheck check_trivial_shape(const TrivialShape& trivial, const Scene& scene,
                                             const ShapeCheck& check,
                                             const ShapeCheckOptions& options);

}  // namespace dlo::compare
