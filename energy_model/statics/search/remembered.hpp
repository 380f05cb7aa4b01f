#pragma once

#include <Eigen/Core>
#include <memory>

#include "problem/split.hpp"
#include "span/span_options.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// A span's last solution, to go on from; nothing after a failure.
struct Remembered {
  KnownShape last;
  KnownShape before;                                    ///< the one before it, without a factor
  std::shared_ptr<const SpanPoint> point;               ///< of `last`
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();  ///< PlacedSpan::frame

  [[nodiscard]] bool is_known() const { return last.model != nullptr; }
  [[nodiscard]] bool planar() const { return !is_known() || last.model->span().planar; }

  void remember(const SpanSolution& found, const PlacedSpan& placed);
  /// Its shape as a span sees it whose frame may be another one. At the nodes where they were,
  /// unless grips or loads have moved along the rod.
  [[nodiscard]] TangentField field(const PlacedSpan& placed) const;
};

/// The same of a span that clamps twist, which is followed without twist too.
struct RememberedTwist {
  Remembered untwisted, twisted;
  double twist = 0;   ///< of `twisted` [rad]
  double turned = 0;  ///< of the end's frame from where the untwisted rod has it [rad]
};

}  // namespace dlo::energy_model
