#include "format/json.hpp"

namespace dlo::cli {
namespace {

struct OldKey {
  const char* now;
  const char* before;
};

/// What people read before 0.2, which takes the old names away.
constexpr OldKey old_keys[] = {
    {"neglected", "left_out"},
    {"not_identified", "not_told"},
    {"reference_verified", "reference_resolved"},
    {"smallest_eigenvalue", "smallest_curvature"},
    {"smallest_eigenvalue_before", "smallest_curvature_before"},
};

void add_old_keys(Json& document) {
  if (!document.is_structured()) return;
  for (Json& value : document) add_old_keys(value);
  if (!document.is_object()) return;
  for (const OldKey& key : old_keys) {
    if (document.contains(key.now)) document[key.before] = Json(document.at(key.now));
  }
}

}  // namespace

std::string json_text(const Json& document) {
  Json whole = document;
  add_old_keys(whole);
  return whole.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json modulus_json(const compare::EffectiveModulus& modulus) {
  const bool none = modulus.optimum == compare::Optimum::none;
  // NaN is null.
  return {{"effective_modulus_ratio", modulus.ratio},
          {"rms_at_effective_modulus_m", modulus.rms_m},
          {"effective_modulus_explains_share", modulus.explained_share},
          {"effective_modulus_at_bifurcation", none ? Json() : Json(modulus.at_bifurcation)},
          {"optimum", none ? Json() : Json(compare::to_string(modulus.optimum))},
          {"why_no_effective_modulus", none ? Json(modulus.why_none) : Json()}};
}

Json deviation_json(const compare::Deviation& deviation) {
  return {{"rms_m", deviation.rms_m},
          {"max_m", deviation.max_m},
          {"max_at_m", deviation.max_at_m},
          {"tip_m", deviation.tip_m},
          {"rms_over_length", deviation.rms_over_length},
          {"rms_over_movement", deviation.rms_over_movement},
          {"angle_rms_rad", deviation.angle_rms_rad},
          {"curvature_rms_per_m", deviation.curvature_rms_per_m}};
}

Json to_json(const compare::ComparedState& state) {
  Json others = Json::array();
  for (const compare::OtherState& other : state.others) {
    others.push_back({{"stable", other.stable},
                      {"energy_difference_J", other.energy_difference_J},
                      {"rms_from_compared_m", other.rms_from_compared_m},
                      {"rms_from_shape_m", other.rms_from_shape_m}});
  }
  return {{"energy_J", state.energy_J},
          {"rank_of_stable", state.rank},
          {"stable_found", state.stable},
          {"unstable_found", state.unstable},
          {"others", std::move(others)}};
}

Json to_json(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

Json points_json(const Eigen::Matrix3Xd& points) {
  Json result = Json::array();
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    result.push_back(to_json(Eigen::Vector3d(points.col(i))));
  }
  return result;
}

Json obstacles_json(const std::vector<Eigen::Vector3d>& forces) {
  Json result = Json::array();
  for (const Eigen::Vector3d& force : forces) result.push_back({{"force_N", to_json(force)}});
  return result;
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
    // Steps in time and Newton's have neither.
    if (force.c_F > 0) {
      result["c_F"] = force.c_F;
      result["c_h"] = force.c_h;
    }
  }
  return result;
}

}  // namespace dlo::cli
