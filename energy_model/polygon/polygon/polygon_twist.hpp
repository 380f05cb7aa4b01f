#pragma once

#include <Eigen/Core>

#include "dlo/energy_model/polygon.hpp"
#include "polygon/polygon_energy.hpp"

namespace dlo::energy_model {

/// What the twists of a polygon have to be. @throws std::invalid_argument naming the first number
/// that is out of range
void require_twists(const PolygonProblem& problem);

/// Energy of all twists [J]; their gradient [N] is added.
[[nodiscard]] double add_twist_energy(const PolygonProblem& problem,
                                      const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                      Eigen::Ref<Eigen::Matrix3Xd> gradient);

/// Of the Hessian the part M d2 theta, of neighbours; the other is B B^T, with a column
/// d theta / sqrt(C) of B for each twist (twist_columns).
void add_twist_hessian(const PolygonProblem& problem,
                       const Eigen::Ref<const Eigen::Matrix3Xd>& points, const AddBlock& add);

/// 3 (n+1) x the number of twists, coordinates of a point side by side [sqrt(N/m)].
[[nodiscard]] Eigen::MatrixXd twist_columns(const PolygonProblem& problem,
                                            const Eigen::Ref<const Eigen::Matrix3Xd>& points);

}  // namespace dlo::energy_model
