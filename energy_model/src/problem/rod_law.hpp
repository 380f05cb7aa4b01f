#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/energy_model/natural_frame.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// The rod from end to end as parts of one section each, by growing arc length.
[[nodiscard]] std::vector<Section> rod_parts(const Problem& problem);

/// Strains of the free rod at an arc length [1/m].
[[nodiscard]] Eigen::Vector3d natural_strain(const Problem& problem, double arc_length);

/// Frame (columns d1, d2, t) of a clamp that has this d1 before it is rolled.
[[nodiscard]] Eigen::Matrix3d held_frame(const Grip& clamp, const Eigen::Vector3d& d1);

}  // namespace dlo::energy_model
