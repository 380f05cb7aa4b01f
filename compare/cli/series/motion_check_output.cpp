#include <fmt/format.h>

#include <cmath>

#include "base/number.hpp"
#include "base/text.hpp"
#include "record/csv_table.hpp"
#include "series/series_output.hpp"

namespace dlo::cli {
namespace {

using compare::FrameError;
using compare::MotionCheck;
using compare::PartError;

Json frame_error_json(const FrameError& frame) {
  return {{"time_s", frame.time},
          {"rms_m", frame.rms_m},
          {"largest_m", frame.largest_m},
          {"largest_at_m", frame.largest_at_m}};
}

}  // namespace

compare::Document motion_check_document(const MotionCheck& check, const std::string& verdict) {
  Json result = {{"schema", "dlo/motion_check/1"},
                 {"scene", check.scene.name},
                 {"motion", check.file},
                 {"model", to_string(check.model)},
                 {"points", check.points},
                 {"begin_s", check.begin},
                 {"frames_per_second", check.frame_rate},
                 {"rms_m", check.errors.rms_m},
                 {"rms_over_length", check.errors.rms_m / check.scene.length},
                 {"largest_m", check.errors.largest_m},
                 {"worst", frame_error_json(check.worst_frame_error())},
                 {"lag_s", check.lag},
                 {"rms_without_lag_m", check.lag_rms_m},
                 {"at_rest_rms_m", check.at_rest_rms_m},
                 {"with_inertia_rms_m", check.with_inertia_rms_m},
                 {"no_inertia", text_or_null(check.missing_inertia_reason)},
                 {"nearer", check.nearer ? Json(to_string(*check.nearer)) : Json()},
                 {"damping_s", check.damping.material},
                 {"drag_N_s_per_m2", check.damping.air},
                 {"quadratic_drag_N_s2_per_m3", check.damping.quadratic},
                 {"judged_m", check.judged_m},
                 {"verdict", check.passes ? "pass" : "fail"},
                 {"reason", check.reason}};
  result["tolerance"] = {{"measure", check.tolerance.largest ? "max" : "rms"},
                         {"allowed_m", check.tolerance.allowed_m},
                         {"default", check.tolerance.by_default}};
  result["causes"] = json_list(check.causes, [](const compare::MotionCause& cause) -> Json {
    return {{"kind", to_string(cause.kind)}, {"cause", cause.words}, {"rms_m", cause.rms_m}};
  });
  result["thirds"] = json_list(check.errors.thirds, [](const PartError& part) -> Json {
    return {{"from_m", part.from_m},
            {"to_m", part.to_m},
            {"rms_m", part.rms_m},
            {"largest_m", part.largest_m}};
  });
  result["markers"] = json_list(check.errors.markers, [](const PartError& marker) -> Json {
    return {{"s_m", marker.from_m}, {"rms_m", marker.rms_m}, {"largest_m", marker.largest_m}};
  });
  result["frames"] = json_list(check.errors.frames, frame_error_json);
  Json shown = result;
  for (const char* key : {"verdict", "reason", "frames"}) shown.erase(key);
  std::string head =
      fmt::format("{}: {}\n\n", verdict.empty() ? result["verdict"].get<std::string>() : verdict,
                  compare::display(check.reason));
  return {.json = std::move(result),
          .columns = {{"frames", "time_s,rms_m,largest_m,largest_at_m"}},
          .large = magnitudes(check.scene),
          .table = "frames",
          .head = std::move(head),
          .shown = std::move(shown)};
}

}  // namespace dlo::cli
