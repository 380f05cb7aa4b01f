#pragma once

#include <string>
#include <vector>

#include "shooting/rod_flow.hpp"
#include "shooting/shooting_system.hpp"

namespace dlo::energy_model {

/// How Newton's method has ended.
struct [[nodiscard]] ClosedGaps {
  bool converged = false;
  std::string message = "Newton's method took too many steps";
  int shots = 0;
};

/// Whether the rod can move for nearly nothing, as a buckle along a twisted rod: then it must not
/// drift that way.
enum class Modes { stiff, nearly_zero };

/// Newton's method on the equations of multiple shooting. Steps are damped until the next
/// simplified step is shorter (Deuflhard's natural monotonicity); where there is no such step,
/// because of a zero mode or nearly one, a Levenberg step makes the gaps smaller.
ClosedGaps close_gaps(const ShootingSystem& system, ShootingPoint& point, int max_iterations,
                      Modes modes);

}  // namespace dlo::energy_model
