#include "recording/motion_check_fields.hpp"

#include <string>

namespace dlo::compare {

std::span<const Field<MotionCheck>> motion_check_fields() {
  using M = const MotionCheck&;
  static const Field<MotionCheck> fields[] = {
      {"scene", "", "The scene's name", [](M m) { return m.scene.name; }, in_json},
      {"motion", "", "The recording", [](M m) { return m.file; }, in_json},
      {"model", "", "\"at_rest\" or \"with_inertia\": what it was held against",
       [](M m) -> std::string { return to_string(m.model); }, in_json},
      {"points", "", "Of the recording, in all frames",
       [](M m) -> long { return static_cast<long>(m.points); }, in_json},
      {"begin", "s", "When the rod's motion begins", [](M m) { return m.begin; }, in_json},
      {"frames_per_second", "", "Of the model, which is interpolated between its frames",
       [](M m) { return m.frame_rate; }, in_json},
      {"rms", "m", "Of all points", [](M m) { return m.errors.rms_m; }, in_json},
      {"rms_over_length", "", "The same over the length",
       [](M m) { return m.errors.rms_m / m.scene.length; }, in_json},
      {"largest", "m", "Of a point", [](M m) { return m.errors.largest_m; }, in_json},
      {"time", "s", "Of the frame with the largest RMS", [](M m) { return m.worst().time; },
       in_json, "worst/time_s"},
      {"rms", "m", "Of that frame", [](M m) { return m.worst().rms_m; }, in_json, "worst/rms_m"},
      {"largest", "m", "Of a point of that frame", [](M m) { return m.worst().largest_m; }, in_json,
       "worst/largest_m"},
      {"largest_at", "m", "Arc length of that point", [](M m) { return m.worst().largest_at_m; },
       in_json, "worst/largest_at_m"},
      {"lag", "s", "By which the recording is late, where that explains much of it",
       [](M m) { return m.lag; }, in_json},
      {"rms_without_lag", "m", "What is left then", [](M m) { return m.lag_rms_m; }, in_json},
      {"at_rest_rms", "m", "From the rod at rest", [](M m) { return m.at_rest_rms_m; }, in_json},
      {"with_inertia_rms", "m", "From the rod with inertia",
       [](M m) { return m.with_inertia_rms_m; }, in_json},
      {"no_inertia", "", "Why there is none with inertia",
       [](M m) { return m.no_inertia.empty() ? Json() : Json(m.no_inertia); }, in_json},
      {"nearer", "", "Which of the two is nearer by far; null: neither",
       [](M m) { return m.nearer ? Json(to_string(*m.nearer)) : Json(); }, in_json},
      {"damping", "s", "Of the rod with inertia", [](M m) { return m.damping.material; }, in_json},
      {"drag_N_s_per_m2", "", "The air's, likewise", [](M m) { return m.damping.air; }, in_json},
      {"quadratic_drag_N_s2_per_m3", "", "The same by the squared velocity",
       [](M m) { return m.damping.quadratic; }, in_json},
      {"judged", "m", "What was held against the tolerance", [](M m) { return m.judged_m; },
       in_json},
      {"verdict", "", "\"pass\" or \"fail\"",
       [](M m) -> std::string { return m.passes ? "pass" : "fail"; }, in_json},
      {"reason", "", "Why", [](M m) { return m.reason; }, in_json}};
  return fields;
}

}  // namespace dlo::compare
