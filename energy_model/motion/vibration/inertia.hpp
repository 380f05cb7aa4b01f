#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "dlo/energy_model/vibrations.hpp"
#include "frames/position_operator.hpp"
#include "problem/split.hpp"

namespace dlo::energy_model {

/// @throws std::invalid_argument naming what of it is out of range, and the function
void check(const Problem& problem, const Inertia& inertia, std::string_view function);

/// Of the rod and what hangs on it [kg].
[[nodiscard]] double total_mass(const Problem& problem, const Inertia& inertia);

/// Of each of a span's pieces over its length in the span's own unit [kg].
[[nodiscard]] std::vector<double> masses_per_length(const Problem& problem, const Inertia& inertia,
                                                    const PlacedSpan& placed,
                                                    const std::vector<Piece>& pieces);

/// Of a movement along one axis, M: with the unknowns' velocities v its kinetic energy is half of
/// v^T M v.
/// @param masses    of the points of a span
/// @param tangents  derivatives of the tangents' component by the unknowns, nodes x unknowns
[[nodiscard]] Eigen::MatrixXd mass_matrix(const SpanReach& reach, const Eigen::VectorXd& masses,
                                          const Eigen::MatrixXd& tangents);

}  // namespace dlo::energy_model
