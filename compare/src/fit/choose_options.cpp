#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>

#include "dlo/compare/error.hpp"
#include "fit/fit_from.hpp"
#include "least_squares/fitted_rods.hpp"
#include "least_squares/measured_shapes.hpp"
#include "wire/identifiable.hpp"
#include "wire/wire_fit.hpp"
#include "wire/wire_numbers.hpp"

namespace dlo::compare {
namespace {

/// Default tolerance of clamp directions that belong to one shape alone, and default scatter
/// between shapes [rad].
constexpr double shape_clamp_tolerance = 5 * std::numbers::pi / 180;
/// Relative difference of predictions up to which they count as equal, and fewer numbers are
/// chosen.
constexpr double equal_prediction_tolerance = 0.01;
/// Accuracy of predictions, divided by the length: shapes are not measured better, so smaller
/// predictions count as equal.
constexpr double prediction_accuracy = 1e-5;
/// Relative difference of predictions up to which options may also be correct.
constexpr double acceptable_prediction_excess = 0.1;
/// Number of successive terms that do not improve the prediction, after which no more are tried;
/// with shared clamps all are tried.
constexpr int most_unsuccessful_terms = 2;

enum class Clamps { nominal, shared, own };

struct Trial {
  MaterialFitOptions options;
  MaterialFit fit;

  [[nodiscard]] double prediction() const { return fit.prediction->rms_m; }
  [[nodiscard]] std::size_t numbers() const { return fit.others.size(); }
  [[nodiscard]] int terms() const { return options.natural_curvature_terms; }
};

/// Whether the residuals may contain more than noise.
bool is_systematic(const MaterialFit& fit) {
  return !fit.correlation_was_tested || fit.correlation || fit.scatter || !fit.warning.empty() ||
         !fit.alternatives.empty();
}

class OptionsSearch {
 public:
  OptionsSearch(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                const MaterialFitOptions& options)
      : scenes_(scenes), shapes_(shapes), options_(options) {}

  [[nodiscard]] MaterialFit run() {
    MaterialFitOptions nominal = with_all_outputs(options_of(0, Clamps::nominal));
    nominal.predict = false;
    plain_ = fit_material_from(scenes_, shapes_, nominal, std::nullopt);
    if (!is_systematic(plain_)) plain_ = with_alternatives();
    start_ = material_point_of(plain_, scenes_.front());
    if (!is_systematic(plain_)) {
      if (options_.predict) plain_.prediction = plain_prediction();
      plain_.tried.push_back(described(nominal, plain_));
      return plain_;
    }
    for (const Clamps clamps : {Clamps::nominal, Clamps::shared, Clamps::own}) try_terms(clamps);
    if (trials_.empty()) {
      throw ConvergenceError("calibrate: no fit was completed with any of the options tried");
    }
    const Trial& chosen = best();
    MaterialFit fit = with_all_outputs(chosen);
    // Other assumptions were tried: they predict the shapes less well, or the interval includes
    // them.
    fit.assumed.clear();
    widen(fit, chosen);
    for (const Trial& trial : trials_) {
      fit.tried.push_back(described(trial.options, trial.fit));
      if (&trial == &chosen) std::rotate(fit.tried.begin(), fit.tried.end() - 1, fit.tried.end());
    }
    return fit;
  }

 private:
  [[nodiscard]] static FitAlternative described(const MaterialFitOptions& options,
                                                const MaterialFit& fit) {
    FitAlternative result{.natural_curvature_terms = options.natural_curvature_terms,
                          .direction_tolerance = options.direction_tolerance,
                          .rms_m = fit.rms_m,
                          .youngs_modulus = fit.youngs_modulus,
                          .position_tolerance = options.position_tolerance,
                          .shared_clamps = options.shared_clamps,
                          .direction_scatter = options.direction_scatter,
                          .camera_tilt = options.camera_tilt};
    if (fit.prediction) result.prediction_m = fit.prediction->rms_m;
    return result;
  }

  [[nodiscard]] MaterialFitOptions with_all_outputs(MaterialFitOptions options) const {
    options.predict = options_.predict;
    options.chain_segments = options_.chain_segments;
    options.chain_segment_lengths = options_.chain_segment_lengths;
    options.profile_points = options_.profile_points;
    return options;
  }

  /// Returns the fit with the chosen options and all requested outputs, such as a profile and
  /// chains. Without further numbers it is the fit that searched all E.
  [[nodiscard]] MaterialFit with_all_outputs(const Trial& chosen) const {
    MaterialFitOptions last = with_all_outputs(chosen.options);
    last.predict = false;
    MaterialFit fit =
        fits_a_wire(last) ? fit_material_from(scenes_, shapes_, last, start_) : with_alternatives();
    fit.prediction = chosen.fit.prediction;
    return fit;
  }

  /// Returns the fit of the material alone, with alternatives that would remove its residuals. The
  /// alternatives may take as long as all trials, so they are computed only if they decide between
  /// fits or belong to the result.
  [[nodiscard]] MaterialFit with_alternatives() const {
    if (!options_.alternatives) return plain_;
    MaterialFitOptions nominal = with_all_outputs(options_of(0, Clamps::nominal));
    nominal.alternatives = true;
    nominal.predict = false;
    return fit_material_from(scenes_, shapes_, nominal, std::nullopt);
  }

  void try_terms(Clamps clamps) {
    const int terms = std::max(default_curvature_terms, options_.natural_curvature_terms);
    double least = INFINITY;
    int useless = 0;
    const int most_useless = clamps == Clamps::shared ? terms : most_unsuccessful_terms;
    for (int term = 0; term <= terms && useless < most_useless; ++term) {
      const std::optional<double> prediction = predict(term, clamps);
      useless =
          prediction && *prediction < (1 - equal_prediction_tolerance) * least ? 0 : useless + 1;
      least = std::min(least, prediction.value_or(INFINITY));
    }
  }

  /// Adds the trial with these options. @return its prediction; std::nullopt if it has no fit
  std::optional<double> predict(int terms, Clamps clamps) {
    MaterialFitOptions options = options_of(terms, clamps);
    options.predict = true;
    try {
      if (fits_a_wire(options)) {
        trials_.push_back({options, fit_material_from(scenes_, shapes_, options, start_)});
      } else {
        MaterialFit plain = plain_;
        plain.prediction = plain_prediction();
        trials_.push_back({options, std::move(plain)});
      }
    } catch (const TimeLimitError&) {
      throw;
    } catch (const ResultError&) {
      // There is no clamp or plane, the grippers differ, the points are too few, or a shape was not
      // found.
      return std::nullopt;
    }
    return trials_.back().prediction();
  }

  /// Returns the prediction by the fit of the material alone.
  [[nodiscard]] std::optional<Prediction> plain_prediction() const {
    MaterialFitOptions options = options_of(0, Clamps::nominal);
    options.predict = true;
    return fit_material_from(scenes_, shapes_, options, start_).prediction;
  }

  [[nodiscard]] MaterialFitOptions options_of(int terms, Clamps clamps) const {
    MaterialFitOptions options = options_;
    options.choose_options = options.alternatives = options.predict = false;
    options.chain_segments = options.profile_points = 0;
    options.chain_segment_lengths.clear();
    options.natural_curvature_terms = terms;
    options.shared_clamps = clamps == Clamps::shared;
    if (!options.shared_clamps) {
      options.direction_scatter = 0;
    } else if (!(options.direction_scatter > 0)) {
      options.direction_scatter = shape_clamp_tolerance;
    }
    // Without the tilt of the camera, errors of a fixture's clamps cannot be separated from the
    // wire's natural curvature.
    if (options.shared_clamps && !(options.camera_tilt > 0) &&
        why_no_camera_tilt(scenes_, shapes_).empty()) {
      options.camera_tilt = default_tilt_tolerance;
    }
    if (clamps == Clamps::nominal) {
      options.direction_tolerance = options.position_tolerance = 0;
    } else if (!(options.direction_tolerance > 0)) {
      options.direction_tolerance =
          options.shared_clamps ? fixture_tolerance : shape_clamp_tolerance;
    }
    return options;
  }

  /// Returns the largest prediction that counts as equal to `prediction`.
  [[nodiscard]] double largest_equal_prediction(double prediction) const {
    return std::max((1 + equal_prediction_tolerance) * prediction,
                    prediction_accuracy * scenes_.front().length);
  }

  /// Returns the trial with the fewest numbers among those with the best prediction.
  [[nodiscard]] const Trial& best() const {
    const auto better = [](const Trial& a, const Trial& b) {
      return a.prediction() < b.prediction();
    };
    const double least = std::min_element(trials_.begin(), trials_.end(), better)->prediction();
    const Trial* result = nullptr;
    for (const Trial& trial : trials_) {
      if (trial.prediction() > largest_equal_prediction(least)) continue;
      if (result == nullptr || trial.numbers() < result->numbers()) result = &trial;
    }
    return *result;
  }

  /// Widens the interval of E, which ignores all models but one. It is extended to the interval of
  /// the trial with the most terms of natural curvature among those that predict nearly as well:
  /// such shapes do not show whether the wire has fewer terms, and E differs if it has.
  void widen(MaterialFit& fit, const Trial& chosen) const {
    FittedValue& E = fit.youngs_modulus;
    if (!E.estimate || !E.low || !E.high) return;
    const Trial* most = &chosen;
    for (const Trial& trial : trials_) {
      const FittedValue& other = trial.fit.youngs_modulus;
      if (trial.prediction() > (1 + acceptable_prediction_excess) * chosen.prediction()) continue;
      if (!other.low || !other.high) continue;
      if (trial.terms() > most->terms()) most = &trial;
    }
    if (most == &chosen) return;
    if (include_interval(E, most->fit.youngs_modulus, options_.largest_interval_ratio)) return;
    if (fit.not_identified.empty()) {
      fit.not_identified =
          "options that predict the shapes nearly as well give values that differ too much";
    }
  }

  const std::vector<Scene>& scenes_;
  const std::vector<MeasuredShape>& shapes_;
  const MaterialFitOptions& options_;
  MaterialFit plain_;    // fit of the material alone
  MaterialPoint start_;  // material of that fit
  std::vector<Trial> trials_;
};

}  // namespace

MaterialFit fit_with_chosen_options(const std::vector<Scene>& scenes,
                                    const std::vector<MeasuredShape>& shapes,
                                    const MaterialFitOptions& options) {
  return OptionsSearch(scenes, shapes, options).run();
}

}  // namespace dlo::compare
