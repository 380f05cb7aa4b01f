#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/progress.hpp"
#include "dlo/compare/scene.hpp"
#include "motion/motion_start.hpp"
#include "motion/moving_scene.hpp"

namespace dlo::compare {

/// Physical parameters that can be fitted to a recorded motion.
enum class MotionParameter { stiffness, material, air, quadratic };

/// Simulations of one scene's rod against recordings of its markers. The parameters of the fit are
/// logarithms of physical parameters divided by their first guesses, then for each recording the
/// modes (StartDeviation) by which the rod's start deviates from the smooth start through the first
/// frames. A recording with too few markers for that (smooth_start()) starts in equilibrium.
class MotionMisfit {
 public:
  /// @param fitted  physical parameters to fit, may be empty
  /// @param known   damping; the first guess, if > 0, of parameters that are fitted
  /// @throws InputError if a marker is not on the rod, or a recording has one time only
  MotionMisfit(const Scene& scene, const std::vector<MarkerMotion>& recordings,
               std::vector<MotionParameter> fitted, const RodDamping& known,
               const SolveOptions& solve, Stages stages = {});

  /// Restricts each recording to its first `seconds` seconds, but to no fewer than two frames.
  void restrict_to(double seconds);
  /// Returns the largest duration of a recording [s].
  [[nodiscard]] double duration() const { return duration_; }
  /// Returns the natural time sqrt(m l^3 / EI) of the scene as given, with the smaller EI of two
  /// [s].
  [[nodiscard]] double natural_time() const { return natural_time_; }

  [[nodiscard]] const std::vector<MotionParameter>& fitted() const { return fitted_; }
  /// Returns the number of physical parameters, which come before all others.
  [[nodiscard]] Eigen::Index physical_parameters() const { return std::ssize(fitted_); }
  [[nodiscard]] Eigen::Index parameters() const;
  /// Returns the number of coordinates of the markers within the restriction.
  [[nodiscard]] Eigen::Index coordinates() const;
  [[nodiscard]] int simulations() const { return simulations_; }
  [[nodiscard]] int terms() const { return terms_; }
  /// Whether the start of a recording is fitted to it.
  [[nodiscard]] bool starts_as_recorded(std::size_t recording) const {
    return recorded_[recording].deviation.has_value();
  }
  /// Returns the largest displacement of a marker from its start in the last simulations [m].
  [[nodiscard]] double largest_displacement() const { return largest_displacement_; }
  /// Returns why one of the last simulations ended early, with the file of its recording; empty if
  /// none did.
  [[nodiscard]] const std::string& stop_reason() const { return stop_reason_; }

  /// Returns a physical parameter [SI]; for the stiffness its ratio to the scene's.
  [[nodiscard]] double value(std::size_t number, double log) const;
  [[nodiscard]] bool is_damping(Eigen::Index parameter) const {
    return parameter < physical_parameters() &&
           fitted_[static_cast<std::size_t>(parameter)] != MotionParameter::stiffness;
  }
  /// Returns the nearest logarithm in the range of a physical parameter.
  [[nodiscard]] static double within_bounds(double log);
  /// Whether the logarithm of a physical parameter is at a bound of its range, within 1 % of the
  /// bound.
  [[nodiscard]] static bool at_bound(double log);
  [[nodiscard]] RodDamping damping(const Eigen::VectorXd& parameters) const;
  /// Returns the start of a recording; std::nullopt: it starts in equilibrium.
  [[nodiscard]] std::optional<MotionStart> start(const Eigen::VectorXd& parameters,
                                                 std::size_t recording) const;

  /// Returns simulated minus recorded coordinates [m]; the rod length for all coordinates of a
  /// recording whose simulation ends early.
  [[nodiscard]] Eigen::VectorXd residuals(const Eigen::VectorXd& parameters);
  /// Computes derivatives of the residuals by differences; by a damping, they are derivatives by
  /// its relative change. @param here  residuals at the parameters
  /// @param first  index of the first physical parameter whose column is computed; the columns of
  /// earlier physical parameters are zero, those of the modes of starts are always computed
  [[nodiscard]] Eigen::MatrixXd derivatives(const Eigen::VectorXd& parameters,
                                            const Eigen::VectorXd& here, Eigen::Index first = 0);
  /// Returns the prior inverse variances of the parameters: small for the physical ones, and for
  /// the modes from the errors of the smooth start.
  [[nodiscard]] Eigen::VectorXd prior() const;
  /// Returns the variance of a coordinate by errors of the simulation alone [m^2].
  [[nodiscard]] double least_variance() const;

 private:
  struct Frame {
    double time = 0;
    std::size_t begin = 0, end = 0;  ///< range in MarkerMotion::positions
  };
  struct Recorded {
    const MarkerMotion* motion = nullptr;
    std::vector<Frame> frames;
    std::size_t used_frames = 0;  ///< frames within the restriction
    std::optional<StartDeviation> deviation;
    Eigen::Index first_mode = 0;  ///< among the parameters
    [[nodiscard]] Eigen::Index coordinates() const {
      return static_cast<Eigen::Index>(3 * frames[used_frames - 1].end);
    }
  };

  [[nodiscard]] Eigen::VectorXd simulated(const Scene& scene, const RodDamping& damping,
                                          const Eigen::VectorXd& parameters, std::size_t recording);
  [[nodiscard]] Scene scene_with(const Eigen::VectorXd& parameters) const;

  const Scene& scene_;
  std::vector<MotionParameter> fitted_;
  RodDamping known_;
  SolveOptions solve_;
  Stages stages_;
  std::vector<Recorded> recorded_;
  std::vector<double> first_;
  double natural_time_ = 0, duration_ = 0;
  int simulations_ = 0, terms_ = 0;
  double largest_displacement_ = 0;
  std::string stop_reason_;
};

/// Parameters with the least sum of squares. The derivatives may be those of an earlier step.
struct LeastSquares {
  Eigen::VectorXd parameters, residuals;
  Eigen::MatrixXd derivatives;
  double variance = 0;  ///< estimated variance of a residual
  /// Whether a further step would change the parameters by less than their errors.
  bool converged = false;
};

/// Minimises the sum of squares by the Levenberg-Marquardt method. Derivatives are kept while steps
/// with them converge fast.
/// @param free  index of the first fitted parameter; those before are constant
/// @throws ConvergenceError if a simulation with the start ends early
[[nodiscard]] LeastSquares least_squares(MotionMisfit& misfit, const Eigen::VectorXd& start,
                                         int most_steps, Eigen::Index free = 0);

/// Fits the start of a recording to its first second, or to the natural time if that is longer,
/// without changes to the scene.
/// @return std::nullopt if the recording has too few markers
/// @throws InputError as MotionMisfit(), ConvergenceError as least_squares()
[[nodiscard]] std::optional<MotionStart> recorded_start(const Scene& scene,
                                                        const MarkerMotion& recording,
                                                        const RodDamping& damping,
                                                        const SolveOptions& solve);

/// Returns the start that Scene::start defines: recorded_start() of a recording, or a shape with
/// zero velocities; std::nullopt if the scene has no start.
/// @param begin  time at which a shape starts [s]; a recording starts at its first time
/// @throws InputError if the start has too few points; also as recorded_start()
[[nodiscard]] std::optional<MotionStart> given_start(const Scene& scene, double begin,
                                                     const RodDamping& damping,
                                                     const SolveOptions& solve);

/// Sum of squares and prior, linearised about one point with the derivatives of that point or of an
/// earlier one. A step is the change of a logarithm; for a damping it is the change divided by the
/// damping, because the residuals are nearly linear in a damping and need not determine its
/// logarithm.
class NormalEquations {
 public:
  NormalEquations(const LeastSquares& at, const MotionMisfit& misfit, Eigen::Index free)
      : misfit_(misfit),
        normal_(at.derivatives.transpose() * at.derivatives / at.variance),
        prior_(misfit.prior()),
        variance_(at.variance) {
    gradient_ = at.derivatives.transpose() * at.residuals / at.variance +
                prior_.cwiseProduct(at.parameters);
    gradient_.head(free).setZero();
    normal_.diagonal() += prior_;
    // Second derivative of the prior by the damping itself.
    for (Eigen::Index i = 0; i < misfit.physical_parameters(); ++i) {
      if (misfit.is_damping(i)) normal_(i, i) += prior_[i] * std::max(0.0, -at.parameters[i]);
    }
  }
  /// Returns the step to the minimum, which reduces no damping more than tenfold.
  [[nodiscard]] Eigen::VectorXd step(double marquardt) const {
    constexpr double lowest = -0.9;
    constexpr double rounding = 1e-9;
    Eigen::MatrixXd matrix = normal_;
    matrix.diagonal() *= 1 + marquardt;
    Eigen::VectorXd right = -gradient_;
    for (;;) {
      const Eigen::VectorXd result = matrix.ldlt().solve(right);
      bool within = true;
      for (Eigen::Index i = 0; i < misfit_.physical_parameters(); ++i) {
        if (!misfit_.is_damping(i) || !(result[i] < lowest - rounding)) continue;
        within = false;
        right -= lowest * matrix.col(i);
        matrix.row(i).setZero();
        matrix.col(i).setZero();
        matrix(i, i) = 1;
        right[i] = lowest;
      }
      if (within) return result;
    }
  }
  /// Returns parameters after a step, within the bounds.
  [[nodiscard]] Eigen::VectorXd after(const Eigen::VectorXd& step,
                                      Eigen::VectorXd parameters) const {
    for (Eigen::Index i = 0; i < step.size(); ++i) {
      parameters[i] += misfit_.is_damping(i) ? std::log1p(step[i]) : step[i];
      if (i < misfit_.physical_parameters())
        parameters[i] = MotionMisfit::within_bounds(parameters[i]);
    }
    return parameters;
  }
  /// Returns the predicted decrease of sum() by a full step.
  [[nodiscard]] double decrease() const {
    const Eigen::VectorXd full = step(0);
    return -2 * gradient_.dot(full) - full.dot(normal_ * full);
  }
  /// Returns the sum of squares of residuals and parameters, in variances.
  [[nodiscard]] double sum(const Eigen::VectorXd& residuals,
                           const Eigen::VectorXd& parameters) const {
    return residuals.squaredNorm() / variance_ + parameters.dot(prior_.cwiseProduct(parameters));
  }

 private:
  const MotionMisfit& misfit_;
  Eigen::MatrixXd normal_;
  Eigen::VectorXd gradient_, prior_;
  double variance_;
};

}  // namespace dlo::compare
