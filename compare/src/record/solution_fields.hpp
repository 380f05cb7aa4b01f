#pragma once

#include <span>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "record/field.hpp"

namespace dlo::compare {

/// A solution and its scene.
struct SolvedShape {
  const Scene& scene;
  const Solution& solution;
};

/// What `solve` says: of how it was solved, and of its energies.
[[nodiscard]] std::span<const Field<SolvedShape>> solution_fields();

/// Numbers of a shape at rest: of `solve`, of each row of `sweep` and of each frame of `track`.
[[nodiscard]] std::span<const Field<SolvedShape>> shape_numbers();

/// Of a shape, in J.
[[nodiscard]] std::span<const Field<SceneEnergies>> energy_fields();

/// What is said of a shape's distance from another one.
[[nodiscard]] std::span<const Field<Deviation>> deviation_fields();

/// A status as documents spell it.
[[nodiscard]] const char* status_name(energy_model::SolveStatus status);

/// As far as it is known: of a shape that is not verified its eigenvalue says it, and a fold or
/// bifurcation is a singular point.
[[nodiscard]] bool is_stable(const Solution& solution);

/// Whether it is an equilibrium of loads without a potential, `not_verified` because no more than
/// its balance can be checked.
[[nodiscard]] bool is_balance_alone(const Scene& scene, const Solution& solution);

/// Whether it is among Solution::neglected.
[[nodiscard]] bool neglects(const Solution& solution, std::string_view what);

}  // namespace dlo::compare
