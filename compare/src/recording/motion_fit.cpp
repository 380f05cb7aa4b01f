#include "recording/motion_fit.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "base/gsl.hpp"
#include "dlo/compare/error.hpp"
#include "motion/motion_misfit.hpp"
#include "recording/motion_residuals.hpp"

namespace dlo::compare {
namespace {

/// Movement of the rod, divided by its length, that counts as zero: ten times the error of a step
/// of the simulation.
constexpr double negligible_movement = 1e-6;
/// Half the logarithm of the ratio of an interval's ends above which a number is not identified: a
/// factor of ten to each side.
constexpr double largest_half_interval = 2.3;

/// Bounds of the first window [s]. The window is the natural time, in which vibrations cannot be a
/// whole period late.
constexpr double shortest_window = 1;
constexpr double longest_window = 2;
/// Largest number of least squares steps with a window, and with all of a recording.
constexpr int most_window_steps = 12;
constexpr int most_last_steps = 24;

/// Returns the ratio of the variance of a mean of the residuals to that of independent ones: 1 + 2
/// (rho_1 + rho_2 + ..) up to the first autocorrelation in time that is not positive, of all
/// markers together.
double variance_inflation(const std::vector<MarkerMotion>& recordings,
                          const Eigen::VectorXd& residuals) {
  std::map<std::pair<std::size_t, double>, std::vector<Eigen::Vector3d>> series;
  Eigen::Index row = 0;
  std::size_t longest = 0;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    for (const MarkerPosition& at : recordings[r].positions) {
      std::vector<Eigen::Vector3d>& one = series[{r, at.arc_length}];
      one.emplace_back(residuals.segment<3>(row));
      longest = std::max(longest, one.size());
      row += 3;
    }
  }
  const auto product = [&](std::size_t lag) {
    double sum = 0;
    for (const auto& [marker, at] : series) {
      for (std::size_t k = lag; k < at.size(); ++k) sum += at[k].dot(at[k - lag]);
    }
    return sum;
  };
  const double square = product(0);
  double result = 1;
  for (std::size_t lag = 1; lag < longest && square > 0; ++lag) {
    const double rho = product(lag) / square;
    if (!(rho > 0)) break;
    result += 2 * rho;
  }
  return result;
}

/// Checks that the rod moves at the markers; otherwise every stiffness and damping fits.
/// @throws InputError
void require_movement(const Scene& scene, const MotionMisfit& misfit,
                      const std::vector<MarkerMotion>& recordings) {
  if (misfit.largest_displacement() > negligible_movement * scene.length) return;
  const MarkerMotion& recorded = recordings.front();
  const std::optional<TimeSpan> motion = motion_time_span(scene);
  const std::string when = motion ? fmt::format("{} moves it from {:g} to {:g} s", scene.file,
                                                motion->begin, motion->end)
                                  : scene.file + " does not move it";
  throw InputError(fmt::format(
      "{}: the rod does not move at the markers of all {} rows, time = {:g} to {:g} s, so they "
      "identify neither stiffness nor damping (allowed: times in which it moves; {})",
      recorded.file, recorded.positions.size(), recorded.positions.front().time,
      recorded.positions.back().time, when));
}

/// Returns the parameters with the best of a few stiffnesses.
Eigen::VectorXd with_best_stiffness(MotionMisfit& misfit, const Eigen::VectorXd& start) {
  constexpr double scan_log_step = 0.35;  // step of the logarithm
  constexpr int most = 6;
  Eigen::VectorXd best;
  double least = std::numeric_limits<double>::infinity();
  for (int k = -most; k <= most; ++k) {
    Eigen::VectorXd parameters = start;
    parameters[0] = scan_log_step * k;
    const double sum = misfit.residuals(parameters).squaredNorm();
    if (!(sum < least) || !misfit.stop_reason().empty()) continue;
    least = sum;
    best = parameters;
  }
  if (best.size() == 0) throw ConvergenceError(misfit.stop_reason());
  return best;
}

/// Returns the covariance of all parameters. @param share  variance_inflation() of the residuals
Eigen::MatrixXd covariance(const MotionMisfit& misfit, const LeastSquares& nearest, double share) {
  Eigen::MatrixXd normal =
      nearest.derivatives.transpose() * nearest.derivatives / (share * nearest.variance);
  normal.diagonal() += misfit.prior();
  return normal.ldlt().solve(Eigen::MatrixXd::Identity(normal.rows(), normal.cols()));
}

/// Adds the physical parameters with their intervals, by the curvature of the sum of squares in
/// their logarithms.
void add_numbers(const Scene& scene, const MotionMisfit& misfit, const LeastSquares& nearest,
                 double share, MotionFit& result) {
  result.effective_coordinates = static_cast<double>(result.coordinates) / share;
  const auto numbers = static_cast<double>(nearest.parameters.size());
  const double freedom = std::max(1.0, result.effective_coordinates - numbers);
  result.noise = std::sqrt(nearest.variance);
  const Eigen::MatrixXd covariances = covariance(misfit, nearest, share);
  const double quantile = gsl_distribution(gsl_cdf_tdist_Pinv, 0.975, freedom);
  for (std::size_t i = 0; i < misfit.fitted().size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double half = quantile * std::sqrt(covariances(k, k));
    const double value = misfit.value(i, nearest.parameters[k]);
    MotionNumber number{value, value * std::exp(-half), value * std::exp(half),
                        half < largest_half_interval};
    if (!number.identified && misfit.is_damping(k)) {
      // From zero to a limit by the curvature in the damping itself, without the prior of its
      // logarithm.
      const double information = 1 / covariances(k, k) - misfit.prior()[k];
      const double most = misfit.value(i, std::numeric_limits<double>::infinity());
      number.low = 0;
      number.high =
          information > 0 ? std::min(most, value * (1 + quantile / std::sqrt(information))) : most;
    }
    const auto times = [&](double factor) {
      return MotionNumber{factor * number.value, factor * number.low, factor * number.high,
                          number.identified};
    };
    const MotionParameter parameter = misfit.fitted()[i];
    if (parameter == MotionParameter::stiffness) {
      result.stiffness = times(scene.bending_stiffness() / scene.mass_per_length());
      result.scene_stiffness = times(scene.stiffness().value);
    } else {
      (parameter == MotionParameter::material ? result.material
       : parameter == MotionParameter::air    ? result.air
                                              : result.quadratic) = number;
    }
  }
}

/// Returns why the stiffness is not identified; empty if it is.
std::string not_identified(const MotionMisfit& misfit, const LeastSquares& nearest,
                           const MotionFit& fit) {
  constexpr double rounding = 1e-6;
  if (misfit.at_bound(nearest.parameters[0])) {
    return fmt::format("the fit ends at a bound of its range, {:.4g} m^4/s^2", fit.stiffness.value);
  }
  if (!(fit.rms <= (1 + rounding) * fit.given_rms)) {
    return fmt::format("the fit leaves {:.4g} mm (RMS), more than the scene as given, {:.4g} mm",
                       fit.rms * 1e3, fit.given_rms * 1e3);
  }
  if (!nearest.converged) return "the least squares did not converge";
  if (!fit.stiffness.identified) {
    return fmt::format("stiffnesses of {:.3g} to {:.3g} m^4/s^2 fit the recording equally well",
                       fit.stiffness.low, fit.stiffness.high);
  }
  return "";
}

/// Adds the remaining distances: of each recording, of each marker, and of all points.
void add_errors(const std::vector<MarkerMotion>& recordings, const Eigen::VectorXd& residuals,
                const Scene& scene, const MotionMisfit& misfit, MotionFit& result) {
  MarkerMotion joined;
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const MarkerMotion& recorded = recordings[i];
    const Eigen::Index points = std::ssize(recorded.positions);
    const Eigen::Matrix3Xd own = residuals.segment(row, 3 * points).reshaped(3, points);
    result.recordings.push_back(
        {recorded.file, motion_errors(recorded, own, scene.length), misfit.starts_as_recorded(i)});
    joined.positions.insert(joined.positions.end(), recorded.positions.begin(),
                            recorded.positions.end());
    row += 3 * points;
  }
  const Eigen::Matrix3Xd all = residuals.reshaped(3, residuals.size() / 3);
  MotionErrors errors = motion_errors(joined, all, scene.length, joined.positions.size());
  result.rms = errors.rms_m;
  result.by_marker = std::move(errors.markers);
}

}  // namespace

MotionFit fit_motion(const Scene& scene, const std::vector<MarkerMotion>& recordings,
                     const MotionFitOptions& options, const Stages& stages) {
  std::vector<MotionParameter> fitted{MotionParameter::stiffness};
  if (options.material) fitted.push_back(MotionParameter::material);
  if (options.air) fitted.push_back(MotionParameter::air);
  if (options.quadratic) fitted.push_back(MotionParameter::quadratic);
  MotionMisfit misfit(scene, recordings, fitted, options.damping, options.solve, stages);
  MotionFit result;
  result.coordinates = static_cast<std::size_t>(misfit.coordinates());
  if (misfit.coordinates() <= misfit.parameters()) {
    throw InputError(recordings.front().file + ": too few rows");
  }
  const double window = std::clamp(misfit.natural_time(), shortest_window, longest_window);
  misfit.restrict_to(window);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(misfit.parameters());
  constexpr int start_steps = 6;
  const Eigen::VectorXd as_given =
      misfit.physical_parameters() < misfit.parameters()
          ? least_squares(misfit, zero, start_steps, misfit.physical_parameters()).parameters
          : zero;
  misfit.restrict_to(misfit.duration());
  const Eigen::VectorXd given = misfit.residuals(as_given);
  if (misfit.stop_reason().empty()) require_movement(scene, misfit, recordings);
  result.given_rms = rms_of(given.reshaped(3, given.size() / 3));
  misfit.restrict_to(window);
  Eigen::VectorXd start = with_best_stiffness(misfit, zero);
  LeastSquares nearest;
  constexpr double window_growth = 4;
  for (double seconds = window;; seconds *= window_growth) {
    const bool all = seconds * 1.5 >= misfit.duration();
    misfit.restrict_to(all ? misfit.duration() : seconds);
    nearest = least_squares(misfit, start, all ? most_last_steps : most_window_steps);
    start = nearest.parameters;
    if (all) break;
  }
  add_errors(recordings, nearest.residuals, scene, misfit, result);
  add_numbers(scene, misfit, nearest, variance_inflation(recordings, nearest.residuals), result);
  result.not_identified = not_identified(misfit, nearest, result);
  result.damping = misfit.damping(nearest.parameters);
  result.terms = misfit.terms();
  result.simulations = misfit.simulations();
  return result;
}

}  // namespace dlo::compare
