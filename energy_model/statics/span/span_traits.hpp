#pragma once

#include <string_view>

#include "problem/span.hpp"

namespace dlo::energy_model {

/// Properties of a span that determine how its equilibria are searched for.
struct SpanTraits {
  explicit SpanTraits(const Span& span);

  /// Number of strains that are unknowns.
  [[nodiscard]] static int fields_of(const Span& span) {
    return span.planar ? 1 : span.has_material_directors() ? 3 : 2;
  }

  double load;  ///< weight and loads [EI/l^2]
  int fields;
  bool adapted;  ///< the mesh is adapted to a known shape
  double longest_piece = 0;
  int natural_terms = 0;  ///< number of coefficients needed for natural strains and couples
  bool taut = false;      ///< elements end where layers at taut segments' ends have decayed
  double stiffness = 0;   ///< largest stiffness of a taut segment along its chord [EI/l^3]
};

/// Largest number of unknowns of a span's model before its shape is refined: its dense matrices
/// then occupy about half a gigabyte, and a step of Newton's method takes about a second.
inline constexpr int most_model_unknowns = 2400;

/// Smallest number of coefficients of an element, per strain, with which a model is made.
inline constexpr int least_model_terms = 9;

/// Returns the largest affordable number of coefficients per strain and element, at least one.
[[nodiscard]] int affordable_terms(const Span& span);

/// Checks the size of a span's model. Elements end at loads, grips and section changes, and each
/// has unknowns of its own.
/// @param terms  number of coefficients that each element is to have; 0: the fewest
/// @throws std::invalid_argument if the model would have more unknowns than affordable
void require_affordable(const Span& span, int terms, std::string_view function);

}  // namespace dlo::energy_model
