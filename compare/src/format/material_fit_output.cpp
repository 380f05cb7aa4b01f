#include <algorithm>
#include <cmath>
#include <string_view>

#include "base/text.hpp"
#include "dlo/compare/alignment.hpp"
#include "format/calibration_output.hpp"
#include "format/result_output.hpp"
#include "record/csv_table.hpp"

namespace dlo::cli {
namespace {

using compare::FittedValue;

std::string value_text(const FittedValue& value, const char* unit) {
  const std::string_view blank = *unit == '\0' ? "" : " ";
  const std::string interval = fmt::format("{}{}{}", interval_text(value), blank, unit);
  if (!value.low && !value.high) return "not identified";
  if (!value.value) return "not identified, " + interval;
  return fmt::format("{:.5g}{}{}, {}", *value.value, blank, unit, interval);
}

std::string prediction_text(const compare::Prediction& prediction) {
  std::string out = fmt::format(
      "prediction  {:.4g} mm between each shape and the rod fitted to the others (RMS)\n",
      prediction.rms_m * 1e3);
  if (!prediction.repeatability_m) return out;
  append(out, "            {:.4g} mm between each shape and the mean of the others: ",
         *prediction.repeatability_m * 1e3);
  const double ratio = prediction.repeatability_ratio().value_or(1);
  if (ratio > compare::reported_repeatability_ratio) {
    append(out,
           "predictions are {:.3g} times worse\n            than the shapes repeat, so the fit "
           "lacks something that all shapes have in common\n",
           ratio);
  } else {
    out += "a prediction can hardly come nearer\n";
  }
  return out;
}

/// Returns a text such as "length, scale and vertical are".
std::string assumed_text(std::vector<std::string> assumed) {
  if (assumed.size() == 1) return assumed.front() + " is";
  const std::string last = assumed.back();
  assumed.pop_back();
  return fmt::format("{} and {} are", fmt::join(assumed, ", "), last);
}

/// Returns the larger distance of an end of the interval from the value; empty if there is no
/// value.
std::optional<double> half_width(const FittedValue& value) {
  if (!value.value) return std::nullopt;
  return std::max(*value.high - *value.value, *value.value - *value.low);
}

Json number_json(const compare::FittedNumber& number) {
  return {{"name", number.name},
          {"unit", number.unit},
          {"value", number.value},
          {"standard_deviation", number.deviation},
          {"known_before", number.prior_deviation},
          {"seen", number.is_determined_by_shapes()},
          {"shape", json_or_null(number.shape)}};
}

Json scatter_json(const compare::ScatterBetweenShapes& scatter) {
  return {{"relative_deviation", scatter.relative_deviation},
          {"chance", scatter.chance},
          {"interval_widened_by", scatter.widening}};
}

/// Returns the keys of a value, its uncertainty and its interval.
/// @param prefix  prefix of the keys of the uncertainty and the interval
std::vector<std::string> value_keys(const Key& key, const std::string& prefix) {
  return {key.text(), prefix + "uncertainty" + key.unit, prefix + "interval_95" + key.unit};
}

void add_value(Json& result, const Key& key, const std::string& prefix, const FittedValue& value) {
  const std::vector<std::string> keys = value_keys(key, prefix);
  result[keys[0]] = json_or_null(value.value);
  result[keys[1]] = json_or_null(half_width(value));
  result[keys[2]] = {json_or_null(value.low), json_or_null(value.high)};
}

Json alternatives_json(const compare::Calibration& report,
                       const std::vector<compare::FitAlternative>& alternatives) {
  return json_list(alternatives, [&](const compare::FitAlternative& alternative) {
    Json one = {{"options", option_words(alternative)},
                {"natural_curvature_terms", alternative.natural_curvature_terms},
                {"direction_tolerance_rad", alternative.direction_tolerance},
                {"position_tolerance_m", alternative.position_tolerance},
                {"same_clamps", alternative.shared_clamps},
                {"direction_scatter_rad", alternative.direction_scatter},
                {"camera_tilt_rad", alternative.camera_tilt},
                {"prediction_rms_m", json_or_null(alternative.prediction_m)},
                {"rms_m", alternative.rms_m}};
    add_value(one, stiffness_key(report.scenes.front()), "", alternative.youngs_modulus);
    return one;
  });
}

Json shapes_json(const compare::Calibration& report) {
  const compare::MaterialFit& fit = report.fit;
  Json shapes = Json::array();
  for (std::size_t i = 0; i < fit.shapes.size(); ++i) {
    const compare::Alignment& alignment = fit.shapes[i].alignment;
    Json shape = {{"scene", fit.shapes[i].scene}, {"shape", report.files[i]}};
    shape.update(to_json(alignment));
    shape["rms_m"] = std::sqrt(alignment.mean_square);
    shape["arc_length_m"] = alignment.shape.arc_length;
    shape["points_m"] = points_json(alignment.shape.points);
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

/// Returns the columns of the only row of CSV.
std::string material_columns(const compare::Scene& scene) {
  const Key stiffness = stiffness_key(scene);
  const Key mass_parameter = mass_parameter_key(scene);
  return fmt::format(
      "{0},low{1}=interval_95{1}/0,high{1}=interval_95{1}/1,{2},{3}_low={3}_interval_95{4}/0,"
      "{3}_high={3}_interval_95{4}/1,noise_m,degrees_of_freedom,rms_m,not_identified,warning,"
      "errors_are_correlated,correlation_length_m=correlation/length_m,"
      "correlation_share=correlation/share_of_variance,"
      "interval_widened_by=correlation/interval_widened_by,"
      "effective_degrees_of_freedom=correlation/effective_degrees_of_freedom,"
      "{5}{6},{5}_low={5}_interval_95{6}/0,{5}_high={5}_interval_95{6}/1",
      stiffness.text(), stiffness.unit, mass_parameter.text(), mass_parameter.name,
      mass_parameter.unit, torsion_key().name, torsion_key().unit);
}

Json material_json(const compare::Calibration& report) {
  const compare::MaterialFit& fit = report.fit;
  Json result = {{"schema", "dlo/calibrate/1"}};
  for (const ShownValue& one : fitted_values(report)) {
    add_value(result, one.key, one.prefix, one.value);
  }
  result["assumed"] = fit.assumed;
  result["not_identified"] = text_or_null(fit.not_identified);
  result["warning"] = text_or_null(fit.warning);
  result["noise_m"] = fit.noise_m;
  for (const compare::HeldOutShape& shape : report.held_out) {
    result["held_out"].push_back(
        {{"file", shape.file}, {"scene", shape.scene}, {"rms_m", shape.rms_m}});
  }
  result["noise_is_estimated"] = fit.noise_is_estimated;
  result["degrees_of_freedom"] = fit.degrees_of_freedom;
  result["errors_are_correlated"] =
      fit.correlation_was_tested ? Json(fit.correlation.has_value()) : Json(nullptr);
  result["correlation"] = json_or_null(fit.correlation, [](const auto& errors) -> Json {
    return {{"length_m", errors.length_m},
            {"share_of_variance", errors.share},
            {"interval_widened_by", errors.widening},
            {"effective_degrees_of_freedom", errors.degrees_of_freedom}};
  });
  result["common_share"] = json_or_null(fit.common_share);
  result["alternatives"] = alternatives_json(report, fit.alternatives);
  result["tried"] = alternatives_json(report, fit.tried);
  result["others"] = json_list(fit.others, number_json);
  result["chains"] = chains_json(fit.chains);
  result["clamps"] = json_list(fit.clamps, [](const compare::ClampCorrection& one) -> Json {
    return {{"gripper", one.gripper},
            {"rotation_rad", compare::to_json(one.rotation)},
            {"displacement_m", compare::to_json(one.displacement)}};
  });
  result["camera_tilt_rad"] = compare::to_json(fit.camera_tilt);
  result["prediction"] = json_or_null(fit.prediction, [](const auto& found) -> Json {
    return {{"rms_m", found.rms_m},
            {"repeatability_m", json_or_null(found.repeatability_m)},
            {"over_repeatability", json_or_null(found.repeatability_ratio())},
            {"shapes_m", found.shapes_m}};
  });
  result["scatter_between_shapes"] = json_or_null(fit.scatter, scatter_json);
  result["rms_m"] = fit.rms_m;
  result["shapes"] = shapes_json(report);
  return result;
}

}  // namespace

compare::Document material_document(const compare::Calibration& report) {
  const compare::MaterialFit& fit = report.fit;
  compare::Document document{.json = material_json(report)};
  document.shown = document.json;
  std::string& out = document.head;
  for (const ShownValue& one : fitted_values(report)) {
    const compare::NamedValue& quantity = one.quantity;
    append(out, "{:<11} {}   (scene: {:.5g}{}{})\n", quantity.name,
           value_text(one.value, quantity.unit), quantity.value, *quantity.unit == '\0' ? "" : " ",
           quantity.unit);
    for (const std::string& key : value_keys(one.key, one.prefix)) document.shown.erase(key);
  }
  if (!fit.assumed.empty()) {
    append(out, "            (if {} as given: errors of these may leave no residual)\n",
           assumed_text(fit.assumed));
  }
  if (!fit.not_identified.empty()) append(out, "            {}\n", fit.not_identified);
  if (!fit.warning.empty()) append(out, "            {}\n", fit.warning);
  append(out, "residual    {:.4g} mm between points and rod (RMS)\n", fit.rms_m * 1e3);
  if (fit.prediction) out += prediction_text(*fit.prediction);
  for (const char* key : {"assumed", "not_identified", "warning", "rms_m", "prediction"}) {
    document.shown.erase(key);
  }
  if (fit.camera_tilt.isZero(0)) document.shown.erase("camera_tilt_rad");
  const std::vector<std::string> stiffness = value_keys(stiffness_key(report.scenes.front()), "");
  const std::string alternative =
      fmt::format("options,prediction_rms_m,rms_m,{},{}", stiffness[0], stiffness[2]);
  document.columns = {
      {"", material_columns(report.scenes.front())},
      {"alternatives", alternative},
      {"tried", alternative},
      {"shapes", "shape,scene,arc_lengths,reversed,rms_m"},
      {"chains/#/joints", "at_m,joint_stiffness_Nm_per_rad,binormal_stiffness_Nm_per_rad"}};
  out += "\n";
  return document;
}

}  // namespace dlo::cli
