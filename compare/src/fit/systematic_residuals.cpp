#include "fit/systematic_residuals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "dlo/compare/error.hpp"
#include "fit/choose_options.hpp"
#include "fit/material_errors.hpp"
#include "wire/between_shapes.hpp"
#include "wire/identifiable.hpp"
#include "wire/wire_fit.hpp"
#include "wire/wire_numbers.hpp"

namespace dlo::compare {
namespace {

/// Part of the mean square that shapes have in common beyond chance, above which residuals may be,
/// and certainly are, systematic. Smooth residuals have some three independent numbers each. Two
/// shapes with random residuals then exceed the first limit in one case of five and the second in
/// one of eleven, five shapes in one of a hundred and one of two thousand.
constexpr double maybe_common = 0.5;
constexpr double surely_common = 0.7;
/// Part of the residual that an alternative may leave to be reported, and to cast doubt on the fit;
/// part by which an alternative that includes another one must leave less.
constexpr double worth_naming = 0.7;
constexpr double too_much = 0.5;
constexpr double next_to_nothing = 0.02;

/// Returns the part of the residuals that all shapes have in common; std::nullopt without a plane.
std::optional<double> common_to_shapes(MaterialProfiles& material, const MaterialPoint& best,
                                       const std::vector<FittedShape>& shapes) {
  constexpr int samples = 1001;
  const std::vector<Shape> rods = sampled(material.rods(best), material.scenes(), samples);
  if (rods.size() != shapes.size()) return std::nullopt;
  std::vector<AcrossRod> across;
  std::optional<Eigen::Vector3d> first;
  for (std::size_t i = 0; i < rods.size(); ++i) {
    std::optional<Eigen::Vector3d> normal = material.scenes()[i].plane_normal();
    if (!normal) return std::nullopt;
    if (!first) first = normal;
    if (normal->dot(*first) < 0) *normal *= -1;
    across.push_back(across_rod(shapes[i].alignment.shape, rods[i], *normal));
  }
  return common_share(across);
}

/// Adds an alternative. Alternatives are added in the order of their number of fitted numbers; one
/// that includes an earlier one must leave less.
void add_alternative(const FitAlternative& found, MaterialFit& fit) {
  for (const FitAlternative& one : fit.alternatives) {
    const bool has_more = found.natural_curvature_terms >= one.natural_curvature_terms &&
                          found.direction_tolerance >= one.direction_tolerance;
    if (has_more && found.rms_m > one.rms_m - next_to_nothing * fit.rms_m) return;
  }
  fit.alternatives.push_back(found);
}

void try_alternatives(MaterialProfiles& material, const MaterialPoint& best, MaterialFit& fit) {
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
      if (!(other.rms_m <= worth_naming * fit.rms_m)) continue;
      add_alternative({terms, directions, other.rms_m, other.youngs_modulus}, fit);
    } catch (const ResultError&) {
      // There is no clamp or plane, the points are too few, a shape was not found, or time is up.
    }
  }
  std::stable_sort(
      fit.alternatives.begin(), fit.alternatives.end(),
      [](const FitAlternative& a, const FitAlternative& b) { return a.rms_m < b.rms_m; });
}

/// Widens the interval of E to that of an intrinsically curved wire in misaligned clamps, observed
/// by a camera that is not level. One or two shapes do not show whether this is the cause of their
/// residuals, and E differs if it is. The choice by predictions needs more shapes.
/// @return whether such a wire has a fit
bool widen_to_any_wire(MaterialProfiles& material, const MaterialPoint& best, MaterialFit& fit) {
  MaterialFitOptions options = material.options();
  options.profile_points = 0;
  options.natural_curvature_terms = usual_curvature_terms;
  options.direction_tolerance = fixture_tolerance;
  if (why_no_camera_tilt(material.scenes(), material.shapes()).empty()) {
    options.camera_tilt = usual_tilt;
  }
  try {
    const FittedValue other = fit_wire(material.scenes(), material.shapes(), material.measured(),
                                       options, best, material.has_density())
                                  .youngs_modulus;
    FittedValue& E = fit.youngs_modulus;
    E.low = E.low && other.low ? std::optional(std::min(*E.low, *other.low)) : std::nullopt;
    E.high = E.high && other.high ? std::optional(std::max(*E.high, *other.high)) : std::nullopt;
    if (E.low && E.high && *E.high <= options.identified_within * *E.low) return true;
    E.value.reset();
  } catch (const ResultError&) {
    // There is no clamp or plane, the points are too few, a shape was not found, or time is up.
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

/// Returns the warning that residuals are systematic.
/// @param common  shapes certainly have much of the residuals in common
/// @param widened  whether the interval is that of any wire
std::string doubt(const MaterialFit& fit, bool common, bool widened, const char* stiffness) {
  if (widened) {
    return fmt::format(
        "the residuals are systematic: the interval of {} includes that of an intrinsically curved "
        "wire in misaligned clamps",
        stiffness);
  }
  if (!fit.alternatives.empty() && fit.alternatives.front().rms_m <= too_much * fit.rms_m) {
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
void note_weight(const Scene& scene, MaterialFit& fit) {
  const char* const heaviness = scene.heaviness().name;
  const bool first = fit.not_identified.empty();
  fit.not_identified += fmt::format(
      "{}the {}{}: nothing but gravity bends the rod, so a wrong {} leaves no residual and makes "
      "{} wrong by the same factor",
      first ? "" : "; nor is ", heaviness, first ? " is not identifiable from these shapes" : "",
      heaviness, scene.stiffness().name);
}

}  // namespace

bool look_for_alternatives(MaterialProfiles& material, const MaterialPoint& best,
                           MaterialFit& fit) {
  const std::vector<Scene>& scenes = material.scenes();
  if (!(fit.rms_m > MaterialErrors::least_noise(scenes.front()))) return false;
  fit.common_share = common_to_shapes(material, best, fit.shapes);
  const double common = fit.common_share ? beyond_chance(*fit.common_share, scenes.size()) : 0;
  const bool explained = material.options().noise && fit.warning.empty();
  if (explained || !(common > maybe_common || fit.correlation)) return false;
  try_alternatives(material, best, fit);
  // Without forces E has no interval that could be wrong.
  if (!material.is_forced()) return false;
  const bool widened = scenes.size() < fewest_predicted && widen_to_any_wire(material, best, fit);
  if (fit.warning.empty()) {
    fit.warning = doubt(fit, common > surely_common, widened, scenes.front().stiffness().name);
  }
  const bool weight_alone = std::none_of(scenes.begin(), scenes.end(), has_forces_beside_weight);
  // If the density was requested, this was reported already.
  if (weight_alone && !material.options().density) note_weight(scenes.front(), fit);
  return widened;
}

}  // namespace dlo::compare
