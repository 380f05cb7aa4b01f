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

std::string error_word(double error) {
  return std::isfinite(error) ? fmt::format("{:.1e}", error) : "-";
}

std::string order_word(double order) {
  return std::isfinite(order) ? fmt::format("{:.1f}", order) : "-";
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
std::string what_is_wrong(const CardScene& scene) {
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
  if (text.empty() && !scene.right()) {
    constexpr double converges = 0.8;
    text = fmt::format("{:.3g} % of l off with N = {}, {}", scene.runs.back().error * 100,
                       scene.runs.back().points,
                       scene.order > converges
                           ? fmt::format("and converges with order {:.1f}", scene.order)
                           : "the cause was not found");
  }
  return text;
}

/// Returns the scenes that are not right, grouped by their reason, with that reason.
std::vector<std::pair<std::string, std::string>> wrong_scenes(const Card& card) {
  std::vector<std::pair<std::string, std::string>> reasons;
  for (const CardScene& scene : card.scenes) {
    const std::string wrong = what_is_wrong(scene);
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

std::vector<std::string> row_of(const CardGroup& group) {
  std::vector<std::string> row = {
      group.name, fmt::format("{} of {}", group.right, group.scenes - group.not_supported)};
  for (const double error : group.largest) row.push_back(error_word(error));
  row.push_back(order_word(group.order));
  row.push_back(fmt::format("{:.2g} s", group.seconds));
  row.push_back(causes_words(group));
  return row;
}

std::vector<std::string> head_of(const Card& card) {
  std::vector<std::string> head = {"class", "right"};
  for (const int points : card.points) head.push_back(fmt::format("N = {}", points));
  head.insert(head.end(), {"order", "time", "causes"});
  return head;
}

std::string markdown_row(std::vector<std::string> cells) {
  for (std::string& cell : cells) cell = markdown(cell);
  return fmt::format("| {} |\n", fmt::join(cells, " | "));
}

}  // namespace

std::string cards_text(const std::vector<Card>& cards) {
  std::string out;
  for (const Card& card : cards) {
    append(out, "{}{}: {} (suite {})\n  {:<11}{:>9}", out.empty() ? "" : "\n", card.simulator,
           summary(card), card.battery_version, "class", "right");
    for (const int points : card.points) append(out, "{:>9}", fmt::format("N = {}", points));
    append(out, "{:>7}{:>11}  {}\n", "order", "time", "causes");
    for (const CardGroup& group : card.groups()) {
      const std::vector<std::string> row = row_of(group);
      append(out, "  {:<11}{:>9}", row[0], row[1]);
      for (std::size_t i = 2; i < row.size() - 3; ++i) append(out, "{:>9}", row[i]);
      append(out, "{:>7}{:>11}  {}", row[row.size() - 3], row[row.size() - 2], row.back());
      out.erase(out.find_last_not_of(' ') + 1);
      out += "\n";
    }
    for (const auto& [scenes, wrong] : wrong_scenes(card)) append(out, "  {}: {}\n", scenes, wrong);
  }
  return out;
}

std::string cards_markdown(const std::vector<Card>& cards) {
  std::string out;
  for (const Card& card : cards) {
    append(out, "{}**{}**: {} (suite {})\n\n", out.empty() ? "" : "\n", markdown(card.simulator),
           summary(card), card.battery_version);
    const std::vector<std::string> head = head_of(card);
    out += markdown_row(head);
    out += markdown_row(std::vector<std::string>(head.size(), "---"));
    for (const CardGroup& group : card.groups()) out += markdown_row(row_of(group));
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
      compare::JunitCase one{
          .group = "dlo.suite." + scene.group, .name = scene.id, .message = what_is_wrong(scene)};
      for (const compare::SimulatorRun& run : scene.runs) one.seconds += run.seconds;
      if (scene.status() == RunStatus::not_supported) {
        one.outcome = "skipped";
      } else if (scene.status() != RunStatus::solved) {
        one.outcome = "error";
        one.type = compare::to_string(scene.status());
      } else if (!scene.right()) {
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
                            .look = compare::curve_look(i),
                            .x = {card.points.begin(), card.points.end()},
                            .y = groups[i].largest});
  }
  return {.title = card.simulator + ": error of each class against N",
          .panels = {std::move(panel)}};
}

compare::PageResult card_page(const Card& card) {
  const CardGroup total = card.total();
  const bool passes = total.right == total.solved && total.failed == 0 && total.not_judged == 0;
  compare::PageResult page{
      .title = card.simulator,
      .passes = passes,
      .verdict = summary(card),
      .summary = fmt::format("Suite {}. A scene is right within 1 % of the length (RMS).",
                             card.battery_version),
      .cause = {},
      .numbers = {{"right", std::to_string(total.right), fmt::format("of {}", total.scenes)},
                  {"order of convergence", order_word(total.order), "the smallest"},
                  {"time", fmt::format("{:.2g} s", total.seconds), "of all runs"}},
      .pictures = {},
      .table = {"Largest RMS distance from the rod over its length, by classes", head_of(card), {}},
      .details = {}};
  const std::string causes = causes_words(total);
  if (!causes.empty()) page.cause = "Causes: " + causes + ".";
  for (const CardGroup& group : card.groups()) page.table.rows.push_back(row_of(group));
  for (const auto& [scenes, wrong] : wrong_scenes(card)) {
    append(page.details, "{}: {}\n", scenes, wrong);
  }
  return page;
}

}  // namespace dlo::cli
