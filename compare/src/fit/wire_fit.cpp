#include "fit/wire_fit.hpp"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <utility>

#include "dlo/compare/error.hpp"
#include "fit/between_shapes.hpp"
#include "fit/linear_fit.hpp"
#include "fit/log_profile.hpp"
#include "fit/wire_numbers.hpp"
#include "fit/wire_shapes.hpp"

namespace dlo::compare {
namespace {

/// The energy model's own error, in lengths: no noise is taken to be less.
constexpr double own_error = 1e-8;
constexpr int most_descents = 30;
constexpr int most_halvings = 8;
/// A step below this share of every number's standard deviation is the last.
constexpr double last_step = 0.01;
/// Longest step in log E: beyond it nothing is linear.
constexpr double longest_log_step = 1;
/// The correlation is measured from residuals of a fit that knows it: so often.
constexpr int most_correlations = 3;
/// An end of the interval is right if the deviance there is its quantile's square to this share.
constexpr double end_tolerance = 0.05;
constexpr int most_ends = 6;

class WireFitter {
 public:
  WireFitter(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
             MeasuredShapes& measured, const MaterialFitOptions& options, bool density)
      : scenes_(scenes),
        options_(options),
        density_(density),
        curvature_(1 + (density ? 1 : 0) + (options.torsional_stiffness ? 1 : 0)),
        numbers_(wire_numbers(scenes, shapes, options, density)),
        measured_(measured),
        shapes_(scenes, measured, options, numbers_),
        before_(static_cast<Eigen::Index>(numbers_.size())) {
    for (Eigen::Index k = 0; k < before_.size(); ++k) {
      before_[k] = 1 / numbers_[static_cast<std::size_t>(k)].described.known_before;
    }
  }

  [[nodiscard]] MaterialFit run(const MaterialPoint& start) {
    values_ = Eigen::VectorXd::Zero(before_.size());
    values_[0] = start.log_modulus;
    if (density_) values_[1] = start.log_density;
    look_for_start();
    for (int i = 0; i < most_correlations; ++i) {
      descend();
      if (!(variance_ > std::pow(own_error * scenes_.front().length, 2))) break;
      const CorrelationEstimate estimate = correlation_of(series_);
      tested_ = estimate.tested;
      const ErrorCovariance next = estimate.significant ? estimate.covariance : ErrorCovariance();
      if (next.share == covariance_.share && next.length == covariance_.length) break;
      covariance_ = next;
    }
    optimum_ = shapes_.rods();
    unseen_ = unseen(linear_, variance_, before_);
    return result();
  }

 private:
  [[nodiscard]] std::vector<ResidualSeries> derived(const Eigen::VectorXd& values) {
    std::optional<std::vector<ResidualSeries>> found =
        shapes_.residuals(values, WireShapes::Columns::all);
    if (!found) {
      throw ConvergenceError(fmt::format("{}: the energy model has no shape beside the fitted one",
                                         scenes_.front().file));
    }
    return std::move(*found);
  }

  [[nodiscard]] double penalty(const Eigen::VectorXd& values) const {
    return values.cwiseProduct(before_).squaredNorm();
  }

  /// Minus twice the logarithm of the likelihood and of what was known before, with the variance as
  /// it is; infinite where there is no shape.
  [[nodiscard]] double deviance(const Eigen::VectorXd& values) {
    const std::optional<std::vector<ResidualSeries>> series =
        shapes_.residuals(values, WireShapes::Columns::frames);
    if (!series) return INFINITY;
    const LinearFit there = linear_fit(*series, covariance_, measured_.frame_columns());
    return there.residual.squaredNorm() / variance_ + penalty(values);
  }

  void measure_variance(const LinearFit& linear) {
    const double floor = std::pow(own_error * scenes_.front().length, 2);
    if (options_.noise) {
      variance_ = std::pow(*options_.noise, 2);
      freedom_ = static_cast<double>(linear.freedom);
      return;
    }
    const double squares = linear.residual.squaredNorm();
    if (!(variance_ > 0))
      variance_ = std::max(floor, squares / static_cast<double>(linear.freedom));
    // What was known before is no number found.
    const Eigen::VectorXd kept =
        posterior(linear, variance_, before_).diagonal().cwiseProduct(before_.cwiseAbs2());
    freedom_ = static_cast<double>(linear.freedom - before_.size()) + kept.sum();
    if (!(freedom_ >= 1)) {
      throw InputError(
          fmt::format("calibrate: {} numbers measured beside the frames, {} to be found (allowed: "
                      "more measured than found, so more points, or a given noise)",
                      linear.freedom, before_.size()));
    }
    variance_ = std::max(floor, squares / freedom_);
  }

  /// A rod that is intrinsically curved may hang on the other side of its clamp, and the E that
  /// fits best without that may be far away. So mean curvatures all over what is likely are gone
  /// through from both ends, each shape following its own equilibrium, with that E and the scene's;
  /// each shape goes on from the one of the two that is nearer to its points.
  void look_for_start() {
    if (options_.natural_curvature_terms == 0) return;
    constexpr double turns[] = {8, 5, 3, 1.5, 0, -1.5, -3, -5, -8};
    const Eigen::VectorXd straight = values_;
    double least = INFINITY;
    WireShapes::Rods nearest;
    for (const double log_modulus : {straight[0], 0.0}) {
      std::vector<WireShapes::State> down;
      shapes_.go_on_from(WireShapes::Rods(scenes_.size()));
      const auto at = [&](double turn) {
        Eigen::VectorXd values = straight;
        values[0] = log_modulus;
        values[curvature_] = turn / scenes_.front().length;
        return values;
      };
      for (const double turn : turns) down.push_back(shapes_.state(at(turn)));
      shapes_.go_on_from(WireShapes::Rods(scenes_.size()));
      for (std::size_t k = down.size(); k-- > 0;) {
        const WireShapes::State up = shapes_.state(at(turns[k]));
        double sum = 0;
        for (std::size_t i = 0; i < scenes_.size(); ++i) {
          if (up.squares[i] < down[k].squares[i]) {
            down[k].squares[i] = up.squares[i];
            down[k].rods[i] = up.rods[i];
          }
          sum += down[k].squares[i];
        }
        if (!(sum < least)) continue;
        least = sum;
        nearest = down[k].rods;
        values_ = at(turns[k]);
      }
    }
    shapes_.go_on_from(std::move(nearest));
  }

  /// Gauss-Newton steps to the least deviance.
  void descend() {
    for (int i = 0; i < most_descents; ++i) {
      series_ = derived(values_);
      linear_ = linear_fit(series_, covariance_, measured_.frame_columns());
      measure_variance(linear_);
      posterior_ = posterior(linear_, variance_, before_);
      Eigen::VectorXd step = next_step();
      const Eigen::VectorXd deviations = posterior_.diagonal().cwiseSqrt();
      if ((step.array().abs() <= last_step * deviations.array()).all()) return;
      const double here = linear_.residual.squaredNorm() / variance_ + penalty(values_);
      // Every trial follows from here, not from where a longer one has led.
      const WireShapes::Rods rods = shapes_.rods();
      int halvings = 0;
      while (halvings < most_halvings && !(deviance(values_ + step) < here)) {
        shapes_.go_on_from(rods);
        step /= 2;
        ++halvings;
      }
      // Nothing less along a direction of descent but rounding.
      if (halvings == most_halvings) return;
      values_ += step;
    }
  }

  /// To the least deviance of the linear problem with log E near. Where E is hardly seen it would
  /// be far away, and take the others with it; and no farther than E is looked for.
  [[nodiscard]] Eigen::VectorXd next_step() const {
    const Eigen::VectorXd down = slope(linear_, variance_, before_, values_);
    Eigen::VectorXd step = posterior_ * down;
    const double there =
        std::clamp(values_[0] + std::clamp(step[0], -longest_log_step, longest_log_step),
                   std::log(options_.smallest_ratio), std::log(options_.largest_ratio));
    if (values_[0] + step[0] == there) return step;
    step[0] = there - values_[0];
    step.tail(step.size() - 1) = step_of_others(linear_, variance_, before_, down, step[0]);
    return step;
  }

  [[nodiscard]] double quantile() const {
    return options_.noise ? gsl_cdf_ugaussian_Pinv(0.975) : gsl_cdf_tdist_Pinv(0.975, freedom_);
  }

  /// Least deviance over all other numbers at some log E, by chords of the optimum's derivatives.
  [[nodiscard]] double profile(double log_modulus) {
    const Eigen::Index others = before_.size() - 1;
    Eigen::VectorXd values =
        values_ + posterior_.col(0) / posterior_(0, 0) * (log_modulus - values_[0]);
    double least = deviance(values);
    if (others == 0) return least;
    LinearFit chord = linear_;
    constexpr int most_chords = 4;
    for (int i = 0; i < most_chords && std::isfinite(least); ++i) {
      const std::optional<std::vector<ResidualSeries>> series =
          shapes_.residuals(values, WireShapes::Columns::frames);
      if (!series) break;
      chord.residual = linear_fit(*series, covariance_, measured_.frame_columns()).residual;
      const Eigen::VectorXd down = slope(chord, variance_, before_, values);
      Eigen::VectorXd next = values;
      next.tail(others) += step_of_others(chord, variance_, before_, down, 0);
      const double deviance_there = deviance(next);
      if (!(deviance_there < least)) break;
      const bool done = least - deviance_there < end_tolerance;
      least = deviance_there;
      values = next;
      if (done) break;
    }
    return least;
  }

  /// Distance in log E to the end of the interval on a side (1: above, -1: below); none: open.
  /// Where the equilibria that are followed end before, linear theory has to do.
  [[nodiscard]] std::optional<double> end(double side) {
    if (unseen_[0]) return std::nullopt;
    const double wanted = quantile();
    const double least = linear_.residual.squaredNorm() / variance_ + penalty(values_);
    const double linear = wanted * std::sqrt(posterior_(0, 0));
    const double farthest = side > 0 ? std::log(options_.largest_ratio) - values_[0]
                                     : values_[0] - std::log(options_.smallest_ratio);
    constexpr double jump = 4;
    double distance = linear;
    for (int i = 0; i < most_ends; ++i) {
      if (!(distance < farthest)) return std::nullopt;
      shapes_.go_on_from(optimum_);
      const double excess = profile(values_[0] + side * distance) - least;
      const double reached = std::sqrt(std::max(0.0, excess));
      if (!(reached < jump * wanted)) return linear;
      if (std::abs(reached - wanted) <= end_tolerance * wanted) break;
      distance *= std::clamp(wanted / std::max(reached, 1e-300), 0.5, 2.0);
    }
    return distance;
  }

  /// @param variance  of the errors
  void measure_scatter(MaterialFit& fit, double variance) const {
    std::vector<ShapeEstimate> estimates;
    const Eigen::Index frames = measured_.frame_columns();
    for (std::size_t shape = 0; shape < scenes_.size(); ++shape) {
      std::vector<Nuisance> nuisances;
      for (Eigen::Index k = 0; k < frames; ++k) nuisances.push_back({k, 0, INFINITY});
      for (std::size_t k = 0; k < numbers_.size(); ++k) {
        const auto number = static_cast<Eigen::Index>(k);
        if (numbers_[k].described.shape != shape) continue;
        nuisances.push_back({frames + number, values_[number], numbers_[k].described.known_before});
      }
      estimates.push_back(estimate_of_shape(series_of_shape(series_, shape), covariance_, variance,
                                            frames, nuisances));
    }
    fit.scatter = scatter_between(estimates, quantile());
  }

  [[nodiscard]] FittedValue identified(double log_value, double unit, std::optional<double> below,
                                       std::optional<double> above) const {
    FittedValue value;
    if (below) value.low = unit * std::exp(log_value - *below);
    if (above) value.high = unit * std::exp(log_value + *above);
    if (below && above && *below + *above <= std::log(options_.identified_within)) {
      value.value = unit * std::exp(log_value);
    }
    return value;
  }

  /// Of the interval of some numbers' sum with that variance; none: open.
  [[nodiscard]] std::optional<double> half_width(std::initializer_list<Eigen::Index> numbers,
                                                 double variance, double widening) const {
    for (const Eigen::Index number : numbers) {
      // What was known before is no finding.
      const bool in_no_shape = linear_.design.col(number).isZero(0);
      if (in_no_shape || unseen_[static_cast<std::size_t>(number)]) return std::nullopt;
    }
    return quantile() * std::sqrt(variance) * widening;
  }

  /// The errors' covariance is known from the residuals only: by what the interval is wider when
  /// all that they leave likely is averaged over. Of their variance it takes what the residuals
  /// say, a given noise may be another one.
  [[nodiscard]] double unknown_covariance() const {
    if (!(covariance_.share > 0) || unseen_[0]) return 1;
    const auto of_errors = [this](const LinearFit& linear) {
      return linear.residual.squaredNorm() / freedom_;
    };
    double variance = 0;
    double mean = 0;
    double square = 0;
    const std::vector<ResidualSeries> few = thinned(series_);
    for (const LikelyCovariance& likely : likely_covariances(few)) {
      const LinearFit linear = linear_fit(few, likely.covariance, measured_.frame_columns());
      const Eigen::MatrixXd inverse = posterior(linear, of_errors(linear), before_);
      const double shift = inverse.row(0).dot(slope(linear, of_errors(linear), before_, values_));
      variance += likely.weight * inverse(0, 0);
      mean += likely.weight * shift;
      square += likely.weight * shift * shift;
    }
    const LinearFit likeliest = linear_fit(few, covariance_, measured_.frame_columns());
    const double alone = posterior(likeliest, of_errors(likeliest), before_)(0, 0);
    return std::max(1.0, std::sqrt((variance + square - mean * mean) / alone));
  }

  /// Where a given noise explains less than there is: by what the interval is wider.
  [[nodiscard]] double misfit(MaterialFit& fit) const {
    if (!options_.noise) return 1;
    const double squares = linear_.residual.squaredNorm() / variance_ + penalty(values_);
    constexpr double significant = 0.05;
    if (!(gsl_cdf_chisq_Q(squares, freedom_) < significant)) return 1;
    const double times = std::sqrt(squares / freedom_);
    fit.warning = fmt::format(
        "the residuals are {:.3g} times what the given noise explains; the interval is as much "
        "wider",
        times);
    return times;
  }

  /// @param widening  of the interval beside what the deviance alone gives
  void draw_profile(MaterialFit& fit, double widening) {
    constexpr int drawn_samples = 201;
    const WireShapes::Rods rods = shapes_.rods();
    for (std::size_t i = 0; i < fit.shapes.size() && i < rods.size(); ++i) {
      if (!rods[i]) continue;
      const std::vector<double> s = equal_arc_lengths(scenes_[i].length, drawn_samples);
      fit.shapes[i].rod = {.arc_length = s, .points = rods[i]->sample(s).points};
    }
    if (unseen_[0]) return;
    const double unit = scenes_.front().stiffness().value;
    const auto logarithm = [unit](const std::optional<double>& value) {
      return value ? std::optional(std::log(*value / unit)) : std::nullopt;
    };
    const double least = linear_.residual.squaredNorm() / variance_ + penalty(values_);
    for (const double x :
         drawn_logarithms(logarithm(fit.youngs_modulus.low), values_[0],
                          logarithm(fit.youngs_modulus.high), options_.profile_points)) {
      shapes_.go_on_from(optimum_);
      // The interval's ends are `widening` times as far away as where the deviance has its limit.
      const double excess = profile(values_[0] + (x - values_[0]) / widening) - least;
      fit.profile.push_back({unit * std::exp(x), excess / (quantile() * quantile())});
    }
  }

  [[nodiscard]] MaterialFit result() {
    MaterialFit fit;
    const double times_noise = misfit(fit);
    measure_scatter(fit, variance_ * times_noise * times_noise);
    const double unknown = unknown_covariance();
    const double widening = unknown * times_noise * (fit.scatter ? fit.scatter->widening : 1);
    const auto widened = [widening](std::optional<double> distance) {
      if (distance) *distance *= widening;
      return distance;
    };
    const NamedValue stiffness = scenes_.front().stiffness();
    fit.youngs_modulus = identified(values_[0], stiffness.value, widened(end(-1)), widened(end(1)));
    if (std::none_of(scenes_.begin(), scenes_.end(), is_forced)) {
      fit.not_identified = why_unforced(scenes_.front());
    } else if (unseen_[0]) {
      fit.not_identified = fmt::format(
          "{0} is not identifiable from these shapes: with the rest as it fits they are the same "
          "with "
          "any {0}",
          stiffness.name);
    } else if (!fit.youngs_modulus.value) {
      const FittedValue& E = fit.youngs_modulus;
      fit.not_identified = fmt::format(
          "{0} is not identifiable beside what else is fitted: {1} to {2} {3} fit (identified: "
          "within "
          "a factor of {4:g})",
          stiffness.name, E.low ? fmt::format("{:.4g}", *E.low) : "...",
          E.high ? fmt::format("{:.4g}", *E.high) : "...", stiffness.unit,
          options_.identified_within);
    }
    if (density_) {
      const std::optional<double> half = half_width({1}, posterior_(1, 1), widening);
      fit.density = identified(values_[1], scenes_.front().heaviness().value, half, half);
    }
    if (options_.torsional_stiffness) {
      // Its number is the logarithm of GJ / EI.
      const Eigen::Index k = curvature_ - 1;
      const double GJ = scenes_.front().twisting_stiffness();
      const double EI = scenes_.front().mean_bending_stiffness();
      const double variance = posterior_(0, 0) + 2 * posterior_(0, k) + posterior_(k, k);
      const std::optional<double> half = half_width({0, k}, variance, widening);
      fit.torsional_stiffness = identified(values_[0] + values_[k], GJ, half, half);
      const std::optional<double> half_ratio = half_width({k}, posterior_(k, k), widening);
      fit.torsion_over_bending = identified(values_[k], GJ / EI, half_ratio, half_ratio);
    }
    for (Eigen::Index number = curvature_; number < values_.size(); ++number) {
      FittedNumber found = numbers_[static_cast<std::size_t>(number)].described;
      found.value = values_[number];
      found.deviation = std::sqrt(posterior_(number, number));
      fit.others.push_back(std::move(found));
    }
    if (options_.natural_curvature_terms > 0) {
      const Scene found = shapes_.scene(0, values_);
      fit.natural_curvature = {found.natural_strain.head<2>()};
      fit.natural_curvature.insert(fit.natural_curvature.end(), found.natural_variation.begin(),
                                   found.natural_variation.end());
    }
    fit.noise_m = std::sqrt(variance_);
    fit.noise_is_estimated = !options_.noise;
    fit.degrees_of_freedom = static_cast<int>(freedom_);
    fit.correlation_was_tested = tested_;
    if (covariance_.share > 0) {
      fit.correlation = CorrelatedErrors{.length_m = covariance_.length,
                                         .share = covariance_.share,
                                         .widening = unknown,
                                         .degrees_of_freedom = freedom_};
    }
    shapes_.go_on_from(optimum_);
    const std::vector<Alignment> alignments = shapes_.alignments(values_);
    double squares = 0;
    for (std::size_t i = 0; i < alignments.size(); ++i) {
      squares += alignments[i].mean_square * static_cast<double>(alignments[i].shape.points.cols());
      fit.shapes.push_back({scenes_[i].name, alignments[i], {}});
    }
    if (options_.profile_points > 0) draw_profile(fit, widening);
    fit.rms_m = std::sqrt(squares / static_cast<double>(measured_.points()));
    return fit;
  }

  const std::vector<Scene>& scenes_;
  const MaterialFitOptions& options_;
  bool density_;
  Eigen::Index curvature_;  // the first number that has its own value: of natural curvature, if any
  std::vector<WireNumber> numbers_;
  MeasuredShapes& measured_;
  WireShapes shapes_;
  Eigen::VectorXd before_;  // 1 over what was known of each number
  Eigen::VectorXd values_;
  ErrorCovariance covariance_;
  bool tested_ = false;
  double variance_ = 0;  // of a coordinate's error [m^2]
  double freedom_ = 0;
  // At the values
  WireShapes::Rods optimum_;
  std::vector<ResidualSeries> series_;
  LinearFit linear_;
  Eigen::MatrixXd posterior_;
  std::vector<bool> unseen_;  // of the numbers, see unseen()
};

}  // namespace

bool fits_a_wire(const MaterialFitOptions& options) {
  return options.torsional_stiffness || options.natural_curvature_terms > 0 ||
         options.direction_tolerance > 0 || options.position_tolerance > 0;
}

MaterialFit fit_wire(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                     MeasuredShapes& measured, const MaterialFitOptions& options,
                     const MaterialPoint& start, bool density) {
  return WireFitter(scenes, shapes, measured, options, density).run(start);
}

}  // namespace dlo::compare
