#pragma once

#include <Eigen/Core>
#include <vector>

#include "problem/span.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// An arc length at which a contact begins or ends and which is not given: where a rod that
/// touches at one point is parallel to the obstacle, and where a lying part lifts off without a
/// moment, that is with no curvature towards the obstacle.
struct FreeBoundary {
  std::size_t contact = 0;  ///< of Span::contacts
  bool begins = true;       ///< the part that lies; or, of one that touches, where it does

  [[nodiscard]] double at(const Span& span) const;
  void move(Span& span, double way) const;
};

/// All of a span's, by growing s.
[[nodiscard]] std::vector<FreeBoundary> free_boundaries(const Span& span);

/// Residual there: of one that touches and slides the way to where it is nearest; of one that
/// is held the slope of the clearance times the length of the shorter piece beside it, because the
/// way would be slope over curvature, which is 0 / 0 where the rod begins to lie; of a lying part
/// the second derivative of the clearance times the length of the free piece beside it.
[[nodiscard]] Eigen::VectorXd free_boundary_residual(const SpanSolution& solution,
                                                     const std::vector<FreeBoundary>& ends);

/// How far a lift-off may be moved down and up without passing what is beside it.
struct Room {
  double down = 0, up = 0;
};
[[nodiscard]] Room room_of(const Span& span, const FreeBoundary& end);

}  // namespace dlo::energy_model
