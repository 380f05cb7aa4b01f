#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "base/deadline.hpp"
#include "dlo/energy_model/problem.hpp"
#include "kirchhoff/relaxed_polygon.hpp"
#include "problem/split.hpp"
#include "span/span_solver.hpp"

namespace dlo::energy_model {

/// The lowest minima of a coarse polygon, lowest first: the initial guesses of solve_exact(). For a
/// planar span they include minima in its plane and out of it. There are none if clamps transmit a
/// torque, which the polygon does not model.
class PolygonFields {
 public:
  PolygonFields(const Problem& problem, const PlacedSpan& placed, const Deadline& deadline);

  [[nodiscard]] std::size_t size() const { return minima_.size(); }
  /// Returns the tangents of one minimum, in the span's frame. If the grips' forces bend it within
  /// less than a segment, it is first relaxed with shorter segments.
  [[nodiscard]] TangentField field(std::size_t index) const;

 private:
  Deadline deadline_;
  bool reversed_;
  Eigen::Matrix3d frame_;
  std::optional<RodSpan> span_;
  double longest_ = 0;  // longest interval of the mesh
  std::vector<RelaxedPolygon> minima_;
};

}  // namespace dlo::energy_model
