#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/number.hpp"
#include "base/output_file.hpp"
#include "base/text.hpp"
#include "format/json.hpp"
#include "format/result_output.hpp"
#include "option/output.hpp"
#include "record/csv_table.hpp"
#include "record/solution_fields.hpp"
#include "series/series_output.hpp"
#include "shape/write_vtk.hpp"
#include "trajectory/trajectory_files.hpp"

namespace dlo::cli {
namespace {

using compare::Track;
using compare::TrackEvent;
using compare::TrackFrame;
using compare::TrackOptions;
using energy_model::ContactKind;
using energy_model::ContactPart;

std::string vector_text(const Eigen::Vector3d& vector, double magnitude) {
  const Eigen::Vector3d v = shown(vector, magnitude);
  return compare::formatted("[{:.4g}, {:.4g}, {:.4g}]", v.x(), v.y(), v.z());
}

std::string part_text(const ContactPart& part) {
  const std::string kind = energy_model::to_string(part.kind);
  if (part.kind == ContactKind::lying) {
    return fmt::format("obstacle {}, {} from s = {:.4g} to {:.4g} m", part.obstacle + 1, kind,
                       part.begin, part.end);
  }
  return fmt::format("obstacle {}, {} at s = {:.4g} m", part.obstacle + 1, kind, part.begin);
}

/// Returns the contacts in words, such as "1 touching, 2 lying"; "-" if there is none.
std::string state_text(const TrackFrame& frame, const char* separator) {
  std::string text;
  for (const ContactPart& part : frame.contacts) {
    text += fmt::format("{}{} {}", text.empty() ? "" : separator, part.obstacle + 1,
                        energy_model::to_string(part.kind));
  }
  return text.empty() ? "-" : text;
}

std::string event_text(const Track& track, const TrackEvent& event,
                       const compare::Magnitudes& large) {
  const TrackFrame& after = track.frames[event.frame];
  const TrackFrame& before = track.frames[event.frame - 1];
  std::string out = fmt::format("{:11.6g} s  {:8}", after.time, to_string(event.kind));
  if (event.contact) {
    append(out, "{}", part_text(event.contact->part));
    if (event.contact->goes_on) {
      out += event.contact->begins ? ", touched before" : ", goes on touching";
    }
    out += "\n";
  } else {
    const bool balanced = std::isfinite(event.released);
    out += balanced ? fmt::format("{:.4g} J released (+- {:.2g} J)", event.released,
                                  event.released_bound)
                    : "the shape is another one";
    append(out, "; smallest eigenvalue before {:.3g}\n", event.smallest_eigenvalue);
    if (event.kind == TrackEvent::Kind::lost) {
      append(out, "{:23}its branch has not been seen to end: the solver may have lost it\n", "");
    }
  }
  for (std::size_t i = 0; i < after.grippers.size(); ++i) {
    const compare::GripperLoad& from = before.grippers[i];
    const compare::GripperLoad& to = after.grippers[i];
    append(out, "{:22} gripper {}: force {} -> {} N\n", "", i + 1,
           vector_text(from.force, large.force), vector_text(to.force, large.force));
    append(out, "{:22}            torque {} -> {} Nm\n", "", vector_text(from.torque, large.torque),
           vector_text(to.torque, large.torque));
  }
  return out;
}

std::string force_text(const Track& track, const compare::Scene& scene,
                       const TrackOptions& options) {
  const compare::ForceTrackSummary& force = track.force;
  std::string out = "force model ";
  if (track.frames.front().force) {
    append(out, "law {}, stepper {}, N = {}, {} steps a frame, {:.3g} ms (median)\n",
           compare::to_string(scene.force_model.law), compare::to_string(scene.force_model.stepper),
           scene.force_model.points, force.steps_per_frame, force.median_seconds * 1e3);
    append(out,
           "            error {:.4g} % of l at first (at rest), mean {:.4g} %, largest {:.4g} % "
           "at {:.6g} s\n",
           force.rest_error * 100, force.mean * 100, force.largest * 100, force.largest_time);
    out += lag_text(force.lag, force.error_without_lag);
    const double spare = 1 / options.rates.frames;
    if (force.median_seconds > spare) {
      append(out, "            not in real time: a frame has {:.4g} ms\n", spare * 1e3);
    }
    if (!force.none.empty())
      append(out, "            then none: {}\n", compare::display(force.none));
    return out;
  }
  append(out, "none: {}\n", compare::display(force.none));
  return out;
}

std::string table_text(const Track& track, const compare::Magnitudes& large) {
  std::string out;
  append(out, "\n{:>10} {:>14} {:>12} {:>12}   {}\n", "t [s]", "energy [J]", "force 1 [N]",
         "error/l", "touches");
  for (const std::size_t i : listed_frames(track.frames.size())) {
    const TrackFrame& frame = track.frames[i];
    append(out, "{:10.5g} {:14.8g} {:12.5g} {:>12}   {}\n", frame.time,
           compare::shown(frame.energy.total(), large.energy),
           compare::shown(frame.grippers.front().force.norm(), large.force),
           frame.force ? fmt::format("{:.3g}", frame.force->error_over_length) : "-",
           state_text(frame, ", "));
  }
  return out;
}

Json event_json(const Track& track, const TrackEvent& event) {
  const TrackFrame& after = track.frames[event.frame];
  const TrackFrame& before = track.frames[event.frame - 1];
  Json result = {{"time_s", after.time}, {"kind", to_string(event.kind)}};
  result["obstacle"] = event.contact ? Json(event.contact->part.obstacle) : Json(nullptr);
  result["from_m"] = event.contact ? Json(event.contact->part.begin) : Json(nullptr);
  result["to_m"] = event.contact ? Json(event.contact->part.end) : Json(nullptr);
  if (event.contact) {
    result["contact_kind"] = energy_model::to_string(event.contact->part.kind);
    result["goes_on"] = event.contact->goes_on;
  } else {
    result["released_J"] = event.released;
    result["released_bound_J"] = event.released_bound;
    result["smallest_eigenvalue_before"] = event.smallest_eigenvalue;
  }
  Json grippers = Json::array();
  for (std::size_t i = 0; i < after.grippers.size(); ++i) {
    grippers.push_back({{"force_before_N", to_json(before.grippers[i].force)},
                        {"force_after_N", to_json(after.grippers[i].force)},
                        {"torque_before_Nm", to_json(before.grippers[i].torque)},
                        {"torque_after_Nm", to_json(after.grippers[i].torque)}});
  }
  result["grippers"] = std::move(grippers);
  return result;
}

Json gripper_json(const compare::Gripper& gripper, const compare::GripperLoad& load) {
  Json entry = {{"position_m", to_json(gripper.position)}};
  if (gripper.direction) entry["direction"] = to_json(*gripper.direction);
  entry["force_N"] = to_json(load.force);
  entry["torque_Nm"] = to_json(load.torque);
  return entry;
}

Json frame_json(const TrackFrame& frame, const compare::Scene& scene, bool points) {
  const compare::Scene now = compare::scene_at(scene, frame.time);
  Json grippers = Json::array();
  for (std::size_t i = 0; i < frame.grippers.size(); ++i) {
    grippers.push_back(gripper_json(now.grippers[i], frame.grippers[i]));
  }
  Json energy = compare::json_of(compare::numbers_of(compare::energy_fields(), frame.energy));
  energy["work"] = frame.work;
  energy["released"] = frame.released;
  Json result = {{"time_s", frame.time},
                 {"followed", frame.followed},
                 {"smallest_eigenvalue", frame.smallest_eigenvalue},
                 {"grippers", std::move(grippers)},
                 {"contacts", contacts_json(frame.contacts)},
                 {"obstacles", obstacles_json(frame.obstacles)},
                 {"energy_J", std::move(energy)}};
  compare::add_json(result, compare::shape_numbers(), {scene, frame}, scene);
  result["error_over_length"] = frame.force ? Json(frame.force->error_over_length) : Json(nullptr);
  if (frame.force) result["force_grippers"] = loads_json(frame.force->grippers);
  if (!points) return result;
  result["points_m"] = points_json(frame.shape.points);
  if (frame.force) result["force_points_m"] = points_json(frame.force->points);
  return result;
}

/// Adds columns of the loads of grippers and obstacles. @param name, path  prefixes of their names
/// and paths
void add_forces(compare::CsvTable& table, const std::string& name, const std::string& path,
                const compare::Scene& scene) {
  const auto add = [&](const std::string& what, const char* unit, const std::string& of,
                       std::size_t i) {
    for (int axis = 0; axis < 3; ++axis) {
      table.add(fmt::format("{}{}{}_{}_{}={}{}_{}/{}", name, what, "xyz"[axis], i + 1, unit, path,
                            of, unit, axis));
    }
  };
  for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
    add("f", "N", fmt::format("grippers/{}/force", i), i);
    add("t", "Nm", fmt::format("grippers/{}/torque", i), i);
  }
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
    add("obstacle_f", "N", fmt::format("obstacles/{}/force", i), i);
  }
}

Json force_json(const compare::ForceTrackSummary& force, const compare::Scene& scene,
                const TrackOptions& options) {
  return {{"law", compare::to_string(scene.force_model.law)},
          {"stepper", compare::to_string(scene.force_model.stepper)},
          {"points", scene.force_model.points},
          {"steps_per_frame", force.steps_per_frame},
          {"steps_per_second", options.rates.steps},
          {"rest_error_over_length", force.rest_error},
          {"mean_error_over_length", force.mean},
          {"largest_error_over_length", force.largest},
          {"largest_error_time_s", force.largest_time},
          {"lag_s", force.lag},
          {"error_without_lag_over_length", force.error_without_lag},
          {"frame_s", force.median_seconds}};
}

}  // namespace

std::vector<std::size_t> TrackFrames::of(const Track& track) const {
  std::vector<std::size_t> result;
  const std::size_t count = track.frames.size();
  for (std::size_t i = 0; i < count; i += static_cast<std::size_t>(every)) result.push_back(i);
  for (const TrackEvent& event : track.events) result.push_back(event.frame);
  result.push_back(count - 1);
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

std::vector<std::size_t> listed_frames(std::size_t count) {
  constexpr std::size_t most_rows = 11;
  const std::size_t rows = std::min(count, most_rows);
  std::vector<std::size_t> result;
  result.reserve(rows);
  for (std::size_t row = 0; row < rows; ++row) {
    result.push_back(rows == 1 ? 0 : row * (count - 1) / (rows - 1));
  }
  return result;
}

std::string lag_text(double lag, double error_without_lag) {
  if (!std::isfinite(lag)) return "";
  return fmt::format(
      "            it lags by {:.4g} ms: from where the rod was then it is {:.4g} % of l (RMS) "
      "off\n",
      lag * 1e3, error_without_lag * 100);
}

std::string stop_text(const std::optional<compare::TrackStop>& stop) {
  if (!stop) return "";
  return fmt::format("stopped     at {:.6g} s: {}\n", stop->time, compare::display(stop->why));
}

Json stop_json(const compare::TrackStop& stop) {
  return {{"time_s", stop.time}, {"why", stop.why}};
}

std::string track_text(const Track& track, const compare::Scene& scene,
                       const TrackOptions& options) {
  std::string out;
  const TrackFrame& first = track.frames.front();
  const TrackFrame& last = track.frames.back();
  const compare::Magnitudes large = compare::magnitudes(scene);
  append(out, "scene       {}\n", compare::display(scene.name));
  append(out, "motion      {:.6g} to {:.6g} s, {} frames at {:g} Hz{}\n", first.time, last.time,
         track.frames.size(), options.rates.frames,
         options.rates.obstacles ? fmt::format(", obstacles at {:g} Hz", *options.rates.obstacles)
                                 : "");
  append(out, "energy      {:.3g} ms a frame (median): {:.4g} frames a second\n",
         track.median_seconds * 1e3, 1 / track.median_seconds);
  append(out, "branch      left in {} of them, kept in {} in smaller steps only\n", track.lost,
         track.repeated);
  double released = 0;
  for (const TrackEvent& event : track.events) {
    if (!event.contact) released += event.released;
  }
  if (!std::isnan(last.released)) {
    append(
        out,
        "balance     work of grippers and obstacles {:.6g} J, change of energy {:.6g} J, released "
        "by snap-through {:.4g} J\n",
        compare::shown(last.work, large.energy),
        compare::shown(last.energy.total() - first.energy.total(), large.energy),
        compare::shown(released, large.energy));
  }
  out += force_text(track, scene, options);
  out += stop_text(track.stopped);
  append(out, "events      {}\n",
         track.events.empty() ? "none" : std::to_string(track.events.size()));
  for (const TrackEvent& event : track.events) out += event_text(track, event, large);
  return out + table_text(track, large);
}

std::string track_json(const Track& track, const compare::Scene& scene, const TrackOptions& options,
                       const TrackFrames& frames, const compare::DynamicTrack* dynamic) {
  Json result = {{"schema", "dlo/track/1"},
                 {"scene", scene.name},
                 {"model", "energy"},
                 {"frames_per_second", options.rates.frames},
                 {"frame_s", track.median_seconds},
                 {"frames_lost", track.lost},
                 {"frames_repeated", track.repeated}};
  result["stopped"] = json_or_null(track.stopped, stop_json);
  result["force_model"] = json_or_null(track.frames.front().force, [&](const auto& /*first*/) {
    return force_json(track.force, scene, options);
  });
  result["no_force_model"] = text_or_null(track.force.none);
  if (dynamic != nullptr) result["dynamic"] = dynamic_json(*dynamic, track, frames);
  result["events"] = json_list(
      track.events, [&](const TrackEvent& event) -> Json { return event_json(track, event); });
  if (frames.points) result["arc_length_m"] = track.arc_length;
  result["frames"] = json_list(frames.of(track), [&](const std::size_t i) -> Json {
    return frame_json(track.frames[i], scene, frames.points);
  });
  return json_text(result);
}

std::string track_csv(const Track& track, const compare::Scene& scene, const TrackFrames& frames,
                      const compare::DynamicTrack* dynamic) {
  compare::CsvTable table(
      "time_s,energy_J=energy_J/total,work_J=energy_J/work,released_J=energy_J/released,touches,"
      "error_over_length");
  add_forces(table, "", "", scene);
  if (dynamic != nullptr) {
    table.add(
        "dynamic_energy_J=dynamic/energy_J/total,kinetic_J=dynamic/energy_J/kinetic,"
        "dynamic_work_J=dynamic/energy_J/work,dissipated_J=dynamic/energy_J/dissipated,"
        "lost_J=dynamic/energy_J/lost,"
        "quasi_static_error_over_length=dynamic/quasi_static_error_over_length,"
        "force_error_over_length=dynamic/force_error_over_length");
    add_forces(table, "dynamic_", "dynamic/", scene);
  }
  for (const auto& number : fields_in(compare::in_csv, compare::shape_numbers(), scene)) {
    table.add(number.key() + "=" + number.json_path());
  }
  std::string out = table.header();
  for (const std::size_t i : frames.of(track)) {
    const TrackFrame& frame = track.frames[i];
    Json row = frame_json(frame, scene, false);
    row["touches"] = frame.contacts.empty() ? "" : state_text(frame, "; ");
    if (dynamic != nullptr && i < dynamic->frames.size()) {
      row["dynamic"] = moving_frame_json(dynamic->frames[i], false);
    }
    out += table.row(row);
  }
  return out;
}

void write_series(const compare::Track& track, const compare::Scene& scene,
                  const TrackFrames& frames, const std::string& file,
                  const compare::DynamicTrack* dynamic) {
  namespace fs = std::filesystem;
  const std::string stem = compare::series_stem(file);
  const fs::path folder = fs::path(file).parent_path();
  Json files = Json::array();
  for (const std::size_t i : frames.of(track)) {
    if (dynamic != nullptr && i >= dynamic->frames.size()) break;
    const compare::TrackFrame& frame = track.frames[i];
    const Eigen::Matrix3Xd& points =
        dynamic != nullptr ? dynamic->frames[i].points : frame.shape.points;
    const std::string name = fmt::format("{}_{:05}.vtk", stem, i);
    compare::write_file(
        (folder / name).string(),
        compare::vtk_polyline({track.arc_length, points}, {},
                              fmt::format("{}, t = {:.9g} s", scene.name, frame.time)));
    files.push_back({{"name", name}, {"time", frame.time}});
  }
  compare::write_file(file,
                      json_text({{"file-series-version", "1.0"}, {"files", std::move(files)}}));
}

}  // namespace dlo::cli
