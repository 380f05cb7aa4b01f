#pragma once

#include "dlo/compare/force_model_settings.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

/// Reads the table [force_model].
/// @throws InputError that names file, line, key, value and what is allowed; check() rejects
/// settings that contradict each other
[[nodiscard]] ForceModelSettings read_force_model(StrictTable& table);

}  // namespace dlo::compare
