#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "fit/material_profiles.hpp"
#include "least_squares/error_correlation.hpp"

namespace dlo::compare {

/// Errors of the points about the rods of the material that fits best, and up to which sum of
/// squares others fit. A number is E, 0, or the density, 1.
class MaterialErrors {
 public:
  /// @param least  sum of squares at the best one [m^2]
  MaterialErrors(MaterialProfiles& material, const MaterialPoint& best, double least);

  /// Noise, correlation and scatter.
  void tell(MaterialFit& fit) const;

  /// Of the sum of squares, at the ends of a number's interval [m^2].
  [[nodiscard]] double level(std::size_t number) const;

  /// Up to which another local minimum is as good an explanation. Its frames are others as well, so
  /// it is outside the joint region of all fitted numbers only where its sum of squares is so much
  /// larger with a chance of 1e-3 (F distribution; a given noise: chi-squared).
  [[nodiscard]] double rival_level(std::size_t number) const;

  /// The energy model's own error, so that a perfect shape gets no interval of rounding [m].
  [[nodiscard]] static double least_noise(const Scene& scene);

 private:
  void allow_for(const ErrorCovariance& covariance, const std::vector<ResidualSeries>& series,
                 Eigen::Index frames);
  [[nodiscard]] double quantile(std::size_t number) const;
  [[nodiscard]] double excess(std::size_t number) const;

  const MaterialFitOptions& options_;
  double least_;
  double freedom_;  // degrees, of independent errors
  double fitted_;   // numbers that are, frames included
  std::vector<CorrelationEffect> effects_;
  double variance_ = 0;  // of one coordinate if errors were independent [m^2]
  double noise_m_ = 0;
  bool tested_ = false;  // whether errors are correlated
  std::optional<CorrelatedErrors> correlation_;
  std::optional<ScatterBetweenShapes> scatter_;
};

}  // namespace dlo::compare
