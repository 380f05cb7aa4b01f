#pragma once

#include <Eigen/Core>

#include "dlo/force_model/environment.hpp"

namespace dlo::force_model {

/// What a solid does at one look.
struct SolidPush {
  Eigen::Index point = 0;  ///< before it
  double share = 0;        ///< of the way from there to the next point
  obstacle::Gap gap;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N]
};

/// Calls action(SolidPush) for each look that finds the rod within a solid.
/// @param at  position of a point by its index;  @param count  of points
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
