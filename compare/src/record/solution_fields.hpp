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

/// Returns the fields of a result of `solve`, without shape_numbers().
[[nodiscard]] std::span<const Field<SolvedShape>> solution_fields();

/// Returns the fields of an equilibrium shape that `solve`, each row of `sweep` and each frame of
/// `track` have, for scenes whose clamps prescribe twist.
[[nodiscard]] std::span<const Field<SolvedShape>> shape_numbers();

/// Returns the fields of the energies of a shape [J].
[[nodiscard]] std::span<const Field<SceneEnergies>> energy_fields();

/// Returns the fields of a shape's deviation from another one.
[[nodiscard]] std::span<const Field<Deviation>> deviation_fields();

/// Returns the name of a status in documents; "failed" if the solver was not called, was stopped by
/// a limit or gave up.
[[nodiscard]] const char* status_name(energy_model::SolveStatus status);

/// Whether a solution is stable, as far as this is known. If a shape is not verified, its smallest
/// eigenvalue decides; a fold or bifurcation is a singular point and does not count as stable.
[[nodiscard]] bool is_stable(const Solution& solution);

/// Whether a solution is an equilibrium of loads without a potential, which is `not_verified`
/// because only its balance can be checked.
[[nodiscard]] bool is_balance_alone(const Scene& scene, const Solution& solution);

/// Whether Solution::neglected contains an effect.
[[nodiscard]] bool neglects(const Solution& solution, std::string_view what);

}  // namespace dlo::compare
