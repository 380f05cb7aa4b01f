#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"

namespace dlo::compare {

/// What of a shape file's frame is unknown.
enum class PoseFreedom {
  known,        ///< nothing: it is the scene's frame
  translation,  ///< where its origin is
  upright,      ///< and how it is turned about the vertical (the direction of gravity)
  rigid,        ///< any proper rigid motion. A planar shape and its mirror image in the plane are
                ///< then the same: up and down is lost with the frame.
};

/// Where the points' arc lengths come from.
enum class ArcLengths {
  automatic,  ///< the file's, if it has them; else `nearest`
  file,       ///< the file's column s
  chord,      ///< the points are the whole rod: lengths along the polyline, with a correction for
              ///< the bow over each chord, scaled to the rod's; a dozen points know them to 1e-4 l
  nearest,    ///< each the curve's nearest point, in order: parts may be missing. Differences along
              ///< the curve are invisible. With PointWeights::by_length the ends of a file as long
              ///< as the rod are the rod's.
};

/// Of the frame.
template <>
struct Choices<PoseFreedom> {
  /// In the enumeration's order.
  static constexpr Choice<PoseFreedom> all[] = {
      {PoseFreedom::known, "known", "the scene's frame"},
      {PoseFreedom::translation, "translation", "all directions are known"},
      {PoseFreedom::upright, "upright", "the vertical is known"},
      {PoseFreedom::rigid, "rigid", "nothing is known"}};
};

/// Of the arc lengths.
template <>
struct Choices<ArcLengths> {
  /// In the enumeration's order.
  static constexpr Choice<ArcLengths> all[] = {
      {ArcLengths::automatic, "auto", "file if there is a column s, else nearest"},
      {ArcLengths::file, "file", "its column s"},
      {ArcLengths::chord, "chord", "lengths along the polyline of a whole rod"},
      {ArcLengths::nearest, "nearest", "nearest points of the rod"}};
};

/// Direction of "up" for PoseFreedom::upright.
/// @throws InputError if the pose is `upright` and the scene has no gravity
[[nodiscard]] Eigen::Vector3d up_of(const Scene& scene, PoseFreedom pose);

/// A rigid motion from a file's frame to the scene's: p -> rotation p + translation.
struct RigidMotion {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< proper [-]
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();   ///< [m]

  /// Points [m], 3 x M, in the scene's frame.
  [[nodiscard]] Eigen::Matrix3Xd applied(const Eigen::Matrix3Xd& points) const {
    return (rotation * points).colwise() + translation;
  }
};

/// How much a point counts.
enum class PointWeights {
  equal,      ///< all the same: measured points with the same noise
  by_length,  ///< by the length up to its neighbours' middles, so that sums are integrals: the
              ///< longer of the rod's arc length and the polyline's own, so that no point is left
              ///< out
};

/// How a shape is to be laid on a reference.
struct AlignOptions {
  PoseFreedom pose = PoseFreedom::known;           ///< what is unknown of its frame
  ArcLengths arc_lengths = ArcLengths::automatic;  ///< where its arc lengths come from
  PointWeights weights = PointWeights::by_length;  ///< how much each point counts
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();   ///< unit, for `upright`
};

/// A measured shape laid on a reference.
struct Alignment {
  RigidMotion pose;       ///< from the file's frame to the scene's
  bool reversed = false;  ///< the file runs (its s counts) from arc length l to 0
  ArcLengths arc_lengths = ArcLengths::nearest;  ///< which rule was used; of a whole file whose
                                                 ///< frame is found `nearest` may become `chord`
  Shape shape;             ///< the points in the scene's frame, by growing arc length
  double rms_m = 0;        ///< distance with the given weights
  double other_rms_m = 0;  ///< the same the other way round
  double mean_square = 0;  ///< of all distances, unweighted [m^2]
};

/// A part of the rod between two neighbouring points.
struct RodPart {
  double from_m = 0;    ///< arc length
  double to_m = 0;      ///< arc length
  double untold_m = 0;  ///< how far a smooth curve through the reference at the points is from the
                        ///< reference in the middle: what is nearer cannot be told apart there
};

/// Lays a shape on a reference curve of arc length 0 to `length`: the direction, the motion within
/// its freedom and, for `nearest`, the arc lengths at which the sum of squared distances is least.
///
/// Given arc lengths: in closed form (Kabsch for a rigid motion). `nearest`: starts from lengths
/// along the polyline, at several places along the rod and in both directions; the points are
/// assigned in order (dynamic programming), the motion then follows by Gauss-Newton steps on the
/// distances across the curve (along it too where a point is past an end). With weights by length
/// and a frame to be found, the frame is then the one in which the distances that ShapeCheck tells
/// are least, and a file as long as the rod (to 3 %) is laid by `chord` where that is nearer.
/// @throws InputError if the options ask for a column s that the file lacks, if the arc lengths in
/// the file are not on the rod, or if a motion is asked of too few points (3)
[[nodiscard]] Alignment align(const MeasuredShape& shape, const Reference& reference, double length,
                              const AlignOptions& options = {});

}  // namespace dlo::compare
