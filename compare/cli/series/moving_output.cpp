#include <cmath>
#include <numbers>

#include "base/quote.hpp"
#include "format/result_output.hpp"
#include "option/output.hpp"
#include "series/study_output.hpp"

namespace dlo::cli {
namespace {

using compare::MovingChoices;
using compare::MovingRow;

const char* to_text(compare::MovingStatus status) {
  switch (status) {
    case compare::MovingStatus::finished:
      return "finished";
    case compare::MovingStatus::too_many_steps:
      return "given up";
    case compare::MovingStatus::diverged:
      break;
  }
  return "diverged";
}

std::string name(const MovingRow& row) {
  return fmt::format("{}, {}, {}", compare::to_string(row.experiment.movement),
                     row.experiment.horizontal ? "horizontal rod" : "hanging rod",
                     compare::to_string(row.experiment.variant));
}

std::string pair(const std::string& computed, const std::string& printed) {
  return fmt::format("{:>9} {:>8}", computed, printed);
}

void add_rows(std::string& out, const std::vector<MovingRow>& rows) {
  append(out, "  {:<5} {:<42} {:^18} {:^18} {:^18} {:^18} {:>8}\n", "table", "", "steps needed",
         "c_s != 1", "d_m > l_s", "avg. force [N]", "net [N]");
  append(out, "  {:<5} {:<42} {} {} {} {}\n", "", "", pair("here", "printed"),
         pair("here", "printed"), pair("here", "printed"), pair("here", "printed"));
  for (const MovingRow& row : rows) {
    const compare::MovingRun& run = row.run;
    const auto count = [&](long computed, long compare::PrintedMovingRow::*member) {
      return pair(fmt::format("{}", computed),
                  row.printed ? fmt::format("{}", (*row.printed).*member) : "-");
    };
    append(out, "  {:<5} {:<42} {} {} {} {} {:>8.3f}{}\n", row.printed ? row.printed->table : "-",
           name(row), count(run.steps, &compare::PrintedMovingRow::steps),
           count(run.damped_steps, &compare::PrintedMovingRow::damped_steps),
           count(run.limited_steps, &compare::PrintedMovingRow::limited_steps),
           pair(fmt::format("{:.3f}", run.average_force),
                row.printed ? fmt::format("{:.2f}", row.printed->average_force) : "-"),
           run.average_net_force,
           run.status == compare::MovingStatus::finished
               ? ""
               : fmt::format("  ({})", to_text(run.status)));
  }
}

/// Adds the errors against the dynamic energy model, and the physical parameters of the points.
void add_errors(std::string& out, const compare::MovingReport& report) {
  append(out,
         "\nAgainst the moving energy model, and Formula 19 read as points of mass m* = dt^2/c_F\n"
         "  {:<5} {:<42} {:>9} {:>9} {:>10} {:>10} {:>8} {:>11}\n",
         "table", "", "shape RMS", "largest", "force RMS", "largest", "m*", "damping");
  for (const MovingRow& row : report.rows) {
    if (!row.error) continue;
    const compare::PointReading reading = compare::point_reading(row.run.c_F, row.run.c_h);
    append(out,
           "  {:<5} {:<42} {:>7.2f} % {:>7.2f} % {:>8.4f} N {:>8.4f} N {:>6.3f} g {:>7.0f} 1/s\n",
           row.printed ? row.printed->table : "-", name(row), 100 * row.error->shape_rms,
           100 * row.error->shape_max, row.error->force_rms, row.error->force_max,
           1e3 * reading.mass, reading.damping_rate);
  }
}

std::string factor(const compare::MovingDistance& distance) {
  return std::isfinite(distance.force_factor) ? fmt::format("{:.3f}", distance.force_factor)
                                              : std::string("no end");
}

void add_scan(std::string& out, const std::vector<compare::MovingScanEntry>& scan) {
  append(out, "  {:<34} {:>8} {:>9} ", "varied", "forces x", "counters");
  for (const MovingRow& row : scan.front().rows) {
    append(out, " {:>15}", row.printed->label.substr(0, 15));
  }
  out += "\n";
  for (const compare::MovingScanEntry& entry : scan) {
    append(out, "  {:<34} {:>8} {:>6}/{:<2} ", entry.varied, factor(entry.distance),
           entry.distance.counters_near, entry.distance.counters);
    for (const MovingRow& row : entry.rows) {
      append(out, " {:>15}",
             row.run.status == compare::MovingStatus::finished
                 ? fmt::format("{:.2f} N {:>6}+", row.run.average_force,
                               row.run.steps - compare::nominal_moving_steps)
                 : to_text(row.run.status));
    }
    out += "\n";
  }
  append(out, "  {:<34} {:>8} {:>9} ", "printed", "", "");
  for (const MovingRow& row : scan.front().rows) {
    append(out, " {:>15}",
           fmt::format("{:.2f} N {:>6}+", row.printed->average_force,
                       row.printed->steps - compare::nominal_moving_steps));
  }
  out += "\n";
}

Json moving_json(const MovingChoices& choices) {
  return {{"length_unit_m", choices.length_unit},
          {"grip_force_at_5_percent_N", choices.grip_force},
          {"angle_rad", choices.angle},
          {"distance_m", choices.distance},
          {"c_h", choices.c_h},
          {"c_s_change", choices.c_s_change},
          {"start_offset_segments", choices.start_offset}};
}

Json moving_json(const compare::MovingDistance& distance) {
  // A factor that is not finite becomes null.
  return {{"force_factor", distance.force_factor},
          {"counters_near", distance.counters_near},
          {"counters", distance.counters}};
}

Json moving_json(const std::vector<MovingRow>& rows) {
  Json result = Json::array();
  for (const MovingRow& row : rows) {
    const compare::MovingRun& run = row.run;
    Json entry = {{"movement", compare::to_string(row.experiment.movement)},
                  {"rod", row.experiment.horizontal ? "horizontal" : "hanging"},
                  {"variant", compare::to_string(row.experiment.variant)},
                  {"status", to_text(run.status)},
                  {"steps", run.steps},
                  {"c_s_not_1", run.damped_steps},
                  {"d_m_above_l_s", run.limited_steps},
                  {"average_force_N", run.average_force},
                  {"average_net_force_N", run.average_net_force}};
    if (row.printed) {
      entry["printed"] = {{"table", row.printed->table},
                          {"label", row.printed->label},
                          {"steps", row.printed->steps},
                          {"c_s_not_1", row.printed->damped_steps},
                          {"d_m_above_l_s", row.printed->limited_steps},
                          {"average_force_N", row.printed->average_force}};
    }
    const compare::PointReading reading = compare::point_reading(row.run.c_F, row.run.c_h);
    entry["reading"] = {{"point_mass_kg", reading.mass},
                        {"damping_rate_per_s", reading.damping_rate},
                        {"drag_N_s_per_m", reading.drag}};
    if (row.error) {
      // Errors that are not finite become null.
      entry["error"] = {{"shape_rms_over_length", row.error->shape_rms},
                        {"shape_max_over_length", row.error->shape_max},
                        {"force_rms_N", row.error->force_rms},
                        {"force_max_N", row.error->force_max}};
    }
    result.push_back(std::move(entry));
  }
  return result;
}

Json moving_json(const std::vector<compare::MovingScanEntry>& scan) {
  return json_list(scan, [&](const compare::MovingScanEntry& entry) -> Json {
    return {{"varied", entry.varied},
            {"choices", moving_json(entry.choices)},
            {"distance", moving_json(entry.distance)},
            {"rows", moving_json(entry.rows)}};
  });
}

}  // namespace

std::string moving_text(const compare::MovingReport& report) {
  const MovingChoices& choices = report.choices;
  std::string out;
  append(
      out,
      "\nTables 2 to 4, moving grippers: Table 1's rod, 28 s, nominal {} steps, movement from 5 "
      "to 13 s.\nThe paper does not give angle, speed, c_h, the growth of c_s and the unit of c_F. "
      "Chosen: {:g} deg,\n{:g} cm in 8 s, c_h = {:g}, c_s grows by {:g}; c_F and l_s in units "
      "of {:g} m; {:g} N at 5 % of a segment.\n",
      compare::nominal_moving_steps, choices.angle * 180 / std::numbers::pi, choices.distance * 100,
      choices.c_h, choices.c_s_change, choices.length_unit, choices.grip_force);
  add_rows(out, report.rows);
  add_errors(out, report);
  append(out,
         "\nAverage forces are off by a factor {}, {} of {} counters are within 10 % of the print."
         "\n\nOne choice varied at a time, Tables 2 and 4: average force and steps beyond the "
         "nominal ones\n",
         factor(report.distance), report.distance.counters_near, report.distance.counters);
  add_scan(out, report.scan);
  out += "\nTable 3 against the distance\n";
  add_scan(out, report.table_3_scan);
  out += "\n";
  for (const std::string& finding : report.findings) out += "  - " + finding + "\n";
  return out;
}

std::string moving_csv(const compare::MovingReport& report) {
  std::string out;
  const auto add = [&](const std::string& item, const char* quantity, double value) {
    append(out, "moving,,{},{},{}\n", compare::csv_field(item), quantity,
           compare::csv_number(value, 12));
  };
  const auto add_rows = [&](const std::string& varied, const std::vector<MovingRow>& rows) {
    for (const MovingRow& row : rows) {
      const std::string item = fmt::format("{}; varied: {}", name(row), varied);
      add(item, "steps", static_cast<double>(row.run.steps));
      add(item, "c_s_not_1", static_cast<double>(row.run.damped_steps));
      add(item, "d_m_above_l_s", static_cast<double>(row.run.limited_steps));
      add(item, "average_force_N", row.run.average_force);
      if (row.printed) add(item, "printed_average_force_N", row.printed->average_force);
      if (!row.error) continue;
      const compare::PointReading reading = compare::point_reading(row.run.c_F, row.run.c_h);
      add(item, "point_mass_kg", reading.mass);
      add(item, "damping_rate_per_s", reading.damping_rate);
      add(item, "shape_rms_over_length", row.error->shape_rms);
      add(item, "shape_max_over_length", row.error->shape_max);
      add(item, "force_rms_N", row.error->force_rms);
      add(item, "force_max_N", row.error->force_max);
    }
  };
  add_rows("none", report.rows);
  for (const auto* scan : {&report.scan, &report.table_3_scan}) {
    for (const compare::MovingScanEntry& entry : *scan) {
      if (entry.choices != report.choices) add_rows(entry.varied, entry.rows);
    }
  }
  return out;
}

Json moving_json(const compare::MovingReport& report) {
  return {{"choices", moving_json(report.choices)},
          {"nominal_steps", compare::nominal_moving_steps},
          {"rows", moving_json(report.rows)},
          {"distance", moving_json(report.distance)},
          {"reference",
           {{"bending_stiffness_N_m2", compare::reference_bending_stiffness()},
            {"mass_kg", compare::table_1().mass},
            {"weight_N", compare::moving_weight()},
            {"damping_ratio", compare::reference_damping_ratio},
            {"energy_error", report.reference_energy_error}}},
          {"scan", moving_json(report.scan)},
          {"table_3_scan", moving_json(report.table_3_scan)},
          {"findings", report.findings}};
}

}  // namespace dlo::cli
