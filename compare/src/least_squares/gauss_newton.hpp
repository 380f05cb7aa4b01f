#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "least_squares/error_correlation.hpp"
#include "least_squares/fitted_rods.hpp"

namespace dlo::compare {

/// Generalised least squares, linearised about some values of the fitted numbers, some of which
/// have priors. All matrices are in the order of the numbers.
struct LinearFit {
  Eigen::MatrixXd design;    ///< innovations by the numbers, minus the part that frames explain
  Eigen::VectorXd residual;  ///< innovations of points minus rod, with the frames' part removed
  /// 1 over the prior standard deviation of each number about zero
  Eigen::VectorXd prior_inverse_deviations;
  Eigen::Index freedom = 0;  ///< number of rows minus rank of the frames' columns
};

/// Returns the covariance of the numbers after the fit. For numbers that are undetermined_numbers()
/// it is that of the pseudoinverse, which is no variance.
/// @param variance  of the errors
[[nodiscard]] Eigen::MatrixXd posterior(const LinearFit& fit, double variance);

/// Returns the covariance of the numbers after a least squares fit that assumes independent errors,
/// if the errors have another covariance (sandwich estimator).
/// @param series    residual series of the fit
/// @param weight    variance by which the squares of the fit were divided
/// @param errors    covariance of the errors, divided by `variance`
/// @param variance  factor on `errors`
[[nodiscard]] Eigen::MatrixXd sandwich_covariance(const std::vector<ResidualSeries>& series,
                                                  const LinearFit& fit, double weight,
                                                  const ErrorCovariance& errors, double variance);

/// Variance of errors of a given correlation, estimated from the residuals of generalised least
/// squares without priors, and its degrees of freedom.
struct VarianceEstimate {
  double variance = 0;  ///< variance of the errors [m^2]
  double freedom = 0;   ///< degrees of freedom of the variance
};
[[nodiscard]] VarianceEstimate variance_under(const std::vector<ResidualSeries>& series,
                                              const ErrorCovariance& errors, Eigen::Index frames);

/// Returns for each number whether neither the points nor priors determine it, alone or in
/// combination with others. The variance of such a number is infinite.
[[nodiscard]] std::vector<bool> undetermined_numbers(const LinearFit& fit, double variance);

struct GaussNewtonOptions {
  std::optional<double> noise;  ///< standard deviation of a coordinate [m]; empty: estimated
  double least_noise = 0;       ///< lower bound of the estimated noise [m]
  double lowest = -std::numeric_limits<double>::infinity();  ///< lower bound of the first number
  double highest = std::numeric_limits<double>::infinity();  ///< upper bound of the first number
  /// Largest step of any number, divided by its standard deviation, at which the iteration ends.
  /// With the default, four digits of numbers and intervals are final.
  double last_step = 1e-5;
  double least_gain = 0;  ///< smallest predicted relative decrease of the deviance in a step
};

/// Minimises the deviance of measured shapes over numbers that change their scenes: least squares
/// with priors of the numbers, by Gauss-Newton steps that are halved until the deviance decreases.
/// Correlation of the errors along the rod enters intervals, not this fit: with a correlated
/// covariance it would leave larger residuals where the model differs from the wire. All fits to
/// shapes use this class: those of a wire's numbers, and the causes of a wrong shape.
class GaussNewton {
 public:
  /// @param rods     must outlive this; solves start from their current equilibria
  /// @param values   initial values
  GaussNewton(FittedRods& rods, Eigen::VectorXd values, const GaussNewtonOptions& options);

  /// Iterates to a local minimum of the deviance, in at most 30 steps.
  /// @return false if a shape has no equilibrium at the values or at neighbouring ones
  /// @throws ConvergenceError if the time limit is exceeded
  /// @throws InputError if the noise is estimated and no more numbers are measured than fitted
  [[nodiscard]] bool descend();

  /// Sets the variance by which squares are divided in the sum with the priors, from the next
  /// descend() on [m^2].
  void set_data_variance(double weight) { given_weight_ = weight; }

  // Results at the values, after descend():
  [[nodiscard]] const Eigen::VectorXd& values() const { return values_; }
  [[nodiscard]] const FittedRods::Rods& rods() const { return here_; }
  [[nodiscard]] const std::vector<ResidualSeries>& series() const { return series_; }
  [[nodiscard]] const LinearFit& linear() const { return linear_; }
  [[nodiscard]] const Eigen::MatrixXd& covariance_of_numbers() const { return posterior_; }
  /// Returns the variance of a coordinate's error [m^2].
  [[nodiscard]] double variance() const { return variance_; }
  [[nodiscard]] double weight() const { return given_weight_.value_or(variance_); }
  /// Returns the degrees of freedom of the residuals; with given noise the fitted numbers are not
  /// subtracted.
  [[nodiscard]] double freedom() const { return freedom_; }
  /// Returns the sum of squares divided by the weight, plus the priors' terms.
  [[nodiscard]] double deviance() const;

  /// Returns values with the given first number and the others at the least deviance, to first
  /// order.
  [[nodiscard]] Eigen::VectorXd conditional_optimum(double first) const;

  /// Returns the derivative by the first number of the term that marginalisation over the others
  /// adds to the deviance (Laplace's approximation: the logarithm of the determinant of the others'
  /// second derivatives). If points determine the others better at a larger first number, the
  /// others have less volume there, and the minimum of the deviance alone is at too large a first
  /// number. Returns 0 without other numbers, or if a shape has no equilibrium at the neighbouring
  /// values.
  [[nodiscard]] double marginal_slope();

  /// Returns the least deviance over all other numbers at a given first number, by chord iterations
  /// with the derivatives at the values; infinite if a shape does not exist.
  [[nodiscard]] double profile(double first);

 private:
  [[nodiscard]] double penalty(const Eigen::VectorXd& values) const;
  [[nodiscard]] LinearFit linearised(const std::vector<ResidualSeries>& series) const;
  [[nodiscard]] double deviance_at(const Eigen::VectorXd& values);
  void measure_variance();
  [[nodiscard]] Eigen::VectorXd next_step() const;
  [[nodiscard]] double last_step(double first_deviation) const;

  FittedRods& rods_;
  GaussNewtonOptions options_;
  Eigen::VectorXd prior_inverse_deviations_;
  Eigen::VectorXd values_;
  std::optional<double> given_weight_;
  double variance_ = 0;
  double freedom_ = 0;
  FittedRods::Rods here_;
  std::vector<ResidualSeries> series_;
  LinearFit linear_;
  Eigen::MatrixXd posterior_;
};

}  // namespace dlo::compare
