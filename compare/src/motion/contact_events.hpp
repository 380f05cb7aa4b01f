#pragma once

#include <cstddef>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::compare {

/// A contact that begins, ends or changes its kind from one frame to the next.
struct ContactChange {
  bool begins = true;              ///< contact begins, or a point contact becomes a line contact
  energy_model::ContactPart part;  ///< the contact after the change; if it ends, before the change
  bool goes_on = false;            ///< the contact existed before, or continues to exist
};

/// Returns the changes from the contacts of one frame to those of the next. Contacts on one
/// obstacle are paired in the order of their arc lengths, the nearest ones if their numbers differ.
/// If a point contact becomes a line contact, the change begins and goes on; in the opposite case
/// it ends and goes on. A change between the rod's tip and its inside begins and goes on.
/// @param before, after  in the order of arc lengths
[[nodiscard]] std::vector<ContactChange> contact_changes(
    const std::vector<energy_model::ContactPart>& before,
    const std::vector<energy_model::ContactPart>& after);

}  // namespace dlo::compare
