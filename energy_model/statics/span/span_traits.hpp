#pragma once

#include <string_view>

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
  bool adapted;  ///< pieces end where a shape that is known wants it
  double longest_piece = 0;
  int natural_terms = 0;  ///< that natural strains take, and couples
  bool taut = false;      ///< pieces end where the layers at taut segments' ends have decayed
  double stiffness = 0;   ///< of the tautest segment along its chord
};

/// Unknowns that a span's model may have before its shape is refined: its dense matrices then take
/// about half a gigabyte and a step of Newton's method about a second.
inline constexpr int most_model_unknowns = 2400;

/// Coefficients of a piece, in each of its strains, with which a model is made at least.
inline constexpr int least_model_terms = 9;

/// Coefficients that the span's model may have in each of its strains on each piece, at least one.
[[nodiscard]] int affordable_terms(const Span& span);

/// Pieces end at loads, grips and other sections, and each takes unknowns of its own.
/// @param terms  that each piece is to have; 0: the fewest
/// @throws std::invalid_argument if that makes more unknowns than a model may have
void require_affordable(const Span& span, int terms, std::string_view function);

}  // namespace dlo::energy_model
