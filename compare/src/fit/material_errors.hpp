#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "fit/material_profiles.hpp"
#include "least_squares/error_correlation.hpp"

namespace dlo::compare {

/// Errors of the points about the rods of the best material, and the sums of squares up to which
/// other materials fit. The index of a number is 0 for E and 1 for the density.
class MaterialErrors {
 public:
  /// @param least  sum of squares at the best material [m^2]
  MaterialErrors(MaterialProfiles& material, const MaterialPoint& best, double least);

  /// Sets noise, correlation and scatter of the result.
  void tell(MaterialFit& fit) const;

  /// Returns the sum of squares at the ends of a number's interval [m^2].
  [[nodiscard]] double level(std::size_t number) const;

  /// Returns the sum of squares up to which another local minimum is an equally good explanation
  /// [m^2]. Its frames differ too, so it must be outside the joint region of all fitted numbers:
  /// its sum of squares must be so large that the probability is below 1e-3 (F distribution;
  /// chi-squared distribution for given noise).
  [[nodiscard]] double rival_level(std::size_t number) const;

  /// Returns the error of the energy model [m]. With it as lower bound of the noise, the interval
  /// of a perfect shape is not rounding.
  [[nodiscard]] static double least_noise(const Scene& scene);

 private:
  void allow_for(const ErrorCovariance& covariance, const std::vector<ResidualSeries>& series,
                 Eigen::Index frames);
  [[nodiscard]] double quantile(std::size_t number) const;
  [[nodiscard]] double excess(std::size_t number) const;

  const MaterialFitOptions& options_;
  double least_;
  double freedom_;  // degrees of freedom, of independent errors
  double fitted_;   // number of fitted numbers, frames included
  std::vector<CorrelationEffect> effects_;
  double variance_ = 0;  // of one coordinate, for independent errors [m^2]
  double noise_m_ = 0;
  bool tested_ = false;  // whether correlation of errors was tested
  std::optional<CorrelatedErrors> correlation_;
  std::optional<ScatterBetweenShapes> scatter_;
};

}  // namespace dlo::compare
