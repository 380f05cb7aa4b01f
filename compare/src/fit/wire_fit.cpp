#include "fit/wire_fit.hpp"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "dlo/compare/error.hpp"
#include "fit/between_shapes.hpp"
#include "fit/leave_one_out.hpp"
#include "fit/log_profile.hpp"
#include "fit/wire_errors.hpp"
#include "fit/wire_numbers.hpp"
#include "least_squares/gauss_newton.hpp"
#include "least_squares/linear_fit.hpp"

namespace dlo::compare {
namespace {

/// The energy model's own error, in lengths: no noise is taken to be less.
constexpr double own_error = 1e-8;
/// Longest step in log E: beyond it nothing is linear.
constexpr double longest_log_step = 1;
/// In log E from the scene's: another one fits best without the other numbers than with them.
constexpr double far_away = 0.7;
/// Last step of fits from which others go on, in standard deviations.
constexpr double coarse_step = 0.1;
/// Correlated errors tell less than as many independent ones, which counts beside what was known
/// before. How much less is measured from the residuals of a fit that knows it: so often, and to so
/// much of it.
constexpr int most_weights = 3;
constexpr double weight_tolerance = 0.1;
/// An end of the interval is right if the deviance there is its quantile's square to this share.
constexpr double end_tolerance = 0.05;
constexpr int most_ends = 6;

/// Scenes whose numbers are fitted.
std::vector<Scene> fitted_scenes(const std::vector<Scene>& scenes, const MeasuredShapes& measured,
                                 const MaterialFitOptions& options) {
  std::vector<bool> flat;
  for (std::size_t i = 0; i < scenes.size(); ++i) flat.push_back(measured.is_flat(i));
  return with_said_frames(scenes, flat, options);
}

/// A shape's scene at some values of a wire's numbers.
FittedRods::SceneAt scene_at(std::vector<Scene> scenes, std::vector<WireNumber> numbers) {
  return [scenes = std::move(scenes), numbers = std::move(numbers)](std::size_t shape,
                                                                    const Eigen::VectorXd& values) {
    Scene result = scenes[shape];
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const std::optional<std::size_t>& whose = numbers[k].described.shape;
      if (whose && *whose != shape) continue;
      numbers[k].change(result, values[static_cast<Eigen::Index>(k)]);
    }
    return result;
  };
}

/// @param terms  of natural curvature that are fitted, the others stay
std::vector<Unknown> unknowns_of(const std::vector<WireNumber>& numbers, int terms) {
  std::vector<Unknown> result;
  result.reserve(numbers.size());
  for (const WireNumber& number : numbers) {
    result.push_back({.stride = number.term < std::max(1, terms) ? number.stride : 0,
                      .shape = number.described.shape,
                      .known_before = number.described.known_before,
                      .longest_step = number.longest_step});
  }
  result.front().longest_step = longest_log_step;
  return result;
}

class WireFitter {
 public:
  WireFitter(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
             MeasuredShapes& measured, const MaterialFitOptions& options, bool density)
      : scenes_(scenes),
        shapes_(shapes),
        options_(options),
        density_(density),
        curvature_(1 + (density ? 1 : 0) + (options.torsional_stiffness ? 1 : 0)),
        numbers_(wire_numbers(fitted_scenes(scenes, measured, options), shapes, options, density)),
        measured_(measured),
        scene_at_(scene_at(fitted_scenes(scenes, measured, options), numbers_)),
        rods_(measured, scene_at_, unknowns_of(numbers_, options.natural_curvature_terms)) {}

  [[nodiscard]] MaterialFit run(const MaterialPoint& start) {
    Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(numbers_.size()));
    if (start.log_modulus > lowest()) values[0] = start.log_modulus;
    if (density_) values[1] = start.log_density;
    look_for_start(values);
    look_for_modulus(values);
    fit_fewer_terms(values);
    fit_.emplace(rods_, values, steps());
    descend();
    for (int i = 0; i < most_weights && !fit_->before().isZero(); ++i) {
      const double weight = weight_of(errors_, *fit_);
      if (std::abs(weight / fit_->weight() - 1) < weight_tolerance) break;
      fit_->weigh(weight);
      descend();
    }
    unseen_ = unseen(fit_->linear(), fit_->weight(), fit_->before());
    if (!unseen_[0]) go_to_likely_modulus();
    optimum_ = fit_->rods();
    covariance_ = covariance_of_numbers(errors_, *fit_, measured_.frame_columns(), options_.noise);
    MaterialFit found = result();
    if (options_.predict) {
      found.prediction = leave_one_out(scenes_, shapes_, options_, found,
                                       [this](std::size_t left) { return predicted(left); });
    }
    return found;
  }

 private:
  [[nodiscard]] double least_noise() const { return own_error * scenes_.front().length; }

  [[nodiscard]] GaussNewtonOptions steps() const {
    return {.noise = options_.noise,
            .least_noise = least_noise(),
            .lowest = lowest(),
            .highest = std::log(options_.largest_ratio)};
  }

  /// Of log E. Weight makes a rope of a softer rod, whose shape is the same with any E; at least two
  /// decades are looked at.
  [[nodiscard]] double lowest() const {
    constexpr double ropes_load = 1e5;  // w l^3 / (EI)
    double load = 0;
    for (const Scene& scene : scenes_) load = std::max(load, scene.gamma());
    return std::max(std::log(options_.smallest_ratio), std::log(std::min(load / ropes_load, 1e-2)));
  }

  [[noreturn]] void refuse_no_shape() const {
    throw ConvergenceError(fmt::format("{}: the energy model has no shape beside the fitted one",
                                       scenes_.front().file));
  }

  void descend() {
    if (!fit_->descend()) refuse_no_shape();
    errors_ = errors_about(*fit_, measured_.frame_columns(), options_.noise, least_noise());
  }

  /// From the least deviance to the E that is likeliest whatever the other numbers are. The two
  /// differ by how much more a stiffer rod lets the shapes tell of its clamps.
  void go_to_likely_modulus() {
    marginal_slope_ = fit_->marginal_slope();
    const double variance = fit_->covariance_of_numbers()(0, 0);
    const double step =
        std::clamp(-marginal_slope_ * variance / 2, -longest_log_step, longest_log_step);
    if (std::abs(step) <= steps().last_step * std::sqrt(variance)) return;
    GaussNewtonOptions held = steps();
    held.lowest = held.highest = std::clamp(fit_->values()[0] + step, held.lowest, held.highest);
    rods_.go_on_from(fit_->rods());
    GaussNewton there(rods_, fit_->values_beside(held.lowest), held);
    there.weigh(fit_->weight());
    if (!there.descend()) refuse_no_shape();
    fit_.emplace(std::move(there));
    errors_ = errors_about(*fit_, measured_.frame_columns(), options_.noise, least_noise());
  }

  /// Twice the logarithm of how much less likely another E is, whatever the other numbers are.
  [[nodiscard]] double unlikelihood(double log_modulus) {
    rods_.go_on_from(optimum_);
    return fit_->profile(log_modulus) - fit_->deviance() +
           marginal_slope_ * (log_modulus - fit_->values()[0]);
  }

  /// The scene of a shape as the fit to the others says, to which steps lead from the fit to all,
  /// with its weights. What was the shape's own is as if nothing were known of it.
  [[nodiscard]] PredictedScene predicted(std::size_t left) const {
    const std::vector<Scene> scenes = all_but(scenes_, left);
    const std::vector<MeasuredShape> shapes = all_but(shapes_, left);
    MeasuredShapes measured(scenes, shapes, measured_options(options_),
                            std::chrono::steady_clock::now());
    WireFitter others(scenes, shapes, measured, options_, density_);
    std::vector<Eigen::Index> common;
    for (std::size_t k = 0; k < numbers_.size(); ++k) {
      if (numbers_[k].described.shape != left) common.push_back(static_cast<Eigen::Index>(k));
    }
    others.rods_.go_on_from(all_but(optimum_, left));
    others.fit_.emplace(others.rods_, fit_->values()(common), steps());
    others.fit_->weigh(fit_->weight());
    if (!others.fit_->descend()) others.refuse_no_shape();
    Eigen::VectorXd values = Eigen::VectorXd::Zero(fit_->values().size());
    values(common) = others.fit_->values();
    return {scene_at_(left, values), optimum_[left]};
  }

  /// More terms of natural curvature never fit worse than fewer: each one is added where the fit
  /// without it has led.
  void fit_fewer_terms(Eigen::VectorXd& values) {
    GaussNewtonOptions coarse = steps();
    coarse.last_step = coarse_step;
    for (int terms = 1; terms < options_.natural_curvature_terms; ++terms) {
      FittedRods rods(measured_, scene_at_, unknowns_of(numbers_, terms));
      rods.go_on_from(rods_.rods());
      GaussNewton fit(rods, values, coarse);
      if (!fit.descend()) return;
      values = fit.values();
      rods_.go_on_from(fit.rods());
    }
  }

  /// Each shape's numbers and its rod, those of some that come nearest to its points.
  struct Nearest {
    std::vector<double> squares;
    FittedRods::Rods rods;
    Eigen::VectorXd values;

    [[nodiscard]] double sum() const {
      return std::accumulate(squares.begin(), squares.end(), 0.0);
    }
  };

  void take_nearer(Nearest& nearest, const FittedRods::State& state,
                   const Eigen::VectorXd& values) const {
    if (nearest.squares.empty()) {
      nearest = {state.squares, state.rods, values};
      return;
    }
    for (std::size_t i = 0; i < scenes_.size(); ++i) {
      if (!(state.squares[i] < nearest.squares[i])) continue;
      nearest.squares[i] = state.squares[i];
      nearest.rods[i] = state.rods[i];
      for (std::size_t k = 0; k < numbers_.size(); ++k) {
        const auto number = static_cast<Eigen::Index>(k);
        if (numbers_[k].described.shape == i) nearest.values[number] = values[number];
      }
    }
  }

  /// A rod that is intrinsically curved may hang on the other side of its clamp, and the E that
  /// fits best without that may be far away. So mean curvatures all over what is likely are gone
  /// through from both ends, each shape following its own equilibrium, with that E and the scene's,
  /// and, where it is not known how the clamp holds the rod, with angles all around; each shape
  /// goes on from the one that is nearest to its points.
  void look_for_start(Eigen::VectorXd& start) {
    if (options_.natural_curvature_terms == 0) return;
    constexpr std::array turns = {8.0, 5.0, 3.0, 1.5, 0.0, -1.5, -3.0, -5.0, -8.0};
    constexpr int angles = 6;
    const bool turns_the_rod =
        std::ranges::any_of(numbers_, [](const WireNumber& one) { return one.turns_the_rod; });
    const Eigen::VectorXd straight = start;
    double least = INFINITY;
    FittedRods::Rods nearest;
    for (const double log_modulus : {straight[0], 0.0}) {
      std::vector<Nearest> found(turns.size());
      for (int angle = 0; angle < (turns_the_rod ? angles : 1); ++angle) {
        const auto look_at = [&](std::size_t k) {
          Eigen::VectorXd values = straight;
          values[0] = log_modulus;
          values[curvature_] = turns[k] / scenes_.front().length;
          for (std::size_t i = 0; i < numbers_.size(); ++i) {
            if (!numbers_[i].turns_the_rod) continue;
            values[static_cast<Eigen::Index>(i)] = 2 * std::numbers::pi * angle / angles;
          }
          take_nearer(found[k], rods_.state(values), values);
        };
        rods_.go_on_from(FittedRods::Rods(scenes_.size()));
        for (std::size_t k = 0; k < turns.size(); ++k) look_at(k);
        rods_.go_on_from(FittedRods::Rods(scenes_.size()));
        for (std::size_t k = turns.size(); k-- > 0;) look_at(k);
      }
      // From the last one, as of two that are as near.
      for (auto one = found.rbegin(); one != found.rend(); ++one) {
        if (!(one->sum() < least)) continue;
        least = one->sum();
        nearest = one->rods;
        start = one->values;
      }
    }
    rods_.go_on_from(std::move(nearest));
  }

  /// Of a rod that is held otherwise than was said, the E that fits best with what was said may be
  /// far away: steps begin at the scene's E as well.
  void look_for_modulus(Eigen::VectorXd& values) {
    if (options_.natural_curvature_terms > 0 || !(std::abs(values[0]) > far_away)) return;
    GaussNewtonOptions coarse = steps();
    coarse.last_step = coarse_step;
    const Eigen::VectorXd start = values;
    double least = INFINITY;
    FittedRods::Rods nearest(scenes_.size());
    for (const double log_modulus : {start[0], 0.0}) {
      Eigen::VectorXd from = start;
      from[0] = log_modulus;
      rods_.go_on_from(FittedRods::Rods(scenes_.size()));
      GaussNewton fit(rods_, from, coarse);
      if (!fit.descend() || !(fit.variance() < least)) continue;
      least = fit.variance();
      nearest = fit.rods();
      values = fit.values();
    }
    rods_.go_on_from(std::move(nearest));
  }

  /// By what correlated errors make the interval of E wider than where the deviance has its limit.
  [[nodiscard]] double correlated_width() const {
    return std::sqrt(covariance_(0, 0) / fit_->covariance_of_numbers()(0, 0));
  }

  /// By what they make it wider than as many independent ones of the same squares would.
  [[nodiscard]] double correlated_widening() const {
    const double independent = posterior(fit_->linear(), fit_->variance(), fit_->before())(0, 0);
    const double alone = options_.noise ? quantile() : gsl_cdf_tdist_Pinv(0.975, fit_->freedom());
    return std::sqrt(covariance_(0, 0) / independent) * quantile() / alone;
  }

  [[nodiscard]] double quantile() const {
    return options_.noise ? gsl_cdf_ugaussian_Pinv(0.975)
                          : gsl_cdf_tdist_Pinv(0.975, errors_.freedom);
  }

  /// Distance in log E to the end of the interval on a side (1: above, -1: below); none: open.
  /// Where the equilibria that are followed end before, linear theory has to do.
  [[nodiscard]] std::optional<double> end(double side) {
    if (unseen_[0]) return std::nullopt;
    const double wanted = quantile() * correlated_width();
    const double linear = quantile() * std::sqrt(covariance_(0, 0));
    const double farthest = side > 0 ? std::log(options_.largest_ratio) - fit_->values()[0]
                                     : fit_->values()[0] - lowest();
    constexpr double jump = 4;
    double distance = linear;
    for (int i = 0; i < most_ends; ++i) {
      if (!(distance < farthest)) return std::nullopt;
      const double excess = unlikelihood(fit_->values()[0] + side * distance);
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
        nuisances.push_back(
            {frames + number, fit_->values()[number], numbers_[k].described.known_before});
      }
      estimates.push_back(estimate_of_shape(series_of_shape(fit_->series(), shape),
                                            errors_.correlation, variance, frames, nuisances));
    }
    fit.scatter = scatter_between(estimates, quantile());
  }

  [[nodiscard]] FittedValue identified(double log_value, double unit, std::optional<double> below,
                                       std::optional<double> above) const {
    FittedValue value{.estimate = unit * std::exp(log_value)};
    // An end farther away than E is looked for is no bound.
    const double farthest = std::log(options_.largest_ratio) - lowest();
    if (below && !(*below < farthest)) below.reset();
    if (above && !(*above < farthest)) above.reset();
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
      const bool in_no_shape = fit_->linear().design.col(number).isZero(0);
      if (in_no_shape || unseen_[static_cast<std::size_t>(number)]) return std::nullopt;
    }
    return quantile() * std::sqrt(variance) * widening;
  }

  /// Where a given noise explains less than there is: by what the interval is wider.
  [[nodiscard]] double misfit(MaterialFit& fit) const {
    if (!options_.noise) return 1;
    constexpr double significant = 0.05;
    if (!(gsl_cdf_chisq_Q(errors_.squares, errors_.freedom_of_squares) < significant)) return 1;
    const double times = std::sqrt(errors_.squares / errors_.freedom_of_squares);
    fit.warning = fmt::format(
        "the residuals are {:.3g} times what the given noise explains; the interval is as much "
        "wider",
        times);
    return times;
  }

  /// @param widening  of the interval beside what the deviance alone gives
  void draw_profile(MaterialFit& fit, double widening) {
    constexpr int drawn_samples = 201;
    const FittedRods::Rods rods = rods_.rods();
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
    for (const double x :
         drawn_logarithms(logarithm(fit.youngs_modulus.low), fit_->values()[0],
                          logarithm(fit.youngs_modulus.high), options_.profile_points)) {
      // The interval's ends are `widening` times as far away as where the deviance has its limit.
      const double excess = unlikelihood(fit_->values()[0] + (x - fit_->values()[0]) / widening);
      const double limit = quantile() * correlated_width();
      fit.profile.push_back({unit * std::exp(x), excess / (limit * limit)});
    }
  }

  static void warn(MaterialFit& fit, const std::string& what) {
    if (!fit.warning.empty()) fit.warning += "; ";
    fit.warning += what;
  }

  /// Clamps, or a camera, that are not known as well as was said.
  static void note_contradicted_tolerances(MaterialFit& fit) {
    constexpr double likely = 2.5;  // standard deviations
    const auto excess = [](const FittedNumber& number) {
      const bool is_said = number.unit == "rad" || number.unit == "m";
      return is_said ? std::abs(number.value) / number.known_before : 0;
    };
    const auto farthest = std::max_element(
        fit.others.begin(), fit.others.end(),
        [&](const FittedNumber& a, const FittedNumber& b) { return excess(a) < excess(b); });
    if (farthest == fit.others.end() || !(excess(*farthest) > likely)) return;
    warn(fit, fmt::format("the shapes contradict how well it is said to be known: {} is off by "
                          "{:.2g} times that; say less",
                          farthest->name, excess(*farthest)));
  }

  /// A rod that was found in its plane, but would not stay there.
  void note_ways_out_of_plane(MaterialFit& fit) {
    double farthest = 0;
    std::size_t whose = 0;
    for (std::size_t i = 0; i < optimum_.size(); ++i) {
      const double way = measured_.way_out_of_plane(i, scene_at_(i, fit_->values()), *optimum_[i]);
      if (way > farthest) whose = i;
      farthest = std::max(farthest, way);
    }
    if (!(farthest > 0)) return;
    warn(fit, fmt::format("the rod was fitted in the plane of its points and would leave it, by "
                          "{:.3g} mm in {}: GJ is larger, or the natural curvature another one",
                          farthest * 1000, scenes_[whose].file));
  }

  /// What was found of clamps that are alike in all scenes.
  [[nodiscard]] std::vector<ClampCorrection> clamp_corrections() const {
    Eigen::VectorXd shared = fit_->values();
    for (std::size_t k = 0; k < numbers_.size(); ++k) {
      if (numbers_[k].described.shape || numbers_[k].camera_axis)
        shared[static_cast<Eigen::Index>(k)] = 0;
    }
    const std::vector<Gripper> found = scene_at_(0, shared).grippers;
    std::vector<ClampCorrection> result;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const Gripper& said = scenes_.front().grippers[i];
      ClampCorrection correction{.gripper = i, .displacement = found[i].position - said.position};
      if (said.direction) {
        const Eigen::AngleAxisd turn(
            Eigen::Quaterniond::FromTwoVectors(*said.direction, *found[i].direction));
        correction.rotation = turn.angle() * turn.axis();
      }
      result.push_back(correction);
    }
    return result;
  }

  /// What was found of the camera, all axes together: a rotation vector.
  [[nodiscard]] Eigen::Vector3d camera_tilt() const {
    Eigen::Quaterniond tilt = Eigen::Quaterniond::Identity();
    for (std::size_t k = 0; k < numbers_.size(); ++k) {
      const std::optional<Eigen::Vector3d>& axis = numbers_[k].camera_axis;
      const double angle = fit_->values()[static_cast<Eigen::Index>(k)];
      if (axis) tilt = Eigen::AngleAxisd(angle, *axis) * tilt;
    }
    const Eigen::AngleAxisd whole(tilt);
    return whole.angle() * whole.axis();
  }

  [[nodiscard]] MaterialFit result() {
    MaterialFit fit;
    const double times_noise = misfit(fit);
    measure_scatter(fit, errors_.variance * times_noise * times_noise);
    const double widening = times_noise * (fit.scatter ? fit.scatter->widening : 1);
    const auto widened = [widening](std::optional<double> distance) {
      if (distance) *distance *= widening;
      return distance;
    };
    const NamedValue stiffness = scenes_.front().stiffness();
    fit.youngs_modulus =
        identified(fit_->values()[0], stiffness.value, widened(end(-1)), widened(end(1)));
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
      const std::optional<double> half = half_width({1}, covariance_(1, 1), widening);
      fit.density = identified(fit_->values()[1], scenes_.front().heaviness().value, half, half);
    }
    if (options_.torsional_stiffness) {
      // Its number is the logarithm of GJ / EI.
      const Eigen::Index k = curvature_ - 1;
      const double GJ = scenes_.front().twisting_stiffness();
      const double EI = scenes_.front().mean_bending_stiffness();
      const double variance = covariance_(0, 0) + 2 * covariance_(0, k) + covariance_(k, k);
      const std::optional<double> half = half_width({0, k}, variance, widening);
      fit.torsional_stiffness = identified(fit_->values()[0] + fit_->values()[k], GJ, half, half);
      const std::optional<double> half_ratio = half_width({k}, covariance_(k, k), widening);
      fit.torsion_over_bending = identified(fit_->values()[k], GJ / EI, half_ratio, half_ratio);
    }
    for (Eigen::Index number = curvature_; number < fit_->values().size(); ++number) {
      FittedNumber found = numbers_[static_cast<std::size_t>(number)].described;
      found.value = fit_->values()[number];
      found.deviation = std::sqrt(covariance_(number, number));
      fit.others.push_back(std::move(found));
    }
    if (options_.natural_curvature_terms > 0) {
      const Scene found = scene_at_(0, fit_->values());
      fit.natural_curvature = {found.natural_strain.head<2>()};
      fit.natural_curvature.insert(fit.natural_curvature.end(), found.natural_variation.begin(),
                                   found.natural_variation.end());
    }
    if (options_.shared_clamps) fit.clamps = clamp_corrections();
    fit.camera_tilt = camera_tilt();
    fit.noise_m = std::sqrt(errors_.variance);
    fit.noise_is_estimated = !options_.noise;
    fit.degrees_of_freedom = static_cast<int>(fit_->freedom());
    fit.correlation_was_tested = errors_.tested;
    if (errors_.are_correlated()) {
      fit.correlation = CorrelatedErrors{.length_m = errors_.correlation.length,
                                         .share = errors_.correlation.share,
                                         .widening = correlated_widening(),
                                         .degrees_of_freedom = errors_.freedom};
    }
    rods_.go_on_from(optimum_);
    const std::vector<Alignment> alignments = rods_.alignments(fit_->values());
    double squares = 0;
    for (std::size_t i = 0; i < alignments.size(); ++i) {
      squares += alignments[i].mean_square * static_cast<double>(alignments[i].shape.points.cols());
      fit.shapes.push_back({scenes_[i].name, alignments[i], {}});
    }
    if (options_.profile_points > 0) draw_profile(fit, widening);
    fit.rms_m = std::sqrt(squares / static_cast<double>(measured_.points()));
    note_ways_out_of_plane(fit);
    note_contradicted_tolerances(fit);
    return fit;
  }

  const std::vector<Scene>& scenes_;
  const std::vector<MeasuredShape>& shapes_;
  const MaterialFitOptions& options_;
  bool density_;
  Eigen::Index curvature_;  // the first number that has its own value: of natural curvature, if any
  std::vector<WireNumber> numbers_;
  MeasuredShapes& measured_;
  FittedRods::SceneAt scene_at_;
  FittedRods rods_;
  std::optional<GaussNewton> fit_;
  WireErrors errors_;
  double marginal_slope_ = 0;   // see GaussNewton::marginal_slope()
  Eigen::MatrixXd covariance_;  // of the numbers, under these errors
  FittedRods::Rods optimum_;
  std::vector<bool> unseen_;  // of the numbers, see unseen()
};

}  // namespace

bool fits_a_wire(const MaterialFitOptions& options) {
  return options.torsional_stiffness || options.natural_curvature_terms > 0 ||
         options.direction_tolerance > 0 || options.position_tolerance > 0 ||
         options.roll_tolerance > 0 || options.camera_tilt > 0;
}

MaterialFit fit_wire(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                     MeasuredShapes& measured, const MaterialFitOptions& options,
                     const MaterialPoint& start, bool density) {
  return WireFitter(scenes, shapes, measured, options, density).run(start);
}

}  // namespace dlo::compare
