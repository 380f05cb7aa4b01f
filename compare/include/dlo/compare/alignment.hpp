#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"

namespace dlo::compare {

/// The unknown part of a shape file's frame.
enum class PoseFreedom {
  known,        ///< nothing is unknown: the file has the scene's frame
  translation,  ///< the origin is unknown
  /// The origin and the rotation about the vertical (the direction of gravity) are unknown.
  upright,
  /// Any proper rigid motion is possible. A planar shape and its mirror image in the plane are then
  /// identical, so that up and down cannot be distinguished.
  rigid,
};

/// Source of the points' arc lengths.
enum class ArcLengths {
  automatic,  ///< the file's, if it has them; else `nearest`
  file,       ///< the file's column s
  /// The points are the whole rod: lengths along the polyline, with a correction for the bow over
  /// each chord, scaled to the rod's length; accurate to 1e-4 l for a dozen points.
  chord,
  /// Arc length of the nearest point of the curve for each point, in order; parts may be missing.
  /// Differences along the curve are invisible. With PointWeights::by_length the ends of a file as
  /// long as the rod are the rod's ends.
  nearest,
};

/// Names of the values in files and options.
template <>
struct Choices<PoseFreedom> {
  /// All values, in the order of the enumeration.
  static constexpr Choice<PoseFreedom> all[] = {
      {PoseFreedom::known, "known", "the scene's frame"},
      {PoseFreedom::translation, "translation", "all directions are known"},
      {PoseFreedom::upright, "upright", "the vertical is known"},
      {PoseFreedom::rigid, "rigid", "nothing is known"}};
};

/// Names of the values in files and options.
template <>
struct Choices<ArcLengths> {
  /// All values, in the order of the enumeration.
  static constexpr Choice<ArcLengths> all[] = {
      {ArcLengths::automatic, "auto", "file if there is a column s, else nearest"},
      {ArcLengths::file, "file", "its column s"},
      {ArcLengths::chord, "chord", "lengths along the polyline of a whole rod"},
      {ArcLengths::nearest, "nearest", "nearest points of the rod"}};
};

/// Returns the upward direction for PoseFreedom::upright, +y for other poses.
/// @throws InputError if the pose is `upright` and the scene has no gravity
[[nodiscard]] Eigen::Vector3d upward_direction(const Scene& scene, PoseFreedom pose);

/// A rigid motion from a file's frame to the scene's: p -> rotation p + translation.
struct RigidMotion {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< proper [-]
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();   ///< [m]

  /// Returns points of the file [m], 3 x M, in the scene's frame [m].
  [[nodiscard]] Eigen::Matrix3Xd applied(const Eigen::Matrix3Xd& points) const {
    return (rotation * points).colwise() + translation;
  }
};

/// Weight of a point in the fit.
enum class PointWeights {
  equal,  ///< equal weights: measured points with the same noise
  /// The length between the middles to its neighbours, so that sums are integrals: the arc length
  /// of the rod or the polyline's own length, whichever is longer, so that no point is ignored.
  by_length,
};

/// How a shape is aligned with a reference.
struct AlignOptions {
  PoseFreedom pose = PoseFreedom::known;           ///< unknown part of the file's frame
  ArcLengths arc_lengths = ArcLengths::automatic;  ///< source of the arc lengths
  PointWeights weights = PointWeights::by_length;  ///< weight of each point
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();   ///< upward unit vector, for `upright`
};

/// A measured shape aligned with a reference.
struct Alignment {
  RigidMotion pose;  ///< motion from the file's frame to the scene's
  /// Whether the file's points, or with ArcLengths::file its arc lengths, run from the rod's arc
  /// length l to 0.
  bool reversed = false;
  /// Rule that was used for arc lengths. `chord` may replace `nearest` if the frame of a file of
  /// the whole rod is fitted and points are weighted by length.
  ArcLengths arc_lengths = ArcLengths::nearest;
  Shape shape;  ///< points in the scene's frame, by increasing arc length
  /// RMS distance with the given weights; for `nearest` with weights by length and a fitted frame
  /// the distance that ShapeCheck reports.
  double rms_m = 0;
  /// RMS distance in the other direction of the file; of a part of the points, if these suffice to
  /// reject it.
  double opposite_direction_rms_m = 0;
  double mean_square = 0;  ///< mean of all squared distances, unweighted [m^2]
};

/// An interval of the rod between two adjacent points.
struct RodPart {
  double from_m = 0;  ///< start [m]
  double to_m = 0;    ///< end [m]
  /// Interpolation error: distance in the middle between the reference and a smooth curve through
  /// the reference at the points; smaller deviations cannot be detected there.
  double interpolation_error_m = 0;
};

/// Aligns a shape with a reference curve of arc length 0 to `length`: finds the direction of the
/// file, the motion within its freedom and, for `nearest`, the arc lengths that minimise the sum of
/// squared distances.
///
/// Given arc lengths: solution in closed form (Kabsch for a rigid motion). `nearest`: the search
/// starts from lengths along the polyline, at several positions along the rod and in both
/// directions. The points are assigned in order (dynamic programming); the motion then follows by
/// Gauss-Newton steps on the distances perpendicular to the curve (also along it if a point is past
/// an end). With weights by length and a frame to be fitted, the frame is then the one that
/// minimises the distances that ShapeCheck reports, and a file that is at most 3 % shorter than the
/// rod is aligned by `chord` if that is nearer.
/// @throws InputError if the options need a column s that the file lacks, if arc lengths of the
/// file are not on the rod, or if a motion is to be fitted to too few points (fewer than 3)
[[nodiscard]] Alignment align(const MeasuredShape& shape, const Reference& reference, double length,
                              const AlignOptions& options = {});

}  // namespace dlo::compare
