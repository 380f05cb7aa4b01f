#pragma once

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

/// What moves with a rod; Problem knows weights only. Cross-sections have no rotary inertia.
struct Inertia {
  double mass_per_length = 0;           ///< rho A [kg/m], outside sections
  std::vector<double> of_sections;      ///< the same of each of Problem::sections
  std::vector<PointMass> point_masses;  ///< may be empty
};

/// Where a mode moves the rod, of a shape that lies in a plane; of a straight one in that which
/// its grips and forces share.
enum class ModePlane {
  in,       ///< in the shape's plane
  out,      ///< across it
  mixed,    ///< both
  spatial,  ///< the shape lies in no plane
};

/// In words, for files.
[[nodiscard]] constexpr const char* to_string(ModePlane plane) {
  switch (plane) {
    case ModePlane::in:
      return "in";
    case ModePlane::out:
      return "out";
    case ModePlane::mixed:
      return "mixed";
    case ModePlane::spatial:
      break;
  }
  return "spatial";
}

/// A free vibration about an equilibrium.
struct VibrationMode {
  /// Square of the angular frequency [1/s^2]; negative: unstable, growing as
  /// exp((-omega_squared)^(1/2) t).
  double omega_squared = 0;
  /// What the terms left out change of omega, over it: by how much it differed with fewer. Of a
  /// rod with a zero mode, whose omega_squared is below 1e-2 EI / (m l^3) with its mass m,
  /// over the root of that.
  double error = std::numeric_limits<double>::infinity();
  ModePlane plane = ModePlane::spatial;  ///< of the movement, about the plane of the shape
  double begin = 0;                      ///< of the part between clamps that moves, arc length [m]
  double end = 0;                        ///< its end [m]
  /// Displacements at arc lengths within [0, length], 3 x M [m], of the movement in which the
  /// farthest point goes 1 m.
  std::function<Eigen::Matrix3Xd(std::span<const double>)> shape;

  /// [rad/s]; NaN of an unstable one.
  [[nodiscard]] double omega() const;
};

/// The slowest modes of a rod about an equilibrium.
struct [[nodiscard]] Vibrations {
  SolveStatus status =
      SolveStatus::not_run;           ///< converged: each mode's error is below the tolerance
  std::string message = "never ran";  ///< the same in words
  int terms = 0;                      ///< of each piece and field
  std::vector<VibrationMode> modes;   ///< by growing omega_squared
};

/// How many, and how well.
struct VibrationOptions {
  int count = 6;                                                ///< modes, > 0
  double tolerance = 1e-9;                                      ///< of omega, relative
  double time_limit = std::numeric_limits<double>::infinity();  ///< [s], > 0
};

/// Small free vibrations without damping about an equilibrium of the energy model: H v = omega^2 M
/// v on the directions that grips leave, H the second variation of the energy less the grips' work,
/// M the mass matrix of the points' movement over the same unknowns. Spans between clamps vibrate
/// each on its own. Twist follows at once, because cross-sections have no inertia. Grips stand, and
/// obstacles that yield push as springs do. Terms are added until omega does not change.
/// @param known  of the same problem; unstable ones have negative squares
/// @throws std::invalid_argument if the problem, the inertia or an option is out of range. A shape
/// that touches a rigid obstacle is `failed`: what vibrates leaves it, and that is not linear
Vibrations vibrations(const Problem& problem, const Inertia& inertia, const Equilibrium& known,
                      const VibrationOptions& options = {});

/// Whether clamps hold a rod straight: each as far from the next one, along the directions of both,
/// as the rod between them is long, to rounding. It has no other shape, and solve_energy() none.
[[nodiscard]] bool is_held_straight(const Problem& problem);

/// vibrations() of a rod that is held straight, whose shape does not determine its tension. To
/// first order a deflection takes no length, so that without tension the modes are those of a beam
/// that is clamped at both ends; with it there is w_ssss EI - tension w_ss = omega^2 m w. The rod
/// that does not stretch keeps them for deflections whose length, int w_s^2/2 ds, the grips' give
/// or the rod's own stretch has.
/// @param tension  of the rod between its clamps [N]; pressed where < 0
/// @throws std::invalid_argument as vibrations(), and if the rod is not held straight, or its
/// weight, a load, natural strains, an obstacle or clamps that hold frames could bend or twist it
Vibrations taut_vibrations(const Problem& problem, const Inertia& inertia, double tension,
                           const VibrationOptions& options = {});

}  // namespace dlo::energy_model
