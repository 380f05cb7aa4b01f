#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::compare {

/// The sum of what depends on a shape, drag and forces that follow the rod, before arc lengths [N]:
/// at the rod's end without what acts there, as a tension counts. Drag by Gauss's rule between
/// where the tangent has kinks in its rate.
[[nodiscard]] std::vector<Eigen::Vector3d> shape_loads_before(
    const Scene& scene, const energy_model::Equilibrium& shape,
    const std::vector<double>& arc_lengths);

}  // namespace dlo::compare
