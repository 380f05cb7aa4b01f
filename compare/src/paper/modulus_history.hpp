#pragma once

#include <vector>

#include "dlo/compare/effective_modulus.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"

namespace dlo::compare {

/// Steps per simulated second [1/s]: Table 2's 112000 nominal steps in 28 s.
inline constexpr double paper_steps_per_second = 4000;
/// Simulated time of the last sample of a history [s].
inline constexpr double last_history_time = 200;

/// E*/E of a shape that has not yet come to rest.
struct ModulusAtTime {
  double time_s = 0;           ///< simulated time, at paper_steps_per_second [s]
  long steps = 0;              ///< number of steps up to that time
  EffectiveModulus modulus;    ///< fitted modulus at that time
  double rms_over_length = 0;  ///< RMS distance from the energy model at E, divided by the length
  /// RMS distance from the force model's own rest shape, divided by the length.
  double rest_distance_over_length = 0;
};

/// E*/E over time while the force model creeps to rest.
struct ModulusHistory {
  double c_c = 0;                    ///< [N]
  double c_F = 0;                    ///< [m/N]
  std::vector<ModulusAtTime> times;  ///< samples in the order of time
};

/// Steps a scene from its initial shape (straight, for a single gripper) with the stepper `basic`
/// and fits E*/E after 1, 2, 5, ... 200 s of simulated time. c_F is the scene's or Table 1's 0.86
/// L/(2 c_c), so simulated times are comparable only for equal c_c.
/// @param rest  rest shape of the force model with the same c_c
/// @throws InputError, ConvergenceError, also if the steps diverge
[[nodiscard]] ModulusHistory modulus_history(const Scene& scene, const Shape& rest);

/// Returns the simulated time at which E*/E decreases below a ratio, interpolated between the
/// samples by a power law; NaN if it does not [s].
[[nodiscard]] double time_at_ratio(const std::vector<ModulusAtTime>& times, double ratio);

}  // namespace dlo::compare
