#include "curved/curved_rod.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "dlo/energy_model/turns.hpp"
#include "problem/rod_law.hpp"

namespace dlo::energy_model {
namespace {

/// In the rod's axes; what is out of the plane by rounding is in it, so that planar shapes stay
/// planar.
Eigen::Vector3d in_axes(const Eigen::Matrix3d& axes, const Eigen::Vector3d& v) {
  constexpr double noise = 1e-14;
  Eigen::Vector3d own = axes.transpose() * v;
  for (double& component : own) {
    if (std::abs(component) < noise * own.norm()) component = 0;
  }
  return own;
}

Eigen::Matrix3d axes_of(const Problem& problem) {
  if (first_clamp(problem)) return first_frame(problem);
  // Nothing holds the frame of a rod on pins: its plane has the second axis for a normal.
  const std::optional<Eigen::Vector3d> normal = natural_normal(problem);
  const Eigen::Vector3d d2 = normal.value_or(Eigen::Vector3d::UnitZ());
  return frame_of(d2.unitOrthogonal(), d2.unitOrthogonal().cross(d2));
}

}  // namespace

bool CurvedRod::planar() const {
  bool flat = true;
  for (const RodSpan::Hold& hold : span.holds) {
    flat = flat && hold.position.y() == span.holds.front().position.y();
  }
  for (const RodSpan::Load& load : span.loads) flat = flat && load.force.y() == 0;
  for (const RodSpan::Part& part : span.parts) flat = flat && part.section.weight.y() == 0;
  for (const RodSpan::Clamp& clamp : span.clamps) flat = flat && clamp.direction.y() == 0;
  // A polynomial of the second strain alone has only zeros of the others.
  constexpr int probes = 24;
  for (int i = 0; i <= probes; ++i) {
    const Eigen::Vector3d u = span.natural(static_cast<double>(i) / probes);
    flat = flat && u[0] == 0 && u[2] == 0;
  }
  return flat;
}

CurvedRod make_curved_rod(const Problem& problem) {
  CurvedRod rod;
  rod.axes = axes_of(problem);
  rod.origin = problem.grips.front().position;
  rod.length = problem.length;
  rod.span = uncut(problem);
  for (RodSpan::Hold& hold : rod.span.holds) hold.position = in_axes(rod.axes, hold.position);
  for (RodSpan::Load& load : rod.span.loads) load.force = in_axes(rod.axes, load.force);
  for (RodSpan::Part& part : rod.span.parts) {
    part.section.weight = in_axes(rod.axes, part.section.weight);
  }
  Grip first;
  for (const RodSpan::Hold& hold : rod.span.holds) {
    const Grip& grip = problem.grips[hold.grip];
    if (!grip.direction) continue;
    RodSpan::Clamp clamp{hold.at, in_axes(rod.axes, grip.direction->normalized()), {}};
    if (rod.span.clamps.empty()) {
      clamp.direction = Eigen::Vector3d::UnitZ();
      first = grip;
      if (!first.frame) first.frame = FrameHold{};
      rod.first_roll = first.frame->roll;
    } else if (grip.frame) {
      clamp.frame = RodSpan::Frame{in_axes(rod.axes, held_d1(problem, grip)),
                                   turns_between(problem, first, grip)};
    }
    rod.span.clamps.push_back(clamp);
  }
  rod.span.natural = [problem](double s) {
    return Eigen::Vector3d(problem.length * natural_strain(problem, s * problem.length));
  };
  return rod;
}

}  // namespace dlo::energy_model
