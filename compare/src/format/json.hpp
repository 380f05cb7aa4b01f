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
using compare::points_json;
using compare::text_or_null;
using compare::to_json;

/// A document as every command writes it: NaN and infinity are null, and what is no UTF-8 in the
/// name of a file becomes U+FFFD.
[[nodiscard]] std::string json_text(const Json& document);

[[nodiscard]] Json modulus_json(const compare::EffectiveModulus& modulus);
/// An object each with `force_N` and `torque_Nm`.
[[nodiscard]] Json loads_json(const std::vector<compare::GripperLoad>& loads);
/// An object each with `force_N`. @param forces  of obstacles on the rod [N]
[[nodiscard]] Json obstacles_json(const std::vector<Eigen::Vector3d>& forces);
[[nodiscard]] Json parameters_json(const compare::Solution& force,
                                   const compare::ForceModelSettings& settings);
[[nodiscard]] Json to_json(const compare::ComparedState& state);

}  // namespace dlo::cli
