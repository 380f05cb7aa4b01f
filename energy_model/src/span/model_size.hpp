#pragma once

#include <string_view>

#include "problem/span.hpp"

namespace dlo::energy_model {

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
