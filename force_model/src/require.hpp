#pragma once

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

namespace dlo::force_model {

/// Throws "function: argument = value, must be allowed".
[[noreturn]] inline void reject(std::string_view function, std::string_view argument, double value,
                                std::string_view allowed) {
  std::ostringstream message;
  message << function << ": " << argument << " = " << value << ", must be " << allowed;
  throw std::invalid_argument(message.str());
}

inline void require(bool good, std::string_view function, std::string_view argument, double value,
                    std::string_view allowed) {
  if (!good) reject(function, argument, value, allowed);
}

inline void require_positive(std::string_view function, std::string_view argument, double value) {
  require(value > 0 && std::isfinite(value), function, argument, value, "finite and > 0");
}

inline void require_not_negative(std::string_view function, std::string_view argument,
                                 double value) {
  require(value >= 0 && std::isfinite(value), function, argument, value, "finite and >= 0");
}

/// Checks shapes and finiteness, which every function of points requires.
template <typename Points, typename Lengths>
void require_polygon(std::string_view function, const Points& points, const Lengths& rest_lengths) {
  const auto segments = rest_lengths.size();
  require(segments >= 1, function, "number of segments", static_cast<double>(segments), ">= 1");
  // The message is built only on failure, because steps must not allocate.
  if (points.cols() != segments + 1) {
    reject(function, "number of points", static_cast<double>(points.cols()),
           std::to_string(segments + 1) + ", one more than segments");
  }
  if (!points.allFinite()) {
    throw std::invalid_argument(std::string(function) +
                                ": points contain a value that is not finite");
  }
  const double shortest = rest_lengths.minCoeff();
  require(shortest > 0 && rest_lengths.allFinite(), function, "smallest rest length", shortest,
          "finite and > 0");
}

}  // namespace dlo::force_model
