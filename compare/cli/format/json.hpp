#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "dlo/compare/compared_state.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/effective_modulus.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::cli {

using Json = nlohmann::ordered_json;

/// A document as every command writes it: NaN and infinity are null, and what is no UTF-8 in the
/// name of a file becomes U+FFFD. Keys that had another name before 0.2 are there by both.
[[nodiscard]] std::string json_text(const Json& document);

[[nodiscard]] Json to_json(const Eigen::Vector3d& vector);
[[nodiscard]] Json deviation_json(const compare::Deviation& deviation);
[[nodiscard]] Json modulus_json(const compare::EffectiveModulus& modulus);
[[nodiscard]] Json points_json(const Eigen::Matrix3Xd& points);
/// An object each with `force_N`. @param forces  of obstacles on the rod [N]
[[nodiscard]] Json obstacles_json(const std::vector<Eigen::Vector3d>& forces);
[[nodiscard]] Json parameters_json(const compare::Solution& force,
                                   const compare::ForceModelSettings& settings);
[[nodiscard]] Json to_json(const compare::ComparedState& state);

}  // namespace dlo::cli
