#include "suite/gate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace dlo::compare {
namespace {

int cause_count(const CardGroup& group, const std::string& name) {
  const auto found = std::find_if(group.causes.begin(), group.causes.end(),
                                  [&](const auto& cause) { return cause.first == name; });
  return found == group.causes.end() ? 0 : found->second;
}

/// What is worse; empty if nothing is.
std::string worse_in(const Card& card, const CardGroup& before, const CardGroup& now,
                     const RegressionTolerance& tolerance) {
  if (now.solved < before.solved) {
    return fmt::format("{} scenes are solved, {} were", now.solved, before.solved);
  }
  for (const auto& [name, count] : now.causes) {
    const int known = cause_count(before, name);
    if (count > known) return fmt::format("{}: in {} scenes, was in {}", name, count, known);
  }
  for (std::size_t i = 0; i < now.largest.size(); ++i) {
    const double allowed =
        before.largest[i] + tolerance.absolute + tolerance.relative * before.largest[i];
    if (!(now.largest[i] > allowed)) continue;
    return fmt::format("error {:.3g} % of l with N = {}, was {:.3g} %", now.largest[i] * 100,
                       card.points[i], before.largest[i] * 100);
  }
  return {};
}

bool is_better(const CardGroup& before, const CardGroup& now,
               const RegressionTolerance& tolerance) {
  if (now.solved > before.solved || now.causes.size() < before.causes.size()) return true;
  for (std::size_t i = 0; i < now.largest.size(); ++i) {
    const double allowed =
        before.largest[i] - tolerance.absolute - tolerance.relative * before.largest[i];
    if (now.largest[i] < allowed) return true;
  }
  return false;
}

GroupChange group_change(const Card& card, const Card* before, const CardGroup& now,
                         const RegressionTolerance& tolerance) {
  GroupChange change{.simulator = card.simulator, .group = now.name};
  std::optional<CardGroup> known;
  if (before != nullptr) {
    for (CardGroup& group : before->groups()) {
      if (group.name == now.name) known = std::move(group);
    }
  }
  if (!known) {
    change.verdict = RegressionVerdict::not_in_baseline;
    change.message = "the earlier card does not have it";
    return change;
  }
  if (before->points != card.points || before->battery_version != card.battery_version ||
      known->scenes != now.scenes) {
    change.verdict = RegressionVerdict::changed;
    change.message = "other scenes, another version of the battery or other N";
    return change;
  }
  change.message = worse_in(card, *known, now, tolerance);
  if (!change.message.empty()) {
    change.verdict = RegressionVerdict::worse;
  } else if (is_better(*known, now, tolerance)) {
    change.verdict = RegressionVerdict::better;
  }
  return change;
}

}  // namespace

std::vector<GroupChange> compare_cards(const std::vector<Card>& before,
                                       const std::vector<Card>& now,
                                       const RegressionTolerance& tolerance) {
  std::vector<GroupChange> changes;
  for (const Card& card : now) {
    const auto earlier = std::find_if(before.begin(), before.end(), [&](const Card& one) {
      return one.simulator == card.simulator;
    });
    const Card* known = earlier == before.end() ? nullptr : &*earlier;
    for (const CardGroup& group : card.groups()) {
      changes.push_back(group_change(card, known, group, tolerance));
    }
  }
  return changes;
}

bool passes(const std::vector<GroupChange>& changes) {
  return std::none_of(changes.begin(), changes.end(), [](const GroupChange& change) {
    return change.verdict == RegressionVerdict::worse ||
           change.verdict == RegressionVerdict::changed;
  });
}

}  // namespace dlo::compare
