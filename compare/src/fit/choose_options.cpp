#include "fit/choose_options.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

/// Terms that are tried where the options do not ask for more.
constexpr int usual_curvature_terms = 3;
/// How well clamps are known where the options do not say: a fixture's hardly, and where each shape
/// has its own they are like each other.
constexpr double fixture_tolerance = 20 * std::numbers::pi / 180;
constexpr double own_tolerance = 5 * std::numbers::pi / 180;
/// Fewer numbers are chosen where they predict worse by no more than this share.
constexpr double as_well = 0.02;
/// Options that predict worse by no more than this share may be right too.
constexpr double nearly_as_well = 0.1;
/// Terms in a row that predict no better, after which no more are tried.
constexpr int most_vain_terms = 2;

enum class Clamps { as_said, alike, own };

struct Trial {
  MaterialFitOptions options;
  MaterialFit fit;

  [[nodiscard]] double prediction() const { return fit.prediction->rms_m; }
  [[nodiscard]] std::size_t numbers() const { return fit.others.size(); }
};

class OptionsSearch {
 public:
  OptionsSearch(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                const MaterialFitOptions& options)
      : scenes_(scenes), shapes_(shapes), options_(options) {}

  [[nodiscard]] MaterialFit run() {
    for (const Clamps clamps : {Clamps::as_said, Clamps::alike, Clamps::own}) try_terms(clamps);
    if (trials_.empty()) {
      throw ConvergenceError("calibrate: no fit came to an end with any options that were tried");
    }
    const Trial& chosen = best();
    MaterialFit fit = with_profile_and_chains(chosen);
    widen(fit, chosen);
    for (const Trial& trial : trials_) {
      fit.tried.push_back({.natural_curvature_terms = trial.options.natural_curvature_terms,
                           .direction_tolerance = trial.options.direction_tolerance,
                           .rms_m = trial.fit.rms_m,
                           .youngs_modulus = trial.fit.youngs_modulus,
                           .position_tolerance = trial.options.position_tolerance,
                           .shared_clamps = trial.options.shared_clamps,
                           .prediction_m = trial.prediction()});
      if (&trial == &chosen) std::rotate(fit.tried.begin(), fit.tried.end() - 1, fit.tried.end());
    }
    return fit;
  }

 private:
  /// A profile and chains are those of the chosen fit alone.
  [[nodiscard]] MaterialFit with_profile_and_chains(const Trial& chosen) const {
    if (options_.chain_segments == 0 && options_.chain_segment_lengths.empty() &&
        options_.profile_points == 0) {
      return chosen.fit;
    }
    MaterialFitOptions last = chosen.options;
    last.predict = false;
    last.chain_segments = options_.chain_segments;
    last.chain_segment_lengths = options_.chain_segment_lengths;
    last.profile_points = options_.profile_points;
    MaterialFit fit = fit_material(scenes_, shapes_, last);
    fit.prediction = chosen.fit.prediction;
    return fit;
  }

  void try_terms(Clamps clamps) {
    const int terms = std::max(usual_curvature_terms, options_.natural_curvature_terms);
    double least = INFINITY;
    int vain = 0;
    for (int term = 0; term <= terms && vain < most_vain_terms; ++term) {
      const std::optional<double> prediction = predict(term, clamps);
      vain = prediction && *prediction < (1 - as_well) * least ? 0 : vain + 1;
      least = std::min(least, prediction.value_or(INFINITY));
    }
  }

  /// @return how well that predicts; none if it has no fit
  std::optional<double> predict(int terms, Clamps clamps) {
    MaterialFitOptions options = options_;
    options.choose_options = false;
    options.alternatives = false;
    options.chain_segments = options.profile_points = 0;
    options.chain_segment_lengths.clear();
    options.natural_curvature_terms = terms;
    options.shared_clamps = clamps == Clamps::alike;
    if (clamps == Clamps::as_said) {
      options.direction_tolerance = options.position_tolerance = 0;
    } else if (!(options.direction_tolerance > 0)) {
      options.direction_tolerance = options.shared_clamps ? fixture_tolerance : own_tolerance;
    }
    options.predict = true;
    try {
      trials_.push_back({options, fit_material(scenes_, shapes_, options)});
    } catch (const ConvergenceError&) {
      return std::nullopt;
    }
    return trials_.back().prediction();
  }

  /// The one of fewest numbers among those that predict as well as any.
  [[nodiscard]] const Trial& best() const {
    const auto better = [](const Trial& a, const Trial& b) {
      return a.prediction() < b.prediction();
    };
    const double least = std::min_element(trials_.begin(), trials_.end(), better)->prediction();
    const Trial* result = nullptr;
    for (const Trial& trial : trials_) {
      if (trial.prediction() > (1 + as_well) * least) continue;
      if (result == nullptr || trial.numbers() < result->numbers()) result = &trial;
    }
    return *result;
  }

  /// The interval under one model knows nothing of the others: what the estimates of those that
  /// predict nearly as well differ from the chosen one adds to its square, in the mean.
  void widen(MaterialFit& fit, const Trial& chosen) const {
    FittedValue& E = fit.youngs_modulus;
    if (!E.estimate || !E.low || !E.high) return;
    constexpr double deviations = 1.96;
    const double own = std::log(*E.high / *E.low) / 2;
    double squares = 0;
    int count = 0;
    for (const Trial& trial : trials_) {
      const FittedValue& other = trial.fit.youngs_modulus;
      if (trial.prediction() > (1 + nearly_as_well) * chosen.prediction()) continue;
      if (!other.estimate || !other.low || !other.high) continue;
      squares += std::pow(deviations * std::log(*other.estimate / *E.estimate), 2);
      ++count;
    }
    const double wide = count > 0 ? std::sqrt(own * own + squares / count) : 0;
    if (!(wide > own)) return;
    E.low = *E.low * std::exp(own - wide);
    E.high = *E.high * std::exp(wide - own);
    if (std::log(*E.high / *E.low) <= std::log(options_.identified_within)) return;
    E.value.reset();
    if (fit.not_identified.empty()) {
      fit.not_identified = "options that predict the shapes alike differ too much in it";
    }
  }

  const std::vector<Scene>& scenes_;
  const std::vector<MeasuredShape>& shapes_;
  const MaterialFitOptions& options_;
  std::vector<Trial> trials_;
};

}  // namespace

MaterialFit fit_with_chosen_options(const std::vector<Scene>& scenes,
                                    const std::vector<MeasuredShape>& shapes,
                                    const MaterialFitOptions& options) {
  return OptionsSearch(scenes, shapes, options).run();
}

}  // namespace dlo::compare
