#include "report/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/solution.hpp"
#include "judge/budget_parts.hpp"

namespace dlo::compare {
namespace {

std::string setting_of(const Comparison& c) {
  return fmt::format("{}, {}, {}", to_string(c.settings.law), to_string(c.settings.bookkeeping),
                     c.settings.points);
}

const char* const setting_head = "law, bookkeeping, N";

/// Calls for every comparison.
template <typename Function>
void for_each_comparison(const Report& report, const Function& function) {
  for (const SceneReport& scene : report.scenes) {
    for (const Comparison& comparison : scene.comparisons) function(comparison);
  }
}

std::string hold_of(const Scene& scene) {
  std::string text;
  for (const Gripper& gripper : scene.grippers) {
    if (!text.empty()) text += ", ";
    text += fmt::format("{} at {} m", gripper.direction ? "clamp" : "pin", page_number(gripper.at));
    if (gripper.frame) text += " that holds the frame";
  }
  return text;
}

std::string answer_text(const std::vector<BenchmarkRun>& runs, std::optional<std::size_t> best,
                        std::optional<Model> model) {
  if (!best) return has_run(runs, model) ? "none" : "not run";
  return fmt::format("{}: {} ms", name_of(runs[*best]),
                     page_number(runs[*best].time.median_s * 1e3));
}

void add_answers(const SceneBenchmark& scene, const char* kind,
                 const std::vector<BenchmarkRun>& runs, const std::vector<BenchmarkAnswer>& answers,
                 HtmlTable& table) {
  for (const BenchmarkAnswer& answer : answers) {
    table.add_row(
        scene.scene, kind, page_percent(answer.error), answer_text(runs, answer.best, {}),
        answer_text(runs, fastest_within(runs, answer.error, Model::force), Model::force));
  }
}

/// What became of it, in a word, and how far it is off.
std::string outcome_cell(const StabilityResult& result) {
  const bool creeping = result.outcome == Outcome::wrong && !result.at_rest;
  std::string word = creeping ? "creeping" : to_string(result.outcome);
  if (result.outcome == Outcome::refused) return word;
  const char* mark = result.outcome == Outcome::pass ? "✓" : "✗";
  if (!std::isfinite(result.error_over_length)) return fmt::format("{} {}", mark, word);
  return fmt::format("{} {} {:.0e}", mark, word, result.error_over_length);
}

}  // namespace

HtmlTable scene_table(const Report& report) {
  HtmlTable table{.caption = "Scenes",
                  .columns = {{"scene", HtmlCell::text},
                              {"l [m]"},
                              {"d [mm]"},
                              {"EI [N m²]"},
                              {"ρA [kg/m]"},
                              {"Γ = w l³/(EI)"},
                              {"held", HtmlCell::text},
                              {"loads"},
                              {"file", HtmlCell::word}}};
  for (const SceneReport& entry : report.scenes) {
    const Scene& scene = entry.file.scene;
    table.add_row(scene.name, scene.length,
                  scene.diameter > 0 ? page_number(scene.diameter * 1e3) : "",
                  scene.bending_stiffness(), scene.mass_per_length(), scene.gamma(), hold_of(scene),
                  scene.loads.size() + scene.distributed_loads.size(), "scenes/" + entry.file.name);
  }
  return table;
}

HtmlTable deviation_table(const Report& report) {
  HtmlTable table{.caption =
                      "Distance of the force model at rest from the energy model, at equal "
                      "arc length",
                  .columns = {{"scene", HtmlCell::text},
                              {setting_head, HtmlCell::word},
                              {"RMS [mm]"},
                              {"RMS / l"},
                              {"RMS / movement"},
                              {"largest [mm]"},
                              {"at s [m]"},
                              {"tip [mm]"},
                              {"tangent RMS [deg]"},
                              {"curvature RMS [1/m]"},
                              {"unbent rod, RMS / l"}}};
  for_each_comparison(report, [&](const Comparison& c) {
    const Deviation& d = c.deviation;
    table.add_row(c.scene, setting_of(c), d.rms_m * 1e3, page_percent(d.rms_over_length),
                  page_percent(d.rms_over_movement), d.max_m * 1e3, d.max_at_m, d.tip_m * 1e3,
                  d.angle_rms_rad * 180 / std::numbers::pi, d.curvature_rms_per_m,
                  page_percent(c.undeformed_rms_over_length));
  });
  return table;
}

HtmlTable state_table(const Report& report) {
  HtmlTable table{.caption = "Which equilibrium of the energy model was compared",
                  .columns = {{"scene", HtmlCell::text},
                              {setting_head, HtmlCell::word},
                              {"its energy [J]"},
                              {"rank by energy"},
                              {"stable ones found"},
                              {"unstable ones found"}}};
  for_each_comparison(report, [&](const Comparison& c) {
    table.add_row(c.scene, setting_of(c), c.state.energy_J, c.state.rank, c.state.stable,
                  c.state.unstable);
  });
  return table;
}

HtmlTable budget_table(const Report& report) {
  HtmlTable table{
      .caption = "What the budgets split: RMS of force model - rod, and the largest part",
      .columns = {{"scene", HtmlCell::text},
                  {setting_head, HtmlCell::word},
                  {"total [mm]"},
                  {"largest part", HtmlCell::word},
                  {"its share of the total"}}};
  for_each_comparison(report, [&](const Comparison& c) {
    const auto parts = shown_parts(c);
    const auto largest =
        std::max_element(parts.begin(), parts.end(), [](const auto& a, const auto& b) {
          return std::abs(a.second->share) < std::abs(b.second->share);
        });
    table.add_row(c.scene, setting_of(c), c.budget.total_m * 1e3, largest->first,
                  page_percent(largest->second->share));
  });
  return table;
}

HtmlTable motion_table(const Report& report) {
  HtmlTable table{.caption =
                      "Motion: contacts and snaps of the rod at rest, its grippers' largest "
                      "force and torque, and the error of the force model on the way",
                  .columns = {{"scene", HtmlCell::text},
                              {"time [s]"},
                              {"frames"},
                              {"contacts begin or end"},
                              {"snaps"},
                              {"branch lost"},
                              {"largest force [N]"},
                              {"largest torque [N m]"},
                              {"force model: mean error"},
                              {"largest error"},
                              {"lag [ms]"}}};
  for (const MotionReport& motion : report.motions) {
    const Track& track = motion.track;
    double force = 0;
    double torque = 0;
    for (const TrackFrame& frame : track.frames) {
      for (const GripperLoad& load : frame.grippers) {
        force = std::max(force, load.force.norm());
        torque = std::max(torque, load.torque.norm());
      }
    }
    const auto count = [&](auto... kinds) {
      return std::count_if(track.events.begin(), track.events.end(),
                           [=](const TrackEvent& event) { return ((event.kind == kinds) || ...); });
    };
    using Kind = TrackEvent::Kind;
    const std::string lost = std::to_string(count(Kind::lost));
    const bool beside = track.force.none.empty();
    const double none = std::numeric_limits<double>::quiet_NaN();
    table.add_row(motion.file.scene.name, track.frames.back().time - track.frames.front().time,
                  track.frames.size(), count(Kind::contact, Kind::release), count(Kind::snap), lost,
                  force, torque, page_percent(beside ? track.force.mean : none),
                  page_percent(beside ? track.force.largest : none), track.force.lag * 1e3);
  }
  return table;
}

HtmlTable modulus_table(const Report& report) {
  HtmlTable table{.caption = "E*/E at rest: the modulus at which the energy model comes nearest",
                  .columns = {{"scene", HtmlCell::text},
                              {setting_head, HtmlCell::word},
                              {"E*/E"},
                              {"RMS there [mm]"},
                              {"RMS there / l"},
                              {"optimum", HtmlCell::word}}};
  for_each_comparison(report, [&](const Comparison& c) {
    table.add_row(
        c.scene, setting_of(c), c.effective_modulus.ratio, c.effective_modulus.rms_m * 1e3,
        page_percent(c.effective_modulus.rms_m / c.length), to_string(c.effective_modulus.optimum));
  });
  return table;
}

HtmlTable history_table(const Report& report) {
  HtmlTable table{.caption =
                      "E*/E on the way to rest: stepper basic, 4000 steps per simulated "
                      "second",
                  .columns = {{"scene", HtmlCell::text},
                              {"weight of a point [N]"},
                              {"c_c [N]"},
                              {"c_F [m/N]"},
                              {"at 1 s"},
                              {"at 10 s"},
                              {"at 28 s"},
                              {"at 200 s"},
                              {"at rest"},
                              {"passes 1/3 at [s] (–: not in 200 s)"}}};
  const auto add = [&](const SceneHistory& entry) {
    std::vector<std::string> row = {entry.scene,
                                    page_number(entry.point_weight) +
                                        (entry.weight == PaperWeight::printed ? ", Table 5's" : ""),
                                    page_number(entry.history.c_c), page_number(entry.history.c_F)};
    for (const double time : {1., 10., 28., last_history_time}) {
      for (const ModulusAtTime& at : entry.history.times) {
        if (at.time_s == time) row.push_back(page_number(at.modulus.ratio));
      }
    }
    row.push_back(page_number(entry.rest.ratio));
    row.push_back(page_number(time_at_ratio(entry.history.times, 1. / 3)));
    table.rows.push_back(std::move(row));
  };
  for (const SceneReport& scene : report.scenes) {
    if (scene.history) add(*scene.history);
  }
  for (const SceneHistory& entry : report.printed_weight) add(entry);
  return table;
}

HtmlTable answer_table(const Report& report) {
  HtmlTable table{.caption = "What to use: the fastest run within an error",
                  .columns = {{"scene", HtmlCell::text},
                              {"kind", HtmlCell::word},
                              {"error, RMS / l"},
                              {"of all models", HtmlCell::text},
                              {"with points and forces", HtmlCell::text}}};
  for (const SceneBenchmark& scene : report.benchmark->scenes) {
    add_answers(scene, "static", scene.runs, scene.answers, table);
    add_answers(scene, "tracking", scene.tracking, scene.tracking_answers, table);
  }
  return table;
}

HtmlTable front_table(const SceneBenchmark& scene) {
  HtmlTable table{
      .caption = fmt::format("{}, Γ = {}: runs on the front (static; error against {})",
                             scene.scene, page_number(scene.gamma), to_string(scene.reference)),
      .columns = {{"run", HtmlCell::text},
                  {"median [ms]"},
                  {"quartiles [ms]"},
                  {"evaluations or steps"},
                  {"RMS / l"}}};
  for (const BenchmarkRun& run : scene.runs) {
    if (!run.front) continue;
    table.add_row(name_of(run), run.time.median_s * 1e3,
                  fmt::format("{} to {}", page_number(run.time.lower_quartile_s * 1e3),
                              page_number(run.time.upper_quartile_s * 1e3)),
                  run.evaluations, run.rms_over_length);
  }
  return table;
}

HtmlTable map_table(const StabilityMap& map) {
  HtmlTable table{.caption = map.scene + ": largest stable c_F",
                  .columns = {{"c_c [N]"},
                              {"c_h"},
                              {"stiffest mode, bound [N/m]"},
                              {"predicted [m/N]"},
                              {"measured [m/N]"},
                              {"measured / predicted"},
                              {"Table 1's c_F / measured"}}};
  for (const MapColumn& column : map.columns) {
    table.add_row(column.c_c, column.c_h, column.fastest_mode, column.predicted, column.measured,
                  column.measured / column.predicted, column.table_1 / column.measured);
  }
  return table;
}

HtmlTable hard_case_table(const std::vector<StabilityResult>& results) {
  HtmlTable table{.caption =
                      "Hard cases: outcome, and largest distance from the chain's rest "
                      "shape over the length",
                  .columns = {{"case", HtmlCell::text}}};
  for (const StabilityResult& result : results) {
    const bool first_case = result.name == results.front().name;
    if (first_case) table.columns.push_back({to_string(result.stepper), HtmlCell::word});
    if (table.rows.empty() || table.rows.back().front() != result.name) {
      table.add_row(result.name);
    }
    table.rows.back().push_back(outcome_cell(result));
  }
  table.columns.push_back({"what is hard about it", HtmlCell::text});
  std::size_t row = 0;
  for (const StabilityResult& result : results) {
    if (row < table.rows.size() && table.rows[row].front() == result.name) {
      table.rows[row].resize(table.columns.size() - 1);
      table.rows[row].push_back(result.what);
      ++row;
    }
  }
  return table;
}

HtmlTable parameter_table(const Report& report) {
  HtmlTable table{.caption = "Parameters of the force model",
                  .columns = {{"scene", HtmlCell::text},
                              {setting_head, HtmlCell::word},
                              {"L [mm]"},
                              {"c_b [N]"},
                              {"c_b by", HtmlCell::word},
                              {"c_c [N]"},
                              {"c_F [m/N]"},
                              {"c_h"},
                              {"stepper", HtmlCell::word},
                              {"weight of a point [N]"},
                              {"steps"},
                              {"force [ms]"},
                              {"energy [ms]"}}};
  for_each_comparison(report, [&](const Comparison& c) {
    const Parameters& p = c.force.parameters;
    const bool paper = c.settings.law == BendingLaw::paper;
    table.add_row(c.scene, setting_of(c), p.segment_length * 1e3, paper ? page_number(p.c_b) : "–",
                  !paper           ? "–"
                  : c.settings.c_b ? "given"
                                   : to_string(c.settings.bending_rule),
                  p.c_c, c.force.c_F, c.force.c_h, to_string(c.settings.stepper), p.point_weight,
                  c.force.steps, c.force.seconds * 1e3, c.energy_seconds * 1e3);
  });
  return table;
}

}  // namespace dlo::compare
