#pragma once

#include <Eigen/Core>

#include "dlo/force_model/environment.hpp"

namespace dlo::force_model {

/// Force of a solid at one sample of the rod.
struct SolidPush {
  Eigen::Index point = 0;  ///< index of the point before the sample
  double share = 0;        ///< position of the sample between that point and the next, 0 to 1
  obstacle::Gap gap;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N]
};

/// Calls action(SolidPush) for each sample inside a solid.
/// @param at  returns the position of a point by its index;  @param count  number of points
template <typename Position, typename Action>
void for_each_push(const Solid& solid, Eigen::Index count, const Position& at,
                   const Action& action) {
  const double stiffness = solid.stiffness / solid.samples;
  for (Eigen::Index i = 0; i < count; ++i) {
    const int samples = i + 1 < count ? solid.samples : 1;
    const Eigen::Vector3d here = at(i);
    for (int k = 0; k < samples; ++k) {
      SolidPush push{.point = i, .share = static_cast<double>(k) / solid.samples};
      Eigen::Vector3d position = here;
      if (k > 0) position += push.share * (at(i + 1) - here);
      if (solid.body.clearance(position) >= 0) continue;
      push.gap = solid.body.gap(position);
      push.force = -stiffness * push.gap.value * push.gap.gradient;
      action(push);
    }
  }
}

}  // namespace dlo::force_model
