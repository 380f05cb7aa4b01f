#include <optional>
#include <utility>
#include <vector>

#include "base/text.hpp"
#include "dlo/compare/solution.hpp"
#include "option/output.hpp"
#include "record/csv_table.hpp"
#include "series/study_output.hpp"

namespace dlo::cli {
namespace {

using compare::BenchmarkAnswer;
using compare::BenchmarkRun;
using compare::SceneBenchmark;

constexpr const char* not_run = "not run";
constexpr const char* no_run_within_error = "no run is within the error";

Json run_json(const BenchmarkRun& run, const char* kind) {
  const bool steps = run.variant && run.model == compare::Model::force;
  return {
      {"scene", run.scene},
      {"kind", kind},
      {"model", model_of(run)},
      {"is_program", !run.program.empty()},
      {"setting", setting_of(run)},
      {"law", run.variant ? Json(compare::to_string(run.variant->law)) : Json()},
      {"bookkeeping", run.variant ? Json(compare::to_string(run.variant->bookkeeping)) : Json()},
      {"stepper", steps ? Json(compare::to_string(run.variant->stepper)) : Json()},
      {"c_c_over_AE", steps ? Json(run.variant->stretch_share) : Json()},
      {"size", run.size},
      {"time_s", run.time.median_s},
      {"lower_quartile_s", run.time.lower_quartile_s},
      {"upper_quartile_s", run.time.upper_quartile_s},
      {"repeats", run.time.repeats},
      {"evaluations", run.program.empty() ? Json(run.evaluations) : Json()},
      {"rms_over_length", run.rms_over_length},
      {"front", run.front}};
}

Json answers_json(const std::vector<BenchmarkAnswer>& answers,
                  const std::vector<BenchmarkRun>& runs) {
  Json result = Json::array();
  for (const BenchmarkAnswer& answer : answers) {
    Json entry = {{"error_over_length", answer.error}, {"use", nullptr}};
    if (answer.best) {
      entry["use"] = name_of(runs[*answer.best]);
    } else {
      entry["reason"] = compare::has_run(runs) ? no_run_within_error : not_run;
    }
    result.push_back(std::move(entry));
  }
  return result;
}

}  // namespace

compare::Document benchmark_document(const compare::BenchmarkReport& report) {
  Json runs = Json::array();
  Json answers = Json::array();
  for (const SceneBenchmark& scene : report.scenes) {
    for (const BenchmarkRun& run : scene.runs) runs.push_back(run_json(run, "static"));
    for (const BenchmarkRun& run : scene.tracking) runs.push_back(run_json(run, "tracking"));
    Json entry = {{"scene", scene.scene},
                  {"gamma", scene.gamma},
                  {"reference", compare::to_string(scene.reference)},
                  {"static", answers_json(scene.answers, scene.runs)},
                  {"tracking", answers_json(scene.tracking_answers, scene.tracking)},
                  {"energy_at_1e-6_s", nullptr},
                  {"force_at_1e-3_s", nullptr}};
    const auto add_time = [&](const std::string& name, std::optional<std::size_t> run,
                              compare::Model model) {
      if (run) {
        entry[name + "_s"] = scene.runs[*run].time.median_s;
      } else {
        entry[name + "_reason"] =
            compare::has_run(scene.runs, model) ? no_run_within_error : not_run;
      }
    };
    add_time("energy_at_1e-6", scene.energy_at_1e6, compare::Model::energy);
    add_time("force_at_1e-3", scene.force_at_1e3, compare::Model::force);
    answers.push_back(std::move(entry));
  }
  Json failures = json_list(report.failures, [&](const compare::BenchmarkFailure& failure) -> Json {
    return {{"scene", failure.scene},
            {"program", failure.program},
            {"points", failure.points},
            {"problem", failure.problem}};
  });
  return {.json = {{"schema", "dlo/bench/2"},
                   {"runs", std::move(runs)},
                   {"answers", std::move(answers)},
                   {"gripper_speed_m_per_s", report.options.gripper_speed},
                   {"skipped", report.skipped},
                   {"failures", std::move(failures)},
                   {"wall_s", report.seconds}},
          .columns = {{"runs",
                       "scene,kind,model,size,setting,time_s,lower_quartile_s,upper_quartile_s,"
                       "evaluations,rms_over_length,front"},
                      {"answers/#/static", "error_over_length,use,reason"},
                      {"answers/#/tracking", "error_over_length,use,reason"}}};
}

std::string benchmark_csv(const compare::BenchmarkReport& report) {
  const compare::CsvTable table(
      "scene,kind,model,size,setting,time_s:4,lower_quartile_s:4,upper_quartile_s:4,repeats,"
      "evaluations,rms_over_length:6,front,problem");
  const Json document = benchmark_document(report).json;
  std::string out = table.text(document.at("runs"));
  for (Json failure : document.at("failures")) {
    failure.update(
        {{"kind", "static"}, {"model", failure["program"]}, {"size", failure["points"]}});
    out += table.row(failure);
  }
  return out;
}

}  // namespace dlo::cli
