#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/quote.hpp"
#include "base/text.hpp"
#include "batch/regression.hpp"
#include "format/result_output.hpp"
#include "option/output.hpp"
#include "series/study_output.hpp"

namespace dlo::cli {
namespace {

using compare::Card;
using compare::CardGroup;
using compare::CardScene;
using compare::Cause;
using compare::RunStatus;

std::string number_word(const char* format, double number) {
  return std::isfinite(number) ? fmt::format(fmt::runtime(format), number) : "-";
}

std::string causes_words(const CardGroup& group) {
  std::string text;
  for (const auto& [name, count] : group.causes) {
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", name, count);
  }
  return text;
}

std::string summary(const Card& card) {
  const CardGroup total = card.total();
  std::string text = fmt::format("{} of {} scenes right", total.right, total.scenes);
  const auto add = [&](int count, const char* what) {
    if (count > 0) text += fmt::format(", {} {}", count, what);
  };
  add(total.solved - total.right, "wrong");
  add(total.not_supported, "not supported");
  add(total.failed, "failed");
  add(total.not_judged, "not judged");
  return text;
}

/// Returns the causes or the problem of a scene; empty if it is right.
std::string cause_or_problem(const CardScene& scene) {
  if (scene.status() != RunStatus::solved) {
    return fmt::format("{}: {}", compare::to_string(scene.status()),
                       compare::display(scene.problem()));
  }
  std::string text;
  for (const Cause& cause : scene.causes) {
    text += fmt::format("{}{}", text.empty() ? "" : "; ", cause.name);
    if (std::isfinite(cause.factor)) text += fmt::format(", {:.3g}", cause.factor);
    text += ": " + cause.words;
  }
  if (text.empty() && !scene.is_correct()) {
    constexpr double least_converging_order = 0.8;
    text = fmt::format("{:.3g} % of l off with N = {}, {}", scene.runs.back().error * 100,
                       scene.runs.back().points,
                       scene.order > least_converging_order
                           ? fmt::format("and converges with order {:.1f}", scene.order)
                           : "the cause was not found");
  }
  return text;
}

/// Returns the scenes that are not right, grouped by their reason, with that reason.
std::vector<std::pair<std::string, std::string>> wrong_scenes(const Card& card) {
  std::vector<std::pair<std::string, std::string>> reasons;
  for (const CardScene& scene : card.scenes) {
    const std::string wrong = cause_or_problem(scene);
    if (wrong.empty()) continue;
    const auto known = std::find_if(reasons.begin(), reasons.end(),
                                    [&](const auto& one) { return one.second == wrong; });
    if (known == reasons.end()) {
      reasons.emplace_back(scene.id, wrong);
    } else {
      known->first += ", " + scene.id;
    }
  }
  return reasons;
}

/// Returns the table of classes: a row for each, whose cells are texts by their titles.
Json rows_of(const Card& card) {
  return json_list(card.groups(), [&](const CardGroup& group) -> Json {
    Json row = {
        {"class", group.name},
        {"right", fmt::format("{} of {}", group.right, group.scenes - group.not_supported)}};
    for (std::size_t i = 0; i < card.points.size(); ++i) {
      row[fmt::format("{} points", card.points[i])] = number_word("{:.1e}", group.largest[i]);
    }
    row["order"] = number_word("{:.1f}", group.order);
    row["time"] = fmt::format("{:.2g} s", group.seconds);
    row["causes"] = causes_words(group);
    return row;
  });
}

std::string markdown_row(const std::vector<std::string>& cells) {
  return fmt::format("| {} |\n", fmt::join(cells, " | "));
}

}  // namespace

std::string cards_text(const std::vector<Card>& cards) {
  std::string out;
  for (const Card& card : cards) {
    append(out, "{}{}: {} (suite {})\n", out.empty() ? "" : "\n", card.simulator, summary(card),
           card.battery_version);
    out += compare::Document{.json = {{"classes", rows_of(card)}}}.text();
    for (const auto& [scenes, wrong] : wrong_scenes(card)) append(out, "  {}: {}\n", scenes, wrong);
  }
  return out;
}

std::string cards_markdown(const std::vector<Card>& cards) {
  std::string out;
  for (const Card& card : cards) {
    append(out, "{}**{}**: {} (suite {})\n\n", out.empty() ? "" : "\n", markdown(card.simulator),
           summary(card), card.battery_version);
    std::vector<std::string> head;
    std::string rows;
    for (const Json& row : rows_of(card)) {
      head.clear();
      std::vector<std::string> cells;
      for (const auto& [title, cell] : row.items()) {
        head.push_back(markdown(title));
        cells.push_back(markdown(cell));
      }
      rows += markdown_row(cells);
    }
    out += markdown_row(head) + markdown_row(std::vector<std::string>(head.size(), "---")) + rows;
    std::string list;
    for (const auto& [scenes, wrong] : wrong_scenes(card)) {
      append(list, "- `{}`: {}\n", scenes, markdown(wrong));
    }
    if (!list.empty())
      append(out, "\n<details><summary>Scenes</summary>\n\n{}\n</details>\n", list);
  }
  return out;
}

std::string cards_junit(const std::vector<Card>& cards) {
  std::vector<compare::JunitSuite> suites;
  for (const Card& card : cards) {
    suites.push_back({card.simulator, {}});
    for (const CardScene& scene : card.scenes) {
      compare::JunitCase one{.group = "dlo.suite." + scene.group,
                             .name = scene.id,
                             .message = cause_or_problem(scene)};
      for (const compare::SimulatorRun& run : scene.runs) one.seconds += run.seconds;
      if (scene.status() == RunStatus::not_supported) {
        one.outcome = "skipped";
      } else if (scene.status() != RunStatus::solved) {
        one.outcome = "error";
        one.type = compare::to_string(scene.status());
      } else if (!scene.is_correct()) {
        one.outcome = "failure";
        one.type = "wrong";
      }
      suites.back().cases.push_back(std::move(one));
    }
  }
  return compare::junit_xml(suites);
}

compare::Figure card_figure(const Card& card) {
  compare::Panel panel{.x = {.label = "N", .logarithmic = true},
                       .y = {.label = "largest RMS distance over l", .logarithmic = true}};
  const std::vector<CardGroup> groups = card.groups();
  for (std::size_t i = 0; i < groups.size(); ++i) {
    panel.curves.push_back({.title = groups[i].name,
                            .look = compare::curve_style(i),
                            .x = {card.points.begin(), card.points.end()},
                            .y = groups[i].largest});
  }
  return {.title = card.simulator + ": error of each class against N",
          .panels = {std::move(panel)}};
}

compare::PageResult card_page(const Card& card) {
  const CardGroup total = card.total();
  return {.title = card.simulator,
          .passes = total.right == total.solved && total.failed == 0 && total.not_judged == 0,
          .text = cards_text({card})};
}

}  // namespace dlo::cli
