#pragma once

namespace dlo::energy_model {

/// A smooth part of a span. Pieces end at loads and grips, where curvature has kinks, and where the
/// layers at a soft rod's clamps have decayed.
struct Piece {
  double begin = 0;
  double length = 0;

  [[nodiscard]] double end() const { return begin + length; }
};

}  // namespace dlo::energy_model
