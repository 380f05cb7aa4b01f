#pragma once

#include <Eigen/Core>

#include "dlo/energy_model/polygon.hpp"
#include "polygon/polygon_energy.hpp"

namespace dlo::energy_model {

/// Checks the twists of a polygon.
/// @throws std::invalid_argument naming the first number out of range
void require_twists(const PolygonProblem& problem);

/// Returns the energy of all twists [J] and adds their gradient [N] to `gradient`.
[[nodiscard]] double add_twist_energy(const PolygonProblem& problem,
                                      const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                      Eigen::Ref<Eigen::Matrix3Xd> gradient);

/// Adds the part M d2 theta of the Hessian, which couples neighbours. The other part is B B^T, with
/// a column d theta / sqrt(C) of B for each twist (twist_columns()).
void add_twist_hessian(const PolygonProblem& problem,
                       const Eigen::Ref<const Eigen::Matrix3Xd>& points, const AddBlock& add);

/// Returns the matrix B of add_twist_hessian(): 3 (n+1) rows, the coordinates of each point
/// consecutively, and a column for each twist [sqrt(N/m)].
[[nodiscard]] Eigen::MatrixXd twist_columns(const PolygonProblem& problem,
                                            const Eigen::Ref<const Eigen::Matrix3Xd>& points);

}  // namespace dlo::energy_model
