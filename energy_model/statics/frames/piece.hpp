#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

namespace dlo::energy_model {

/// A smooth part of a span. Pieces end at loads, grips and sections, where curvature has kinks or
/// jumps, and where the layers at a soft rod's clamps have decayed. On a piece the elastic part of
/// a strain is a series in orthonormal Legendre polynomials p_k on [0, 1], scaled so that its
/// energy is half the sum of the squares of the coefficients.
struct Piece {
  double begin = 0;
  double length = 0;
  /// EI about d1 and d2, and GJ, over the span's unit; in the plane only the first one counts.
  Eigen::Vector3d stiffness = Eigen::Vector3d::Ones();

  [[nodiscard]] double end() const { return begin + length; }
  /// Strain u1, u2 or u3 of the coefficient of p_0 = 1, by field 0, 1 or 2.
  [[nodiscard]] double strain(Eigen::Index field) const {
    return 1 / std::sqrt(stiffness[field] * length);
  }
  /// By which it turns the frame from the piece's begin to its end.
  [[nodiscard]] double angle(Eigen::Index field) const {
    return std::sqrt(length / stiffness[field]);
  }
};

/// How many pieces lie before an arc length at which one begins or ends.
[[nodiscard]] inline Eigen::Index pieces_before(const std::vector<Piece>& pieces, double s) {
  return std::count_if(pieces.begin(), pieces.end(),
                       [s](const Piece& piece) { return piece.begin + piece.length / 2 < s; });
}

}  // namespace dlo::energy_model
