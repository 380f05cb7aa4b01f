#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "frames/piece.hpp"
#include "problem/span.hpp"

namespace dlo::energy_model {

/// Cuts at grips, loads and sections, and where the layers at the clamps of a soft rod and at the
/// ends of its taut segments have decayed by exp(-6) and exp(-24), so that no piece has to resolve
/// all of a layer.
[[nodiscard]] std::vector<Piece> pieces_of(const Span& span);

/// Cuts closer than this would make pieces too short for a curvature of their own.
inline constexpr double closest_cuts = 1e-9;

/// Points along a span, own units and frame.
struct SpanSamples {
  Eigen::Matrix3Xd points;  ///< from the anchor
  Eigen::Matrix3Xd tangents;
  Eigen::Matrix3Xd curvature;
  Eigen::Matrix3Xd d1;  ///< of the frame with Span::first_d1() at the start: the rod's or Bishop's
};

/// A shape to start from, at given arc lengths by growing s.
struct StartShape {
  Eigen::Matrix3Xd tangents;
  /// By which the rod's own frame is turned ahead of Bishop's, where it has one of its own [rad];
  /// empty: nowhere.
  Eigen::VectorXd roll;
  /// End ahead of start, of a rod without such a frame whose ends' frames are held [rad].
  double twist = 0;

  StartShape() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): tangents are most of what a start is
  StartShape(Eigen::Matrix3Xd along, Eigen::VectorXd ahead = {})
      : tangents(std::move(along)), roll(std::move(ahead)) {}
};

/// Tangents at arc lengths of a span, as a start, 3 x M.
using TangentField = std::function<StartShape(const Eigen::VectorXd&)>;

/// Angle of d1 ahead of a frame that does not rotate around the tangents, from the first
/// point on [rad]; no step may turn the tangent by pi.
[[nodiscard]] Eigen::VectorXd roll_of(const Eigen::Matrix3Xd& tangents, const Eigen::Matrix3Xd& d1);

/// A span's shape: in the plane the angle at its start and the Legendre coefficients of its
/// derivative on every piece, in space the start's frame and the unknowns of RodFrames.
struct SpanShape {
  int terms = 0;
  bool planar = true;
  double anchor = 0;
  std::vector<Piece> pieces;
  double start_theta = 0;
  Eigen::VectorXd theta;  ///< terms x pieces
  Eigen::Matrix3d start_frame = Eigen::Matrix3d::Identity();
  bool free_start = false;
  Eigen::VectorXd strains;
  NaturalStrains natural;

  [[nodiscard]] SpanSamples sample(std::span<const double> s) const;
};

}  // namespace dlo::energy_model
