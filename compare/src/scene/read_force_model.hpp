#pragma once

#include "dlo/compare/force_model_settings.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

/// Reads the table [force_model]. @throws InputError naming file, line, key, value and what is
/// allowed; settings that contradict each other are check()'s to refuse
[[nodiscard]] ForceModelSettings read_force_model(StrictTable& table);

}  // namespace dlo::compare
