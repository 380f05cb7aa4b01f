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

/// The lowest minima of a coarse polygon, lowest first: those that solve_exact() shoots from. For a
/// planar span those in its plane and those out of it. None where clamps pass a torque on, of which
/// the polygon knows nothing.
class PolygonFields {
 public:
  PolygonFields(const Problem& problem, const PlacedSpan& placed, const Deadline& deadline);

  [[nodiscard]] std::size_t size() const { return minima_.size(); }
  /// Tangents of one of them, in the span's frame. Where what the grips do to it bends it within
  /// less than its segments, it is first relaxed with shorter ones, from where it is.
  [[nodiscard]] TangentField field(std::size_t index) const;

 private:
  Deadline deadline_;
  bool reversed_;
  Eigen::Matrix3d frame_;
  std::optional<RodSpan> span_;
  double longest_ = 0;  // interval
  std::vector<RelaxedPolygon> minima_;
};

}  // namespace dlo::energy_model
