#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "piece.hpp"
#include "span.hpp"

namespace dlo::energy_model {

/// Cuts at grips and loads, and where the layers at the clamps of a soft rod and at the ends of its
/// taut segments have decayed by exp(-6) and exp(-24), so that no piece has to resolve all of a
/// layer.
[[nodiscard]] std::vector<Piece> pieces_of(const Span& span);

/// Cuts closer than this would make pieces too short for a curvature of their own.
inline constexpr double closest_cuts = 1e-9;

/// Points along a span, own units and frame.
struct SpanSamples {
  Eigen::Matrix3Xd points;  ///< from the anchor
  Eigen::Matrix3Xd tangents;
  Eigen::Matrix3Xd curvature;
};

/// A span's shape: in the plane the angle at its start and the Legendre coefficients of its
/// derivative on every piece, in space the start's frame and the unknowns of BishopFrames.
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

  [[nodiscard]] SpanSamples sample(std::span<const double> s) const;
};

}  // namespace dlo::energy_model
