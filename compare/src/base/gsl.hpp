#pragma once

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_errno.h>

#include <array>
#include <cmath>
#include <memory>
#include <new>
#include <stdexcept>
#include <type_traits>

namespace dlo::compare {

/// Turns off GSL's error handler, which aborts the program; GSL then reports errors by its statuses
/// alone. Every function that calls GSL calls this first.
inline void silence_gsl() {
  static const bool silent = gsl_set_error_handler_off() != nullptr;
  (void)silent;
}

/// Takes ownership of an object that GSL has allocated.
/// @throws std::bad_alloc if it is null, as GSL's functions return without its error handler
template <class T>
[[nodiscard]] std::unique_ptr<T, void (*)(T*)> gsl_owned(T* object, void (*release)(T*)) {
  if (object == nullptr) throw std::bad_alloc();
  return {object, release};
}

/// Calls one of GSL's distribution functions, such as gsl_cdf_tdist_Pinv, which have no status.
/// @throws std::domain_error if GSL returns NaN: an argument is out of range, or its iteration has
/// not converged
template <class... Arguments>
[[nodiscard]] double gsl_distribution(double (*function)(Arguments...),
                                      std::type_identity_t<Arguments>... arguments) {
  silence_gsl();
  const double value = function(arguments...);
  if (!std::isnan(value)) return value;
  const std::array values = {arguments...};
  throw std::domain_error(
      fmt::format("a GSL distribution function has no value at ({:.9g})", fmt::join(values, ", ")));
}

}  // namespace dlo::compare
