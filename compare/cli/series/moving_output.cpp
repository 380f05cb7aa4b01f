#include "base/quote.hpp"
#include "format/result_output.hpp"
#include "option/output.hpp"
#include "series/study_output.hpp"

namespace dlo::cli {
namespace {

using compare::MovingAssumptions;
using compare::MovingRow;

const char* to_text(compare::MovingStatus status) {
  if (status == compare::MovingStatus::finished) return "finished";
  return status == compare::MovingStatus::too_many_steps ? "given up" : "diverged";
}

Json moving_json(const MovingAssumptions& choices) {
  return {{"length_unit_m", choices.length_unit},
          {"grip_force_at_5_percent_N", choices.grip_force},
          {"angle_rad", choices.angle},
          {"distance_m", choices.distance},
          {"c_h", choices.c_h},
          {"c_s_change", choices.c_s_change},
          {"start_offset_segments", choices.start_offset}};
}

Json moving_json(const compare::MovingAgreement& distance) {
  // A factor that is not finite becomes null.
  return {{"force_factor", distance.force_factor},
          {"counters_near", distance.matching_counters},
          {"counters", distance.counters}};
}

Json row_json(const MovingRow& row) {
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
  const compare::PointParameters reading = compare::point_parameters(row.run.c_F, row.run.c_h);
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
  return entry;
}

Json scan_json(const compare::MovingScanEntry& entry) {
  return {{"varied", entry.varied},
          {"choices", moving_json(entry.choices)},
          {"distance", moving_json(entry.distance)},
          {"rows", json_list(entry.rows, row_json)}};
}

}  // namespace

Json moving_json(const compare::MovingReport& report) {
  return {{"choices", moving_json(report.choices)},
          {"nominal_steps", compare::nominal_moving_steps},
          {"rows", json_list(report.rows, row_json)},
          {"distance", moving_json(report.distance)},
          {"reference",
           {{"bending_stiffness_N_m2", compare::reference_bending_stiffness()},
            {"mass_kg", compare::table_1().mass},
            {"weight_N", compare::moving_weight()},
            {"damping_ratio", compare::reference_damping_ratio},
            {"energy_error", report.reference_energy_error}}},
          {"scan", json_list(report.scan, scan_json)},
          {"table_3_scan", json_list(report.table_3_scan, scan_json)},
          {"findings", report.findings}};
}

}  // namespace dlo::cli
