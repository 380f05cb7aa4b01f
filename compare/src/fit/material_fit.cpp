#include "dlo/compare/material_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dlo/compare/error.hpp"
#include "fit/fit_from.hpp"
#include "wire/identifiable.hpp"
#include "wire/leave_one_out.hpp"

namespace dlo::compare {
namespace {

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
        "calibrate: the same clamps in all shapes, but no standard deviation of their directions "
        "or positions (allowed: with one, such as --clamp-angles \"5 deg\")");
  }
  if (options.direction_scatter > 0 && !options.shared_clamps) {
    throw InputError(
        "calibrate: a scatter of clamp directions about shared directions, but the clamps are not "
        "shared (allowed: with the same clamps in all shapes, --same-clamps)");
  }
  if ((options.predict || options.choose_options.value_or(false)) &&
      shapes.size() < least_shapes_for_prediction) {
    throw InputError(fmt::format(
        "calibrate: {} shapes are too few to predict each by the others (allowed: {} or more)",
        shapes.size(), least_shapes_for_prediction));
  }
  if (options.noise && !(*options.noise > 0)) {
    throw InputError(fmt::format("calibrate: noise = {:g} m (allowed: > 0)", *options.noise));
  }
}

/// Removes each shape that has the points of an earlier one: it is the same measurement, whose
/// errors are not independent.
/// @param[in,out] scenes  one per shape
/// @return a sentence that names the removed shapes; empty if there are none
std::string remove_repeats(std::vector<Scene>& scenes, std::vector<MeasuredShape>& shapes) {
  std::string removed;
  for (std::size_t i = 0; i < shapes.size();) {
    const auto end = shapes.begin() + static_cast<std::ptrdiff_t>(i);
    const bool repeats = std::any_of(shapes.begin(), end, [&](const MeasuredShape& one) {
      return one.points.cols() == end->points.cols() && one.points == end->points;
    });
    if (!repeats) {
      ++i;
      continue;
    }
    removed += (removed.empty() ? "" : ", ") + end->file;
    shapes = without_one(std::move(shapes), i);
    scenes = without_one(std::move(scenes), i);
  }
  if (removed.empty()) return "";
  return fmt::format("shapes with the same points are fitted once: {} omitted", removed);
}

/// Returns MaterialFit::assumed.
std::vector<std::string> assumptions_of(const Calibration& found,
                                        const MaterialFitOptions& options) {
  const MaterialFit& fit = found.fit;
  if (!fit.youngs_modulus.low && !fit.youngs_modulus.high) return {};
  const auto any = [&](auto is) { return std::ranges::any_of(found.scenes, is); };
  const bool weight = any([](const Scene& one) { return one.weight_per_length().norm() > 0; });
  const bool tilt_is_fitted =
      fit.tried.empty() ? options.camera_tilt > 0 : fit.tried.front().camera_tilt > 0;
  std::vector<std::string> result = {"length"};
  if (weight && !fit.density) result.emplace_back("weight");
  if (any(has_forces_beside_weight)) result.emplace_back("loads");
  result.emplace_back("scale");
  if (weight && !tilt_is_fitted && options.pose != PoseFreedom::rigid) {
    result.emplace_back("vertical");
  }
  result.insert(result.end(), fit.assumed.begin(), fit.assumed.end());
  return result;
}

}  // namespace

MaterialFit fit_material(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                         const MaterialFitOptions& options) {
  require_pairs(scenes, shapes, options);
  if (options.choose_options.value_or(false))
    return fit_with_chosen_options(scenes, shapes, options);
  return fit_material_from(scenes, shapes, options, std::nullopt);
}

Calibration calibrate(std::vector<Scene> scenes, std::vector<MeasuredShape> shapes,
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
  const std::string repeats =
      scenes.size() == shapes.size() ? remove_repeats(scenes, shapes) : std::string();
  Calibration result{.scenes = std::move(scenes)};
  for (const MeasuredShape& shape : shapes) result.files.push_back(shape.file);
  options.alternatives = true;
  if (!options.choose_options) {
    const bool nothing_given =
        options.natural_curvature_terms == 0 && options.direction_tolerance == 0 &&
        options.position_tolerance == 0 && options.roll_tolerance == 0 && !options.shared_clamps;
    options.choose_options = nothing_given && shapes.size() >= least_shapes_for_prediction;
  }
  result.fit = fit_material(result.scenes, shapes, options);
  result.fit.assumed = assumptions_of(result, options);
  if (!repeats.empty()) {
    result.fit.warning += (result.fit.warning.empty() ? "" : "; ") + repeats;
  }
  // A rod that was confined to the plane of its shapes is predicted in that plane.
  if (!result.fit.tried.empty()) {
    options.natural_curvature_terms = result.fit.tried.front().natural_curvature_terms;
  }
  for (std::size_t i = 0; i < held_out.size(); ++i) {
    const Scene scene = fitted_scene(judged[i], result.fit, result.scenes.front());
    result.held_out.push_back(
        {held_out[i].file, scene.name, distance_from_rod(scene, held_out[i], options)});
  }
  return result;
}

}  // namespace dlo::compare
