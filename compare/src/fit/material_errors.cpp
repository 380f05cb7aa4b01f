#include "fit/material_errors.hpp"

#include <algorithm>
#include <cmath>

#include "base/gsl.hpp"
#include "wire/between_shapes.hpp"
#include "wire/identifiable.hpp"

namespace dlo::compare {

double MaterialErrors::least_noise(const Scene& scene) { return 1e-8 * scene.length; }

MaterialErrors::MaterialErrors(MaterialProfiles& material, const MaterialPoint& best, double least)
    : options_(material.options()),
      least_(least),
      freedom_(material.freedom()),
      fitted_(material.measured().frame_numbers() + material.unknowns()),
      effects_(static_cast<std::size_t>(material.unknowns()), {.degrees_of_freedom = freedom_}) {
  const double floor = std::pow(least_noise(material.scenes().front()), 2);
  variance_ = options_.noise ? std::pow(*options_.noise, 2) : std::max(least / freedom_, floor);
  noise_m_ = std::sqrt(variance_);
  if (!(least / std::max(1.0, freedom_) > floor)) return;
  const std::vector<ResidualSeries> series = material.residuals(best);
  if (series.empty()) return;
  const CorrelationEstimate estimate = correlation_of(series);
  tested_ = estimate.tested;
  const Eigen::Index frames = material.measured().frame_columns();
  const ErrorCovariance covariance = estimate.significant ? estimate.covariance : ErrorCovariance();
  if (estimate.significant) allow_for(covariance, series, frames);
  std::vector<Nuisance> nuisances = frame_nuisances(frames);
  if (material.has_density()) nuisances.push_back({frames + 1, 0, INFINITY});
  scatter_ = scatter_between(estimates_of_shapes(series, covariance, std::pow(noise_m_, 2), frames,
                                                 std::vector(material.scenes().size(), nuisances)),
                             quantile(0));
}

/// Sets the effects of correlated errors.
void MaterialErrors::allow_for(const ErrorCovariance& covariance,
                               const std::vector<ResidualSeries>& series, Eigen::Index frames) {
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    effects_[k] = correlation_effect(series, frames + static_cast<Eigen::Index>(k), covariance);
  }
  if (!options_.noise) noise_m_ /= std::sqrt(effects_[0].residual_factor);
  correlation_ = CorrelatedErrors{
      .length_m = covariance.length,
      .share = covariance.share,
      .widening = std::sqrt(excess(0)) * quantile(0) / interval_quantile(options_.noise, freedom_),
      .degrees_of_freedom = effects_[0].degrees_of_freedom};
}

void MaterialErrors::tell(MaterialFit& fit) const {
  fit.noise_m = noise_m_;
  fit.noise_is_estimated = !options_.noise;
  fit.degrees_of_freedom = static_cast<int>(freedom_);
  fit.correlation_was_tested = tested_;
  fit.correlation = correlation_;
  fit.scatter = scatter_;
}

/// Returns half the width of a number's interval, in standard deviations.
double MaterialErrors::quantile(std::size_t number) const {
  return interval_quantile(options_.noise, effects_[number].degrees_of_freedom);
}

/// Returns the variance of a fitted number, divided by that which follows from the sum of squares
/// (or the given noise) under the assumption of independent errors.
double MaterialErrors::excess(std::size_t number) const {
  const CorrelationEffect& effect = effects_[number];
  const double between = scatter_ ? std::pow(scatter_->widening, 2) : 1;
  return between *
         std::max(1.0, effect.variance_factor / (options_.noise ? 1 : effect.residual_factor));
}

double MaterialErrors::level(std::size_t number) const {
  return least_ + std::pow(quantile(number), 2) * excess(number) * variance_;
}

double MaterialErrors::rival_level(std::size_t number) const {
  const double nu = std::max(1.0, effects_[number].degrees_of_freedom);
  const double excess_of_all =
      options_.noise ? gsl_distribution(gsl_cdf_chisq_Qinv, 1e-3, fitted_)
                     : fitted_ * gsl_distribution(gsl_cdf_fdist_Qinv, 1e-3, fitted_, nu);
  return std::max(level(number), least_ + variance_ * excess(number) * excess_of_all);
}

}  // namespace dlo::compare
