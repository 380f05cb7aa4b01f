#pragma once

#include <vector>

#include "dlo/compare/effective_modulus.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"

namespace dlo::compare {

/// Steps of a simulated second [1/s]: Table 2's 112000 nominal steps in 28 s.
inline constexpr double paper_steps_per_second = 4000;
/// Simulated time of the last look at a history [s].
inline constexpr double last_history_time = 200;

/// E*/E of a shape that is still on its way to rest.
struct ModulusAtTime {
  double time_s = 0;                     ///< simulated, at paper_steps_per_second
  long steps = 0;                        ///< to that time
  EffectiveModulus modulus;              ///< at that time
  double rms_over_length = 0;            ///< against the energy model at E
  double rest_distance_over_length = 0;  ///< RMS distance to the force model's own rest shape
};

/// How E*/E changes while the force model creeps to rest.
struct ModulusHistory {
  double c_c = 0;                    ///< [N]
  double c_F = 0;                    ///< [m/N]
  std::vector<ModulusAtTime> times;  ///< by time
};

/// Steps a scene from its start (straight, for a single gripper) with the stepper `basic` and
/// looks at it after 1, 2, 5, ... 200 s of simulated time. c_F is the scene's or Table 1's
/// 0.86 L/(2 c_c), so a simulated second means something for one c_c only.
/// @param rest  the force model's rest shape with the same c_c
/// @throws InputError, ConvergenceError, also if the steps diverge
[[nodiscard]] ModulusHistory modulus_history(const Scene& scene, const Shape& rest);

/// Simulated time at which E*/E passes a ratio on its way down, between the times that were looked
/// at (power law); NaN if it does not [s].
[[nodiscard]] double time_at_ratio(const std::vector<ModulusAtTime>& times, double ratio);

}  // namespace dlo::compare
