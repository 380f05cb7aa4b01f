#include "format/json.hpp"

namespace dlo::cli {
namespace {

/// Removes the sign of every -0.
void remove_signs_of_zero(Json& value) {
  if (value.is_number_float()) value = value.get<double>() + 0.0;
  if (!value.is_structured()) return;
  for (Json& part : value) remove_signs_of_zero(part);
}

}  // namespace

std::string json_text(const Json& document) {
  Json whole = document;
  remove_signs_of_zero(whole);
  return whole.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json modulus_json(const compare::EffectiveModulus& modulus) {
  const bool none = modulus.optimum == compare::Optimum::none;
  // JSON represents NaN as null.
  return {{"effective_modulus_ratio", modulus.ratio},
          {"rms_at_effective_modulus_m", modulus.rms_m},
          {"effective_modulus_explains_share", modulus.explained_share},
          {"effective_modulus_at_bifurcation", none ? Json() : Json(modulus.at_bifurcation)},
          {"optimum", none ? Json() : Json(compare::to_string(modulus.optimum))},
          {"why_no_effective_modulus", none ? Json(modulus.missing_reason) : Json()}};
}

Json to_json(const compare::ComparedEquilibrium& state) {
  Json others = json_list(state.others, [&](const compare::UncomparedEquilibrium& other) -> Json {
    return {{"stable", other.stable},
            {"energy_difference_J", other.energy_difference_J},
            {"rms_from_compared_m", other.rms_from_compared_m},
            {"rms_from_shape_m", other.rms_from_shape_m}};
  });
  return {
      {"energy_J", state.energy_J},       {"energy_above_lowest_J", state.energy_above_lowest_J()},
      {"rank_of_stable", state.rank},     {"stable_found", state.stable},
      {"unstable_found", state.unstable}, {"searched", state.searched},
      {"others", std::move(others)}};
}

Json loads_json(const std::vector<compare::GripperLoad>& loads) {
  return json_list(loads, [&](const compare::GripperLoad& load) -> Json {
    return {{"force_N", to_json(load.force)}, {"torque_Nm", to_json(load.torque)}};
  });
}

Json obstacles_json(const std::vector<Eigen::Vector3d>& forces) {
  return json_list(forces, [&](const Eigen::Vector3d& force) -> Json {
    return {{"force_N", to_json(force)}};
  });
}

Json parameters_json(const compare::Solution& force, const compare::ForceModelSettings& settings) {
  const compare::Parameters& p = force.parameters;
  Json result = {{"points", settings.points},
                 {"law", compare::to_string(settings.law)},
                 {"bookkeeping", compare::to_string(settings.bookkeeping)},
                 {"segment_length_m", p.segment_length},
                 {"c_c", p.c_c},
                 {"point_weight_N", p.point_weight}};
  if (settings.law == compare::BendingLaw::paper) {
    result["c_b"] = p.c_b;
    if (!settings.c_b) {
      result["bending_rule"] = compare::to_string(settings.bending_rule);
      result["design_curvature_per_m"] = p.design_curvature;
    }
  }
  if (force.steps > 0) {
    result["stepper"] = compare::to_string(settings.stepper);
    // Time steppers and Newton's method have neither c_F nor c_h.
    if (force.c_F > 0) {
      result["c_F"] = force.c_F;
      result["c_h"] = force.c_h;
    }
  }
  return result;
}

}  // namespace dlo::cli
