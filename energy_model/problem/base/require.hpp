#pragma once

#include <Eigen/Core>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace dlo::energy_model {

/// Throws std::invalid_argument "function: argument = value, must be allowed" unless `good`.
inline void require(bool good, std::string_view function, std::string_view argument, double value,
                    std::string_view allowed) {
  if (good) return;
  std::ostringstream message;
  message << function << ": " << argument << " = " << value << ", must be " << allowed;
  throw std::invalid_argument(message.str());
}

inline void require_positive(std::string_view function, std::string_view argument, double value) {
  require(value > 0 && std::isfinite(value), function, argument, value, "finite and > 0");
}

inline void require_not_negative(std::string_view function, std::string_view argument,
                                 double value) {
  require(value >= 0 && std::isfinite(value), function, argument, value, ">= 0 and finite");
}

/// Checks that a number or all components of an array are finite.
/// @throws std::invalid_argument naming the number, or the norm of the array
inline void require_finite(std::string_view function, std::string_view argument, double value) {
  require(std::isfinite(value), function, argument, value, "finite");
}
template <typename Derived>
void require_finite(std::string_view function, std::string_view argument,
                    const Eigen::MatrixBase<Derived>& values) {
  require(values.allFinite(), function, argument, values.norm(), "finite");
}

}  // namespace dlo::energy_model
