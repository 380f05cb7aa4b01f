#include "base/text.hpp"
#include "format/result_output.hpp"
#include "record/csv_table.hpp"

namespace dlo::cli {

Json plan_json(const compare::Plan& plan) {
  Json spans = json_list(plan.spans, [&](const compare::PlannedSpan& span) -> Json {
    return {{"begin_m", span.begin},
            {"end_m", span.end},
            {"begin_held", span.begin_support},
            {"end_held", span.end_support},
            {"inner_pins", span.inner_pins}};
  });
  Json obstacles = json_list(plan.obstacles, [&](const compare::PlannedObstacle& obstacle) -> Json {
    return {{"in_reach", obstacle.in_reach}, {"clearance_m", obstacle.clearance}};
  });
  // A missing bound, which is infinity, is null in JSON.
  Json neglected = json_list(plan.neglected, [&](const compare::Neglected& item) -> Json {
    return {{"what", item.name},
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

std::string plan_text(const compare::Plan& plan, const compare::Scene& scene) {
  const compare::Document document{.json = plan_json(plan),
                                   .columns = {{"neglected", "what,bound_m,by_models,why"},
                                               {"twist", "from_m,to_m,turn_rad,twist_rad"}},
                                   .large = compare::magnitudes(scene)};
  return fmt::format("plan of {}\n{}\n", compare::display(scene.name), document.text());
}

}  // namespace dlo::cli
