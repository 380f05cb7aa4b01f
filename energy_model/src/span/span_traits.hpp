#pragma once

#include "problem/span.hpp"

namespace dlo::energy_model {

/// What a span is to those who look for its equilibria.
struct SpanTraits {
  explicit SpanTraits(const Span& span);

  /// Of unknowns: strains that bend or twist it.
  [[nodiscard]] static int fields_of(const Span& span) {
    return span.planar ? 1 : span.has_material_directors() ? 3 : 2;
  }

  double load;  ///< weight and loads [EI/l^2]
  int fields;
  bool graded;  ///< pieces end where a shape that is known wants it
  double longest_piece = 0;
  int natural_terms = 0;  ///< that the free rod's own strains take
  bool taut = false;      ///< pieces end where the layers at taut segments' ends have decayed
  double stiffness = 0;   ///< of the tautest segment along its chord
};

}  // namespace dlo::energy_model
