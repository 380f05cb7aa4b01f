#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "span.hpp"

namespace dlo::energy_model {

/// A smooth part of a span. Pieces end at loads and grips, where curvature has kinks, and where the
/// layers at a soft rod's clamps have decayed.
struct Piece {
  double begin = 0;
  double length = 0;

  [[nodiscard]] double end() const { return begin + length; }
};

/// Cuts at grips and loads, and for a soft rod where the layers at its clamps have decayed by
/// exp(-6) and exp(-24), so that no piece has to resolve all of a layer.
[[nodiscard]] std::vector<Piece> pieces_of(const Span& span);

/// Cuts closer than this would make pieces too short for a curvature of their own.
inline constexpr double closest_cuts = 1e-9;

/// Points along a span, own units and frame.
struct SpanSamples {
  Eigen::Matrix3Xd points;  ///< from the anchor
  Eigen::Matrix3Xd tangents;
  Eigen::Matrix3Xd curvature;
};

/// A span's shape as the angles theta and beta at its start and the Legendre coefficients of their
/// derivatives on every piece.
struct SpanShape {
  int terms = 0;
  bool planar = true;
  double anchor = 0;
  double start_theta = 0;
  double start_beta = 0;
  std::vector<Piece> pieces;
  Eigen::VectorXd theta;  ///< terms x pieces
  Eigen::VectorXd beta;   ///< the same, or empty

  [[nodiscard]] SpanSamples sample(std::span<const double> s) const;
};

}  // namespace dlo::energy_model
