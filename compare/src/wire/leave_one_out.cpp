#include "wire/leave_one_out.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/timer.hpp"
#include "least_squares/measured_shapes.hpp"
#include "shape/curve.hpp"
#include "wire/between_shapes.hpp"
#include "wire/wire_numbers.hpp"

namespace dlo::compare {
namespace {

/// Largest difference between grippers that hold a rod in the same way: of positions divided by the
/// length, and of directions.
constexpr double same_experiment_tolerance = 0.02;

/// Replaces the arc lengths of an aligned shape that covers the whole rod by lengths along its own
/// points, because nearest points on the rod depend on the other fitted numbers.
Shape with_arc_lengths_along_points(Shape shape, double length) {
  const std::vector<double> s = arc_lengths_along(shape.points);
  constexpr double whole_rod_share = 0.97;
  if (s.back() < whole_rod_share * length) return shape;
  for (std::size_t i = 0; i < s.size(); ++i) shape.arc_length[i] = s[i] * length / s.back();
  return shape;
}

/// Whether two scenes are the same experiment, up to the accuracy with which a gripper is put back
/// into its place.
bool are_same_experiment(const Scene& a, const Scene& b) {
  return a.length == b.length &&
         std::equal(a.grippers.begin(), a.grippers.end(), b.grippers.begin(), b.grippers.end(),
                    [&](const Gripper& one, const Gripper& other) {
                      return one.at == other.at &&
                             one.direction.has_value() == other.direction.has_value() &&
                             (!one.direction || (*one.direction - *other.direction).norm() <=
                                                    same_experiment_tolerance) &&
                             (one.position - other.position).norm() <=
                                 same_experiment_tolerance * a.length;
                    });
}

std::optional<double> repeatability_of(const std::vector<Scene>& scenes, const MaterialFit& fit) {
  if (!std::all_of(scenes.begin(), scenes.end(), [&](const Scene& scene) {
        return are_same_experiment(scene, scenes.front());
      })) {
    return std::nullopt;
  }
  std::vector<Shape> shapes;
  shapes.reserve(fit.shapes.size());
  for (const FittedShape& fitted : fit.shapes) {
    const Alignment& aligned = fitted.alignment;
    shapes.push_back(aligned.arc_lengths == ArcLengths::file
                         ? aligned.shape
                         : with_arc_lengths_along_points(aligned.shape, scenes.front().length));
  }
  return repeatability(shapes, fit.shapes.front().alignment.arc_lengths);
}

}  // namespace

std::vector<std::string> unfitted_assumptions(const std::vector<Scene>& scenes,
                                              const MaterialFitOptions& options) {
  constexpr int enough_different_scenes = 3;
  int different = 0;
  for (auto scene = scenes.begin(); scene != scenes.end(); ++scene) {
    const auto is_same_scene = [&](const Scene& before) {
      return are_same_experiment(before, *scene);
    };
    different += std::none_of(scenes.begin(), scene, is_same_scene) ? 1 : 0;
  }
  std::vector<std::string> result;
  if (different >= enough_different_scenes) return result;
  if (options.natural_curvature_terms == 0) result.emplace_back("natural curvature");
  const bool clamped = std::ranges::any_of(scenes.front().grippers, [](const Gripper& gripper) {
    return gripper.direction.has_value();
  });
  if (clamped && options.direction_tolerance == 0) result.emplace_back("clamp directions");
  return result;
}

double distance_from_rod(const Scene& scene, const MeasuredShape& shape,
                         const MaterialFitOptions& options,
                         const energy_model::Equilibrium* known) {
  MeasuredShapes measured({scene}, {shape}, measured_options(options), Timer());
  double square = measured.alignment(0, measured.solve(0, scene, nullptr)).mean_square;
  if (known != nullptr) {
    const energy_model::Equilibrium near = measured.solve(0, scene, known);
    if (energy_model::succeeded(near.status)) {
      square = std::min(square, measured.alignment(0, near).mean_square);
    }
  }
  return std::sqrt(square);
}

Prediction leave_one_out(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                         const MaterialFitOptions& options, const MaterialFit& fit,
                         const Predict& predict) {
  Prediction result{.repeatability_m = repeatability_of(scenes, fit)};
  double sum_of_squares = 0;
  double points = 0;
  for (std::size_t excluded = 0; excluded < scenes.size(); ++excluded) {
    const PredictedScene predicted = predict(excluded);
    const double rms = distance_from_rod(predicted.scene, shapes[excluded], options,
                                         predicted.known ? &*predicted.known : nullptr);
    result.shapes_m.push_back(rms);
    const auto count = static_cast<double>(shapes[excluded].points.cols());
    sum_of_squares += rms * rms * count;
    points += count;
  }
  result.rms_m = std::sqrt(sum_of_squares / points);
  return result;
}

}  // namespace dlo::compare
