#pragma once

#include <cstddef>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::compare {

/// A part that touches now and did not before, or the other way round, or in another way.
struct ContactChange {
  bool begins = true;              ///< to touch, or to lie where it touched
  energy_model::ContactPart part;  ///< as it is then; where it ends, as it was before
  bool goes_on = false;            ///< touched there before, or does so afterwards
};

/// What has changed from one frame's contacts to the next one's. Parts on one obstacle are paired
/// in the order of their arc lengths, the nearest ones where they are not as many. A part that lies
/// where it touched at a point before begins (to lie) and goes on, and ends and goes on the other
/// way round; between the rod's tip and its inside it begins and goes on.
/// @param before, after  by arc length
[[nodiscard]] std::vector<ContactChange> contact_changes(
    const std::vector<energy_model::ContactPart>& before,
    const std::vector<energy_model::ContactPart>& after);

}  // namespace dlo::compare
