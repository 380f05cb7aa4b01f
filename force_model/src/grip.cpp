#include "dlo/force_model/grip.hpp"

#include "require.hpp"

namespace dlo::force_model {

Eigen::Matrix3Xd grip_targets(const Eigen::Vector3d& position, const Eigen::Vector3d& direction,
                              double segment_length, double behind) {
  require_positive("grip_targets", "|direction|", direction.norm());
  require_positive("grip_targets", "segment_length", segment_length);
  require(std::isfinite(behind), "grip_targets", "behind", behind, "finite");
  require(position.allFinite(), "grip_targets", "|position|", position.norm(), "finite");
  const Eigen::Vector3d t = direction.normalized();
  Eigen::Matrix3Xd targets(3, 2);
  targets.col(0) = position - behind * t;
  targets.col(1) = position + (segment_length - behind) * t;
  return targets;
}

}  // namespace dlo::force_model
