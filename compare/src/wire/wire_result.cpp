#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <utility>

#include "base/gsl.hpp"
#include "wire/between_shapes.hpp"
#include "wire/identifiable.hpp"
#include "wire/wire_optimum.hpp"

namespace dlo::compare {
namespace {

void add_warning(MaterialFit& fit, const std::string& what) {
  if (!fit.warning.empty()) fit.warning += "; ";
  fit.warning += what;
}

/// Computes the intervals of E, the density, GJ and GJ / EI.
class WireIntervals {
 public:
  WireIntervals(const WireProblem& problem, WireOptimum& optimum)
      : problem_(problem), optimum_(optimum), scene_(problem.scenes.front()) {}

  void find(MaterialFit& fit) {
    const double times_noise = misfit(fit);
    fit.scatter = scatter(times_noise);
    widening_ = times_noise * (fit.scatter ? fit.scatter->widening : 1);
    fit.youngs_modulus = identified(optimum_.values()[0], scene_.stiffness().value,
                                    widened(optimum_.end(-1)), widened(optimum_.end(1)));
    fit.not_identified = why_not_identified(fit.youngs_modulus);
    if (problem_.density) {
      const double variance = optimum_.covariance()(1, 1);
      fit.density = identified({1}, scene_.mass_parameter().value, variance);
    }
    if (problem_.options.torsional_stiffness) find_torsion(fit);
  }

  /// Samples the profile of E.
  void draw_profile(MaterialFit& fit) {
    if (optimum_.is_undetermined(0)) return;
    const double best = optimum_.values()[0];
    const double unit = scene_.stiffness().value;
    const auto logarithm = [unit](const std::optional<double>& value) {
      return value ? std::optional(std::log(*value / unit)) : std::nullopt;
    };
    for (const double x :
         drawn_logarithms(logarithm(fit.youngs_modulus.low), best,
                          logarithm(fit.youngs_modulus.high), problem_.options.profile_points)) {
      // The ends of the interval are `widening_` times as far away as the limit of the deviance.
      fit.profile.push_back(
          {unit * std::exp(x), optimum_.excess_over_limit(best + (x - best) / widening_)});
    }
  }

 private:
  /// Returns the factor by which the interval is wider because the residuals exceed the given
  /// noise, and adds a warning; 1 without a warning if the excess is not significant at 5 %, or if
  /// no noise is given.
  [[nodiscard]] double misfit(MaterialFit& fit) const {
    if (!problem_.options.noise) return 1;
    constexpr double significance_level = 0.05;
    const double sum_of_squares = optimum_.errors().sum_of_squares;
    const double freedom = optimum_.errors().freedom_of_squares;
    if (!(gsl_distribution(gsl_cdf_chisq_Q, sum_of_squares, freedom) < significance_level))
      return 1;
    const double times = std::sqrt(sum_of_squares / freedom);
    add_warning(fit,
                fmt::format("the residuals are {:.3g} times what the given noise explains; the "
                            "interval is as much wider",
                            times));
    return times;
  }

  [[nodiscard]] std::optional<ScatterBetweenShapes> scatter(double times_noise) const {
    const Eigen::Index frames = problem_.measured.frame_columns();
    std::vector<std::vector<Nuisance>> nuisances(problem_.scenes.size());
    for (std::size_t k = 0; k < problem_.numbers.size(); ++k) {
      const FittedNumber& described = problem_.numbers[k].described;
      if (!described.shape) continue;
      const auto number = static_cast<Eigen::Index>(k);
      nuisances[*described.shape].push_back(
          {frames + number, optimum_.values()[number], described.prior_deviation});
    }
    const WireErrors& errors = optimum_.errors();
    return scatter_between(
        estimates_of_shapes(optimum_.fit().series(), errors.correlation,
                            errors.variance * times_noise * times_noise, frames, nuisances),
        optimum_.quantile());
  }

  [[nodiscard]] std::optional<double> widened(std::optional<double> distance) const {
    if (distance) *distance *= widening_;
    return distance;
  }

  [[nodiscard]] FittedValue identified(double log_value, double unit,
                                       const std::optional<double>& below,
                                       const std::optional<double>& above) const {
    const MaterialFitOptions& options = problem_.options;
    // An end outside the search range of E is no bound.
    const double farthest = std::log(options.largest_ratio) - problem_.lowest();
    LogProfile::Interval interval;
    if (below && *below < farthest) interval.low = log_value - *below;
    if (above && *above < farthest) interval.high = log_value + *above;
    return fitted_value(log_value, interval, unit, options.largest_interval_ratio);
  }

  /// Returns the value whose logarithm is the sum of some numbers, with that sum's variance.
  [[nodiscard]] FittedValue identified(std::initializer_list<Eigen::Index> numbers, double unit,
                                       double variance) const {
    double log_value = 0;
    std::optional<double> half = optimum_.quantile() * std::sqrt(variance) * widening_;
    for (const Eigen::Index number : numbers) {
      log_value += optimum_.values()[number];
      // A number that only its prior determines has no interval.
      const bool is_unobserved = optimum_.fit().linear().design.col(number).isZero(0);
      if (is_unobserved || optimum_.is_undetermined(number)) half.reset();
    }
    return identified(log_value, unit, half, half);
  }

  [[nodiscard]] std::string why_not_identified(const FittedValue& E) const {
    const NamedValue stiffness = scene_.stiffness();
    if (std::none_of(problem_.scenes.begin(), problem_.scenes.end(), has_external_force)) {
      return why_stiffness_not_identifiable(scene_);
    }
    if (optimum_.is_undetermined(0)) {
      return fmt::format(
          "{0} is not identifiable from these shapes: with the other parameters as fitted, the "
          "shapes are the same for any {0}",
          stiffness.name);
    }
    if (E.value) return "";
    const auto end = [](const std::optional<double>& value) {
      return value ? fmt::format("{:.4g}", *value) : "...";
    };
    return fmt::format(
        "{0} is not identifiable together with the other fitted parameters: {1} to {2} {3} fit "
        "(identified: within a factor of {4:g})",
        stiffness.name, end(E.low), end(E.high), stiffness.unit,
        problem_.options.largest_interval_ratio);
  }

  /// Sets GJ and GJ / EI; the fitted number is the logarithm of the factor on GJ / EI.
  void find_torsion(MaterialFit& fit) const {
    const Eigen::Index k = problem_.first_remaining_number() - 1;
    const Eigen::MatrixXd& covariance = optimum_.covariance();
    const double GJ = scene_.twisting_stiffness();
    fit.torsional_stiffness =
        identified({0, k}, GJ, covariance(0, 0) + 2 * covariance(0, k) + covariance(k, k));
    fit.torsion_over_bending =
        identified({k}, GJ / scene_.mean_bending_stiffness(), covariance(k, k));
  }

  const WireProblem& problem_;
  WireOptimum& optimum_;
  const Scene& scene_;
  double widening_ = 1;  // width of intervals over that of the deviance alone
};

/// Returns the values of the numbers; rounding of those that no shape depends on is set to zero.
Eigen::VectorXd optimal_values(const WireProblem& problem, const WireOptimum& optimum) {
  constexpr double rounding = 1e-9;  // divided by the prior deviation
  Eigen::VectorXd values = optimum.values();
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const double before = problem.numbers[static_cast<std::size_t>(k)].described.prior_deviation;
    if (std::isfinite(before) && std::abs(values[k]) < rounding * before) values[k] = 0;
  }
  return values;
}

/// Sets natural curvature, and how the shapes were held.
void set_supports(const WireProblem& problem, const WireOptimum& optimum,
                  const Eigen::VectorXd& values, MaterialFit& fit) {
  for (Eigen::Index k = problem.first_remaining_number(); k < values.size(); ++k) {
    FittedNumber found = problem.numbers[static_cast<std::size_t>(k)].described;
    found.value = values[k];
    found.deviation = std::sqrt(optimum.covariance()(k, k));
    fit.others.push_back(std::move(found));
  }
  if (problem.options.natural_curvature_terms == 0) return;
  const Scene found = problem.scene_at(0, values);
  fit.natural_curvature = {found.natural_strain.head<2>()};
  fit.natural_curvature.insert(fit.natural_curvature.end(), found.natural_variation.begin(),
                               found.natural_variation.end());
}

/// Returns the corrections of clamps that all scenes share.
std::vector<ClampCorrection> clamp_corrections(const WireProblem& problem, Eigen::VectorXd values) {
  for (std::size_t k = 0; k < problem.numbers.size(); ++k) {
    const WireNumber& number = problem.numbers[k];
    if (number.described.shape || number.camera_axis) values[static_cast<Eigen::Index>(k)] = 0;
  }
  const std::vector<Gripper> found = problem.scene_at(0, values).grippers;
  std::vector<ClampCorrection> result;
  result.reserve(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Gripper& nominal = problem.scenes.front().grippers[i];
    ClampCorrection correction{.gripper = i, .displacement = found[i].position - nominal.position};
    if (nominal.direction) {
      const Eigen::AngleAxisd turn(
          Eigen::Quaterniond::FromTwoVectors(*nominal.direction, *found[i].direction));
      correction.rotation = turn.angle() * turn.axis();
    }
    result.push_back(correction);
  }
  return result;
}

/// Returns the tilt of the camera about all axes as a rotation vector [rad].
Eigen::Vector3d camera_tilt(const WireProblem& problem, const Eigen::VectorXd& values) {
  Eigen::Quaterniond tilt = Eigen::Quaterniond::Identity();
  for (std::size_t k = 0; k < problem.numbers.size(); ++k) {
    const std::optional<Eigen::Vector3d>& axis = problem.numbers[k].camera_axis;
    const double angle = values[static_cast<Eigen::Index>(k)];
    if (axis) tilt = Eigen::AngleAxisd(angle, *axis) * tilt;
  }
  const Eigen::AngleAxisd whole(tilt);
  return whole.angle() * whole.axis();
}

void set_fit_errors(const WireProblem& problem, const WireOptimum& optimum, MaterialFit& fit) {
  const WireErrors& errors = optimum.errors();
  fit.noise_m = std::sqrt(errors.variance);
  fit.noise_is_estimated = !problem.options.noise;
  fit.degrees_of_freedom = static_cast<int>(optimum.fit().freedom());
  fit.correlation_was_tested = errors.tested;
  if (!errors.are_correlated()) return;
  fit.correlation = CorrelatedErrors{.length_m = errors.correlation.length,
                                     .share = errors.correlation.share,
                                     .widening = optimum.correlated_widening(),
                                     .degrees_of_freedom = errors.freedom};
}

void set_fitted_shapes(const WireProblem& problem, WireOptimum& optimum, MaterialFit& fit) {
  const std::vector<Alignment> alignments = optimum.alignments();
  double sum_of_squares = 0;
  for (std::size_t i = 0; i < alignments.size(); ++i) {
    sum_of_squares +=
        alignments[i].mean_square * static_cast<double>(alignments[i].shape.points.cols());
    fit.shapes.push_back({problem.scenes[i].name, alignments[i], {}});
  }
  fit.rms_m = std::sqrt(sum_of_squares / static_cast<double>(problem.measured.points()));
}

/// Adds a warning if a rod was fitted in its plane but would leave it.
void warn_of_out_of_plane_rods(const WireProblem& problem, const WireOptimum& optimum,
                               MaterialFit& fit) {
  double farthest = 0;
  std::size_t farthest_shape = 0;
  for (std::size_t i = 0; i < optimum.rods().size(); ++i) {
    const double distance = problem.measured.out_of_plane_displacement(
        i, problem.scene_at(i, optimum.values()), *optimum.rods()[i]);
    if (distance > farthest) farthest_shape = i;
    farthest = std::max(farthest, distance);
  }
  if (!(farthest > 0)) return;
  add_warning(
      fit, fmt::format("the rod was fitted in the plane of its points, but would leave this plane "
                       "by {:.3g} mm in {}: its GJ is larger or its natural curvature differs",
                       farthest * 1000, problem.scenes[farthest_shape].file));
}

/// Adds a warning if clamps or a camera deviate more than their tolerances allow.
void note_contradicted_tolerances(MaterialFit& fit) {
  constexpr double reported_excess = 2.5;  // standard deviations
  const auto excess = [](const FittedNumber& number) {
    const bool has_tolerance = number.unit == "rad" || number.unit == "m";
    return has_tolerance ? std::abs(number.value) / number.prior_deviation : 0;
  };
  const auto farthest = std::max_element(
      fit.others.begin(), fit.others.end(),
      [&](const FittedNumber& a, const FittedNumber& b) { return excess(a) < excess(b); });
  if (farthest == fit.others.end() || !(excess(*farthest) > reported_excess)) return;
  add_warning(fit,
              fmt::format("the shapes contradict a given standard deviation: {} deviates by {:.2g} "
                          "times this value; give a larger one",
                          farthest->name, excess(*farthest)));
}

}  // namespace

void draw_rods(const FittedRods::Rods& rods, const std::vector<Scene>& scenes, MaterialFit& fit) {
  constexpr int drawn_samples = 201;
  const std::vector<Shape> drawn = sampled(rods, scenes, drawn_samples);
  for (std::size_t i = 0; i < drawn.size(); ++i) fit.shapes[i].rod = drawn[i];
}

MaterialFit wire_result(const WireProblem& problem, WireOptimum& optimum) {
  MaterialFit fit;
  WireIntervals intervals(problem, optimum);
  intervals.find(fit);
  const Eigen::VectorXd values = optimal_values(problem, optimum);
  set_supports(problem, optimum, values, fit);
  if (problem.options.shared_clamps) fit.clamps = clamp_corrections(problem, values);
  fit.camera_tilt = camera_tilt(problem, values);
  set_fit_errors(problem, optimum, fit);
  set_fitted_shapes(problem, optimum, fit);
  if (problem.options.profile_points > 0) {
    draw_rods(optimum.rods(), problem.scenes, fit);
    intervals.draw_profile(fit);
  }
  warn_of_out_of_plane_rods(problem, optimum, fit);
  note_contradicted_tolerances(fit);
  return fit;
}

}  // namespace dlo::compare
