#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "least_squares/fitted_rods.hpp"
#include "least_squares/gauss_newton.hpp"
#include "wire/wire_errors.hpp"
#include "wire/wire_problem.hpp"

namespace dlo::compare {

/// The likeliest values of a wire's numbers, and how likely others are.
class WireOptimum {
 public:
  /// Goes there.
  /// @param problem  outlives this, as do the rods of all its numbers;  @param start  values that
  ///                 they go on from
  /// @throws ConvergenceError if the steps lead nowhere, or the time limit is over
  WireOptimum(const WireProblem& problem, FittedRods& rods, const Eigen::VectorXd& start);

  [[nodiscard]] const GaussNewton& fit() const { return *fit_; }
  [[nodiscard]] const Eigen::VectorXd& values() const { return fit_->values(); }
  [[nodiscard]] const WireErrors& errors() const { return errors_; }
  /// Of the numbers, under these errors.
  [[nodiscard]] const Eigen::MatrixXd& covariance() const { return covariance_; }
  [[nodiscard]] const FittedRods::Rods& rods() const { return here_; }
  /// Of the numbers, see unseen().
  [[nodiscard]] bool is_unseen(Eigen::Index number) const {
    return unseen_[static_cast<std::size_t>(number)];
  }
  /// Of an interval, in standard deviations.
  [[nodiscard]] double quantile() const;

  /// By what correlated errors make an interval wider than as many independent ones of the same
  /// squares would.
  [[nodiscard]] double correlated_widening() const;

  /// How much less likely another E is, whatever the other numbers are: twice the logarithm, as a
  /// share of what it is at the interval's ends.
  [[nodiscard]] double excess_over_limit(double log_modulus);

  /// Distance in log E to the end of the interval on a side (1: above, -1: below); none: open.
  /// Where the equilibria that are followed end before, linear theory has to do.
  [[nodiscard]] std::optional<double> end(double side);

  /// How the shapes lie.
  [[nodiscard]] std::vector<Alignment> alignments();

 private:
  void descend();
  void go_to_likely_modulus();
  [[nodiscard]] double limit() const;
  [[nodiscard]] double unlikelihood(double log_modulus);

  const WireProblem& problem_;
  FittedRods& rods_;
  std::optional<GaussNewton> fit_;
  WireErrors errors_;
  double marginal_slope_ = 0;  // see GaussNewton::marginal_slope()
  std::vector<bool> unseen_;
  FittedRods::Rods here_;
  Eigen::MatrixXd covariance_;
};

}  // namespace dlo::compare
