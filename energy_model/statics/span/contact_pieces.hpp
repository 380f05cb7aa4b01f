#pragma once

#include <functional>

#include "span/local_solver.hpp"

namespace dlo::energy_model {

/// An equilibrium on obstacles that yield, on pieces that end where contact with them does
/// (Span::contact_ends): there the force per length has a kink, which no series takes. The ends are
/// those of the shape before; what they are off by moves the shape by about its square, so that a
/// few rounds find both.
/// @param refine  raises the number of terms of an equilibrium on pieces that stay
[[nodiscard]] SpanSolution with_found_pieces(
    LocalSolver& on, SpanSolution solution,
    const std::function<SpanSolution(LocalSolver&, SpanSolution)>& refine);

/// The shape of a solution on a span, from its tangents: pieces may end elsewhere. Not an
/// equilibrium yet.
[[nodiscard]] SpanSolution on_other_pieces(LocalSolver& on, const SpanSolution& solution,
                                           int terms);

}  // namespace dlo::energy_model
