#include "solve/linking.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/quote.hpp"
#include "dlo/energy_model/turns.hpp"
#include "polygon/energy_problems.hpp"

namespace dlo::compare {
namespace {

/// By how many turns a shape differs from those that are held, a whole number. Each passage through
/// itself takes or gives two.
double turns_lost(const Linking& part) { return std::round(part.held - part.twist - part.writhe); }

std::string why_lost(const Linking& part) {
  const bool odd = std::fmod(turns_lost(part), 2) != 0;
  return formatted(
      "not verified: the grips hold {:.3f} turns from s = {:g} to {:g} m and the shape has "
      "{:.3f} (twist {:.3f}, writhe {:.3f}): {}",
      part.held, part.begin, part.end, part.twist + part.writhe, part.twist, part.writhe,
      odd ? "its frames are a path of the other homotopy class" : "it has passed through itself");
}

/// Axis of the shortest rotation between the directions of the clamps at the ends of a part.
Eigen::Vector3d shortest_axis(const Scene& scene, const Linking& part) {
  std::array<Eigen::Vector3d, 2> ends = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (const Gripper& gripper : scene.grippers) {
    if (gripper.at == part.begin) ends[0] = gripper.direction.value_or(ends[0]);
    if (gripper.at == part.end) ends[1] = gripper.direction.value_or(ends[1]);
  }
  return ends[0].cross(ends[1]);
}

/// Whether the directions of its clamps are opposite between two times: the axis reverses.
bool passes_opposite(const Scene& before, const Scene& after, const Linking& part) {
  return shortest_axis(before, part).dot(shortest_axis(after, part)) < 0;
}

}  // namespace

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
    // A roll counts from the rod as it lies without it.
    if (!energy_model::turns_between(problem, **(last - 1), **last).turns) {
      *held += std::round(part.twist + part.writhe - *held);
    }
    part.held = *held;
    parts.push_back(part);
  }
  return parts;
}

std::string lost_turns(const std::vector<Linking>& parts) {
  for (const Linking& part : parts) {
    if (turns_lost(part) != 0) return why_lost(part);
  }
  return {};
}

std::string lost_turns(const Scene& before, const std::vector<Linking>& parts_before,
                       const Scene& after, const std::vector<Linking>& parts_after) {
  for (const Linking& part : parts_after) {
    const auto was = std::ranges::find(parts_before, part.begin, &Linking::begin);
    if (was == parts_before.end()) continue;
    const double lost = turns_lost(part) - turns_lost(*was);
    const bool reverses = passes_opposite(before, after, part);
    if (lost != 0 && !(reverses && std::abs(lost) == 1)) return why_lost(part);
  }
  return {};
}

}  // namespace dlo::compare
