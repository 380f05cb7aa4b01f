#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {

/// Frames of the intervals of a mesh from which a polygon is relaxed: straight along a line, their
/// tangents along the force that is carried, and at an angle a(x) to the line, x in [0, 1] along
/// the span, towards each of several normals,
///     a = A cos(pi x) (arch),  A sin(2 pi x) (arch with straight ends),  A cos(2 pi x) (S),
///     2 pi x (loop),
/// where A fits the distance of the outermost grips. The line is theirs, or a clamp's direction. In
/// the plane the normals are its two, in space six or four around the line. Of a rod that is not
/// round also its natural shape from its first clamp on, and tangents against the force: what is
/// round may be in equilibrium there, and stay. What of these would lie in a plane is
/// tilted out of it in space.
[[nodiscard]] std::vector<std::vector<Eigen::Quaterniond>> polygon_starts(const RodSpan& span,
                                                                          const RodMesh& mesh,
                                                                          Motion motion);

}  // namespace dlo::energy_model
