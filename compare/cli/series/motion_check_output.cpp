#include <fmt/format.h>

#include <cmath>

#include "base/number.hpp"
#include "base/text.hpp"
#include "record/csv_table.hpp"
#include "recording/motion_check_fields.hpp"
#include "series/series_output.hpp"

namespace dlo::cli {
namespace {

using compare::FrameError;
using compare::MotionCheck;
using compare::MotionModel;
using compare::PartError;

Json frame_error_json(const FrameError& frame) {
  return {{"time_s", frame.time},
          {"rms_m", frame.rms_m},
          {"largest_m", frame.largest_m},
          {"largest_at_m", frame.largest_at_m}};
}

/// Returns a distance in mm; 0 if it is below the error of the rod's own points.
std::string mm(const MotionCheck& check, double value) {
  return fmt::format("{:.4g} mm", compare::shown(value, check.scene.length) * 1e3);
}

std::string percent_text(const MotionCheck& check, double value) {
  const double length = check.scene.length;
  return fmt::format("{} = {:.4g} % of l", mm(check, value),
                     compare::shown(value, length) / length * 100);
}

std::string part_text(const MotionCheck& check, const PartError& part) {
  return fmt::format("RMS {}, largest {}\n", mm(check, part.rms_m), mm(check, part.largest_m));
}

std::string model_text(const MotionCheck& check) {
  if (check.model == MotionModel::at_rest) return "at rest at every time (quasi-static)";
  const compare::RodDamping& damping = check.damping;
  return fmt::format("with inertia; damping {:g} s, drag {:g} N s/m^2 and {:g} N s^2/m^3",
                     damping.material, damping.air, damping.quadratic);
}

/// Returns the errors against both models, and which model was chosen.
std::string both_text(const MotionCheck& check) {
  std::string out = std::isfinite(check.at_rest_rms_m)
                        ? fmt::format("RMS {} from the rod at rest", mm(check, check.at_rest_rms_m))
                        : "no rod at rest to its end";
  if (!std::isfinite(check.with_inertia_rms_m)) {
    return out + "; none with inertia: " + compare::display(check.no_inertia);
  }
  append(out, ", {} from that with inertia: ", mm(check, check.with_inertia_rms_m));
  if (!check.nearer) return out + "neither is nearer by far";
  return out + (*check.nearer == MotionModel::at_rest ? "it is quasi-static" : "it has inertia");
}

}  // namespace

std::string motion_check_text(const MotionCheck& check, const std::string& verdict) {
  const compare::MotionErrors& errors = check.errors;
  std::string out;
  append(out, "{}\n", compare::display(check.scene.name));
  append(out, "  motion          {}: {} points at {} times, {:.6g} to {:.6g} s\n",
         compare::display(check.file), check.points, errors.frames.size(),
         errors.frames.front().time, errors.frames.back().time);
  append(out, "  rod             {}; from {:.6g} s, {:.4g} frames a second\n", model_text(check),
         check.begin, check.frame_rate);
  append(out, "  deviation       RMS {}\n                  largest {}\n",
         percent_text(check, errors.rms_m), percent_text(check, errors.largest_m));
  const FrameError& worst = check.worst();
  append(out, "  worst frame     at {:.6g} s: RMS {}, largest {} at s = {:.4g} m\n", worst.time,
         mm(check, worst.rms_m), mm(check, worst.largest_m), worst.largest_at_m);
  const char* label = "along the rod";
  for (const PartError& part : errors.thirds) {
    append(out, "  {:<15} s = {:.4g} to {:.4g} m: {}", label, part.from_m, part.to_m,
           part_text(check, part));
    label = "";
  }
  label = "markers";
  for (const PartError& marker : errors.markers) {
    append(out, "  {:<15} s = {:.4g} m: {}", label, marker.from_m, part_text(check, marker));
    label = "";
  }
  if (std::isfinite(check.lag)) {
    append(out, "  lag             {:.4g} ms {}: RMS {} without it\n", std::abs(check.lag) * 1e3,
           check.lag > 0 ? "late" : "early", mm(check, check.lag_rms_m));
  }
  append(out, "  inertia         {}\n", both_text(check));
  label = "explained by";
  for (const compare::MotionCause& cause : check.causes) {
    append(out, "  {:<15} RMS {} if {}\n", label, mm(check, cause.rms_m), cause.words);
    label = "";
  }
  append(out, "  verdict         {}: {}\n",
         verdict.empty() ? (check.passes ? "pass" : "fail") : verdict, check.reason);
  const bool could_be_fitted =
      !check.passes && check.causes.empty() && check.model == MotionModel::with_inertia;
  if (could_be_fitted) {
    out +=
        "                  (dlo calibrate --motion finds the stiffness over the mass, and the "
        "damping)\n";
  }
  return out;
}

Json motion_check_json(const MotionCheck& check) {
  Json result = {{"schema", "dlo/motion_check/1"}};
  compare::add_json(result, compare::motion_check_fields(), check, check.scene);
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
  return result;
}

std::string motion_check_csv(const MotionCheck& check) {
  return compare::CsvTable("time_s,rms_m,largest_m,largest_at_m")
      .text(json_list(check.errors.frames, frame_error_json));
}

}  // namespace dlo::cli
