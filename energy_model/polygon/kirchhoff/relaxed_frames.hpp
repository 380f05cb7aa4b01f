#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "base/deadline.hpp"
#include "kirchhoff/relaxed_polygon.hpp"
#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {

/// Computes relax_polygon() for any rod by NLopt's L-BFGS on the components of the quaternions,
/// with an augmented Lagrangian that closes the gaps at the grips.
[[nodiscard]] RelaxedPolygon relax_frames(const RodSpan& span, const RodMesh& mesh,
                                          const std::vector<Eigen::Quaterniond>& start,
                                          Motion motion, const Deadline& deadline);

}  // namespace dlo::energy_model
