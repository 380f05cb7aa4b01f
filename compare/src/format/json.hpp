#pragma once

#include <string>
#include <vector>

#include "base/quote.hpp"
#include "dlo/compare/compared_state.hpp"
#include "dlo/compare/effective_modulus.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/solution.hpp"
#include "record/field.hpp"

namespace dlo::cli {

using compare::append;
using compare::Json;
using compare::json_list;
using compare::json_or_null;
using compare::picked;
using compare::points_json;
using compare::text_or_null;
using compare::to_json;

/// Returns a document as text, as every command writes it: NaN and infinity become null, -0 becomes
/// 0, and invalid UTF-8 in a text becomes U+FFFD.
[[nodiscard]] std::string json_text(const Json& document);

[[nodiscard]] Json modulus_json(const compare::EffectiveModulus& modulus);
/// Returns an object with `force_N` and `torque_Nm` for each gripper.
[[nodiscard]] Json loads_json(const std::vector<compare::GripperLoad>& loads);
/// Returns an object with `force_N` for each obstacle. @param forces  of obstacles on the rod [N]
[[nodiscard]] Json obstacles_json(const std::vector<Eigen::Vector3d>& forces);
[[nodiscard]] Json parameters_json(const compare::Solution& force,
                                   const compare::ForceModelSettings& settings);
[[nodiscard]] Json to_json(const compare::ComparedEquilibrium& state);

}  // namespace dlo::cli
