#include "wire/wire_optimum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "dlo/compare/error.hpp"
#include "least_squares/gauss_newton.hpp"
#include "wire/identifiable.hpp"

namespace dlo::compare {
namespace {

/// Longest step in log E for which the fit is nearly linear.
constexpr double longest_log_step = 1;
/// Largest last step of fits from which others start, in standard deviations.
constexpr double coarse_step = 0.1;

/// Largest number of fits with updated weights, and relative change of the weight at which they
/// end. Correlated errors carry less information than as many independent ones, which matters
/// relative to the priors. The weight is measured from the residuals of a fit that uses the
/// previous weight.
constexpr int most_weights = 3;
constexpr double weight_tolerance = 0.1;
/// Relative error of the root of the deviance at an end of the interval: below the printed digits.
constexpr double end_tolerance = 1e-5;
constexpr int most_ends = 12;

/// Estimates the errors about a fit.
/// @param frames  number of columns of the design before those of the numbers
/// @param noise        standard deviation of a coordinate, if known [m]
/// @param least_noise  residuals below it are errors of the solver [m]
WireErrors estimate_errors(const GaussNewton& fit, Eigen::Index frames,
                           const std::optional<double>& noise, double least_noise) {
  WireErrors errors{.variance = fit.variance(),
                    .freedom = fit.freedom(),
                    .sum_of_squares = fit.deviance(),
                    .freedom_of_squares = fit.freedom()};
  if (!(fit.variance() > least_noise * least_noise)) return errors;
  const CorrelationEstimate estimate = correlation_of(fit.series());
  errors.tested = estimate.tested;
  if (!estimate.significant) return errors;
  errors.correlation = estimate.covariance;
  const VarianceEstimate variance_estimate =
      variance_under(fit.series(), errors.correlation, frames);
  errors.freedom = std::max(1.0, variance_estimate.freedom);
  errors.variance = noise ? *noise * *noise : variance_estimate.variance;
  const CorrelationEffect effect = correlation_effect(fit.series(), frames, errors.correlation);
  const double expected = errors.variance * effect.residual_factor * errors.freedom;
  errors.freedom_of_squares = effect.degrees_of_freedom;
  errors.sum_of_squares =
      fit.linear().residual.squaredNorm() / expected * errors.freedom_of_squares;
  return errors;
}

/// Returns the variance by which squares are divided so that they have the information about the
/// first number that these errors leave [m^2]: correlated errors carry less information than as
/// many independent ones.
double effective_variance(const WireErrors& errors, const GaussNewton& fit) {
  if (!errors.are_correlated()) return errors.variance;
  LinearFit linear = fit.linear();
  linear.prior_inverse_deviations.setZero();
  const double independent = posterior(linear, 1)(0, 0);
  const double correlated =
      sandwich_covariance(fit.series(), linear, 1, errors.correlation, 1)(0, 0);
  return errors.variance * std::max(1.0, correlated / independent);
}

/// Returns the covariance of the fitted numbers. The covariance of correlated errors is only known
/// from the residuals, so the result is the mean over all likely ones.
Eigen::MatrixXd covariance_of_numbers(const WireErrors& errors, const GaussNewton& fit,
                                      Eigen::Index frames, const std::optional<double>& noise) {
  if (!errors.are_correlated()) return fit.covariance_of_numbers();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(fit.values().size(), fit.values().size());
  for (const LikelyCovariance& likely : likely_covariances(fit.series())) {
    const double variance =
        noise ? errors.variance : variance_under(fit.series(), likely.covariance, frames).variance;
    sum += likely.weight * sandwich_covariance(fit.series(), fit.linear(), fit.weight(),
                                               likely.covariance, variance);
  }
  return sum;
}

}  // namespace

WireProblem::WireProblem(const std::vector<Scene>& nominal, const std::vector<MeasuredShape>& of,
                         MeasuredShapes& against, const MaterialFitOptions& asked,
                         bool with_density)
    : scenes(nominal), shapes(of), measured(against), options(asked), density(with_density) {
  std::vector<Scene> fitted = with_nominal_frames(scenes, measured, options);
  numbers = wire_numbers(fitted, shapes, options, density);
  scene_at = [fitted = std::move(fitted), changes = numbers](std::size_t shape,
                                                             const Eigen::VectorXd& values) {
    Scene result = fitted[shape];
    for (std::size_t k = 0; k < changes.size(); ++k) {
      const std::optional<std::size_t>& own_shape = changes[k].described.shape;
      if (own_shape && *own_shape != shape) continue;
      changes[k].change(result, values[static_cast<Eigen::Index>(k)]);
    }
    return result;
  };
}

Eigen::Index WireProblem::first_remaining_number() const {
  return 1 + (density ? 1 : 0) + (options.torsional_stiffness ? 1 : 0);
}

FittedRods WireProblem::rods(int terms) const {
  std::vector<Unknown> unknowns;
  unknowns.reserve(numbers.size());
  for (const WireNumber& number : numbers) {
    unknowns.push_back(
        {.difference_step = number.term < std::max(1, terms) ? number.difference_step : 0,
         .shape = number.described.shape,
         .prior_deviation = number.described.prior_deviation,
         .longest_step = number.longest_step});
  }
  unknowns.front().longest_step = longest_log_step;
  return {measured, scene_at, std::move(unknowns)};
}

double WireProblem::lowest() const {
  constexpr double rope_gamma = 1e5;  // w l^3 / (EI)
  constexpr double largest_modulus_reduction = 1e-2;
  double load = 0;
  for (const Scene& scene : scenes) load = std::max(load, scene.gamma());
  return std::log(
      std::max(options.smallest_ratio, std::min(load / rope_gamma, largest_modulus_reduction)));
}

GaussNewtonOptions WireProblem::steps() const {
  return {.noise = options.noise,
          .least_noise = least_noise(scenes.front()),
          .lowest = lowest(),
          .highest = std::log(options.largest_ratio)};
}

GaussNewtonOptions WireProblem::coarse_iteration_options() const {
  GaussNewtonOptions result = steps();
  result.last_step = coarse_step;
  return result;
}

void WireProblem::descend(GaussNewton& fit) const {
  if (fit.descend()) return;
  throw ConvergenceError(fmt::format("{}: the energy model has no equilibrium near the fitted one",
                                     scenes.front().file));
}

WireOptimum::WireOptimum(const WireProblem& problem, FittedRods& rods, const Eigen::VectorXd& start)
    : problem_(problem), rods_(rods), fit_(std::in_place, rods, start, problem.steps()) {
  descend();
  for (int i = 0; i < most_weights && !fit_->linear().prior_inverse_deviations.isZero(); ++i) {
    const double weight = effective_variance(errors_, *fit_);
    if (std::abs(weight / fit_->weight() - 1) < weight_tolerance) break;
    fit_->set_data_variance(weight);
    descend();
  }
  undetermined_ = undetermined_numbers(fit_->linear(), fit_->weight());
  if (!is_undetermined(0)) move_to_most_likely_modulus();
  here_ = fit_->rods();
  covariance_ = covariance_of_numbers(errors_, *fit_, problem.measured.frame_columns(),
                                      problem.options.noise);
}

void WireOptimum::descend() {
  problem_.descend(*fit_);
  errors_ = estimate_errors(*fit_, problem_.measured.frame_columns(), problem_.options.noise,
                            least_noise(problem_.scenes.front()));
}

/// Moves from the least deviance to the most likely E, marginalised over the other numbers. The two
/// differ if the shapes determine the clamps better for a stiffer rod.
void WireOptimum::move_to_most_likely_modulus() {
  marginal_slope_ = fit_->marginal_slope();
  const double variance = fit_->covariance_of_numbers()(0, 0);
  const double longest = rods_.unknowns().front().longest_step;
  const double step = std::clamp(-marginal_slope_ * variance / 2, -longest, longest);
  GaussNewtonOptions fixed_options = problem_.steps();
  if (std::abs(step) <= fixed_options.last_step * std::sqrt(variance)) return;
  fixed_options.lowest = fixed_options.highest =
      std::clamp(values()[0] + step, fixed_options.lowest, fixed_options.highest);
  rods_.set_initial_rods(fit_->rods());
  GaussNewton shifted_fit(rods_, fit_->conditional_optimum(fixed_options.lowest), fixed_options);
  shifted_fit.set_data_variance(fit_->weight());
  fit_.emplace(std::move(shifted_fit));
  descend();
}

double WireOptimum::quantile() const {
  return interval_quantile(problem_.options.noise, errors_.freedom);
}

double WireOptimum::correlated_widening() const {
  const double independent = posterior(fit_->linear(), fit_->variance())(0, 0);
  const double alone = interval_quantile(problem_.options.noise, fit_->freedom());
  return std::sqrt(covariance_(0, 0) / independent) * quantile() / alone;
}

/// Returns the root of excess_deviance() at the ends of the interval, which is larger than the
/// limit of the deviance for independent errors.
double WireOptimum::limit() const {
  return quantile() * std::sqrt(covariance_(0, 0) / fit_->covariance_of_numbers()(0, 0));
}

double WireOptimum::excess_deviance(double log_modulus) {
  rods_.set_initial_rods(here_);
  return fit_->profile(log_modulus) - fit_->deviance() +
         marginal_slope_ * (log_modulus - values()[0]);
}

double WireOptimum::excess_over_limit(double log_modulus) {
  return excess_deviance(log_modulus) / (limit() * limit());
}

std::optional<double> WireOptimum::end(double side) {
  if (is_undetermined(0)) return std::nullopt;
  const double wanted = limit();
  const double linear = quantile() * std::sqrt(covariance_(0, 0));
  const GaussNewtonOptions range = problem_.steps();
  const double farthest = side > 0 ? range.highest - values()[0] : values()[0] - range.lowest;
  constexpr double largest_root_ratio = 4;
  double distance = linear;
  double before = 0;          // distance of the previous step
  double reached_before = 0;  // root of the deviance at the previous step
  for (int i = 0; i < most_ends; ++i) {
    if (!(distance < farthest)) return std::nullopt;
    const double excess = excess_deviance(values()[0] + side * distance);
    const double reached = std::sqrt(std::max(0.0, excess));
    if (!(reached < largest_root_ratio * wanted)) return linear;
    if (std::abs(reached - wanted) <= end_tolerance * wanted) break;
    // A secant step; the root is about proportional to the distance, with value 0 at 0.
    const double slope = (reached - reached_before) / (distance - before);
    const double next = slope > 0 ? distance + (wanted - reached) / slope
                                  : distance * wanted / std::max(reached, 1e-300);
    before = distance;
    reached_before = reached;
    distance = std::clamp(next, distance / 2, distance * 2);
  }
  return distance;
}

std::vector<Alignment> WireOptimum::alignments() {
  rods_.set_initial_rods(here_);
  return rods_.alignments(values());
}

}  // namespace dlo::compare
