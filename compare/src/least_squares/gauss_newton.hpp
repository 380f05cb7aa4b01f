#pragma once

#include <optional>
#include <vector>

#include "least_squares/fitted_rods.hpp"
#include "least_squares/linear_fit.hpp"

namespace dlo::compare {

/// How Gauss-Newton steps are made.
struct GaussNewtonOptions {
  std::optional<double> noise;  ///< standard deviation of a coordinate [m]; none: of the residuals
  double least_noise = 0;       ///< it is taken to be no less [m]
  double lowest = -std::numeric_limits<double>::infinity();  ///< of the first number
  double highest = std::numeric_limits<double>::infinity();  ///< of the first number
  /// Largest step of any number, divided by its standard deviation, with which the iteration ends;
  /// with the default the fourth digits of numbers and intervals hold.
  double last_step = 1e-5;
  double least_gain = 0;  ///< share of the deviance that a step has to promise to be made
};

/// The least deviance of measured shapes over numbers that change their scenes: least squares with
/// what was known of the numbers before (Gauss-Newton steps, each shortened until the deviance is
/// less). Errors that are correlated along the rod count in intervals, not here: a fit under their
/// covariance leaves larger residuals wherever the rod itself is not quite the wire. Every fit to
/// shapes is made by it: those of a wire's numbers, and the explanations of a shape that is wrong.
class GaussNewton {
 public:
  /// @param rods     outlives this; they go on from where they are
  /// @param values   to begin with
  GaussNewton(FittedRods& rods, Eigen::VectorXd values, const GaussNewtonOptions& options);

  /// Goes to the least deviance nearby.
  /// @return whether there; false: at its values, or beside them, a shape has no equilibrium
  /// @throws ConvergenceError if the time limit is over
  /// @throws InputError if there are no more numbers measured than found
  [[nodiscard]] bool descend();

  /// Squares count over this variance beside what was known before, from the next descend() on
  /// [m^2].
  void weigh(double weight) { given_weight_ = weight; }

  // At the values, after descend():
  [[nodiscard]] const Eigen::VectorXd& values() const { return values_; }
  [[nodiscard]] const FittedRods::Rods& rods() const { return here_; }
  [[nodiscard]] const std::vector<ResidualSeries>& series() const { return series_; }
  [[nodiscard]] const LinearFit& linear() const { return linear_; }
  [[nodiscard]] const Eigen::MatrixXd& covariance_of_numbers() const { return posterior_; }
  [[nodiscard]] double variance() const { return variance_; }  ///< of a coordinate's error [m^2]
  [[nodiscard]] double weight() const { return given_weight_.value_or(variance_); }
  [[nodiscard]] double freedom() const { return freedom_; }  ///< degrees, of the residuals
  [[nodiscard]] const Eigen::VectorXd& before() const { return before_; }  ///< see posterior()
  /// Sum of squares over the weight, and of what was known before.
  [[nodiscard]] double deviance() const;

  /// The first number at some value, the others where the deviance is then least to first order.
  [[nodiscard]] Eigen::VectorXd values_beside(double first) const;

  /// How twice the logarithm of the probability of a first number, summed over all values that the
  /// others may have, falls with it beside the deviance (Laplace's approximation: the logarithm of
  /// the determinant of their second derivatives). The more a larger first number lets points tell
  /// the others, the less room these have: the least deviance alone is then at too large a one.
  /// 0 without others, or where a shape has no equilibrium beside the values.
  [[nodiscard]] double marginal_slope();

  /// Least deviance over all other numbers with the first at some value, by chords of the
  /// derivatives at the values; infinite where there is no shape.
  [[nodiscard]] double profile(double first);

 private:
  [[nodiscard]] double penalty(const Eigen::VectorXd& values) const;
  [[nodiscard]] double deviance_at(const Eigen::VectorXd& values);
  void measure_variance();
  [[nodiscard]] Eigen::VectorXd next_step() const;
  [[nodiscard]] double last_step(double first_deviation) const;

  FittedRods& rods_;
  GaussNewtonOptions options_;
  Eigen::VectorXd before_;
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
