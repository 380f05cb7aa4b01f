#include "suite/card_document.hpp"

#include <fmt/format.h>

#include <limits>

#include "base/input_file.hpp"
#include "dlo/compare/error.hpp"
#include "record/field.hpp"

namespace dlo::compare {
namespace {

constexpr const char* card_schema = "dlo/card/1";

Json cause_json(const Cause& cause) {
  return {{"name", cause.name},
          {"factor", cause.factor},
          {"defect", cause.defect},
          {"words", cause.words}};
}

Json run_json(const CardRun& run) {
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
          {"right", scene.right()},
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
          {"largest_rms_over_length", group.largest},
          {"smallest_order", group.order},
          {"wall_s", group.seconds},
          {"causes", std::move(causes)}};
}

/// null is NaN.
double number_of(const Json& value) {
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

CardScene parse_scene_card(const Json& document) {
  CardScene scene;
  scene.id = document.at("id");
  scene.group = document.at("class");
  scene.order = number_of(document.at("order"));
  for (const Json& cause : document.at("causes")) {
    scene.causes.push_back({.name = cause.at("name"),
                            .factor = number_of(cause.at("factor")),
                            .words = cause.at("words"),
                            .defect = cause.at("defect")});
  }
  for (const Json& run : document.at("runs")) {
    scene.runs.push_back({.points = run.at("points"),
                          .status = from_name<RunStatus>(run.at("status").get<std::string>()),
                          .problem = run.at("problem"),
                          .error = number_of(run.at("rms_over_length")),
                          .seconds = number_of(run.at("wall_s"))});
  }
  return scene;
}

Card parse_card(const Json& document) {
  Card card;
  card.simulator = document.at("simulator");
  card.battery_version = document.at("version");
  card.points = document.at("points").get<std::vector<int>>();
  for (const Json& scene : document.at("scenes")) {
    CardScene one = parse_scene_card(scene);
    const bool whole = one.runs.size() == card.points.size() ||
                       (!one.runs.empty() && one.status() != RunStatus::solved);
    if (!whole) throw InputError(fmt::format("scene {}: {} runs", one.id, one.runs.size()));
    card.scenes.push_back(std::move(one));
  }
  return card;
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

std::vector<Card> parse_cards(const std::string& text, const std::string& file) {
  try {
    const Json document = Json::parse(text);
    if (document.at("schema") != card_schema) {
      throw InputError(fmt::format("schema is not {}", card_schema));
    }
    std::vector<Card> cards;
    for (const Json& card : document.at("cards")) cards.push_back(parse_card(card));
    return cards;
  } catch (const nlohmann::json::exception&) {
    throw InputError(
        fmt::format("{}: no cards (allowed: what dlo suite --format json has written)", file));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {} (allowed: what dlo suite --format json has written)", file,
                                 error.what()));
  }
}

std::vector<Card> load_cards(const std::string& path) { return parse_cards(read_file(path), path); }

}  // namespace dlo::compare
