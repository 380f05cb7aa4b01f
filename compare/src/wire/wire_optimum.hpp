#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"
#include "least_squares/error_correlation.hpp"
#include "least_squares/fitted_rods.hpp"
#include "least_squares/gauss_newton.hpp"
#include "least_squares/measured_shapes.hpp"
#include "wire/wire_numbers.hpp"

namespace dlo::compare {

/// A wire's numbers, and the shapes to which they are fitted. All references must outlive it.
struct WireProblem {
  /// @param with_density  whether the density is the second number, after E
  WireProblem(const std::vector<Scene>& nominal, const std::vector<MeasuredShape>& of,
              MeasuredShapes& against, const MaterialFitOptions& asked, bool with_density);

  const std::vector<Scene>& scenes;  ///< scenes as given, one per shape
  const std::vector<MeasuredShape>& shapes;
  MeasuredShapes& measured;  ///< the shapes, with their time limit
  const MaterialFitOptions& options;
  bool density;
  std::vector<WireNumber> numbers;
  FittedRods::SceneAt scene_at;  ///< scene of a shape, at some values of the numbers

  /// Returns the index of the first number after E, density and GJ: of natural curvature, if
  /// fitted.
  [[nodiscard]] Eigen::Index first_remaining_number() const;
  /// Whether a number belongs to one shape alone. @param shape  index of the shape
  [[nodiscard]] bool belongs_to_shape(std::size_t number, std::size_t shape) const {
    return numbers[number].described.shape == shape;
  }

  /// Returns the rods of the shapes.
  /// @param terms  number of fitted terms of natural curvature, the others are constant
  [[nodiscard]] FittedRods rods(int terms) const;

  /// Returns the lower bound of log E in the search. The weight makes a softer rod a rope, whose
  /// shape does not depend on E. The search covers at least two decades below the scene's E, unless
  /// MaterialFitOptions::smallest_ratio ends it earlier.
  [[nodiscard]] double lowest() const;
  [[nodiscard]] GaussNewtonOptions steps() const;
  /// Returns the options of a fit from which another one starts.
  [[nodiscard]] GaussNewtonOptions coarse_iteration_options() const;

  /// Minimises the deviance. @throws as GaussNewton::descend(), and ConvergenceError if a shape has
  /// no equilibrium at the values or at neighbouring ones
  void descend(GaussNewton& fit) const;
};

/// Errors of the points about the rods of a least squares fit.
struct WireErrors {
  bool tested = false;  ///< whether correlation was tested; false with too few residuals or none
  ErrorCovariance correlation;  ///< independent, unless correlation is significant
  double variance = 0;          ///< variance of a coordinate; given, or from the residuals [m^2]
  double freedom = 0;           ///< degrees of freedom of the residuals
  /// Sum of squares of the residuals divided by the variance, and its degrees of freedom. For
  /// independent errors the sum includes the priors' terms. For correlated errors these are
  /// Satterthwaite's, since residuals determine the correlation length hardly better than their
  /// variance.
  double sum_of_squares = 0;
  double freedom_of_squares = 0;

  [[nodiscard]] bool are_correlated() const { return correlation.share > 0; }
};

/// The most likely values of a wire's numbers, and the likelihood of others.
class WireOptimum {
 public:
  /// Finds the most likely values.
  /// @param problem  must outlive this, as must the rods with all its numbers
  /// @param start  initial values
  /// @throws as WireProblem::descend()
  WireOptimum(const WireProblem& problem, FittedRods& rods, const Eigen::VectorXd& start);

  [[nodiscard]] const GaussNewton& fit() const { return *fit_; }
  [[nodiscard]] const Eigen::VectorXd& values() const { return fit_->values(); }
  [[nodiscard]] const WireErrors& errors() const { return errors_; }
  /// Returns the covariance of the numbers under these errors.
  [[nodiscard]] const Eigen::MatrixXd& covariance() const { return covariance_; }
  [[nodiscard]] const FittedRods::Rods& rods() const { return here_; }
  /// Whether a number is not identified, see undetermined_numbers().
  [[nodiscard]] bool is_undetermined(Eigen::Index number) const {
    return undetermined_[static_cast<std::size_t>(number)];
  }
  /// Returns half the width of an interval, in standard deviations.
  [[nodiscard]] double quantile() const;

  /// Returns the ratio of the interval with correlated errors to that with as many independent
  /// errors of the same sum of squares.
  [[nodiscard]] double correlated_widening() const;

  /// Returns how much less likely another E is, marginalised over the other numbers: twice the
  /// decrease of the log likelihood, divided by its value at the ends of the interval.
  [[nodiscard]] double excess_over_limit(double log_modulus);

  /// Returns the distance in log E to the end of the interval on a side (1: above, -1: below);
  /// std::nullopt if it is open. If the followed equilibria end before, the distance is that of
  /// linear theory.
  [[nodiscard]] std::optional<double> end(double side);

  [[nodiscard]] std::vector<Alignment> alignments();

 private:
  void descend();
  void move_to_most_likely_modulus();
  [[nodiscard]] double limit() const;
  [[nodiscard]] double excess_deviance(double log_modulus);

  const WireProblem& problem_;
  FittedRods& rods_;
  std::optional<GaussNewton> fit_;
  WireErrors errors_;
  double marginal_slope_ = 0;  // see GaussNewton::marginal_slope()
  std::vector<bool> undetermined_;
  FittedRods::Rods here_;
  Eigen::MatrixXd covariance_;
};

/// Returns the result of fit_wire(), without the prediction.
[[nodiscard]] MaterialFit wire_result(const WireProblem& problem, WireOptimum& optimum);

/// Sets FittedShape::rod of the fit's shapes.
void draw_rods(const FittedRods::Rods& rods, const std::vector<Scene>& scenes, MaterialFit& fit);

}  // namespace dlo::compare
