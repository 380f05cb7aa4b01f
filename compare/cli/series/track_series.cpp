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

using compare::DynamicFrame;
using compare::DynamicTrack;
using compare::Track;
using compare::TrackErrors;
using compare::TrackEvent;
using compare::TrackFrame;
using compare::TrackOptions;
using energy_model::ContactPart;

/// Returns the contacts in words, such as "1 touching, 2 lying", with the numbers of the obstacles
/// from 1; "-" if there is none.
std::string state_text(const TrackFrame& frame, const char* separator) {
  std::string text;
  for (const ContactPart& part : frame.contacts) {
    text += fmt::format("{}{} {}", text.empty() ? "" : separator, part.obstacle + 1,
                        energy_model::to_string(part.kind));
  }
  return text.empty() ? "-" : text;
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
    result["goes_on"] = event.contact->contact_persists;
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
          {"steps_per_second", options.rates.step_rate},
          {"rest_error_over_length", force.rest_error},
          {"mean_error_over_length", force.mean},
          {"largest_error_over_length", force.largest},
          {"largest_error_time_s", force.largest_time},
          {"lag_s", force.lag},
          {"error_without_lag_over_length", force.error_without_lag},
          {"frame_s", force.median_seconds}};
}

Json track_errors_json(const TrackErrors& errors) {
  return {{"mean_error_over_length", errors.mean},
          {"largest_error_over_length", errors.largest},
          {"largest_error_time_s", errors.largest_time}};
}

Json stop_json(const compare::TrackStop& stop) {
  return {{"time_s", stop.time}, {"why", stop.why}};
}

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
      {"quasi_static", track_errors_json(dynamic.quasi_static)}};
  result["force_model"] = json_or_null(dynamic.force, [](const compare::ForceErrors& errors) {
    Json entry = track_errors_json(errors);
    entry["lag_s"] = errors.lag;
    entry["error_without_lag_over_length"] = errors.error_without_lag;
    return entry;
  });
  result["stopped"] = json_or_null(dynamic.stopped, stop_json);
  std::vector<std::size_t> listed = frames.of(track);
  std::erase_if(listed, [&](std::size_t i) { return i >= dynamic.frames.size(); });
  result["frames"] = json_list(
      listed, [&](std::size_t i) { return moving_frame_json(dynamic.frames[i], frames.points); });
  return result;
}

}  // namespace

std::vector<std::size_t> TrackFrames::of(const Track& track) const {
  std::vector<std::size_t> result;
  const std::size_t count = track.frames.size();
  for (std::size_t i = 0; i < count; i += static_cast<std::size_t>(frame_interval))
    result.push_back(i);
  for (const TrackEvent& event : track.events) result.push_back(event.frame);
  result.push_back(count - 1);
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

compare::Document track_document(const compare::TrackResult& found, const compare::Scene& scene,
                                 const TrackFrames& frames) {
  const Track& track = found.track;
  const TrackOptions& options = found.options;
  const DynamicTrack* dynamic = found.moving();
  Json result = {{"schema", "dlo/track/1"},
                 {"scene", scene.name},
                 {"model", "energy"},
                 {"frames_per_second", options.rates.frame_rate},
                 {"frame_s", track.median_seconds},
                 {"frames_lost", track.lost_frames},
                 {"frames_repeated", track.repeated_frames}};
  result["stopped"] = json_or_null(track.stopped, stop_json);
  result["force_model"] = json_or_null(track.frames.front().force, [&](const auto& /*first*/) {
    return force_json(track.force, scene, options);
  });
  result["no_force_model"] = text_or_null(track.force.missing_reason);
  if (dynamic != nullptr) result["dynamic"] = dynamic_json(*dynamic, track, frames);
  result["events"] = json_list(
      track.events, [&](const TrackEvent& event) -> Json { return event_json(track, event); });
  if (frames.points) result["arc_length_m"] = track.arc_length;
  result["frames"] = json_list(frames.of(track), [&](const std::size_t i) -> Json {
    return frame_json(track.frames[i], scene, frames.points);
  });
  return {.json = std::move(result), .large = magnitudes(scene)};
}

std::string track_text(const compare::TrackResult& found, const compare::Scene& scene) {
  constexpr std::size_t approximate_rows = 10;
  const Track& track = found.track;
  const TrackFrames frames{.frame_interval = static_cast<int>(
                               std::max(std::size_t{1}, track.frames.size() / approximate_rows))};
  compare::Document document = track_document(found, scene, frames);
  const std::vector<std::size_t> listed = frames.of(track);
  for (std::size_t i = 0; i < listed.size(); ++i) {
    document.json["frames"][i]["touches"] = state_text(track.frames[listed[i]], ", ");
  }
  for (Json& event : document.json["events"]) {
    if (!event["obstacle"].is_null()) event["obstacle"] = event["obstacle"].get<long>() + 1;
  }
  document.columns = {
      {"events",
       "time_s,kind,obstacle,contact_kind,from_m,to_m,released_J,released_bound_J,smallest_"
       "eigenvalue_before,"
       "gripper_1_before_N=grippers/0/force_before_N,gripper_1_after_N=grippers/0/force_after_N"},
      {"frames",
       "time_s,energy_J=energy_J/total,work_J=energy_J/work,gripper_1_N=grippers/0/"
       "force_N,error_over_length,touches"},
      {"dynamic/frames",
       "time_s,energy_J=energy_J/total,kinetic_J=energy_J/kinetic,gripper_1_N=grippers/0/force_N,"
       "quasi_static_error_over_length,force_error_over_length"}};
  return document.text();
}

std::string track_csv(const compare::TrackResult& found, const compare::Scene& scene,
                      const TrackFrames& frames) {
  const Track& track = found.track;
  const DynamicTrack* dynamic = found.moving();
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

void write_series(const compare::TrackResult& found, const compare::Scene& scene,
                  const TrackFrames& frames, const std::string& file) {
  const Track& track = found.track;
  const DynamicTrack* dynamic = found.moving();
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
