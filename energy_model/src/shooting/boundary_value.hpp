#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "base/deadline.hpp"
#include "kirchhoff/rod_flow.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {

/// The rod's frame at the clamps of a span: its first directors, unit and across the directions.
struct ShotFrames {
  Eigen::Vector3d start;
  Eigen::Vector3d end;
};

struct ShootingOptions {
  double tolerance = 1e-13;  ///< of the integrator, see follow_rod
  bool planar = false;       ///< stay in the span's plane
  int max_iterations = 60;   ///< Newton steps
  Deadline deadline{};       ///< the result is a failure once it has passed
  /// Of a rod with twist, in space; its torque is unknown. The start's d are those of its frame.
  std::optional<ShotFrames> frames{};
};

struct [[nodiscard]] ShootingResult {
  bool converged = false;
  std::string message = "never ran";
  int shots = 0;  ///< integrations of the whole span, with or without linearisation
  double residual =
      -1;  ///< largest gap in r, t, b v / f, n / f^2 at a node, f^2 the largest |n| or 1
  std::vector<RodState> nodes;  ///< n is the force after the node
};

/// Multiple shooting: the span is integrated from every node of the mesh to the next, and Newton's
/// method closes the gaps in r, t, b v and n (which jumps by a load). At a grip the position is
/// given and n free instead; at a clamp t is given, at a free end v = n = 0. At each node Newton
/// moves in minimal coordinates: r and n, a turn of t and a change of v across t, which makes the
/// system square. Of a rod with held frames Newton also turns the frames about t, which twist by M
/// h / c over an interval h, and changes M at each node: so whole turns are counted and the matrix
/// stays banded. close_gaps.hpp says how it steps.
///
/// Well posed for soft rods as long as the intervals are not much longer than |n|^(-1/2), over
/// which errors grow e-fold.
/// @param start  one for each node of the mesh
ShootingResult shoot(const RodSpan& span, const RodMesh& mesh, const std::vector<RodState>& start,
                     const ShootingOptions& options);

}  // namespace dlo::energy_model
