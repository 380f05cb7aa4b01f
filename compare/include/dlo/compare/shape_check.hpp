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

/// Options of a comparison.
struct ShapeCheckOptions {
  PoseFreedom pose = PoseFreedom::known;           ///< unknown part of the shape's frame
  ArcLengths arc_lengths = ArcLengths::automatic;  ///< source of the shape's arc lengths
  ModulusSearch modulus = ModulusSearch::yes;      ///< whether E*/E is searched
  SolveOptions solve;                              ///< limits of the solvers
};

/// An equilibrium to which a search from a file's points converged, but whose stability or contacts
/// could not be verified.
struct UnverifiedState {
  double rms_m = 0;     ///< RMS deviation of the file from it, as ShapeCheck::whole_rod_rms_m
  double max_m = 0;     ///< largest deviation, as ShapeCheck::whole_rod_max_m
  std::string message;  ///< message of the solver
};

/// Comparison of a measured shape with the energy model of its scene.
struct ShapeCheck {
  std::string scene;    ///< name of the scene
  std::string file;     ///< name of the shape's file
  double gamma = 0;     ///< w l^3 / (EI) [-]
  double length_m = 0;  ///< l of the rod
  /// Length of the reference; differs from l only if the rod stretches.
  double stretched_length_m = 0;
  Alignment alignment;  ///< the shape as aligned with the reference
  /// The equilibrium nearest to the shape, of the lowest one and those that are proven stable.
  ComparedEquilibrium state;
  Shape reference;  ///< the compared equilibrium at the arc lengths where points are compared
  energy_model::Equilibrium rod;                      ///< the whole compared equilibrium
  std::vector<energy_model::Equilibrium> other_rods;  ///< the other stable equilibria
  /// Given if the search from the file's points converged to an equilibrium that is not verified.
  std::optional<UnverifiedState> unverified;
  /// Deviation of all points from the reference. The weight of a point is the arc length between
  /// its neighbours' middles, of the rod or of the polyline, whichever is longer. Missing ends of
  /// the rod do not count. RMS over length refers to the whole rod. For `nearest`, angle and
  /// curvature are NaN, and distances are from the nearest points in order; if points extend past
  /// an end, the length by which the polyline is longer is distributed along it.
  Deviation deviation;
  double length_beyond_ends_m = 0;  ///< `nearest`: length of the file beyond the rod's ends [m]
  /// RMS deviation of the file as the whole rod: a missing end counts with its distance from the
  /// outermost point.
  double whole_rod_rms_m = 0;
  double whole_rod_max_m = 0;    ///< largest deviation of the file as the whole rod
  std::vector<RodPart> between;  ///< intervals longer than 1e-3 l between adjacent points
  std::string hint;              ///< probable error of the file, as a clause; may be empty
  long worst_point = 0;          ///< point of the largest deviation, counted from 1 as in the file
  /// Position of the worst point in the scene's frame [m].
  Eigen::Vector3d worst_position = Eigen::Vector3d::Zero();
  /// RMS displacement of the reference from straight, over the same interval; or NaN.
  double movement_m = 0;
  double polyline_length_m = 0;  ///< length of the polyline through the points
  double observed_share = 0;     ///< arc length from the first point to the last, divided by l [-]
  double largest_gap_m = 0;      ///< largest arc length between adjacent points
  double largest_gap_at_m = 0;   ///< arc length at which the largest gap begins
  /// Number of the file's points that are not where a gripper holds the rod.
  long measured_points = 0;
  bool is_direction_determined = false;  ///< whether the other direction fits at least 5 % worse
  /// PoseFreedom::rigid: whether the points determine the rotation about the line that fits them
  /// best; false if they lie nearly on it. True for other poses.
  bool is_rotation_determined = true;
  /// E*/E; for each modulus the shape is aligned again, and the equilibrium followed.
  EffectiveModulus effective_modulus;
  NamedValue stiffness;  ///< Scene::stiffness
  /// E* [Pa], or E*I [N m^2] of a rod that is given by EI; NaN without one.
  double modulus = std::numeric_limits<double>::quiet_NaN();
};

/// Solves the scene with the energy model and compares the shape with the nearest stable
/// equilibrium.
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
