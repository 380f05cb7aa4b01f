#include "solve/held_frames.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/quote.hpp"
#include "dlo/energy_model/turns.hpp"
#include "polygon/energy_problems.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

Eigen::Vector3d direction_of(const Eigen::Matrix3Xd& points, Eigen::Index segment) {
  return (points.col(segment + 1) - points.col(segment)).normalized();
}

/// Returns the first director of the frame that a clamp holds, rotated by the clamp's roll about
/// the held segment.
Eigen::Vector3d rolled_d1(const energy_model::Problem& problem, const energy_model::Grip& clamp,
                          const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(clamp.frame->roll, axis) * energy_model::held_d1(problem, clamp);
}

/// Returns the difference between the turns that the grips hold and those of a shape, an integer.
/// Each passage of the rod through itself changes it by two.
double missing_turns(const Linking& part) {
  return std::round(part.held - part.twist - part.writhe);
}

std::string missing_turns_message(const Linking& part) {
  const bool odd = std::fmod(missing_turns(part), 2) != 0;
  return formatted(
      "not verified: the grips hold {:.3f} turns from s = {:g} to {:g} m and the shape has "
      "{:.3f} (twist {:.3f}, writhe {:.3f}): {}",
      part.held, part.begin, part.end, part.twist + part.writhe, part.twist, part.writhe,
      odd ? "its frames are a path of the other homotopy class" : "it has passed through itself");
}

/// Returns the axis of the shortest rotation between the directions of the clamps at the ends of a
/// part.
Eigen::Vector3d shortest_axis(const Scene& scene, const Linking& part) {
  std::array<Eigen::Vector3d, 2> ends = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (const Gripper& gripper : scene.grippers) {
    if (gripper.at == part.begin) ends[0] = gripper.direction.value_or(ends[0]);
    if (gripper.at == part.end) ends[1] = gripper.direction.value_or(ends[1]);
  }
  return ends[0].cross(ends[1]);
}

/// Whether the directions of a part's clamps are opposite at some time between two scenes: the axis
/// of the shortest rotation then reverses.
bool directions_become_opposite(const Scene& before, const Scene& after, const Linking& part) {
  return shortest_axis(before, part).dot(shortest_axis(after, part)) < 0;
}

}  // namespace

std::vector<std::size_t> framed_grippers(const Scene& scene) {
  std::vector<std::size_t> framed;
  for (const Gripper* gripper : grippers_by_arc_length(scene)) {
    if (!gripper->frame) continue;
    framed.push_back(static_cast<std::size_t>(gripper - scene.grippers.data()));
  }
  return framed;
}

force_model::TwistedSpan held_span(const energy_model::Problem& problem, std::size_t first,
                                   std::size_t last, Eigen::Index first_segment,
                                   Eigen::Index last_segment, const Eigen::Matrix3Xd& points) {
  const energy_model::Grip& before = problem.grips[first];
  const energy_model::Grip& held = problem.grips[last];
  const Eigen::Vector3d from = direction_of(points, first_segment);
  const Eigen::Vector3d to = direction_of(points, last_segment);
  force_model::TwistedSpan span{.first_segment = first_segment,
                                .last_segment = last_segment,
                                .first_d1 = energy_model::held_d1(problem, before),
                                .last_d1 = energy_model::held_d1(problem, held),
                                .compliance = 1};
  const double frame_angle = force_model::twist_angle(span, points);
  const std::optional<energy_model::Writhe> writhe = energy_model::writhe(
      points.middleCols(first_segment, last_segment - first_segment + 1), from, to);
  span.angle = energy_model::end_rotation(energy_model::prescribed_turns(problem, before, held),
                                          frame_angle, 0, writhe);
  span.first_d1 = rolled_d1(problem, before, from);
  span.last_d1 = rolled_d1(problem, held, to);
  return span;
}

force_model::Rod with_frames(const Scene& scene, const Discretisation& discretisation,
                             const Eigen::Matrix3Xd& untwisted) {
  force_model::Rod rod = discretisation.rod;
  const std::vector<std::size_t> framed = framed_grippers(scene);
  rod.twist.angles.resize(static_cast<Eigen::Index>(framed.size()) - 1);
  const energy_model::Problem problem = energy_problem(scene);
  for (std::size_t k = 0; k < framed.size(); ++k) {
    force_model::Grip& grip = rod.grips[framed[k]];
    grip.d1 = rolled_d1(problem, problem.grips[framed[k]], direction_of(grip.targets, 0));
    if (k == 0) continue;
    const Eigen::Index first = rod.grips[framed[k - 1]].first_point;
    rod.twist.angles[static_cast<Eigen::Index>(k) - 1] =
        held_span(problem, framed[k - 1], framed[k], first, grip.first_point, untwisted).angle;
  }
  return rod;
}

std::vector<energy_model::TwistedPart> twisted_parts(const Scene& scene,
                                                     const force_model::Rod& rod,
                                                     const Eigen::Matrix3Xd& points) {
  std::vector<energy_model::TwistedPart> parts;
  const std::vector<std::size_t> framed = framed_grippers(scene);
  for (const force_model::TwistedSpan& span : force_model::twisted_spans(rod)) {
    const std::size_t k = parts.size();
    const double angle = force_model::twist_angle(span, points);
    parts.push_back({.begin = scene.grippers[framed[k]].at,
                     .end = scene.grippers[framed[k + 1]].at,
                     .angle = angle,
                     .torque = angle / span.compliance});
  }
  return parts;
}

void add_twisting_torques(const force_model::Rod& rod, const Eigen::Matrix3Xd& points,
                          std::vector<GripperLoad>& grippers) {
  for (const force_model::TwistedSpan& span : force_model::twisted_spans(rod)) {
    const double moment = force_model::twist_angle(span, points) / span.compliance;
    for (std::size_t i = 0; i < rod.grips.size(); ++i) {
      const Eigen::Index held = rod.grips[i].first_point;
      if (!rod.grips[i].d1) continue;
      if (held == span.first_segment) grippers[i].torque -= moment * direction_of(points, held);
      if (held == span.last_segment) grippers[i].torque += moment * direction_of(points, held);
    }
  }
}

std::vector<Linking> linking_of(const Scene& scene, const energy_model::Equilibrium& equilibrium) {
  std::vector<Linking> parts;
  if (equilibrium.twists.empty()) return parts;
  const energy_model::Problem problem = energy_problem(scene);
  std::vector<const energy_model::Grip*> framed;
  for (const energy_model::Grip& grip : problem.grips) {
    if (grip.frame) framed.push_back(&grip);
  }
  std::ranges::sort(framed, {}, &energy_model::Grip::at);
  for (const energy_model::TwistedPart& twist : equilibrium.twists) {
    const auto last = std::ranges::find_if(
        framed, [&](const energy_model::Grip* grip) { return grip->at >= twist.end; });
    if (last == framed.begin() || last == framed.end()) continue;
    const std::optional<energy_model::Writhe> writhe =
        energy_model::writhe(equilibrium.sample, twist.begin, twist.end);
    std::optional<double> held = energy_model::held_turns(problem, **(last - 1), **last);
    if (!writhe || !held) continue;
    Linking part{.begin = twist.begin,
                 .end = twist.end,
                 .twist = twist.angle / (2 * std::numbers::pi),
                 .writhe_error = writhe->error};
    part.writhe = energy_model::nearest_writhe(*writhe, *held - part.twist);
    // A roll is counted from the twist of the rod without it.
    if (!energy_model::prescribed_turns(problem, **(last - 1), **last).turns) {
      *held += std::round(part.twist + part.writhe - *held);
    }
    part.held = *held;
    parts.push_back(part);
  }
  return parts;
}

std::string turns_mismatch_message(const std::vector<Linking>& parts) {
  for (const Linking& part : parts) {
    if (missing_turns(part) != 0) return missing_turns_message(part);
  }
  return {};
}

std::string turns_mismatch_message(const Scene& before, const std::vector<Linking>& parts_before,
                                   const Scene& after, const std::vector<Linking>& parts_after) {
  for (const Linking& part : parts_after) {
    const auto was = std::ranges::find(parts_before, part.begin, &Linking::begin);
    if (was == parts_before.end()) continue;
    const double lost = missing_turns(part) - missing_turns(*was);
    const bool reverses = directions_become_opposite(before, after, part);
    if (lost != 0 && !(reverses && std::abs(lost) == 1)) return missing_turns_message(part);
  }
  return {};
}

}  // namespace dlo::compare
