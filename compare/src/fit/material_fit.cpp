#include "dlo/compare/material_fit.hpp"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "fit/between_shapes.hpp"
#include "fit/chain_springs.hpp"
#include "fit/choose_options.hpp"
#include "fit/fitted_scene.hpp"
#include "fit/leave_one_out.hpp"
#include "fit/log_profile.hpp"
#include "fit/shape_misfit.hpp"
#include "fit/wire_fit.hpp"
#include "fit/wire_numbers.hpp"
#include "least_squares/error_correlation.hpp"

namespace dlo::compare {
namespace {

/// What the energy model's own error may be, so that a perfect shape gets no interval of rounding.
constexpr double least_noise = 1e-8;
/// Searches for another state between several grippers, at the optimum of the one followed.
constexpr int most_other_states = 2;
/// What shapes have in common beyond chance, of all that they could. Smooth residuals have some
/// three numbers each: two shapes of them are beyond the first in one case of five, beyond the
/// second in one of eleven, five shapes in one of a hundred and one of two thousand.
constexpr double maybe_common = 0.5;
constexpr double surely_common = 0.7;
/// Share of the residual that an alternative may leave to be told, and to put the fit in doubt.
constexpr double worth_naming = 0.7;
constexpr double too_much = 0.5;
constexpr double next_to_nothing = 0.02;
/// Step in the logarithm of a material for derivatives; shapes are right to 1e-10 l.
constexpr double derivative_step = 1e-3;
/// Shapes of which each is predicted from the others.
constexpr std::size_t fewest_predicted = 3;
/// Of a fitted rod that is to be drawn.
constexpr int drawn_samples = 201;

/// A number that was fitted, for messages.
struct Name {
  const char* name;
  const char* unit;
  double scene_value;  // in that unit
};

/// What a profile says of a number.
struct Finding {
  LogProfile::Interval interval;  // reaches to every one of `optima`
  std::vector<Minimum> optima;    // between which the shapes do not decide
  Minimum best;
};

Finding finding(LogProfile& profile, double level, double rival_level) {
  Finding result{profile.below(level), profile.minima_below(rival_level), profile.minimum()};
  if (result.optima.empty()) return result;
  LogProfile::Interval& interval = result.interval;
  if (interval.low) interval.low = std::min(*interval.low, result.optima.front().x);
  if (interval.high) interval.high = std::max(*interval.high, result.optima.back().x);
  return result;
}

FittedValue fitted(const Finding& found, double unit, double identified_within) {
  const LogProfile::Interval& interval = found.interval;
  FittedValue result;
  result.estimate = unit * std::exp(found.best.x);
  if (interval.low) result.low = unit * std::exp(*interval.low);
  if (interval.high) result.high = unit * std::exp(*interval.high);
  const bool closed = result.low && result.high;
  if (closed && *result.high <= identified_within * *result.low) {
    result.value = unit * std::exp(found.best.x);
  }
  return result;
}

std::string what_is_not_identified(const FittedValue& value, const Finding& found, const Name& name,
                                   double identified_within) {
  if (value.value) return {};
  if (value.low && value.high) {
    std::string where;
    if (found.optima.size() > 1) {
      where = ", best";
      for (std::size_t i = 0; i < found.optima.size(); ++i) {
        where += fmt::format("{} near {:.3g}", i == 0 ? "" : " and",
                             name.scene_value * std::exp(found.optima[i].x));
      }
    }
    return fmt::format(
        "{0} is not identifiable from these shapes: {1:.4g} to {2:.4g} {3} fit{4} (identified: "
        "within a factor of {5:g})",
        name.name, *value.low, *value.high, name.unit, where, identified_within);
  }
  if (value.low) {
    return fmt::format(
        "{0} is not identifiable from these shapes: {0} > {1:.4g} {2}, any larger one fits",
        name.name, *value.low, name.unit);
  }
  if (value.high) {
    return fmt::format(
        "{0} is not identifiable from these shapes: {0} < {1:.4g} {2}, any smaller one fits",
        name.name, *value.high, name.unit);
  }
  return fmt::format(
      "{0} is not identifiable from these shapes: any {0} that was tried fits them within their "
      "noise",
      name.name);
}

std::string warning_of(double least_squares, double points, double nu, double length,
                       const std::optional<double>& noise) {
  const double rms = std::sqrt(least_squares / points);
  if (noise && nu > 0 && least_squares > std::pow(*noise, 2) * gsl_cdf_chisq_Qinv(1e-3, nu)) {
    return fmt::format(
        "the rod does not fit these shapes: its residuals are {:.3g} times what the given noise "
        "explains, so the interval means nothing",
        std::sqrt(least_squares / nu) / *noise);
  }
  if (rms > 0.05 * length) {
    return fmt::format(
        "the rod does not fit these shapes: residuals of {:.3g} % of its length (another unit, "
        "frame or rod?)",
        rms / length * 100);
  }
  return {};
}

void require_pairs(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                   const MaterialFitOptions& options) {
  if (scenes.empty() || scenes.size() != shapes.size()) {
    throw InputError(
        fmt::format("calibrate: {} scenes and {} shapes (allowed: one shape per scene)",
                    scenes.size(), shapes.size()));
  }
  if (options.arc_lengths == ArcLengths::chord) {
    throw InputError(
        "calibrate: arc lengths by chord are not exact enough (allowed: auto, file, nearest)");
  }
  if (options.shared_clamps && !options.choose_options.value_or(false) &&
      !(options.direction_tolerance > 0 || options.position_tolerance > 0)) {
    throw InputError(
        "calibrate: the same clamps in all shapes, but nothing says how well they are known "
        "(allowed: with clamp angles or positions, as --clamp-angles \"5 deg\")");
  }
  if (options.direction_scatter > 0 && !options.shared_clamps) {
    throw InputError(
        "calibrate: directions that scatter about shared ones, but none are shared (allowed: with "
        "the same clamps in all shapes, --same-clamps)");
  }
  if ((options.predict || options.choose_options.value_or(false)) &&
      shapes.size() < fewest_predicted) {
    throw InputError(
        fmt::format("calibrate: prediction of {} shapes, each by the others (allowed: {} or more)",
                    shapes.size(), fewest_predicted));
  }
  if (options.noise && !(*options.noise > 0)) {
    throw InputError(fmt::format("calibrate: noise = {:g} m (allowed: > 0)", *options.noise));
  }
}

/// Each scene's once.
void add_chains(const std::vector<Scene>& scenes, const MaterialFitOptions& options,
                MaterialFit& fit) {
  for (auto scene = scenes.begin(); scene != scenes.end(); ++scene) {
    if (std::find(scenes.begin(), scene, *scene) != scene) continue;
    const Scene fitted = fitted_scene(*scene, fit, scenes.front());
    const std::vector<double>& lengths = options.chain_segment_lengths;
    for (ChainSprings& chain : lengths.empty()
                                   ? chain_springs(fitted, options.chain_segments, options.solve)
                                   : chain_springs(fitted, lengths, options.solve)) {
      fit.chains.push_back(std::move(chain));
    }
  }
}

/// The fit of one or two numbers to shapes.
class MaterialFitter {
 public:
  MaterialFitter(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                 const MaterialFitOptions& options)
      : scenes_(scenes),
        shapes_(shapes),
        options_(options),
        measured_(scenes, shapes, measured_options(options), std::chrono::steady_clock::now()),
        misfit_(scenes, measured_),
        forced_(std::any_of(scenes.begin(), scenes.end(), is_forced)),
        both_(options.density &&
              std::any_of(scenes.begin(), scenes.end(), has_forces_beside_weight)),
        // Where every E has the same shapes, differences between them are rounding.
        low_(forced_ ? std::log(options.smallest_ratio) : 0),
        high_(forced_ ? std::log(options.largest_ratio) : 0) {
    const int unknowns = both_ ? 2 : 1;
    result_.degrees_of_freedom = measured_.numbers() - unknowns;
    result_.noise_is_estimated = !options.noise;
    const int fewest = options.noise ? 0 : 1;
    if (result_.degrees_of_freedom < fewest) {
      throw InputError(fmt::format(
          "calibrate: {} numbers measured beside the frames, {} to be found (allowed: {} or more, "
          "so more points{})",
          measured_.numbers(), unknowns, unknowns + fewest,
          options.noise ? "" : ", or a given noise"));
    }
  }

  /// @param start  of steps to all numbers; none: where the material alone fits best
  [[nodiscard]] MaterialFit run(const std::optional<MaterialPoint>& start) {
    MaterialFit fit = start ? whole_wire(*start, misfit_(*start)) : all_numbers();
    fit.equilibria = measured_.solves();
    fit.evaluations = measured_.evaluations();
    return fit;
  }

 private:
  [[nodiscard]] MaterialFit all_numbers() {
    std::unique_ptr<LogProfile> over_modulus = modulus_profile();
    for (int i = 0; i < most_other_states && misfit_.search_at(best_with(*over_modulus)); ++i) {
      over_modulus = modulus_profile();
    }
    const MaterialPoint best = best_with(*over_modulus);
    const double least = over_modulus->minimum().value;
    if (!std::isfinite(least)) {
      throw ConvergenceError(fmt::format(
          "{}: the energy model has a shape at no modulus that was tried", scenes_.front().file));
    }
    if (fits_a_wire(options_)) return whole_wire(best, least);
    measure_noise(least, best);
    const NamedValue stiffness = scenes_.front().stiffness();
    const Finding found = finding(*over_modulus, level(least, 0), rival_level(least, 0));
    result_.youngs_modulus = fitted(found, stiffness.value, options_.identified_within);
    result_.not_identified = what_is_not_identified(
        result_.youngs_modulus, found, {stiffness.name, stiffness.unit, stiffness.value},
        options_.identified_within);
    if (both_) fit_density(least);
    if (!forced_) result_.not_identified = why_unforced(scenes_.front());
    if (options_.density && !both_ && result_.not_identified.empty()) {
      result_.not_identified = fmt::format(
          "the {0} is not identifiable from these shapes: nothing but gravity bends the rod, so "
          "only "
          "{0} / {1} shows; {1} is for the {0} of the scene (a known load would identify both)",
          scenes_.front().heaviness().name, stiffness.name);
    }
    refuse_unverified(std::max(level(least, 0), both_ ? level(least, 1) : 0));
    const auto points = static_cast<double>(measured_.points());
    result_.rms_m = std::sqrt(least / points);
    result_.warning = warning_of(least, points, freedom(), scenes_.front().length, options_.noise);
    const FittedRods::Rods rods = misfit_.rods(best);
    for (std::size_t i = 0; i < rods.size() && rods[i]; ++i) {
      result_.shapes.push_back({scenes_[i].name, measured_.alignment(i, *rods[i]), {}});
    }
    if (options_.alternatives) look_for_alternatives(best);
    if (options_.profile_points > 0) draw_profile(found, best, least);
    return std::move(result_);
  }

  [[nodiscard]] MaterialFit whole_wire(const MaterialPoint& best, double least) {
    MaterialFit fit = fit_wire(scenes_, shapes_, measured_, options_, best, both_);
    refuse_unverified(least);
    if (fit.warning.empty()) {
      const auto points = static_cast<double>(measured_.points());
      fit.warning = warning_of(fit.rms_m * fit.rms_m * points, points, freedom(),
                               scenes_.front().length, std::nullopt);
    }
    return fit;
  }

  /// The rods at equal arc lengths, up to the first that there is not.
  [[nodiscard]] std::vector<Shape> sampled(const MaterialPoint& material, int samples) {
    std::vector<Shape> result;
    const FittedRods::Rods rods = misfit_.rods(material);
    for (std::size_t i = 0; i < rods.size() && rods[i]; ++i) {
      const std::vector<double> s = equal_arc_lengths(scenes_[i].length, samples);
      result.push_back({.arc_length = s, .points = rods[i]->sample(s).points});
    }
    return result;
  }

  /// Residuals with their derivatives by the frames, by log E and, if both are fitted, by the
  /// logarithm of the density; none if a shape is missing beside this material.
  [[nodiscard]] std::vector<ResidualSeries> residuals(const MaterialPoint& material) {
    FittedRods rods(
        measured_,
        [this](std::size_t shape, const Eigen::VectorXd& values) {
          Scene scene = scenes_[shape];
          scene.scale_modulus(std::exp(values[0]));
          if (both_) scene.scale_density(std::exp(values[1]));
          return scene;
        },
        std::vector<Unknown>(both_ ? 2 : 1, Unknown{.stride = derivative_step}));
    rods.go_on_from(misfit_.rods(material));
    const Eigen::Vector2d values(material.log_modulus, material.log_density);
    return rods.residuals(values.head(both_ ? 2 : 1), FittedRods::Columns::all)
        .value_or(std::vector<ResidualSeries>());
  }

  /// What of the residuals all shapes have in common; nothing without a plane.
  [[nodiscard]] std::optional<double> common_to_shapes(const MaterialPoint& best) {
    constexpr int samples = 1001;
    const std::vector<Shape> rods = sampled(best, samples);
    if (rods.size() != result_.shapes.size()) return std::nullopt;
    std::vector<AcrossRod> across;
    std::optional<Eigen::Vector3d> first;
    for (std::size_t i = 0; i < rods.size(); ++i) {
      std::optional<Eigen::Vector3d> normal = scenes_[i].plane_normal();
      if (!normal) return std::nullopt;
      if (!first) first = normal;
      if (normal->dot(*first) < 0) *normal *= -1;
      across.push_back(across_rod(result_.shapes[i].alignment.shape, rods[i], *normal));
    }
    return common_share(across);
  }

  /// Residuals that no noise leaves: what would remove them?
  void look_for_alternatives(const MaterialPoint& best) {
    if (!(result_.rms_m > least_noise * scenes_.front().length)) return;
    result_.common_share = common_to_shapes(best);
    const double common =
        result_.common_share ? beyond_chance(*result_.common_share, scenes_.size()) : 0;
    const bool explained = options_.noise && result_.warning.empty();
    if (explained || !(common > maybe_common || result_.correlation)) return;
    constexpr double tolerance = 5 * std::numbers::pi / 180;
    for (const auto& [terms, directions] :
         {std::pair{1, 0.0}, {2, 0.0}, {0, tolerance}, {2, tolerance}}) {
      MaterialFitOptions options = options_;
      options.natural_curvature_terms = terms;
      options.direction_tolerance = directions;
      options.profile_points = 0;
      try {
        const MaterialFit fit = fit_wire(scenes_, shapes_, measured_, options, best, both_);
        if (!(fit.rms_m <= worth_naming * result_.rms_m)) continue;
        add_alternative({terms, directions, fit.rms_m, fit.youngs_modulus});
      } catch (const InputError&) {
        // No clamp, no plane, or too few points.
      } catch (const ConvergenceError&) {
        // No shape, or no time.
      }
    }
    std::stable_sort(
        result_.alternatives.begin(), result_.alternatives.end(),
        [](const FitAlternative& a, const FitAlternative& b) { return a.rms_m < b.rms_m; });
    explain_systematic(common > surely_common);
  }

  /// Those with fewer numbers come first; one that has theirs and more has to leave less.
  void add_alternative(const FitAlternative& found) {
    for (const FitAlternative& one : result_.alternatives) {
      const bool has_more = found.natural_curvature_terms >= one.natural_curvature_terms &&
                            found.direction_tolerance >= one.direction_tolerance;
      if (has_more && found.rms_m > one.rms_m - next_to_nothing * result_.rms_m) return;
    }
    result_.alternatives.push_back(found);
  }

  void explain_systematic(bool common) {
    // Without forces E has no interval that could be wrong.
    if (!forced_) return;
    const NamedValue stiffness = scenes_.front().stiffness();
    if (result_.warning.empty() && !result_.alternatives.empty() &&
        result_.alternatives.front().rms_m <= too_much * result_.rms_m) {
      result_.warning = fmt::format(
          "the residuals are systematic: what is not fitted would leave {:.3g} mm of {:.3g} mm, so "
          "the interval of {} holds only if the rod is intrinsically straight and held as said",
          result_.alternatives.front().rms_m * 1e3, result_.rms_m * 1e3, stiffness.name);
    } else if (result_.warning.empty() && common) {
      result_.warning = fmt::format(
          "the residuals are systematic: {:.2g} % of their mean square is common to all shapes, "
          "and "
          "the interval of {} knows nothing of what they have in common",
          *result_.common_share * 100, stiffness.name);
    }
    const bool weight_alone =
        std::none_of(scenes_.begin(), scenes_.end(), has_forces_beside_weight);
    // Where the density was asked for it is said already.
    if (!weight_alone || options_.density) return;
    const char* const heaviness = scenes_.front().heaviness().name;
    const bool first = result_.not_identified.empty();
    result_.not_identified += fmt::format(
        "{}the {}{}: nothing but gravity bends the rod, so a wrong {} leaves no residual and makes "
        "{} wrong by the same factor",
        first ? "" : "; nor is ", heaviness, first ? " is not identifiable from these shapes" : "",
        heaviness, stiffness.name);
  }

  void draw_profile(const Finding& found, const MaterialPoint& best, double least) {
    const double limit = level(least, 0) - least;
    const double unit = scenes_.front().stiffness().value;
    for (const double x : drawn_logarithms(found.interval.low, best.log_modulus,
                                           found.interval.high, options_.profile_points)) {
      const double squares = both_ ? over_density(x).value : misfit_({x, 0});
      result_.profile.push_back({unit * std::exp(x), (squares - least) / limit});
    }
    const std::vector<Shape> rods = sampled(best, drawn_samples);
    for (std::size_t i = 0; i < rods.size(); ++i) result_.shapes[i].rod = rods[i];
  }

  [[nodiscard]] double freedom() const { return result_.degrees_of_freedom; }

  // With both unknown each is profiled with the other at its own best.
  [[nodiscard]] Minimum over_density(double log_modulus) {
    const LogProfile inner(
        [&](double y) {
          return misfit_({log_modulus, y});
        },
        low_ / 2, high_ / 2);
    return inner.minimum();
  }

  [[nodiscard]] std::unique_ptr<LogProfile> modulus_profile() {
    return std::make_unique<LogProfile>(
        [this](double x) {
          return both_ ? over_density(x).value : misfit_({x, 0});
        },
        low_, high_);
  }

  [[nodiscard]] MaterialPoint best_with(const LogProfile& over_modulus) {
    const double x = over_modulus.minimum().x;
    return {x, both_ ? over_density(x).x : 0};
  }

  /// Variance of one coordinate [m^2] if errors were independent.
  [[nodiscard]] double variance(double least) const {
    const double floor = std::pow(least_noise * scenes_.front().length, 2);
    return options_.noise ? std::pow(*options_.noise, 2) : std::max(least / freedom(), floor);
  }

  /// The noise and its correlation, from the residuals of the best fit.
  void measure_noise(double least, const MaterialPoint& best) {
    result_.noise_m = std::sqrt(variance(least));
    effects_.assign(both_ ? 2 : 1, {.degrees_of_freedom = freedom()});
    if (!(least / std::max(1.0, freedom()) > std::pow(least_noise * scenes_.front().length, 2))) {
      return;
    }
    const std::vector<ResidualSeries> series = residuals(best);
    if (series.empty()) return;
    const CorrelationEstimate estimate = correlation_of(series);
    result_.correlation_was_tested = estimate.tested;
    const Eigen::Index frames = series.front().design.cols() - (both_ ? 2 : 1);
    if (estimate.significant) allow_for(estimate.covariance, series, frames);
    measure_scatter(series, frames, estimate.significant ? estimate.covariance : ErrorCovariance());
  }

  /// Errors are correlated.
  void allow_for(const ErrorCovariance& covariance, const std::vector<ResidualSeries>& series,
                 Eigen::Index frames) {
    for (std::size_t k = 0; k < effects_.size(); ++k) {
      effects_[k] = correlation_effect(series, frames + static_cast<Eigen::Index>(k), covariance);
    }
    if (!options_.noise) result_.noise_m /= std::sqrt(effects_[0].residual_factor);
    result_.correlation =
        CorrelatedErrors{.length_m = covariance.length,
                         .share = covariance.share,
                         .widening = std::sqrt(excess(0)) * quantile(0) / independent_quantile(),
                         .degrees_of_freedom = effects_[0].degrees_of_freedom};
  }

  /// Whether the shapes agree on E.
  void measure_scatter(const std::vector<ResidualSeries>& series, Eigen::Index frames,
                       const ErrorCovariance& covariance) {
    std::vector<Nuisance> nuisances;
    for (Eigen::Index k = 0; k < frames; ++k) nuisances.push_back({k, 0, INFINITY});
    if (both_) nuisances.push_back({frames + 1, 0, INFINITY});
    std::vector<ShapeEstimate> estimates;
    for (std::size_t shape = 0; shape < scenes_.size(); ++shape) {
      estimates.push_back(estimate_of_shape(series_of_shape(series, shape), covariance,
                                            std::pow(result_.noise_m, 2), frames, nuisances));
    }
    result_.scatter = scatter_between(estimates, quantile(0));
  }

  /// Variance of a fitted number over that which independent errors would have, as they are taken
  /// to be from the sum of squares (or given).
  [[nodiscard]] double excess(std::size_t number) const {
    const CorrelationEffect& effect = effects_[number];
    const double between = result_.scatter ? std::pow(result_.scatter->widening, 2) : 1;
    return between *
           std::max(1.0, effect.variance_factor / (options_.noise ? 1 : effect.residual_factor));
  }

  [[nodiscard]] double independent_quantile() const {
    return options_.noise ? gsl_cdf_ugaussian_Pinv(0.975) : gsl_cdf_tdist_Pinv(0.975, freedom());
  }
  [[nodiscard]] double quantile(std::size_t number) const {
    return options_.noise ? independent_quantile()
                          : gsl_cdf_tdist_Pinv(0.975, effects_[number].degrees_of_freedom);
  }

  /// Of the sum of squares, at the ends of a number's interval [m^2].
  [[nodiscard]] double level(double least, std::size_t number) const {
    return least + std::pow(quantile(number), 2) * excess(number) * variance(least);
  }

  /// Up to which another local minimum is as good an explanation. Its frames are others as well, so
  /// it is outside the joint region of all fitted numbers only where its sum of squares is so much
  /// larger with a chance of 1e-3 (F distribution; a given noise: chi-squared).
  [[nodiscard]] double rival_level(double least, std::size_t number) const {
    const double nu = std::max(1.0, effects_[number].degrees_of_freedom);
    const double fitted = measured_.frame_numbers() + static_cast<double>(effects_.size());
    const double excess_of_all = options_.noise ? gsl_cdf_chisq_Qinv(1e-3, fitted)
                                                : fitted * gsl_cdf_fdist_Qinv(1e-3, fitted, nu);
    return std::max(level(least, number), least + variance(least) * excess(number) * excess_of_all);
  }

  void fit_density(double least) {
    LogProfile profile(
        [this](double y) {
          const LogProfile inner([&](double x) { return misfit_({x, y}); }, low_, high_);
          return inner.minimum().value;
        },
        low_ / 2, high_ / 2);
    const NamedValue heaviness = scenes_.front().heaviness();
    const Finding found = finding(profile, level(least, 1), rival_level(least, 1));
    result_.density = fitted(found, heaviness.value, options_.identified_within);
    if (result_.not_identified.empty()) {
      const std::string name = fmt::format("the {}", heaviness.name);
      result_.not_identified = what_is_not_identified(
          *result_.density, found, {name.c_str(), heaviness.unit, heaviness.value},
          options_.identified_within);
    }
  }

  void refuse_unverified(double highest_level) const {
    const ShapeMisfit::Unverified* unverified = misfit_.unverified_below(highest_level);
    if (unverified == nullptr) return;
    const Scene& scene = scenes_[unverified->scene];
    const NamedValue stiffness = scene.stiffness();
    throw ConvergenceError(fmt::format(
        "{}: at {} = {:.4g} {}, which may fit, the rod is not verified on its obstacles: it sinks "
        "in by {:.3g} m ({}), so {} is not identifiable from the shapes",
        scene.file, stiffness.name, stiffness.value * std::exp(unverified->material.log_modulus),
        stiffness.unit, unverified->penetration, unverified->message, stiffness.name));
  }

  const std::vector<Scene>& scenes_;
  const std::vector<MeasuredShape>& shapes_;
  const MaterialFitOptions& options_;
  MeasuredShapes measured_;
  ShapeMisfit misfit_;
  bool forced_;
  bool both_;
  double low_, high_;
  std::vector<CorrelationEffect> effects_;  // on E, then on the density
  MaterialFit result_;
};

/// With prediction and chains, if they are asked for.
MaterialFit fit_with_outputs(const std::vector<Scene>& scenes,
                             const std::vector<MeasuredShape>& shapes,
                             const MaterialFitOptions& options,
                             const std::optional<MaterialPoint>& start) {
  MaterialFit fit = MaterialFitter(scenes, shapes, options).run(start);
  if (options.predict && !fit.prediction) {
    fit.prediction = leave_one_out(scenes, shapes, options, fit);
  }
  const bool of_chains = options.chain_segments > 0 || !options.chain_segment_lengths.empty();
  if (of_chains && fit.youngs_modulus.value) add_chains(scenes, options, fit);
  return fit;
}

}  // namespace

MaterialPoint material_of(const MaterialFit& fit, const Scene& first) {
  MaterialPoint result;
  if (fit.youngs_modulus.estimate) {
    result.log_modulus = std::log(*fit.youngs_modulus.estimate / first.stiffness().value);
  }
  if (fit.density && fit.density->estimate) {
    result.log_density = std::log(*fit.density->estimate / first.heaviness().value);
  }
  return result;
}

MaterialFit fit_material(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                         const MaterialFitOptions& options) {
  require_pairs(scenes, shapes, options);
  if (options.choose_options.value_or(false))
    return fit_with_chosen_options(scenes, shapes, options);
  return fit_with_outputs(scenes, shapes, options, std::nullopt);
}

MaterialFit fit_material_from(const std::vector<Scene>& scenes,
                              const std::vector<MeasuredShape>& shapes,
                              const MaterialFitOptions& options, const MaterialPoint& start) {
  return fit_with_outputs(scenes, shapes, options, start);
}

Calibration calibrate(std::vector<Scene> scenes, const std::vector<MeasuredShape>& shapes,
                      MaterialFitOptions options, const std::vector<MeasuredShape>& held_out) {
  const std::size_t all = shapes.size() + held_out.size();
  if (scenes.size() == 1) scenes.resize(all, Scene(scenes.front()));
  if (!held_out.empty() && scenes.size() != all) {
    throw InputError(fmt::format(
        "calibrate: {} scenes, {} shapes and {} held out (allowed: one scene, or one per shape)",
        scenes.size(), shapes.size(), held_out.size()));
  }
  const auto fitted = static_cast<std::ptrdiff_t>(scenes.size() - held_out.size());
  const std::vector<Scene> judged(scenes.begin() + fitted, scenes.end());
  scenes.resize(static_cast<std::size_t>(fitted));
  Calibration result{.scenes = std::move(scenes),
                     .frame_was_found = options.pose != PoseFreedom::known};
  for (const MeasuredShape& shape : shapes) result.files.push_back(shape.file);
  options.alternatives = true;
  if (!options.choose_options) {
    const bool nothing_given =
        options.natural_curvature_terms == 0 && options.direction_tolerance == 0 &&
        options.position_tolerance == 0 && options.roll_tolerance == 0 && !options.shared_clamps;
    options.choose_options = nothing_given && shapes.size() >= fewest_predicted;
  }
  result.fit = fit_material(result.scenes, shapes, options);
  for (std::size_t i = 0; i < held_out.size(); ++i) {
    const Scene scene = fitted_scene(judged[i], result.fit, result.scenes.front());
    result.held_out.push_back(
        {held_out[i].file, scene.name, distance_from_rod(scene, held_out[i], options)});
  }
  return result;
}

}  // namespace dlo::compare
