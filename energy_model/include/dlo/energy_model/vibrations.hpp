#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::energy_model {

/// A mass that the rod carries at one point.
struct PointMass {
  double at = 0;    ///< arc length [m]
  double mass = 0;  ///< [kg], >= 0
};

/// Mass distribution of a rod; Problem contains weights only. Cross-sections have no rotary
/// inertia.
struct Inertia {
  double mass_per_length = 0;           ///< rho A [kg/m], outside sections
  std::vector<double> of_sections;      ///< rho A of each of Problem::sections [kg/m]
  std::vector<PointMass> point_masses;  ///< may be empty
};

/// Direction of a mode's motion, relative to the plane of the shape. A straight shape has the plane
/// that its grips and forces share.
enum class ModePlane {
  in,       ///< motion in the shape's plane
  out,      ///< motion across the shape's plane
  mixed,    ///< motion in both directions
  spatial,  ///< the shape is in no plane
};

/// Returns the name of the plane, as files contain it.
[[nodiscard]] constexpr const char* to_string(ModePlane plane) {
  constexpr std::array names = {"in", "out", "mixed", "spatial"};
  return names[static_cast<std::size_t>(plane)];
}

/// A free vibration about an equilibrium.
struct VibrationMode {
  /// Square of the angular frequency [1/s^2]; negative: unstable, the mode grows as
  /// exp((-omega_squared)^(1/2) t).
  double omega_squared = 0;
  /// Estimated relative truncation error of omega: half the change of omega_squared from fewer
  /// terms, divided by |omega_squared|, or by 1e-2 EI / (m l^3) if that is larger, as for a zero
  /// mode; m is the mass of the rod and its point masses.
  double error = std::numeric_limits<double>::infinity();
  /// Plane of the motion, relative to the plane of the shape.
  ModePlane plane = ModePlane::spatial;
  double begin = 0;  ///< begin of the moving part between clamps, arc length [m]
  double end = 0;    ///< end of the moving part, arc length [m]
  /// Returns the displacements at arc lengths within [0, length], 3 x M [m], scaled to a largest
  /// displacement of 1 m.
  std::function<Eigen::Matrix3Xd(std::span<const double>)> shape;

  /// Returns the angular frequency [rad/s]; NaN for an unstable mode.
  [[nodiscard]] double omega() const;
};

/// Modes of a rod about an equilibrium with the lowest frequencies.
struct [[nodiscard]] Vibrations {
  /// `converged`: each mode's error is below the tolerance.
  SolveStatus status = SolveStatus::not_run;
  std::string message = "never ran";  ///< the status in words
  int terms = 0;                      ///< coefficients of each element and strain component
  std::vector<VibrationMode> modes;   ///< by growing omega_squared
};

/// Number, accuracy and time limit of the modes.
struct VibrationOptions {
  int count = 6;            ///< number of modes, > 0
  double tolerance = 1e-9;  ///< relative error of omega
  /// Time limit [s], > 0. A call that reaches it while it solves for the shape is `failed`.
  double time_limit = std::numeric_limits<double>::infinity();
};

/// Computes small free vibrations without damping about an equilibrium of the energy model: H v =
/// omega^2 M v in the directions that grips leave free. H is the second variation of the energy
/// minus the work of the grips, M the mass matrix of the points' motion in the same unknowns. Spans
/// between clamps vibrate independently. Twist is in equilibrium at each time, because
/// cross-sections have no rotary inertia. Grips do not move, and yielding obstacles act as springs.
/// Terms are added until omega does not change.
/// @param known  equilibrium of the same problem; modes of an unstable one have negative squares
/// @throws std::invalid_argument if the problem, the inertia or an option is out of range, for
/// couples and confined_to_plane, and as solve_energy() for grips (a taut_line() included) and
/// loads. A shape that touches a rigid obstacle is `failed`: a vibrating rod lifts off, which is
/// not linear
Vibrations vibrations(const Problem& problem, const Inertia& inertia, const Equilibrium& known,
                      const VibrationOptions& options = {});

/// Whether every grip is a clamp, there are two or more, and they hold the rod between them
/// straight: each is as far from the next one, along the directions of both, as the rod between
/// them is long, to rounding. If the rod is inextensible, the line is then the only shape of this
/// part; free ends beyond the outer clamps are not considered. solve_energy() returns the line only
/// if taut_line() applies.
[[nodiscard]] bool is_held_straight(const Problem& problem);

/// Computes vibrations() of a rod that is_held_straight(), whose shape does not determine its
/// tension. To first order a deflection needs no additional length, so that without tension the
/// modes are those of a beam that is clamped at both ends; with tension w_ssss EI - tension w_ss =
/// omega^2 m w. An inextensible rod has these modes if compliance of the grips or stretch of the
/// rod provides the length of the deflection, int w_s^2/2 ds. VibrationOptions::time_limit is not
/// used.
/// @param tension  tension of the rod between its clamps [N]; compression if < 0
/// @throws std::invalid_argument as vibrations(), and if the rod is not held straight, or if its
/// weight, a load, natural strains, an obstacle or two clamps that hold frames could bend or twist
/// it
Vibrations taut_vibrations(const Problem& problem, const Inertia& inertia, double tension,
                           const VibrationOptions& options = {});

}  // namespace dlo::energy_model
