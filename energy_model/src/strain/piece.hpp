#pragma once

#include <cmath>

namespace dlo::energy_model {

/// A smooth part of a span. Pieces end at loads, grips and sections, where curvature has kinks or
/// jumps, and where the layers at a soft rod's clamps have decayed. On a piece the elastic part of
/// a strain is a series in orthonormal Legendre polynomials p_k on [0, 1], scaled so that its
/// energy is half the sum of the squares of the coefficients.
struct Piece {
  double begin = 0;
  double length = 0;
  double bending = 1;  ///< EI over the span's unit of it
  double torsion = 1;  ///< GJ over the same unit

  [[nodiscard]] double end() const { return begin + length; }
  /// Curvature of the coefficient of p_0 = 1.
  [[nodiscard]] double curvature() const { return 1 / std::sqrt(bending * length); }
  /// By which it turns the tangent from the piece's begin to its end.
  [[nodiscard]] double angle() const { return std::sqrt(length / bending); }
  /// The same for twist.
  [[nodiscard]] double twist() const { return 1 / std::sqrt(torsion * length); }
  [[nodiscard]] double twist_angle() const { return std::sqrt(length / torsion); }
};

}  // namespace dlo::energy_model
