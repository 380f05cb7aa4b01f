#include <set>
#include <string>
#include <utility>

#include "dlo/compare/error.hpp"
#include "record/field.hpp"
#include "suite/card.hpp"

namespace dlo::compare {
namespace {

constexpr const char* card_schema = "dlo/card/1";

Json cause_json(const Cause& cause) {
  return {{"name", cause.name},
          {"factor", cause.factor},
          {"defect", cause.defect},
          {"words", cause.words}};
}

Json run_json(const SimulatorRun& run) {
  return {{"points", run.points},
          {"status", to_string(run.status)},
          {"problem", run.problem},
          {"rms_over_length", run.error},
          {"wall_s", run.seconds}};
}

Json scene_card_json(const CardScene& scene) {
  return {{"id", scene.id},
          {"class", scene.group},
          {"status", to_string(scene.status())},
          {"right", scene.is_correct()},
          {"order", scene.order},
          {"causes", json_list(scene.causes, cause_json)},
          {"runs", json_list(scene.runs, run_json)}};
}

Json group_json(const CardGroup& group) {
  Json causes = Json::object();
  for (const auto& [name, count] : group.causes) causes[name] = count;
  return {{"class", group.name},
          {"scenes", group.scenes},
          {"solved", group.solved},
          {"right", group.right},
          {"not_supported", group.not_supported},
          {"failed", group.failed},
          {"not_judged", group.not_judged},
          {"largest_rms_over_length", group.largest},
          {"smallest_order", group.order},
          {"wall_s", group.seconds},
          {"causes", std::move(causes)}};
}

}  // namespace

nlohmann::ordered_json cards_json(const std::vector<Card>& cards) {
  return {{"schema", card_schema}, {"cards", json_list(cards, [](const Card& card) -> Json {
                                      return {{"simulator", card.simulator},
                                              {"version", card.battery_version},
                                              {"points", card.points},
                                              {"total", group_json(card.total())},
                                              {"classes", json_list(card.groups(), group_json)},
                                              {"scenes", json_list(card.scenes, scene_card_json)}};
                                    })}};
}

Regression judge_cards(const std::vector<BaselineCase>& baseline, const std::vector<Card>& cards,
                       const RegressionTolerance& tolerance) {
  std::vector<MeasuredCase> measured;
  std::set<std::pair<std::string, std::string>> compared;  // scene, simulator
  for (const Card& card : cards) {
    for (const CardScene& scene : card.scenes) {
      compared.emplace(scene.id, card.simulator);
      if (scene.status() == RunStatus::not_supported) continue;
      for (const SimulatorRun& run : scene.runs) {
        BaselineCase entry{.scene = scene.id, .program = card.simulator, .points = run.points};
        entry.errors.rms = run.error;
        measured.push_back({std::move(entry), run.problem});
      }
    }
  }
  std::vector<BaselineCase> known;
  Regression result;
  for (const BaselineCase& entry : baseline) {
    (compared.contains({entry.scene, entry.program}) ? known : result.cases).push_back(entry);
  }
  result.results = judge_regression(known, measured, tolerance);
  if (result.results.empty()) {
    throw InputError(
        "nothing to compare with the baseline: no simulator supports one of the scenes (allowed: "
        "scenes that a simulator supports)");
  }
  for (MeasuredCase& one : measured) result.cases.push_back(std::move(one.entry));
  return result;
}

}  // namespace dlo::compare
