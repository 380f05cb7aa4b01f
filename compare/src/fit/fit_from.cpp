#include "fit/fit_from.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "base/gsl.hpp"
#include "dlo/compare/calibrated_rod.hpp"
#include "dlo/compare/error.hpp"
#include "fit/chain_springs.hpp"
#include "fit/material_profiles.hpp"
#include "least_squares/measured_shapes.hpp"
#include "wire/between_shapes.hpp"
#include "wire/identifiable.hpp"
#include "wire/leave_one_out.hpp"
#include "wire/wire_fit.hpp"
#include "wire/wire_numbers.hpp"
#include "wire/wire_optimum.hpp"

namespace dlo::compare {
namespace {

/// Part of the mean square that shapes have in common beyond chance, above which residuals may be,
/// and certainly are, systematic. Smooth residuals have some three independent numbers each. Two
/// shapes with random residuals then exceed the first limit in one case of five and the second in
/// one of eleven, five shapes in one of a hundred and one of two thousand.
constexpr double possibly_systematic_share = 0.5;
constexpr double certainly_systematic_share = 0.7;
/// Largest RMS residual of an alternative that is reported, divided by that of the fit.
constexpr double reported_residual_ratio = 0.7;
/// Largest RMS residual of the best alternative that casts doubt on the fit, divided by that of the
/// fit.
constexpr double doubtful_residual_ratio = 0.5;
/// Smallest reduction of the RMS residual by which an alternative with more parameters must improve
/// on one that it includes, divided by the residual of the fit.
constexpr double least_residual_reduction = 0.02;

/// Returns the part of the residuals that all shapes have in common; std::nullopt without a plane
/// or a rod, and in the cases of common_share().
std::optional<double> common_residual_share(MaterialProfiles& material, const MaterialPoint& best,
                                            const std::vector<FittedShape>& shapes) {
  constexpr int samples = 1001;
  const std::vector<Shape> rods = sampled(material.rods(best), material.scenes(), samples);
  if (rods.size() != shapes.size()) return std::nullopt;
  std::vector<CrossDistances> across;
  std::optional<Eigen::Vector3d> first;
  for (std::size_t i = 0; i < rods.size(); ++i) {
    std::optional<Eigen::Vector3d> normal = material.scenes()[i].plane_normal();
    if (!normal) return std::nullopt;
    if (!first) first = normal;
    if (normal->dot(*first) < 0) *normal *= -1;
    across.push_back(cross_distances(shapes[i].alignment.shape, rods[i], *normal));
  }
  return common_share(across);
}

/// Adds an alternative. Alternatives are added in the order of their number of fitted numbers; one
/// that includes an earlier one must leave less.
void add_alternative(const FitAlternative& found, MaterialFit& fit) {
  for (const FitAlternative& one : fit.alternatives) {
    const bool has_more = found.natural_curvature_terms >= one.natural_curvature_terms &&
                          found.direction_tolerance >= one.direction_tolerance;
    if (has_more && found.rms_m > one.rms_m - least_residual_reduction * fit.rms_m) return;
  }
  fit.alternatives.push_back(found);
}

void fit_alternatives(MaterialProfiles& material, const MaterialPoint& best, MaterialFit& fit) {
  constexpr double tolerance = 5 * std::numbers::pi / 180;
  MaterialFitOptions options = material.options();
  options.profile_points = 0;
  for (const auto& [terms, directions] :
       {std::pair{1, 0.0}, {2, 0.0}, {0, tolerance}, {2, tolerance}}) {
    options.natural_curvature_terms = terms;
    options.direction_tolerance = directions;
    try {
      const MaterialFit other = fit_wire(material.scenes(), material.shapes(), material.measured(),
                                         options, best, material.has_density());
      if (!(other.rms_m <= reported_residual_ratio * fit.rms_m)) continue;
      add_alternative({terms, directions, other.rms_m, other.youngs_modulus}, fit);
    } catch (const TimeLimitError&) {
      throw;
    } catch (const ResultError&) {
      // There is no clamp or plane, the points are too few, or a shape was not found.
    }
  }
  std::stable_sort(
      fit.alternatives.begin(), fit.alternatives.end(),
      [](const FitAlternative& a, const FitAlternative& b) { return a.rms_m < b.rms_m; });
}

/// Widens the interval of E to include that of an intrinsically curved wire in misaligned clamps,
/// observed by a camera that is not level if the shapes can share a tilt (why_no_camera_tilt()).
/// One or two shapes do not show whether this is the cause of their residuals, and E differs if it
/// is. If the interval is then too wide or open, E is not identified, and `not_identified` states
/// so unless it has a reason already. The choice by predictions needs more shapes.
/// @return whether such a wire has a fit
bool extend_interval_to_curved_wire(MaterialProfiles& material, const MaterialPoint& best,
                                    MaterialFit& fit) {
  MaterialFitOptions options = material.options();
  options.profile_points = 0;
  options.natural_curvature_terms = default_curvature_terms;
  options.direction_tolerance = fixture_tolerance;
  if (why_no_camera_tilt(material.scenes(), material.shapes()).empty()) {
    options.camera_tilt = default_tilt_tolerance;
  }
  try {
    const FittedValue other = fit_wire(material.scenes(), material.shapes(), material.measured(),
                                       options, best, material.has_density())
                                  .youngs_modulus;
    if (include_interval(fit.youngs_modulus, other, options.largest_interval_ratio)) return true;
  } catch (const TimeLimitError&) {
    throw;
  } catch (const ResultError&) {
    // There is no clamp or plane, the points are too few, or a shape was not found.
    return false;
  }
  if (fit.not_identified.empty()) {
    fit.not_identified = fmt::format(
        "{} is not identifiable from so few shapes: with natural curvature and misaligned clamps "
        "others fit as well (three shapes or more may identify it)",
        material.scenes().front().stiffness().name);
  }
  return true;
}

/// Returns the warning that residuals are systematic; empty if they cast no doubt on the interval.
/// @param common  shapes certainly have much of the residuals in common
/// @param widened  whether the interval is that of any wire
std::string systematic_residual_warning(const MaterialFit& fit, bool common, bool widened,
                                        const char* stiffness) {
  if (widened) {
    return fmt::format(
        "the residuals are systematic: the interval of {} includes that of an intrinsically curved "
        "wire in misaligned clamps",
        stiffness);
  }
  if (!fit.alternatives.empty() &&
      fit.alternatives.front().rms_m <= doubtful_residual_ratio * fit.rms_m) {
    return fmt::format(
        "the residuals are systematic: fitting natural curvature or clamps too would leave {:.3g} "
        "mm of {:.3g} mm, so the interval of {} holds only if the rod is intrinsically straight "
        "and clamped as given",
        fit.alternatives.front().rms_m * 1e3, fit.rms_m * 1e3, stiffness);
  }
  if (!common) return "";
  return fmt::format(
      "the residuals are systematic: {:.2g} % of their mean square is common to all shapes, and "
      "the interval of {} does not account for this common part",
      *fit.common_share * 100, stiffness);
}

/// Adds to `not_identified` that the weight is not identifiable: a wrong weight leaves no residual.
void note_unidentified_weight(const Scene& scene, MaterialFit& fit) {
  const char* const mass_parameter = scene.mass_parameter().name;
  const bool first = fit.not_identified.empty();
  fit.not_identified += fmt::format(
      "{}the {}{}: nothing but gravity bends the rod, so a wrong {} leaves no residual and makes "
      "{} wrong by the same factor",
      first ? "" : "; nor is ", mass_parameter,
      first ? " is not identifiable from these shapes" : "", mass_parameter,
      scene.stiffness().name);
}

/// Analyses residuals that noise does not explain: adds alternatives that would remove them, and a
/// warning if they cast doubt on the fit.
/// @param best         material of the fit
/// @param[in,out] fit  fit of the material alone, complete except for its alternatives
/// @return whether the interval of E includes that of any intrinsically curved wire in misaligned
/// clamps
bool analyse_residuals(MaterialProfiles& material, const MaterialPoint& best, MaterialFit& fit) {
  const std::vector<Scene>& scenes = material.scenes();
  if (!(fit.rms_m > least_noise(scenes.front()))) return false;
  fit.common_share = common_residual_share(material, best, fit.shapes);
  const double common =
      fit.common_share ? share_beyond_chance(*fit.common_share, scenes.size()) : 0;
  const bool explained = material.options().noise && fit.warning.empty();
  if (explained || !(common > possibly_systematic_share || fit.correlation)) return false;
  fit_alternatives(material, best, fit);
  // Without forces E has no interval that could be wrong.
  if (!material.has_external_force()) return false;
  const bool widened = scenes.size() < least_shapes_for_prediction &&
                       extend_interval_to_curved_wire(material, best, fit);
  if (fit.warning.empty()) {
    fit.warning = systematic_residual_warning(fit, common > certainly_systematic_share, widened,
                                              scenes.front().stiffness().name);
  }
  const bool weight_alone = std::none_of(scenes.begin(), scenes.end(), has_forces_beside_weight);
  // If the density was requested, this was reported already.
  if (weight_alone && !material.options().density) note_unidentified_weight(scenes.front(), fit);
  return widened;
}

/// Result of a profile for one number.
struct ProfileResult {
  LogProfile::Interval interval;  // includes all of `optima`
  std::vector<Minimum> optima;    // between which the shapes do not decide
  FittedValue value;
};

/// Evaluates a profile.
/// @param number  see MaterialErrors
/// @param unit  the scene's value of the number
ProfileResult evaluate_profile(LogProfile& profile, const MaterialErrors& errors,
                               std::size_t number, double unit, double largest_interval_ratio) {
  ProfileResult result{profile.below(errors.level(number)),
                       profile.minima_below(errors.rival_minimum_level(number)),
                       {}};
  LogProfile::Interval& interval = result.interval;
  if (!result.optima.empty()) {
    if (interval.low) interval.low = std::min(*interval.low, result.optima.front().x);
    if (interval.high) interval.high = std::max(*interval.high, result.optima.back().x);
  }
  result.value = fitted_value(profile.minimum().x, interval, unit, largest_interval_ratio);
  return result;
}

std::string not_identified_message(const ProfileResult& found, const NamedValue& of,
                                   const std::string& name, double largest_interval_ratio) {
  const FittedValue& value = found.value;
  if (value.value) return {};
  const std::string so = name + " is not identifiable from these shapes: ";
  if (value.low && value.high) {
    std::string where;
    for (std::size_t i = 0; i < found.optima.size() && found.optima.size() > 1; ++i) {
      where += fmt::format("{} near {:.3g}", i == 0 ? ", best" : " and",
                           of.value * std::exp(found.optima[i].x));
    }
    return so + fmt::format("{:.4g} to {:.4g} {} fit{} (identified: within a factor of {:g})",
                            *value.low, *value.high, of.unit, where, largest_interval_ratio);
  }
  if (value.low) {
    return so + fmt::format("{} > {:.4g} {}, any larger one fits", name, *value.low, of.unit);
  }
  if (value.high) {
    return so + fmt::format("{} < {:.4g} {}, any smaller one fits", name, *value.high, of.unit);
  }
  return so + fmt::format("any {} that was tried fits them within their noise", name);
}

void find_density(MaterialProfiles& material, const MaterialErrors& errors, MaterialFit& fit) {
  const double within = material.options().largest_interval_ratio;
  const NamedValue mass_parameter = material.scenes().front().mass_parameter();
  LogProfile profile = material.over_density();
  const ProfileResult found = evaluate_profile(profile, errors, 1, mass_parameter.value, within);
  fit.density = found.value;
  if (!fit.not_identified.empty()) return;
  fit.not_identified = not_identified_message(found, mass_parameter,
                                              fmt::format("the {}", mass_parameter.name), within);
}

std::string weight_only_message(const Scene& scene) {
  return fmt::format(
      "the {0} is not identifiable from these shapes: nothing but gravity bends the rod, so only "
      "{0} / {1} is; {1} is computed with the {0} of the scene (a known load would identify both)",
      scene.mass_parameter().name, scene.stiffness().name);
}

void draw_profile(MaterialProfiles& material, const LogProfile::Interval& interval,
                  const MaterialPoint& best, const MaterialErrors& errors, MaterialFit& fit) {
  const double least = material.least_squares(best.log_modulus);
  const double limit = errors.level(0) - least;
  const double unit = material.scenes().front().stiffness().value;
  for (const double x : drawn_logarithms(interval.low, best.log_modulus, interval.high,
                                         material.options().profile_points)) {
    fit.profile.push_back({unit * std::exp(x), (material.least_squares(x) - least) / limit});
  }
  draw_rods(material.rods(best), material.scenes(), fit);
}

/// Returns MaterialFit::warning if the residuals are too large; empty if they are not.
/// @param sum_of_squares  sum of their squares [m^2]
/// @param noise  given noise, unless the interval already accounts for larger residuals
std::string warning_of(const MaterialProfiles& material, double sum_of_squares,
                       const std::optional<double>& noise) {
  const double nu = material.freedom();
  if (noise && nu > 0 &&
      sum_of_squares > std::pow(*noise, 2) * gsl_distribution(gsl_cdf_chisq_Qinv, 1e-3, nu)) {
    return fmt::format(
        "the rod does not fit these shapes: its residuals are {:.3g} times what the given noise "
        "explains, so the interval is meaningless",
        std::sqrt(sum_of_squares / nu) / *noise);
  }
  const double rms = std::sqrt(sum_of_squares / material.points());
  const double length = material.scenes().front().length;
  if (rms > 0.05 * length) {
    return fmt::format(
        "the rod does not fit these shapes: residuals of {:.3g} % of its length (another unit, "
        "frame or rod?)",
        rms / length * 100);
  }
  return {};
}

/// Fits E and, if identifiable, the density, without other numbers.
/// @throws ConvergenceError if a rod within the interval is not verified on its obstacles
MaterialFit fit_material_alone(MaterialProfiles& material, const MaterialProfiles::Search& found) {
  const std::vector<Scene>& scenes = material.scenes();
  const MaterialFitOptions& options = material.options();
  const double least = found.over_modulus.minimum().value;
  const MaterialErrors errors(material, found.best, least);
  MaterialFit fit;
  errors.write_to(fit);
  const NamedValue stiffness = scenes.front().stiffness();
  LogProfile over_modulus = found.over_modulus;
  const ProfileResult modulus =
      evaluate_profile(over_modulus, errors, 0, stiffness.value, options.largest_interval_ratio);
  fit.youngs_modulus = modulus.value;
  fit.not_identified =
      not_identified_message(modulus, stiffness, stiffness.name, options.largest_interval_ratio);
  if (material.has_density()) find_density(material, errors, fit);
  if (!material.has_external_force())
    fit.not_identified = why_stiffness_not_identifiable(scenes.front());
  if (options.density && !material.has_density() && fit.not_identified.empty()) {
    fit.not_identified = weight_only_message(scenes.front());
  }
  material.refuse_unverified(
      std::max(errors.level(0), material.has_density() ? errors.level(1) : 0));
  fit.rms_m = std::sqrt(least / material.points());
  fit.warning = warning_of(material, least, options.noise);
  const FittedRods::Rods rods = material.rods(found.best);
  for (std::size_t i = 0; i < rods.size() && rods[i]; ++i) {
    fit.shapes.push_back({scenes[i].name, material.measured().alignment(i, *rods[i]), {}});
  }
  const bool holds_any_wire = options.alternatives && analyse_residuals(material, found.best, fit);
  // See MaterialFit::assumed.
  if (!holds_any_wire) fit.assumed = unfitted_assumptions(scenes, options);
  if (options.profile_points > 0) {
    draw_profile(material, modulus.interval, found.best, errors, fit);
  }
  return fit;
}

/// Adds the chains of each scene; equal scenes are used once.
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

/// Throws if a force acts on the scenes, E is not identified and solves ended at their evaluation
/// limit: without the limit it may be identifiable.
/// @throws ConvergenceError
void require_unlimited_solves(MaterialProfiles& material, const MaterialFit& fit) {
  const long limited = material.measured().limited_solves();
  if (limited == 0 || fit.youngs_modulus.value || !material.has_external_force()) return;
  const Scene& scene = material.scenes().front();
  throw ConvergenceError(fmt::format(
      "{}: {} of {} equilibria ended at the evaluation limit and {} is not identified from the "
      "others (--max-evaluations: more than {})",
      scene.file, limited, material.measured().solves(), scene.stiffness().name,
      material.options().solve.max_evaluations));
}

/// Fits all numbers of a wire. @param least  sum of squares at the start [m^2]
MaterialFit fit_whole_wire(MaterialProfiles& material, const MaterialPoint& start, double least) {
  MaterialFit fit = fit_wire(material.scenes(), material.shapes(), material.measured(),
                             material.options(), start, material.has_density());
  fit.assumed = unfitted_assumptions(material.scenes(), material.options());
  material.refuse_unverified(least);
  if (fit.warning.empty()) {
    fit.warning = warning_of(material, fit.rms_m * fit.rms_m * material.points(), std::nullopt);
  }
  return fit;
}

/// Predicts each shape by a new fit to all others, which searches all E, and returns the distances.
/// @param fit  fit to all shapes, which determines the arc lengths of their points
/// @throws in the cases of fit_material()
Prediction predict_each(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                        const MaterialFitOptions& options, const MaterialFit& fit) {
  MaterialFitOptions reduced_options = options;
  reduced_options.alternatives = reduced_options.predict = false;
  reduced_options.chain_segments = reduced_options.profile_points = 0;
  reduced_options.chain_segment_lengths.clear();
  return leave_one_out(scenes, shapes, options, fit, [&](std::size_t excluded) -> PredictedScene {
    const std::vector<Scene> other_scenes = without_one(scenes, excluded);
    const MaterialFit others = fit_material_from(other_scenes, without_one(shapes, excluded),
                                                 reduced_options, std::nullopt);
    return {fitted_scene(scenes[excluded], others, other_scenes.front()), std::nullopt};
  });
}

}  // namespace

Scene fitted_scene(Scene scene, const MaterialFit& fit, const Scene& first) {
  CalibratedRod rod{.by_stiffness = scene.given_bending_stiffness.has_value(),
                    .natural_curvature = fit.natural_curvature,
                    .clamps = fit.clamps,
                    .camera_tilt = fit.camera_tilt};
  if (fit.youngs_modulus.estimate) {
    rod.stiffness =
        scene.stiffness().value * *fit.youngs_modulus.estimate / first.stiffness().value;
  }
  if (fit.density && fit.density->estimate) {
    rod.mass_parameter =
        scene.mass_parameter().value * *fit.density->estimate / first.mass_parameter().value;
  }
  if (fit.torsional_stiffness) rod.torsional_stiffness = fit.torsional_stiffness->estimate;
  return calibrated_scene(std::move(scene), rod);
}

MaterialPoint material_point_of(const MaterialFit& fit, const Scene& first) {
  MaterialPoint result;
  if (fit.youngs_modulus.estimate) {
    result.log_modulus = std::log(*fit.youngs_modulus.estimate / first.stiffness().value);
  }
  if (fit.density && fit.density->estimate) {
    result.log_density = std::log(*fit.density->estimate / first.mass_parameter().value);
  }
  return result;
}

MaterialFit fit_material_from(const std::vector<Scene>& scenes,
                              const std::vector<MeasuredShape>& shapes,
                              const MaterialFitOptions& options,
                              const std::optional<MaterialPoint>& start) {
  MaterialProfiles material(scenes, shapes, options);
  MaterialFit fit;
  if (start) {
    fit = fit_whole_wire(material, *start, material.sum_of_squares(*start));
  } else {
    const MaterialProfiles::Search found = material.search();
    fit = fits_a_wire(options)
              ? fit_whole_wire(material, found.best, found.over_modulus.minimum().value)
              : fit_material_alone(material, found);
  }
  require_unlimited_solves(material, fit);
  fit.equilibria = material.measured().solves();
  fit.evaluations = material.measured().evaluations();
  if (options.predict && !fit.prediction) {
    fit.prediction = predict_each(scenes, shapes, options, fit);
  }
  const bool of_chains = options.chain_segments > 0 || !options.chain_segment_lengths.empty();
  if (of_chains && fit.youngs_modulus.value) add_chains(scenes, options, fit);
  return fit;
}

}  // namespace dlo::compare
