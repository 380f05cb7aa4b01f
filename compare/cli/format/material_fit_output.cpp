#include "format/material_fit_output.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include "base/display.hpp"
#include "dlo/compare/alignment.hpp"
#include "dlo/compare/error.hpp"
#include "format/alignment_output.hpp"
#include "format/comparison_output.hpp"
#include "record/csv_table.hpp"

namespace dlo::cli {
namespace {

using compare::FittedValue;

std::string number(const std::optional<double>& value, const char* none) {
  return value ? fmt::format("{:.4g}", *value) : std::string(none);
}

std::string interval_text(const FittedValue& value) {
  return fmt::format("95 %: {} to {}", number(value.low, "..."), number(value.high, "..."));
}

std::string value_text(const FittedValue& value, const char* unit) {
  const std::string_view blank = *unit == '\0' ? "" : " ";
  const std::string interval = fmt::format("{}{}{}", interval_text(value), blank, unit);
  if (!value.low && !value.high) return "not identified";
  if (!value.value) return "not identified, " + interval;
  return fmt::format("{:.5g}{}{}, {}", *value.value, blank, unit, interval);
}

/// Of the two sides the larger; none if the interval is open.
std::optional<double> half_width(const FittedValue& value) {
  if (!value.value) return std::nullopt;
  return std::max(*value.high - *value.value, *value.value - *value.low);
}

/// What makes the interval wider than that of independent errors.
std::string correlation_text(const compare::Calibration& report) {
  const compare::CorrelatedErrors& errors = *report.fit.correlation;
  const FittedValue& E = report.fit.youngs_modulus;
  const bool has_interval = E.low || E.high;
  return fmt::format(
      "            errors along the rod are correlated: {:.0f} % of their variance over about "
      "{:.2g} "
      "m\n            ({:.0f} % of the rod){} ({:.3g} degrees of freedom)\n",
      errors.share * 100, errors.length_m, errors.length_m / report.scenes.front().length * 100,
      has_interval ? fmt::format("; the interval is {:.3g} times as wide to account for that",
                                 errors.widening)
                   : "",
      errors.degrees_of_freedom);
}

/// A number beside E, in the units that people read.
std::string text_of(const compare::FittedNumber& number) {
  struct Shown {
    double factor;
    const char* unit;
  };
  const Shown shown = number.unit == "rad" ? Shown{180 / std::numbers::pi, "deg"}
                      : number.unit == "m" ? Shown{1e3, "mm"}
                                           : Shown{1, number.unit.c_str()};
  if (!number.is_seen()) {
    return fmt::format("{}: not seen by these shapes, known to {:.3g} {}", number.name,
                       number.known_before * shown.factor, shown.unit);
  }
  return fmt::format("{}: {:.4g} {}, standard deviation {:.2g} {}", number.name,
                     number.value * shown.factor, shown.unit, number.deviation * shown.factor,
                     shown.unit);
}

/// The wire's own numbers, or those of one shape, indented.
std::string numbers_text(const compare::MaterialFit& fit, const std::optional<std::size_t>& shape) {
  std::string out;
  for (const compare::FittedNumber& number : fit.others) {
    if (number.shape == shape) append(out, "            {}\n", text_of(number));
  }
  return out;
}

/// As the command line has it.
std::string words_of(const compare::FitAlternative& alternative) {
  std::string out;
  if (alternative.natural_curvature_terms > 0) {
    append(out, "--natural-curvature {}", alternative.natural_curvature_terms);
  }
  if (alternative.direction_tolerance > 0) {
    append(out, "{}--clamp-angles \"{:.3g} deg\"", out.empty() ? "" : " ",
           alternative.direction_tolerance * 180 / std::numbers::pi);
  }
  if (alternative.position_tolerance > 0) {
    append(out, "{}--clamp-positions \"{:.3g} mm\"", out.empty() ? "" : " ",
           alternative.position_tolerance * 1e3);
  }
  if (alternative.shared_clamps) out += " --same-clamps";
  if (alternative.direction_scatter > 0) {
    append(out, " --clamp-scatter \"{:.3g} deg\"",
           alternative.direction_scatter * 180 / std::numbers::pi);
  }
  if (alternative.camera_tilt > 0) {
    append(out, " --camera-tilt \"{:.3g} deg\"", alternative.camera_tilt * 180 / std::numbers::pi);
  }
  return out;
}

/// The options that were chosen, and what the others predict.
std::string tried_text(const std::vector<compare::FitAlternative>& tried) {
  std::string out;
  for (std::size_t i = 0; i < tried.size(); ++i) {
    const std::string words = words_of(tried[i]);
    append(out, "{} {}: {}residual {:.4g} mm{}\n", i == 0 ? "chosen     " : "           ",
           words.empty() ? "no option" : words,
           tried[i].prediction_m ? fmt::format("predicts {:.4g} mm, ", *tried[i].prediction_m * 1e3)
                                 : "",
           tried[i].rms_m * 1e3, tried.size() == 1 ? ", nothing in it is systematic" : "");
  }
  return out;
}

std::string alternatives_text(const compare::Calibration& report) {
  std::string out;
  const compare::NamedValue stiffness = report.scenes.front().stiffness();
  for (const compare::FitAlternative& alternative : report.fit.alternatives) {
    append(out, "            {} would leave {:.4g} mm, {} {}\n", words_of(alternative),
           alternative.rms_m * 1e3, stiffness.name,
           value_text(alternative.youngs_modulus, stiffness.unit));
  }
  return out;
}

std::string prediction_text(const compare::Prediction& prediction) {
  std::string out = fmt::format(
      "prediction  {:.4g} mm between each shape and the rod fitted to the others (RMS)\n",
      prediction.rms_m * 1e3);
  if (prediction.repeatability_m) {
    append(out,
           "            {:.4g} mm between each shape and the mean of the others: a prediction can "
           "hardly come nearer\n",
           *prediction.repeatability_m * 1e3);
  }
  return out;
}

const char* text_of(compare::ChainClamp clamp) {
  switch (clamp) {
    case compare::ChainClamp::hinge:
      return "a hinge at the clamp";
    case compare::ChainClamp::welded:
      return "segments at clamps welded to them";
    case compare::ChainClamp::middle:
      break;
  }
  return "clamped in the middle of a segment";
}

std::string range_text(double low, double high, const char* unit) {
  return low == high ? fmt::format("{:.4g}{}", low, unit)
                     : fmt::format("{:.4g} to {:.4g}{}", low, high, unit);
}

std::string lengths_text(const compare::ChainSprings& chain) {
  const std::vector<double>& h = chain.segment_lengths;
  if (h.empty()) return fmt::format("{:.4g} m", chain.segment_length);
  const auto [low, high] = std::minmax_element(h.begin(), h.end());
  return range_text(*low, *high, " m");
}

std::string stiffness_text(const compare::ChainSprings& chain) {
  if (chain.joints.empty()) return fmt::format("{:.5g}", chain.stiffness);
  const auto [low, high] =
      std::minmax_element(chain.joints.begin(), chain.joints.end(),
                          [](const auto& a, const auto& b) { return a.stiffness < b.stiffness; });
  return range_text(low->stiffness, high->stiffness, "");
}

/// Of unequal segments each joint.
std::string joints_text(const compare::ChainSprings& chain) {
  if (chain.joints.empty()) return "";
  std::string out = fmt::format("              {:>11} {:>15} {:>24}\n", "s [m]", "k [N m/rad]",
                                "discrete elastic rods'");
  for (const compare::ChainJoint& joint : chain.joints) {
    append(out, "              {:11.6f} {:15.6g} {:>24}\n", joint.at, joint.stiffness,
           joint.binormal_stiffness > 0 ? fmt::format("{:.6g}", joint.binormal_stiffness) : "-");
  }
  return out;
}

}  // namespace

std::string chains_text(const std::vector<compare::ChainSprings>& chains) {
  std::string out;
  for (std::size_t i = 0; i < chains.size(); ++i) {
    const compare::ChainSprings& chain = chains[i];
    append(out, "{:<11} {} segments of {}, {}: {} N m/rad a joint, {:.4g} times EI/h{}\n",
           i == 0 ? "chain" : "", chain.segments, lengths_text(chain), text_of(chain.clamp),
           stiffness_text(chain), chain.over_rod,
           chain.joints.empty() ? "" : ", h the mean of its two segments");
    append(out, "            ({:.4g} mm from the rod on {}, RMS)\n", chain.rms_m * 1e3,
           compare::display(chain.scene));
    out += joints_text(chain);
    for (const compare::SimulatorParameter& parameter : compare::simulator_parameters(chain)) {
      append(out, "              {:<10} {} = {:.5g} {}\n", parameter.simulator, parameter.name,
             parameter.value, parameter.unit);
    }
  }
  return out;
}

Json chains_json(const std::vector<compare::ChainSprings>& chains) {
  Json result = Json::array();
  for (const compare::ChainSprings& chain : chains) {
    result.push_back({{"scene", chain.scene},
                      {"clamp", compare::to_string(chain.clamp)},
                      {"segments", chain.segments},
                      {"segment_length_m", chain.segment_length},
                      {"joint_stiffness_Nm_per_rad", chain.stiffness},
                      {"binormal_stiffness_Nm_per_rad", chain.binormal_stiffness},
                      {"over_bending_stiffness_per_length", chain.over_rod},
                      {"rms_m", chain.rms_m},
                      {"parameters", Json::array()}});
    if (!chain.joints.empty()) {
      result.back()["segment_lengths_m"] = chain.segment_lengths;
      result.back()["joints"] =
          json_list(chain.joints, [](const compare::ChainJoint& joint) -> Json {
            return {{"at_m", joint.at},
                    {"joint_stiffness_Nm_per_rad", joint.stiffness},
                    {"binormal_stiffness_Nm_per_rad", joint.binormal_stiffness}};
          });
    }
    for (const compare::SimulatorParameter& parameter : compare::simulator_parameters(chain)) {
      result.back()["parameters"].push_back({{"simulator", parameter.simulator},
                                             {"name", parameter.name},
                                             {"unit", parameter.unit},
                                             {"value", parameter.value}});
    }
  }
  return result;
}

namespace {

Json numbers_json(const compare::MaterialFit& fit) {
  return json_list(fit.others, [&](const compare::FittedNumber& number) -> Json {
    return {{"name", number.name},
            {"unit", number.unit},
            {"value", number.value},
            {"standard_deviation", number.deviation},
            {"known_before", number.known_before},
            {"seen", number.is_seen()},
            {"shape", number.shape ? Json(*number.shape) : Json(nullptr)}};
  });
}

/// As a scene file has it.
std::string vector_text(const Eigen::Vector3d& v) {
  return fmt::format("[{:.6e}, {:.6e}, {:.6e}]", v.x(), v.y(), v.z());
}

/// As a scene file has it [1/m].
std::string natural_curvature_text(const compare::MaterialFit& fit) {
  std::string out;
  for (const Eigen::Vector2d& term : fit.natural_curvature) {
    append(out, "{}[{:.6e}, {:.6e}]", out.empty() ? "" : ", ", term.x(), term.y());
  }
  return "[" + out + "]";
}

Json scatter_json(const compare::ScatterBetweenShapes& scatter) {
  return {{"relative_deviation", scatter.relative_deviation},
          {"chance", scatter.chance},
          {"interval_widened_by", scatter.widening}};
}

Json json_of(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

/// A fitted number's name and unit in keys.
struct Key {
  std::string name;
  std::string unit;

  [[nodiscard]] std::string text() const { return name + unit; }
};

Key stiffness_key(const compare::Scene& scene) {
  return scene.given_bending_stiffness ? Key{"bending_stiffness", "_Nm2"}
                                       : Key{"youngs_modulus", "_Pa"};
}

Key heaviness_key(const compare::Scene& scene) {
  return scene.given_mass_per_length ? Key{"mass_per_length", "_kg_per_m"}
                                     : Key{"density", "_kg_per_m3"};
}

const Key torsion_key{"torsional_stiffness", "_Nm2"};
const Key ratio_key{"torsional_over_bending_stiffness", ""};

compare::NamedValue torsion_of(const compare::Scene& scene) {
  return {"GJ", "N m^2", scene.twisting_stiffness()};
}

compare::NamedValue torsion_ratio_of(const compare::Scene& scene) {
  return {"GJ / EI", "", scene.twisting_stiffness() / scene.mean_bending_stiffness()};
}

/// @param prefix  of the keys of its uncertainty and its interval
void add_value(Json& result, const Key& key, const std::string& prefix, const FittedValue& value) {
  result[key.text()] = json_of(value.value);
  result[prefix + "uncertainty" + key.unit] = json_of(half_width(value));
  result[prefix + "interval_95" + key.unit] = {json_of(value.low), json_of(value.high)};
}

Json alternatives_json(const compare::Calibration& report,
                       const std::vector<compare::FitAlternative>& alternatives) {
  Json result = Json::array();
  for (const compare::FitAlternative& alternative : alternatives) {
    Json one = {{"options", words_of(alternative)},
                {"natural_curvature_terms", alternative.natural_curvature_terms},
                {"direction_tolerance_rad", alternative.direction_tolerance},
                {"position_tolerance_m", alternative.position_tolerance},
                {"same_clamps", alternative.shared_clamps},
                {"direction_scatter_rad", alternative.direction_scatter},
                {"camera_tilt_rad", alternative.camera_tilt},
                {"prediction_rms_m", json_of(alternative.prediction_m)},
                {"rms_m", alternative.rms_m}};
    add_value(one, stiffness_key(report.scenes.front()), "", alternative.youngs_modulus);
    result.push_back(std::move(one));
  }
  return result;
}

}  // namespace

std::string material_text(const compare::Calibration& report) {
  const compare::MaterialFit& fit = report.fit;
  std::string out;
  const auto add = [&](const compare::NamedValue& of, const FittedValue& value) {
    append(out, "{:<11} {}   (scene: {:.5g}{}{})\n", of.name, value_text(value, of.unit), of.value,
           *of.unit == '\0' ? "" : " ", of.unit);
  };
  add(report.scenes.front().stiffness(), fit.youngs_modulus);
  if (fit.density) add(report.scenes.front().heaviness(), *fit.density);
  if (fit.torsional_stiffness) {
    add(torsion_of(report.scenes.front()), *fit.torsional_stiffness);
    add(torsion_ratio_of(report.scenes.front()), *fit.torsion_over_bending);
  }
  if (!fit.not_identified.empty()) append(out, "            {}\n", fit.not_identified);
  if (!fit.warning.empty()) append(out, "            {}\n", fit.warning);
  append(out, "{}", numbers_text(fit, std::nullopt));
  if (fit.scatter) {
    append(out,
           "            the shapes do not agree: they scatter by {:.2g} % in {} (by chance in "
           "{:.2g} % "
           "of cases);\n            the interval is {:.3g} times as wide to account for that\n",
           fit.scatter->relative_deviation * 100, report.scenes.front().stiffness().name,
           fit.scatter->chance * 100, fit.scatter->widening);
  }
  append(out, "noise       {:.4g} mm in each coordinate, {} ({} degrees of freedom)\n",
         fit.noise_m * 1e3, fit.noise_is_estimated ? "estimated from the residuals" : "given",
         fit.degrees_of_freedom);
  if (fit.correlation) {
    append(out, "{}", correlation_text(report));
    if (fit.others.empty() && fit.alternatives.empty()) {
      out +=
          "            (misaligned clamps, or a wire that is not intrinsically straight, leave "
          "such "
          "residuals:\n            --clamp-angles, --natural-curvature)\n";
    }
  }
  append(out, "residual    {:.4g} mm between points and rod (RMS)\n", fit.rms_m * 1e3);
  if (fit.prediction) out += prediction_text(*fit.prediction);
  for (const compare::HeldOutShape& shape : report.held_out) {
    append(out, "held out    {} on {}: {:.4g} mm between its points and the fitted rod (RMS)\n",
           compare::display(shape.file), compare::display(shape.scene), shape.rms_m * 1e3);
  }
  out += tried_text(fit.tried);
  append(out, "{}", alternatives_text(report));
  for (std::size_t i = 0; i < fit.shapes.size(); ++i) {
    const compare::Alignment& a = fit.shapes[i].alignment;
    append(out, "shape       {} on {}: {} points, {}, RMS {:.4g} mm\n",
           compare::display(report.files[i]), compare::display(fit.shapes[i].scene),
           a.shape.points.cols(), range_text(a, report.scenes[i].length),
           std::sqrt(a.mean_square) * 1e3);
    append(out, "            arc lengths: {}\n", compare::to_string(a.arc_lengths));
    if (report.frame_was_found)
      append(out, "            frame {}\n", pose_text(a.pose, report.scenes[i].length));
    append(out, "{}", numbers_text(fit, i));
  }
  out += chains_text(report.fit.chains);
  return out;
}

std::string material_csv(const compare::Calibration& report) {
  const Key stiffness = stiffness_key(report.scenes.front());
  const Key heaviness = heaviness_key(report.scenes.front());
  compare::CsvTable table(fmt::format(
      "{0},low{1}=interval_95{1}/0,high{1}=interval_95{1}/1,{2},{3}_low={3}_interval_95{4}/0,"
      "{3}_high={3}_interval_95{4}/1",
      stiffness.text(), stiffness.unit, heaviness.text(), heaviness.name, heaviness.unit));
  table.add(
      "noise_m,degrees_of_freedom,rms_m,not_identified,warning,errors_are_correlated,"
      "correlation_length_m=correlation/length_m,correlation_share=correlation/share_of_variance,"
      "interval_widened_by=correlation/interval_widened_by,"
      "effective_degrees_of_freedom=correlation/effective_degrees_of_freedom");
  table.add(fmt::format("{0}{1},{0}_low={0}_interval_95{1}/0,{0}_high={0}_interval_95{1}/1",
                        torsion_key.name, torsion_key.unit));
  table.add("not_told=not_identified");  // its name before 0.2
  return table.header() + table.row(material_json(report));
}

Json material_json(const compare::Calibration& report) {
  const compare::MaterialFit& fit = report.fit;
  Json result = {{"schema", "dlo/calibrate/1"}};
  add_value(result, stiffness_key(report.scenes.front()), "", fit.youngs_modulus);
  if (fit.density) {
    const Key key = heaviness_key(report.scenes.front());
    add_value(result, key, key.name + "_", *fit.density);
  }
  if (fit.torsional_stiffness) {
    add_value(result, torsion_key, torsion_key.name + "_", *fit.torsional_stiffness);
    add_value(result, ratio_key, ratio_key.name + "_", *fit.torsion_over_bending);
  }
  result["not_identified"] = fit.not_identified.empty() ? Json(nullptr) : Json(fit.not_identified);
  result["warning"] = fit.warning.empty() ? Json(nullptr) : Json(fit.warning);
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
  result["common_share"] = json_of(fit.common_share);
  result["alternatives"] = alternatives_json(report, fit.alternatives);
  result["tried"] = alternatives_json(report, fit.tried);
  result["others"] = numbers_json(fit);
  result["chains"] = chains_json(fit.chains);
  result["clamps"] = json_list(fit.clamps, [](const compare::ClampCorrection& one) -> Json {
    return {{"gripper", one.gripper},
            {"rotation_rad", compare::to_json(one.rotation)},
            {"displacement_m", compare::to_json(one.displacement)}};
  });
  result["camera_tilt_rad"] = compare::to_json(fit.camera_tilt);
  result["prediction"] = json_or_null(fit.prediction, [](const auto& found) -> Json {
    return {{"rms_m", found.rms_m},
            {"repeatability_m", json_of(found.repeatability_m)},
            {"shapes_m", found.shapes_m}};
  });
  result["scatter_between_shapes"] = json_or_null(fit.scatter, scatter_json);
  result["rms_m"] = fit.rms_m;
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
  result["shapes"] = std::move(shapes);
  return result;
}

std::string material_toml(const compare::Calibration& report) {
  const compare::MaterialFit& fit = report.fit;
  const FittedValue& E = fit.youngs_modulus;
  const bool identified = E.value && (!fit.density || fit.density->value);
  // Numbers that are no material may still predict shapes, all together.
  const bool predicts = fit.prediction && E.estimate && (!fit.density || fit.density->estimate);
  if (!identified && !predicts) {
    throw compare::InputError("calibrate: no material to write, " + fit.not_identified);
  }
  const compare::Scene& scene = report.scenes.front();
  const compare::NamedValue stiffness = scene.stiffness();
  const compare::NamedValue heaviness = scene.heaviness();
  if (scene.given_bending_stiffness.has_value() != scene.given_mass_per_length.has_value()) {
    throw compare::InputError(
        fmt::format("calibrate: {} and {} are of no one table (allowed: a scene with both "
                    "bending_stiffness and "
                    "mass_per_length, or with neither; -o FILE.json)",
                    stiffness.name, heaviness.name));
  }
  const double density = fit.density ? *fit.density->estimate : heaviness.value;
  const bool given = scene.given_bending_stiffness.has_value();
  std::string out =
      given ? "# Written by dlo calibrate, for --calibrated, or lines of a scene's [rod].\n"
            : "# Written by dlo calibrate, for --calibrated, or --materials and material = "
              "\"calibrated\" in a scene.\n";
  if (!identified) {
    append(out,
           "# For shapes like these, of which one is predicted from the others to {:.4g} mm. No "
           "material: {}.\n",
           fit.prediction->rms_m * 1000, fit.not_identified);
  }
  if (fit.torsional_stiffness && fit.torsional_stiffness->value) {
    append(out, "torsional_stiffness = {:.8e}  # N m^2, {}\n", *fit.torsional_stiffness->value,
           interval_text(*fit.torsional_stiffness));
  }
  if (!fit.natural_curvature.empty()) {
    append(out, "natural_curvature = {}\n", natural_curvature_text(fit));
  }
  if (!fit.camera_tilt.isZero(0)) {
    append(out, "camera_tilt = {}  # rad, of the shapes' coordinates\n",
           vector_text(fit.camera_tilt));
  }
  if (!given) out += "[[material]]\nname = \"calibrated\"\n";
  std::string value = fmt::format("{:.8e}", *E.estimate);
  if (scene.given_bending_stiffness_2) {
    // A fit leaves the ratio of the two as it is.
    const double ratio = *scene.given_bending_stiffness_2 / *scene.given_bending_stiffness;
    value = fmt::format("[{}, {:.8e}]", value, ratio * *E.estimate);
  }
  append(out, "{} = {}  # {}, {}\n", stiffness_key(scene).name, value, stiffness.unit,
         interval_text(E));
  append(out, "{} = {:.8e}  # {}, {}\n", heaviness_key(scene).name, density, heaviness.unit,
         fit.density ? interval_text(*fit.density) : std::string("of the scene"));
  append(out, "{}least squares of {} measured shape{}, noise {:.3g} m{}{}\n",
         given ? "# " : "source = \"", fit.shapes.size(), fit.shapes.size() == 1 ? "" : "s",
         fit.noise_m, fit.correlation ? ", correlated along the rod" : "", given ? "" : "\"");
  for (const compare::ClampCorrection& correction : fit.clamps) {
    append(out, "[[gripper]]\nnumber = {}\nrotation = {}  # rad\ndisplacement = {}  # m\n",
           correction.gripper + 1, vector_text(correction.rotation),
           vector_text(correction.displacement));
  }
  return out;
}

}  // namespace dlo::cli
