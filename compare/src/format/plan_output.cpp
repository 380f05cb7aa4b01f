#include <cmath>
#include <numbers>

#include "base/text.hpp"
#include "format/result_output.hpp"

namespace dlo::cli {
namespace {

std::string span_text(const compare::PlannedSpan& span) {
  std::string out;
  append(out, "{:g} to {:g} m, {} - {}", span.begin, span.end, span.begin_held, span.end_held);
  if (span.inner_pins > 0) append(out, " with {} inner pin(s)", span.inner_pins);
  return out;
}

/// Returns the lines about twist; empty if no gripper holds the rod's frame.
std::string twist_text(const compare::Plan& plan) {
  if (!plan.frame_held) return "";
  if (plan.twist.empty()) {
    return "  twist           no: one gripper alone holds the frame, and the rod turns with it\n";
  }
  constexpr double rounding = 1e-9;  // limit of an angle between directors [rad]
  constexpr double degrees = 180 / std::numbers::pi;
  std::string out;
  for (const compare::PlannedTwist& part : plan.twist) {
    const bool none = std::abs(part.turn) < rounding;
    append(out, "  twist           {}: ", none ? "no" : "yes");
    if (none) {
      append(out, "the grippers hold {:g} to {:g} m without a turn", part.begin, part.end);
    } else if (std::isfinite(part.turn)) {
      append(out, "the grippers turn it by {:.6g} degrees from {:g} to {:g} m", part.turn * degrees,
             part.begin, part.end);
    } else {
      append(out, "the grippers' directors turn it from {:g} to {:g} m", part.begin, part.end);
    }
    if (!none && std::isfinite(part.twist)) {
      append(out, "; {:.4g} degrees stay as twist", part.twist * degrees);
    }
    out += "\n";
  }
  return out;
}

std::string stretch_text(const compare::Plan& plan, const compare::Scene& scene) {
  if (scene.stretch == compare::Stretch::counted) {
    return "of the scene: exact has it, chain and force by their segments";
  }
  if (!plan.stretch) return "none";
  if (scene.stretch == compare::Stretch::automatic) {
    return "auto: exact has it where it matters, chain and force by their segments";
  }
  if (!plan.twist.empty()) {
    return "no bound; with the law hooke chain and force have it and the twist";
  }
  return std::isfinite(plan.bound("stretch"))
             ? "needed: stretch = true with exact, or force, or chain with c_c = AE"
             : "no bound; force and chain have it, of what they take";
}

std::string neglected_text(const compare::Neglected& item, double length) {
  std::string out;
  if (item.bound_m == 0) {
    out += "nothing";
  } else if (std::isfinite(item.bound_m)) {
    append(out, "at most {:.2g} mm = {:.2g} % of l", item.bound_m * 1e3,
           item.bound_m / length * 100);
  } else {
    out += "no bound";
  }
  append(out, ": {} (neglected by {})", item.why, item.models);
  return out;
}

/// Explains why no N is known that meets the target.
std::string why_no_points(const compare::Plan& plan) {
  for (const compare::Neglected& item : plan.neglected) {
    if (item.what == "polygon" && !std::isfinite(item.bound_m)) return item.why;
  }
  return fmt::format("none up to {} was found in time", compare::most_planned_points);
}

}  // namespace

std::string assumption_text(const compare::Scene& scene) {
  if (!scene.assumes_torsion()) return "";
  const bool is_rectangle = scene.width > 0 && !scene.given_bending_stiffness;
  return fmt::format(
      "torsional stiffness GJ = {} / {:g} = {:.4g} N m^2 (Poisson's ratio {:g}), as "
      "rod.torsional_stiffness is not given",
      is_rectangle                  ? "E J / 2"
      : scene.bending_stiffness_2() ? "2 EI_1 EI_2 / (EI_1 + EI_2)"
                                    : "EI",
      1 + compare::assumed_poisson_ratio, scene.twisting_stiffness(),
      compare::assumed_poisson_ratio);
}

std::string layers_text(const compare::Scene& scene) {
  if (!scene.layers) return "";
  const compare::LayeredSection& section = *scene.layers;
  return fmt::format(
      "EI {:.6g} N m^2 bonded, {:.6g} N m^2 free to slip; GJ {:.6g}, {:.6g} N m^2 (Poisson's ratio "
      "{:g}); taken: {}",
      section.bonded_bending_stiffness, section.free_bending_stiffness,
      section.bonded_torsional_stiffness, section.free_torsional_stiffness,
      compare::assumed_poisson_ratio, section.bonded ? "bonded" : "free");
}

std::string rest_shape_text(const compare::Scene& scene) {
  if (!scene.rest_shape) return "";
  const compare::RestShape& shape = *scene.rest_shape;
  return fmt::format(
      "{}: {} points, within {:.2g} m of {} arc{} (RMS {:.2g} m){}", compare::display(shape.file),
      shape.points, shape.largest_error, shape.arcs.size(), shape.arcs.size() == 1 ? "" : "s",
      shape.rms_error,
      shape.largest_angle ? fmt::format(", d1 within {:.2g} rad", *shape.largest_angle) : "");
}

std::string plan_text(const compare::Plan& plan, const compare::Scene& scene) {
  std::string out;
  append(out, "plan of {}   Gamma = {:.4g}\n", compare::display(scene.name), plan.gamma);
  append(out, "  geometry        {}\n", plan.planar ? "planar" : "spatial");
  if (const auto motion = compare::motion_of(scene)) {
    append(out,
           "  time            static: the scene as it is at {:g} s; it moves from {:g} to {:g} s "
           "(--time, dlo track)\n",
           motion->begin, motion->begin, motion->end);
  } else {
    append(out, "  time            {}\n", plan.moving ? "moving" : "static");
  }
  for (std::size_t i = 0; i < plan.spans.size(); ++i) {
    append(out, "  {:<15} {}\n", i == 0 ? "spans" : "", span_text(plan.spans[i]));
  }
  for (const compare::PlannedObstacle& obstacle : plan.obstacles) {
    if (obstacle.in_reach) {
      append(out, "  obstacle        in reach{}\n", plan.contact ? ", touched" : "");
    } else {
      append(out, "  obstacle        out of reach by {:.4g} m or more: not solved for\n",
             obstacle.clearance);
    }
  }
  out += twist_text(plan);
  if (scene.assumes_torsion()) append(out, "  assumed         {}\n", assumption_text(scene));
  if (scene.layers) append(out, "  layers          {}\n", layers_text(scene));
  if (scene.rest_shape) append(out, "  rest shape      {}\n", rest_shape_text(scene));
  append(out, "  stretch         {}\n", stretch_text(plan, scene));
  append(out, "  N               ");
  if (plan.points > 0) {
    append(out, "{} for {:g} % of l with the hooke law; the scene has {}\n", plan.points,
           plan.target * 100, plan.scene_points);
  } else {
    append(out, "not determined for {:g} % of l: {}; the scene has {}\n", plan.target * 100,
           why_no_points(plan), plan.scene_points);
  }
  append(out, "  neglected, and what it could change (RMS of the shape)\n");
  for (const compare::Neglected& item : plan.neglected) {
    append(out, "    {:<24}{}\n", item.what, neglected_text(item, scene.length));
  }
  return out + "\n";
}

Json plan_json(const compare::Plan& plan) {
  Json spans = json_list(plan.spans, [&](const compare::PlannedSpan& span) -> Json {
    return {{"begin_m", span.begin},
            {"end_m", span.end},
            {"begin_held", span.begin_held},
            {"end_held", span.end_held},
            {"inner_pins", span.inner_pins}};
  });
  Json obstacles = json_list(plan.obstacles, [&](const compare::PlannedObstacle& obstacle) -> Json {
    return {{"in_reach", obstacle.in_reach}, {"clearance_m", obstacle.clearance}};
  });
  // A missing bound, which is infinity, is null in JSON.
  Json neglected = json_list(plan.neglected, [&](const compare::Neglected& item) -> Json {
    return {{"what", item.what},
            {"by_models", item.models},
            {"bound_m", item.bound_m},
            {"why", item.why}};
  });
  Json result = {{"gamma", plan.gamma},
                 {"target_over_length", plan.target},
                 {"geometry", plan.planar ? "planar" : "spatial"},
                 {"spans", std::move(spans)},
                 {"obstacles", std::move(obstacles)},
                 {"stretch", plan.stretch},
                 {"moving", plan.moving},
                 {"contact", plan.contact},
                 {"points_for_target", plan.points > 0 ? Json(plan.points) : Json()},
                 {"scene_points", plan.scene_points},
                 {"neglected", std::move(neglected)}};
  if (plan.frame_held) {
    result["twist"] = json_list(plan.twist, [&](const compare::PlannedTwist& part) -> Json {
      // Unknown values are null.
      return {{"from_m", part.begin},
              {"to_m", part.end},
              {"turn_rad", part.turn},
              {"twist_rad", part.twist}};
    });
  }
  return result;
}

}  // namespace dlo::cli
