#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {

/// Returns initial guesses for relaxing a polygon, as frames of the intervals of a mesh. They are:
/// straight along a line; with tangents along the carried force; and at an angle a(x) to the line,
/// x in [0, 1] along the span, towards each of several normals,
///     a = A cos(pi x) (arch),  A sin(2 pi x) (arch with straight ends),  A cos(2 pi x) (S),
///     2 pi x (loop),
/// where A fits the distance of the outermost grips. The line connects these grips, or has the
/// direction of a clamp. In a plane there are two normals, in space six or four around the line.
/// For a rod that is not round there are two more: its natural shape from its first clamp on, and
/// tangents against the force. A round rod may be in equilibrium in the latter and stay there. In
/// space, guesses that would lie in a plane are tilted out of it.
[[nodiscard]] std::vector<std::vector<Eigen::Quaterniond>> polygon_starts(const RodSpan& span,
                                                                          const RodMesh& mesh,
                                                                          Motion motion);

}  // namespace dlo::energy_model
