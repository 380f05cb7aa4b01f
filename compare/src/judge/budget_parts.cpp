#include "judge/budget_parts.hpp"

#include "record/solution_fields.hpp"

namespace dlo::compare {

std::span<const NamedPart> budget_parts() {
  static const NamedPart parts[] = {{"twist", &Budget::twist, true},
                                    {"natural curvature", &Budget::natural_curvature, true},
                                    {"law", &Budget::law},
                                    {"bookkeeping", &Budget::bookkeeping},
                                    {"discretisation", &Budget::discretisation},
                                    {"stretch", &Budget::stretch},
                                    {"contact", &Budget::contact},
                                    {"not at rest", &Budget::not_at_rest},
                                    {"interaction", &Budget::interaction}};
  return parts;
}

std::vector<std::pair<const char*, const BudgetPart*>> shown_parts(const Comparison& comparison) {
  std::vector<std::pair<const char*, const BudgetPart*>> parts;
  for (const NamedPart& part : budget_parts()) {
    const BudgetPart& value = comparison.budget.*part.of;
    const bool absent = part.is_neglected ? !neglects(comparison.force, part.name)
                                          : part.of == &Budget::contact && value.rms_m == 0;
    if (!absent) parts.emplace_back(part.name, &value);
  }
  return parts;
}

}  // namespace dlo::compare
