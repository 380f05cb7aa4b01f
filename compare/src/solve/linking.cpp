#include "solve/linking.hpp"

#include <algorithm>
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
    const std::optional<double> writhe =
        energy_model::writhe(equilibrium.sample, twist.begin, twist.end);
    const std::optional<double> held = energy_model::held_turns(problem, **(last - 1), **last);
    if (!writhe || !held) continue;
    parts.push_back({.begin = twist.begin,
                     .end = twist.end,
                     .held = *held,
                     .twist = twist.angle / (2 * std::numbers::pi),
                     .writhe = *writhe});
  }
  return parts;
}

std::string lost_turns(const std::vector<Linking>& parts) {
  for (const Linking& part : parts) {
    if (turns_lost(part) == 0) continue;
    return formatted(
        "not verified: the grips hold {:.3f} turns from s = {:g} to {:g} m and the shape has "
        "{:.3f} "
        "(twist {:.3f}, writhe {:.3f}): it has passed through itself",
        part.held, part.begin, part.end, part.twist + part.writhe, part.twist, part.writhe);
  }
  return {};
}

}  // namespace dlo::compare
