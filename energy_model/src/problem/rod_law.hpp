#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/energy_model/natural_frame.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// The rod from end to end as parts of one section each, by growing arc length.
[[nodiscard]] std::vector<Section> rod_parts(const Problem& problem);

/// The smaller EI outside sections [N m^2]: what stiffnesses, and with the length forces, are
/// measured in, so that a strip's scales are those of the axis about which it yields.
[[nodiscard]] double bending_unit(const Problem& problem);

/// Whether it or one of its sections has a bending_stiffness_2.
[[nodiscard]] bool has_two_stiffnesses(const Problem& problem);

/// EI about d1 and d2 and GJ, over a unit [N m^2].
[[nodiscard]] Eigen::Vector3d principal_stiffness(const Section& section, double unit);

/// Strains of the stress-free shape at an arc length [1/m].
[[nodiscard]] Eigen::Vector3d natural_strain(const Problem& problem, double arc_length);

/// Frame (columns d1, d2, t) of a clamp that has this d1 before it is rolled.
[[nodiscard]] Eigen::Matrix3d held_frame(const Grip& clamp, const Eigen::Vector3d& d1);

}  // namespace dlo::energy_model
