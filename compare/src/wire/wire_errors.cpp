#include "wire/wire_errors.hpp"

#include <algorithm>
#include <cmath>

#include "least_squares/linear_fit.hpp"

namespace dlo::compare {

WireErrors errors_about(const GaussNewton& fit, Eigen::Index frames,
                        const std::optional<double>& noise, double least_noise) {
  WireErrors errors{.variance = fit.variance(),
                    .freedom = fit.freedom(),
                    .squares = fit.deviance(),
                    .freedom_of_squares = fit.freedom()};
  if (!(fit.variance() > least_noise * least_noise)) return errors;
  const CorrelationEstimate estimate = correlation_of(fit.series());
  errors.tested = estimate.tested;
  if (!estimate.significant) return errors;
  errors.correlation = estimate.covariance;
  const VarianceEstimate seen = variance_under(fit.series(), errors.correlation, frames);
  errors.freedom = std::max(1.0, seen.freedom);
  errors.variance = noise ? *noise * *noise : seen.variance;
  const CorrelationEffect effect = correlation_effect(fit.series(), frames, errors.correlation);
  const double expected = errors.variance * effect.residual_factor * errors.freedom;
  errors.freedom_of_squares = effect.degrees_of_freedom;
  errors.squares = fit.linear().residual.squaredNorm() / expected * errors.freedom_of_squares;
  return errors;
}

double weight_of(const WireErrors& errors, const GaussNewton& fit) {
  if (!errors.are_correlated()) return errors.variance;
  const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(fit.before().size());
  const double independent = posterior(fit.linear(), 1, nothing)(0, 0);
  const double correlated =
      posterior_under(fit.series(), fit.linear(), 1, nothing, errors.correlation, 1)(0, 0);
  return errors.variance * std::max(1.0, correlated / independent);
}

Eigen::MatrixXd covariance_of_numbers(const WireErrors& errors, const GaussNewton& fit,
                                      Eigen::Index frames, const std::optional<double>& noise) {
  if (!errors.are_correlated()) return fit.covariance_of_numbers();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(fit.values().size(), fit.values().size());
  for (const LikelyCovariance& likely : likely_covariances(fit.series())) {
    const double variance =
        noise ? errors.variance : variance_under(fit.series(), likely.covariance, frames).variance;
    sum += likely.weight * posterior_under(fit.series(), fit.linear(), fit.weight(), fit.before(),
                                           likely.covariance, variance);
  }
  return sum;
}

}  // namespace dlo::compare
