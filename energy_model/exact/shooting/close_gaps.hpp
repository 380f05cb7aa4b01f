#pragma once

#include <string>
#include <vector>

#include "shooting/rod_flow.hpp"
#include "shooting/shooting_system.hpp"

namespace dlo::energy_model {

/// Outcome of Newton's method.
struct [[nodiscard]] ClosedGaps {
  bool converged = false;
  std::string message = "Newton's method reached its iteration limit";
  int shots = 0;
};

/// Whether the rod has nearly zero modes, such as a buckle that slides along a twisted rod: steps
/// along them are then suppressed.
enum class Modes { stiff, nearly_zero };

/// Solves the equations of multiple shooting by Newton's method. Steps are damped until the next
/// simplified step is shorter (Deuflhard's natural monotonicity). If there is no such step, because
/// of a zero mode or nearly one, a Levenberg step reduces the gaps.
ClosedGaps close_gaps(const ShootingSystem& system, ShootingPoint& point, int max_iterations,
                      Modes modes);

}  // namespace dlo::energy_model
