#include "dlo/energy_model/couple_zero.hpp"

#include <vector>

#include "problem/rod_law.hpp"

namespace dlo::energy_model {

CoupleZero couple_zero(const Problem& problem, const Load& load) {
  const double tolerance = 1e-9 * problem.length;
  const std::vector<OrderedGrip> grips = ordered_grips(problem);
  const Grip* clamp = nullptr;
  for (const OrderedGrip& grip : grips) {
    if (!grip.grip->direction) continue;
    if (clamp == nullptr || grip.grip->at <= load.at + tolerance) clamp = grip.grip;
  }
  if (clamp != nullptr) return {clamp->at, clamp->direction->normalized()};
  for (const OrderedGrip& grip : grips) {
    const Eigen::Vector3d chord = grip.grip->position - grips.front().grip->position;
    if (chord.norm() > tolerance) return {0, chord.normalized()};
  }
  return {0, plane_across(load.torque).front()};
}

}  // namespace dlo::energy_model
