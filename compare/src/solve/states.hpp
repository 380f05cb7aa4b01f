#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "dlo/compare/compared_state.hpp"
#include "dlo/compare/solution.hpp"
#include "polygon/natural_plane.hpp"

namespace dlo::compare {

/// Returns all equilibria of a scene that are found, stable ones first, by energy: those of
/// reference_states, `lowest` even if that wider search does not find it, and the mirror images of
/// shapes of a planar scene that leave its plane.
[[nodiscard]] std::vector<energy_model::Equilibrium> all_equilibria(
    const Scene& scene, const energy_model::Equilibrium& lowest, const SolveOptions& options);

/// RMS distance between shapes, divided by the length, below which they are the same.
inline constexpr double same_shape_tolerance = 1e-4;

/// Distance of a known equilibrium from a shape, divided by the length, below which a search from
/// the shape's points is omitted. The distance of other equilibria from the known one is at least
/// `same_shape_tolerance`, so they are at least as far from the shape as the known one (triangle
/// inequality).
inline constexpr double nearest_shape_tolerance = same_shape_tolerance / 2;

/// Returns the equilibrium that a search from the points of a shape finds (reference_near),
/// whatever its status; std::nullopt if the shape has fewer than two points, or if the scene's
/// reference_model() is not energy, since no other model searches.
/// @param shape   in the scene's frame
[[nodiscard]] std::optional<energy_model::Equilibrium> equilibrium_near(
    const Scene& scene, const Shape& shape, const SolveOptions& options);

/// Inserts an equilibrium into the ordered states, if it is proven stable and differs from all of
/// them.
/// @param[in,out] states  result of all_equilibria()
/// @return the index of the added state, std::nullopt if none was added
[[nodiscard]] std::optional<std::size_t> insert_equilibrium(
    const Scene& scene, energy_model::Equilibrium state,
    std::vector<energy_model::Equilibrium>& states);

/// Describes the state with which a shape was compared.
/// @param states  result of all_equilibria();  @param compared  index of the state
/// @param from_shape  RMS distance of each state from the shape [m]
[[nodiscard]] ComparedEquilibrium describe_state(
    const Scene& scene, const std::vector<energy_model::Equilibrium>& states, std::size_t compared,
    const std::vector<double>& from_shape);

/// Returns, in space, a polygon's solution of a scene that `turn` moved into the plane z = 0.
[[nodiscard]] Solution solution_in_space(Solution solution, const PlaneTransform& turn);

}  // namespace dlo::compare
