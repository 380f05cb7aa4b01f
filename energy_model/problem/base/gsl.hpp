#pragma once

#include <gsl/gsl_errno.h>

#include <memory>
#include <new>
#include <vector>

namespace dlo::energy_model {

/// Turns off GSL's error handler, which aborts the program. It has to be called before any other
/// function of GSL, whose status then has to be checked.
inline void silence_gsl() {
  static const bool silent = gsl_set_error_handler_off() != nullptr;
  (void)silent;
}

/// An object that GSL has allocated, together with the function that frees it.
template <class T>
using GslOwned = std::unique_ptr<T, void (*)(T*)>;

/// Takes ownership of an object that GSL has allocated.
/// @throws std::bad_alloc if it is null, as GSL's functions return without its error handler
template <class T>
[[nodiscard]] GslOwned<T> gsl_owned(T* object, void (*release)(T*)) {
  if (object == nullptr) throw std::bad_alloc();
  return {object, release};
}

/// Integrates y' = rates(s, y) from s = 0 to `length` with GSL's rk8pd, in place.
/// @param rates      in GSL's form: s, y, y', data
/// @param tolerance  local error per step, relative to 1 + |component|
/// @return false if the integrator failed or y is not finite
[[nodiscard]] bool integrate(int (*rates)(double, const double*, double*, void*), void* data,
                             double length, double tolerance, std::vector<double>& y);

}  // namespace dlo::energy_model
