#pragma once

#include <vector>

namespace dlo::energy_model {

/// Integrates y' = rates(s, y) from s = 0 to `length` with GSL's rk8pd, in place.
/// @param rates      in GSL's form: s, y, y', data
/// @param tolerance  local error per step, relative to 1 + |component|
/// @return false if the integrator failed or y is not finite
[[nodiscard]] bool integrate(int (*rates)(double, const double*, double*, void*), void* data,
                             double length, double tolerance, std::vector<double>& y);

}  // namespace dlo::energy_model
