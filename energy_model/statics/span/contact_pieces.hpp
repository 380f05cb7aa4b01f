#pragma once

#include <functional>

#include "span/local_solver.hpp"

namespace dlo::energy_model {

/// Solves for an equilibrium on soft obstacles with elements that end where contact begins or ends
/// (Span::contact_ends). The force per length has a kink there, which no series represents. The
/// ends of each round are those of the previous shape. Their error changes the shape by about its
/// square, so that a few rounds determine both.
/// @param refine  raises the number of coefficients of an equilibrium on fixed elements
[[nodiscard]] SpanSolution with_found_pieces(
    LocalSolver& on, SpanSolution solution,
    const std::function<SpanSolution(LocalSolver&, SpanSolution)>& refine);

/// Fits the shape of a solution, by its tangents, on a span with other elements. The result is not
/// an equilibrium yet.
[[nodiscard]] SpanSolution on_other_pieces(LocalSolver& on, const SpanSolution& solution,
                                           int terms);

}  // namespace dlo::energy_model
