#pragma once

#include <optional>

#include "base/deadline.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// The equilibrium next to a shape that says which parts of the rod touch which obstacles: of a rod
/// that is intrinsically straight, held by any grips, on rigid bodies of any form. Whether it is
/// one is judged here: gaps, forces and pressures of the right sign, a positive second variation.
/// @param shape      of this problem or of a similar one, with its grips' reactions and contacts
/// @param tolerance  of the integrator
/// @return nothing where the problem is another one or the rod touches as it is not known here: it
///         lies on both sides of a grip, or next to where it lies elsewhere
[[nodiscard]] std::optional<Equilibrium> confirm_contacts(const Problem& problem,
                                                          const Equilibrium& shape,
                                                          double tolerance,
                                                          const Deadline& deadline);

}  // namespace dlo::energy_model
