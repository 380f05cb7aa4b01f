#include "dlo/compare/shape_check.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "dlo/compare/comparison.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/plan.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"
#include "shape/aligner.hpp"
#include "shape/curve.hpp"
#include "shape/shape_measure.hpp"
#include "solve/states.hpp"

namespace dlo::compare {
namespace {

/// Largest number of points with which E*/E is fitted; more points are thinned at equal intervals.
constexpr Eigen::Index most_modulus_points = 500;

MeasuredShape thinned(const MeasuredShape& shape) {
  const Eigen::Index count = shape.points.cols();
  const Eigen::Index every = (count + most_modulus_points - 1) / most_modulus_points;
  if (every == 1) return shape;
  MeasuredShape result;
  result.file = shape.file;
  const Eigen::Index kept_count = (count - 1) / every + 1;
  result.points.resize(3, kept_count);
  for (Eigen::Index i = 0; i < kept_count; ++i) {
    // The last point is kept, so that the polyline keeps its length.
    const Eigen::Index from = i + 1 == kept_count ? count - 1 : i * every;
    result.points.col(i) = shape.points.col(from);
    if (!shape.arc_length.empty()) {
      result.arc_length.push_back(shape.arc_length[static_cast<std::size_t>(from)]);
    }
  }
  return result;
}

/// Returns the RMS distance of points from the straight line nearest to them.
double distance_from_line(const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3Xd centred = points.colwise() - points.rowwise().mean();
  const Eigen::Matrix3d moments =
      centred * centred.transpose() / static_cast<double>(points.cols());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(moments);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[0] + eigen.eigenvalues()[1]));
}

/// Returns the number of points that are more than 1e-3 of the length away from all grippers.
long measured_points(const Scene& scene, const Eigen::Matrix3Xd& points) {
  constexpr double tolerance = 1e-3;  // divided by the length
  long count = 0;
  for (const auto& point : points.colwise()) {
    const bool is_held = std::ranges::any_of(scene.grippers, [&](const Gripper& gripper) {
      return (gripper.position - point).norm() <= tolerance * scene.length;
    });
    count += is_held ? 0 : 1;
  }
  return count;
}

Deviation measured_deviation(const Scene& scene, const Alignment& alignment,
                             const Reference& reference, const Measured& measured,
                             double movement) {
  const std::optional<Eigen::Index> tip = free_tip(scene, measured.arc_length);
  Deviation result;
  if (alignment.arc_lengths != ArcLengths::nearest) {
    result = deviation(alignment.shape, reference, std::nullopt, tip);
  } else {
    const Eigen::Matrix3Xd gaps = alignment.shape.points - measured.reference;
    result.tip_m = tip ? gaps.col(*tip).norm() : NAN;
    result.angle_rms_rad = NAN;
    result.curvature_rms_per_m = NAN;
  }
  result.max_m = measured.max_m;
  result.max_at_m = measured.arc_length[static_cast<std::size_t>(measured.worst)];
  result.rms_m = measured.rms_m;
  result.rms_over_length = result.rms_m / scene.length;
  result.rms_over_movement = movement > 1e-9 * scene.length ? result.rms_m / movement : NAN;
  return result;
}

/// Describes what is probably wrong with a polyline that is not as long as its part of the rod;
/// empty if nothing, or if another unit is more probable.
std::string hint_of(const ShapeCheck& check, const Measured& measured) {
  constexpr double least = 1e-3;  // divided by the length: a difference that a person would see
  const Alignment& alignment = check.alignment;
  const Eigen::Matrix3Xd& points = alignment.shape.points;
  const std::vector<double>& s = alignment.shape.arc_length;
  // A much longer or shorter polyline suggests another unit instead.
  if (check.polyline_length_m > 2 * check.length_m) return {};
  if (check.polyline_length_m < check.length_m / 50) return {};
  if (alignment.arc_lengths != ArcLengths::nearest) {
    const double stretch = check.polyline_length_m / (s.back() - s.front()) - 1;
    if (!(stretch > 0.01)) return {};
    return fmt::format("the polyline is {:.4g} % longer than its arc lengths: stretched, or noise",
                       stretch * 100);
  }
  if (check.length_beyond_ends_m > least * check.length_m) {
    const bool at_end = measured.excess_at_end_m >= measured.excess_at_start_m;
    const Eigen::Index outermost = at_end ? points.cols() - 1 : 0;
    const Eigen::Vector3d end = measured.reference.col(outermost);
    const Eigen::Index inner = at_end ? outermost - 1 : 1;
    const Eigen::Vector3d along = (end - measured.reference.col(inner)).normalized();
    const Eigen::Vector3d past = points.col(outermost) - end;
    const double share = past.dot(along) / past.norm();
    // Points within 30 degrees of the rod's direction continue the rod.
    const bool straight_on = share > 0.866;
    return fmt::format("longer than the rod by {:.4g} mm past {}: {}",
                       check.length_beyond_ends_m * 1e3, at_end ? "arc length l" : "arc length 0",
                       straight_on ? fmt::format("stretched by {:.2g} %, or another rod",
                                                 check.length_beyond_ends_m / check.length_m * 100)
                                   : "the points there do not continue in the rod's direction");
  }
  const double missing = check.length_m - (s.back() - s.front());
  if (missing > least * check.length_m) {
    // The length of the polyline distinguishes a file that is cut off from a rod of another shape.
    if (check.polyline_length_m > (1 - least) * check.length_m) {
      return fmt::format(
          "the polyline is as long as the rod, but {:.4g} mm of the rod have no point nearby: the "
          "shapes differ",
          missing * 1e3);
    }
    if (lacks_one_segment(points, check.length_m)) {
      const bool at_end = check.length_m - s.back() > s.front();
      return fmt::format(
          "shorter than the rod by {:.4g} mm, one segment: the {} point is missing, as in MuJoCo's "
          "xpos",
          (check.length_m - check.polyline_length_m) * 1e3,
          at_end != alignment.reversed ? "last" : "first");
    }
    return fmt::format(
        "shorter than the rod by {:.4g} mm: compressed, cut off, or only partly observed",
        missing * 1e3);
  }
  return {};
}

AlignOptions align_options(const Scene& scene, const ShapeCheckOptions& options) {
  return {.pose = options.pose,
          .arc_lengths = options.arc_lengths,
          .up = upward_direction(scene, options.pose)};
}

/// Compares an aligned shape with an equilibrium: sets all of ShapeCheck except the state, other
/// equilibria, unverified, stretched_length_m, is_rotation_determined, E*/E and E*.
ShapeCheck compared(const Scene& scene, const MeasuredShape& shape, Alignment aligned,
                    const energy_model::Equilibrium& rod) {
  ShapeCheck result;
  result.scene = scene.name;
  result.file = shape.file;
  result.gamma = scene.gamma();
  result.length_m = scene.length;
  result.stiffness = scene.stiffness();
  result.alignment = std::move(aligned);
  const Alignment& alignment = result.alignment;
  const Measured measured = measure(alignment, rod.sample, scene.length);
  const std::vector<double>& s = measured.arc_length;
  result.reference = {s, measured.reference};
  result.rod = rod;
  result.movement_m = distance_from_straight(scene, result.reference);
  result.deviation = measured_deviation(scene, alignment, rod.sample, measured, result.movement_m);
  result.length_beyond_ends_m = measured.excess_at_start_m + measured.excess_at_end_m;
  result.between = intervals_between_points(s, rod.sample, scene.length);
  const WholeRod whole = whole_rod_distances(measured, alignment, rod.sample, scene.length);
  result.whole_rod_rms_m = whole.rms_m;
  result.whole_rod_max_m = whole.max_m;

  result.worst_position = alignment.shape.points.col(measured.worst);
  const bool file_falls = alignment.arc_lengths == ArcLengths::file &&
                          shape.arc_length.front() > shape.arc_length.back();
  const bool backwards = alignment.reversed != file_falls;
  result.worst_point = 1 + (backwards ? shape.points.cols() - 1 - measured.worst : measured.worst);
  for (std::size_t i = 0; i + 1 < s.size(); ++i) {
    if (!(s[i + 1] - s[i] > result.largest_gap_m)) continue;
    result.largest_gap_m = s[i + 1] - s[i];
    result.largest_gap_at_m = s[i];
  }
  result.polyline_length_m = polyline_length(shape.points);
  result.observed_share = (s.back() - s.front()) / scene.length;
  result.measured_points = measured_points(scene, alignment.shape.points);
  result.hint = hint_of(result, measured);
  result.is_direction_determined = alignment.opposite_direction_rms_m > 1.05 * alignment.rms_m;
  return result;
}

/// A shape, aligned with each equilibrium.
struct LaidStates {
  LaidStates(const Aligner& on, double length, std::vector<energy_model::Equilibrium> of)
      : aligner(on), states(std::move(of)) {
    for (const energy_model::Equilibrium& state : states) {
      alignments.push_back(aligner.align(Curve(state.sample, length)));
      from_shape.push_back(alignments.back().rms_m);
    }
  }

  /// Returns the index of the equilibrium nearest to the shape among the stable ones and the lowest
  /// one, which has the index 0 and need not be proven stable.
  [[nodiscard]] std::size_t nearest() const {
    std::size_t result = 0;
    for (std::size_t i = 1; i < states.size(); ++i) {
      const bool nearer = from_shape[i] < from_shape[result];
      if (energy_model::succeeded(states[i].status) && nearer) result = i;
    }
    return result;
  }

  /// Adds an equilibrium that a search from the shape's points has found, if it is proven stable
  /// and not yet known.
  void add(const energy_model::Equilibrium& near, const Scene& scene) {
    const std::optional<std::size_t> added = insert_equilibrium(scene, near, states);
    if (!added) return;
    const auto at = static_cast<std::ptrdiff_t>(*added);
    Alignment alignment = aligner.align(Curve(states[*added].sample, scene.length));
    from_shape.insert(from_shape.begin() + at, alignment.rms_m);
    alignments.insert(alignments.begin() + at, std::move(alignment));
  }

  const Aligner& aligner;
  std::vector<energy_model::Equilibrium> states;
  std::vector<Alignment> alignments;
  std::vector<double> from_shape;  // RMS [m]
};

/// Returns the distance of a shape from an equilibrium without a verdict on its stability;
/// std::nullopt if it has one or is no equilibrium.
std::optional<UnverifiedState> unverified_state(const Aligner& aligner,
                                                const energy_model::Equilibrium& rod,
                                                double length) {
  constexpr double at_rest = 1e-8;  // largest residual; Newton's method converges to rounding
  const bool is_open = rod.status == energy_model::SolveStatus::not_verified ||
                       rod.status == energy_model::SolveStatus::near_singular;
  if (!is_open || !(rod.residual >= 0 && rod.residual < at_rest)) return std::nullopt;
  const Alignment aligned = aligner.align(Curve(rod.sample, length));
  const WholeRod whole =
      whole_rod_distances(measure(aligned, rod.sample, length), aligned, rod.sample, length);
  return UnverifiedState{whole.rms_m, whole.max_m, rod.message};
}

/// Returns the length of the axis of a rod, including its stretch if the scene counts it [m].
double stretched_length(const Scene& scene, const energy_model::Equilibrium& rod) {
  if (scene.stretch != Stretch::counted) return scene.length;
  constexpr int samples = 1001;
  return arc_lengths_along(rod.sample(equal_arc_lengths(scene.length, samples)).points).back();
}

}  // namespace

ShapeCheck check_shape(const Scene& scene, const MeasuredShape& shape,
                       const ShapeCheckOptions& options) {
  const Aligner aligner(shape, scene.length, align_options(scene, options));
  const energy_model::Equilibrium lowest = solve_reference(scene, options.solve);
  LaidStates aligned(aligner, scene.length, all_equilibria(scene, lowest, options.solve));
  std::optional<UnverifiedState> unverified;
  if (aligned.from_shape[aligned.nearest()] > nearest_shape_tolerance * scene.length) {
    MeasuredShape placed = shape;
    placed.points = aligned.alignments[aligned.nearest()].pose.applied(shape.points);
    const Shape on_rod = aligned_by_grippers(placed, scene, aligner.arc_lengths());
    if (const auto near = equilibrium_near(scene, on_rod, options.solve)) {
      aligned.add(*near, scene);
      unverified = unverified_state(aligner, *near, scene.length);
    }
  }
  const std::size_t nearest = aligned.nearest();
  std::vector<Alignment>& alignments = aligned.alignments;
  const std::vector<energy_model::Equilibrium>& states = aligned.states;
  const energy_model::Equilibrium& energy = states[nearest];
  ShapeCheck result = compared(scene, shape, std::move(alignments[nearest]), energy);
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (i != nearest && succeeded(states[i].status)) result.other_rods.push_back(states[i]);
  }
  result.unverified = std::move(unverified);
  result.stretched_length_m = stretched_length(scene, energy);
  result.state = describe_state(scene, states, nearest, aligned.from_shape);
  const double offset = distance_from_line(result.alignment.shape.points);
  result.is_rotation_determined =
      options.pose != PoseFreedom::rigid ||
      offset > std::max(3 * result.alignment.rms_m, 1e-6 * scene.length);

  if (options.modulus == ModulusSearch::no) return result;
  const Aligner thin(thinned(shape), scene.length, align_options(scene, options));
  const ShapeDistance distance = [&](const energy_model::Equilibrium& reference) {
    const Alignment aligned = thin.align(Curve(reference.sample, scene.length));
    return measure(aligned, reference.sample, scene.length).rms_m;
  };
  result.effective_modulus = fit_effective_modulus(scene, distance, energy, options.solve);
  result.modulus = result.effective_modulus.ratio * result.stiffness.value;
  return result;
}

std::optional<TrivialShape> trivial_shape(const Scene& scene,
                                          const energy_model::Equilibrium& loaded,
                                          const SolveOptions& options) {
  Scene unloaded = scene;
  unloaded.gravity.setZero();
  unloaded.loads.clear();
  unloaded.distributed_loads.clear();
  unloaded.drag.reset();
  SolveOptions from_loaded = options;
  from_loaded.start = &loaded;
  TrivialShape result;
  try {
    result.rod = solve_reference(unloaded, from_loaded);
  } catch (const ResultError&) {
    return std::nullopt;
  }
  constexpr int samples = 201;
  const std::vector<double> s = equal_arc_lengths(scene.length, samples);
  result.deflection_m =
      (result.rod.sample(s).points - loaded.sample(s).points).colwise().norm().maxCoeff();
  return result;
}

double required_deflection(const Scene& scene, const std::optional<TrivialShape>& trivial) {
  constexpr double least = 1e-6;  // share of the length; a smaller deflection is too inaccurate
  if (!trivial) {
    throw ConvergenceError(fmt::format(
        "{}: a tolerance of deflection: no equilibrium without weight and loads was found",
        scene.file));
  }
  if (!(trivial->deflection_m >= least * scene.length)) {
    throw InputError(fmt::format(
        "{}: a tolerance of deflection: weight and loads deflect the rod by {:.3g} mm only "
        "(allowed: from {:g} of its length on; else a tolerance such as 1% or \"2 mm\")",
        scene.file, trivial->deflection_m * 1e3, least));
  }
  return trivial->deflection_m;
}

ShapeCheck check_trivial_shape(const TrivialShape& trivial, const Scene& scene,
                               const ShapeCheck& check, const ShapeCheckOptions& options) {
  MeasuredShape shape;
  shape.file = check.file;
  shape.points = trivial.rod.sample(check.reference.arc_length).points;
  if (check.alignment.arc_lengths == ArcLengths::file) {
    shape.arc_length = check.reference.arc_length;
  }
  const Aligner aligner(shape, scene.length, align_options(scene, options));
  Alignment aligned = aligner.align(Curve(check.rod.sample, scene.length));
  return compared(scene, shape, std::move(aligned), check.rod);
}

}  // namespace dlo::compare
