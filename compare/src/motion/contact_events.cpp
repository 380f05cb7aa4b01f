#include "motion/contact_events.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace dlo::compare {
namespace {

using energy_model::ContactKind;
using energy_model::ContactPart;
using PartList = std::vector<const ContactPart*>;

double middle_of(const ContactPart& part) { return (part.begin + part.end) / 2; }

PartList parts_on(std::size_t obstacle, const std::vector<ContactPart>& contacts) {
  PartList parts;
  for (const ContactPart& contact : contacts) {
    if (contact.obstacle == obstacle) parts.push_back(&contact);
  }
  return parts;
}

/// Pairs each of `fewer` with one of `more` in the same order, with the least sum of distances.
/// Returns for each of `more` whether it has a partner.
std::vector<bool> paired(const PartList& fewer, const PartList& more) {
  const std::size_t n = fewer.size();
  const std::size_t m = more.size();
  // least[i][j]: least sum for the first i of `fewer` among the first j of `more`
  std::vector<std::vector<double>> least(
      n + 1, std::vector<double>(m + 1, std::numeric_limits<double>::infinity()));
  for (std::size_t j = 0; j <= m; ++j) least[0][j] = 0;
  for (std::size_t i = 1; i <= n; ++i) {
    for (std::size_t j = i; j <= m; ++j) {
      const double pair =
          least[i - 1][j - 1] + std::abs(middle_of(*fewer[i - 1]) - middle_of(*more[j - 1]));
      least[i][j] = std::min(least[i][j - 1], pair);
    }
  }
  std::vector<bool> has_pair(m, false);
  std::size_t j = m;
  for (std::size_t i = n; i > 0; --i, --j) {
    while (least[i][j - 1] <= least[i][j]) --j;
    has_pair[j - 1] = true;
  }
  return has_pair;
}

void compare_pair(const ContactPart& before, const ContactPart& after,
                  std::vector<ContactChange>& changes) {
  if (before.kind == after.kind) return;
  const bool ends = before.kind == ContactKind::lying;
  changes.push_back({!ends, ends ? before : after, true});
}

}  // namespace

std::vector<ContactChange> contact_changes(const std::vector<ContactPart>& before,
                                           const std::vector<ContactPart>& after) {
  std::set<std::size_t> obstacles;
  for (const ContactPart& part : before) obstacles.insert(part.obstacle);
  for (const ContactPart& part : after) obstacles.insert(part.obstacle);
  std::vector<ContactChange> changes;
  for (const std::size_t obstacle : obstacles) {
    const PartList old_parts = parts_on(obstacle, before);
    const PartList new_parts = parts_on(obstacle, after);
    const bool begins = new_parts.size() > old_parts.size();
    const PartList& fewer = begins ? old_parts : new_parts;
    const PartList& more = begins ? new_parts : old_parts;
    const std::vector<bool> has_pair = paired(fewer, more);
    std::size_t next = 0;
    for (std::size_t j = 0; j < more.size(); ++j) {
      if (!has_pair[j]) {
        changes.push_back({begins, *more[j], false});
        continue;
      }
      const ContactPart& other = *fewer[next++];
      compare_pair(begins ? other : *more[j], begins ? *more[j] : other, changes);
    }
  }
  return changes;
}

}  // namespace dlo::compare
