#pragma once

#include <Eigen/Core>

namespace dlo::force_model {

/// Adds the inner force of contraction on every point (paper, Formulas 1 and 2).
///     dL_i = (|P_{i+1} - P_i| - L_i) / L_i,   E_i = (P_{i+1} - P_i) / |.|,   F_i = c_c dL_i E_i
///     on P_i: F_i - F_{i-1}
/// A segment of zero length has no direction; it is pushed apart along the line through its two
/// neighbours, or along +x when these coincide as well, so the force is always finite.
/// @param points        positions [m], 3 x (n+1), n >= 1
/// @param rest_lengths  L_i, the paper's L_s for each segment [m], n, > 0
/// @param c_c           stretch stiffness [N], >= 0
/// @param[in,out] forces  added to, not overwritten [N], 3 x (n+1)
/// @throws std::invalid_argument if a shape or number is out of range
void add_contraction_forces(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                            const Eigen::Ref<const Eigen::VectorXd>& rest_lengths, double c_c,
                            Eigen::Ref<Eigen::Matrix3Xd> forces);

/// Returns the potential of these forces, the sum of c_c (|P_{i+1} - P_i| - L_i)^2 / (2 L_i) [J].
/// Arguments and errors as for add_contraction_forces.
[[nodiscard]] double contraction_energy(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                        const Eigen::Ref<const Eigen::VectorXd>& rest_lengths,
                                        double c_c);

}  // namespace dlo::force_model
