#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/number.hpp"
#include "base/text.hpp"
#include "option/output.hpp"
#include "series/series_output.hpp"

namespace dlo::cli {
namespace {

using compare::DynamicFrame;
using compare::DynamicTrack;
using compare::TrackErrors;

Json errors_json(const TrackErrors& errors) {
  return {{"mean_error_over_length", errors.mean},
          {"largest_error_over_length", errors.largest},
          {"largest_error_time_s", errors.largest_time}};
}

std::string errors_text(const TrackErrors& errors) {
  return fmt::format("mean {:.4g} % of l, largest {:.4g} % at {:.6g} s", errors.mean * 100,
                     errors.largest * 100, errors.largest_time);
}

std::string moving_table(const DynamicTrack& dynamic) {
  std::string out;
  append(out, "\n{:>10} {:>14} {:>12} {:>12} {:>12} {:>12}\n", "t [s]", "energy [J]", "kinetic [J]",
         "force 1 [N]", "at rest: d/l", "error/l");
  for (const std::size_t i : listed_frames(dynamic.frames.size())) {
    const DynamicFrame& frame = dynamic.frames[i];
    append(out, "{:10.5g} {:14.8g} {:12.5g} {:12.5g} {:12.3g} {:>12}\n", frame.time,
           compare::shown(frame.energy.total(), dynamic.largest_energy),
           compare::shown(frame.energy.kinetic, dynamic.largest_energy),
           frame.grippers.front().force.norm(), compare::shown(frame.quasi_static_error, 1),
           frame.force_error ? fmt::format("{:.3g}", *frame.force_error) : "-");
  }
  return out;
}

}  // namespace

Json moving_frame_json(const DynamicFrame& frame, bool points) {
  const energy_model::EnergyBalance& energy = frame.energy;
  Json result = {{"time_s", frame.time},
                 {"grippers", loads_json(frame.grippers)},
                 {"energy_J",
                  {{"kinetic", energy.kinetic},
                   {"bending", energy.bending},
                   {"twisting", energy.twisting},
                   {"gravity", energy.gravity},
                   {"load", energy.load},
                   {"obstacles", energy.obstacles},
                   {"total", energy.total()},
                   {"dissipated", energy.dissipated},
                   {"lost", energy.lost},
                   {"work", energy.work}}},
                 {"obstacles", obstacles_json(frame.obstacles)},
                 {"quasi_static_error_over_length", frame.quasi_static_error}};
  result["force_error_over_length"] = json_or_null(frame.force_error);
  if (points) result["points_m"] = points_json(frame.points);
  return result;
}

std::string dynamic_text(const DynamicTrack& dynamic) {
  std::string out;
  append(
      out,
      "\ndynamic     from {}; damping {:g} s, drag {:g} N s/m^2{}; {} terms, {} steps, {:.3g} s\n",
      dynamic.in_motion ? "motion" : "rest", dynamic.damping.material, dynamic.damping.air,
      dynamic.damping.quadratic > 0 ? fmt::format(" and {:g} N s^2/m^3", dynamic.damping.quadratic)
                                    : "",
      dynamic.terms, dynamic.steps, dynamic.seconds);
  if (dynamic.too_few_terms) {
    append(out, "            with {} terms it stopped before {:.6g} s\n",
           dynamic.too_few_terms->terms, dynamic.too_few_terms->time);
  }
  append(out,
         "            energy balance: residual {:.2g} of the largest energy, {:.4g} J\n"
         "            steps change the shape by {:.2g} l (estimate), {} terms instead {}\n",
         dynamic.energy_error, dynamic.largest_energy, dynamic.step_error, dynamic.fewer_terms,
         std::isfinite(dynamic.term_difference)
             ? fmt::format("by {:.2g} l", dynamic.term_difference)
             : "do not reach the last frame");
  if (dynamic.deepest_contact) {
    append(out,
           "contact     within a rigid obstacle by {:.2g} l at most; {:.4g} J were lost on them\n",
           *dynamic.deepest_contact, dynamic.frames.back().energy.lost);
  }
  append(out, "at rest     off the moving rod by {}\n", errors_text(dynamic.quasi_static));
  if (dynamic.force) {
    append(out, "force model off the moving rod by {}\n", errors_text(*dynamic.force));
    out += lag_text(dynamic.force_lag, dynamic.force_error_without_lag);
  }
  out += stop_text(dynamic.stopped);
  return out + moving_table(dynamic);
}

Json dynamic_json(const DynamicTrack& dynamic, const compare::Track& track,
                  const TrackFrames& frames) {
  Json result = {
      {"damping_s", dynamic.damping.material},
      {"drag_N_s_per_m2", dynamic.damping.air},
      {"in_motion", dynamic.in_motion},
      {"terms", dynamic.terms},
      {"too_few_terms", dynamic.too_few_terms ? Json(dynamic.too_few_terms->terms) : Json(nullptr)},
      {"steps", dynamic.steps},
      {"run_s", dynamic.seconds},
      {"energy_error", dynamic.energy_error},
      {"largest_energy_J", dynamic.largest_energy},
      {"step_error_over_length", dynamic.step_error},
      {"deepest_contact_over_length", json_or_null(dynamic.deepest_contact)},
      {"fewer_terms", dynamic.fewer_terms},
      {"fewer_terms_change_over_length", dynamic.term_difference},
      {"quasi_static", errors_json(dynamic.quasi_static)}};
  result["force_model"] = json_or_null(dynamic.force, [&](const TrackErrors& errors) {
    Json entry = errors_json(errors);
    entry["lag_s"] = dynamic.force_lag;
    entry["error_without_lag_over_length"] = dynamic.force_error_without_lag;
    return entry;
  });
  result["stopped"] = json_or_null(dynamic.stopped, stop_json);
  std::vector<std::size_t> listed = frames.of(track);
  std::erase_if(listed, [&](std::size_t i) { return i >= dynamic.frames.size(); });
  result["frames"] = json_list(
      listed, [&](std::size_t i) { return moving_frame_json(dynamic.frames[i], frames.points); });
  return result;
}

}  // namespace dlo::cli
