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
constexpr const char* none_within = "no run is within the error";

void add_runs(std::string& out, const std::vector<BenchmarkRun>& runs) {
  if (runs.empty()) {
    append(out, "  {}: all were skipped, see below\n", not_run);
    return;
  }
  append(out, "  {:<52} {:>10} {:>21} {:>11} {:>10}\n", "", "median", "quartiles [ms]",
         "evaluations", "error/l");
  for (const BenchmarkRun& run : runs) {
    append(out, "{} {:<52} {:>10.4g} {:>10.4g} {:>10.4g} {:>11} {:>10.2e}\n", run.front ? "*" : " ",
           name_of(run), run.time.median_s * 1e3, run.time.lower_quartile_s * 1e3,
           run.time.upper_quartile_s * 1e3,  // Nobody counts those of somebody else's program.
           run.program.empty() ? fmt::format("{}", run.evaluations) : "", run.rms_over_length);
  }
}

void add_answers(std::string& out, const std::vector<BenchmarkRun>& runs,
                 const std::vector<BenchmarkAnswer>& answers) {
  for (const BenchmarkAnswer& answer : answers) {
    append(out, "    {:>5g} %: ", answer.error * 100);
    const auto add = [&](std::optional<std::size_t> best, std::optional<compare::Model> model) {
      if (!best) return append(out, "{}", compare::has_run(runs, model) ? "none" : not_run);
      append(out, "{}, {:.3g} ms", name_of(runs[*best]), runs[*best].time.median_s * 1e3);
    };
    add(answer.best, {});
    out += "; with points and forces: ";
    add(compare::fastest_within(runs, answer.error, compare::Model::force), compare::Model::force);
    out += "\n";
  }
}

void add_claim(std::string& out, const SceneBenchmark& scene) {
  if (!scene.energy_at_1e6 || !scene.force_at_1e3) {
    const compare::Model model =
        scene.energy_at_1e6 ? compare::Model::force : compare::Model::energy;
    const std::string name = compare::to_string(model);
    append(out, "  energy at 1e-6 l against force at 1e-3 l: {}\n",
           compare::has_run(scene.runs, model) ? "no " + name + " run came that near"
                                               : name + " was not run");
    return;
  }
  const BenchmarkRun& energy = scene.runs[*scene.energy_at_1e6];
  const BenchmarkRun& force = scene.runs[*scene.force_at_1e3];
  const double ratio = force.time.median_s / energy.time.median_s;
  append(out,
         "  energy at 1e-6 l ({}, {:.3g} ms) is {:.3g} times {} the best force run at 1e-3 l ({}, "
         "{:.3g} ms)\n",
         name_of(energy), energy.time.median_s * 1e3, ratio >= 1 ? ratio : 1 / ratio,
         ratio >= 1 ? "faster than" : "slower than", name_of(force), force.time.median_s * 1e3);
}

Json run_json(const BenchmarkRun& run, const char* kind) {
  Json result = {{"scene", run.scene},
                 {"kind", kind},
                 {"model", model_of(run)},
                 {"is_program", !run.program.empty()},
                 {"setting", setting_of(run)},
                 {"law", nullptr},
                 {"bookkeeping", nullptr},
                 {"stepper", nullptr},
                 {"c_c_over_AE", nullptr},
                 {"size", run.size},
                 {"time_s", run.time.median_s},
                 {"lower_quartile_s", run.time.lower_quartile_s},
                 {"upper_quartile_s", run.time.upper_quartile_s},
                 {"repeats", run.time.repeats},
                 {"evaluations", run.program.empty() ? Json(run.evaluations) : Json()},
                 {"rms_over_length", run.rms_over_length},
                 {"front", run.front}};
  if (run.variant) {
    result["law"] = compare::to_string(run.variant->law);
    result["bookkeeping"] = compare::to_string(run.variant->bookkeeping);
  }
  if (run.variant && run.model == compare::Model::force) {
    result["stepper"] = compare::to_string(run.variant->stepper);
    result["c_c_over_AE"] = run.variant->stretch_share;
  }
  return result;
}

Json answers_json(const std::vector<BenchmarkAnswer>& answers,
                  const std::vector<BenchmarkRun>& runs) {
  Json result = Json::array();
  for (const BenchmarkAnswer& answer : answers) {
    Json entry = {{"error_over_length", answer.error}, {"use", nullptr}};
    if (answer.best) {
      entry["use"] = name_of(runs[*answer.best]);
    } else {
      entry["reason"] = compare::has_run(runs) ? none_within : not_run;
    }
    result.push_back(std::move(entry));
  }
  return result;
}

}  // namespace

std::string benchmark_text(const compare::BenchmarkReport& report) {
  std::string out;
  for (const SceneBenchmark& scene : report.scenes) {
    append(out, "{}   Gamma = {:.4g}, error against {}\n\n", compare::display(scene.scene),
           scene.gamma, compare::to_string(scene.reference));
    append(out, "  static: from straight to the shape (* no run is both faster and nearer)\n");
    add_runs(out, scene.runs);
    append(
        out,
        "\n  tracking: a frame of 1 ms behind a gripper that moves at v = {:g} m/s and rotates by "
        "v/l\n",
        report.options.gripper_speed);
    add_runs(out, scene.tracking);
    out += "\n";
  }
  for (const std::string& skipped : report.skipped)
    append(out, "skipped: {}\n", compare::display(skipped));
  for (const compare::BenchmarkFailure& failure : report.failures) {
    append(out, "failed: {}: {} N = {}: {}\n", compare::display(failure.scene), failure.program,
           failure.points, compare::display(failure.problem));
  }
  out += "\nWhat to use\n";
  for (const SceneBenchmark& scene : report.scenes) {
    append(out, "\n{}   Gamma = {:.4g}\n  for a static error of\n", compare::display(scene.scene),
           scene.gamma);
    add_answers(out, scene.runs, scene.answers);
    append(out, "  for an error behind the moving gripper of\n");
    add_answers(out, scene.tracking, scene.tracking_answers);
    add_claim(out, scene);
  }
  append(out, "\n{:.3g} s in all, one thread\n", report.seconds);
  return out;
}

Json benchmark_json(const compare::BenchmarkReport& report) {
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
        entry[name + "_reason"] = compare::has_run(scene.runs, model) ? none_within : not_run;
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
  return {{"schema", "dlo/bench/2"},       {"runs", std::move(runs)},
          {"answers", std::move(answers)}, {"gripper_speed_m_per_s", report.options.gripper_speed},
          {"skipped", report.skipped},     {"failures", std::move(failures)},
          {"wall_s", report.seconds}};
}

std::string benchmark_csv(const compare::BenchmarkReport& report) {
  const compare::CsvTable table(
      "scene,kind,model,size,setting,time_s:4,lower_quartile_s:4,upper_quartile_s:4,repeats,"
      "evaluations,rms_over_length:6,front,problem");
  const Json document = benchmark_json(report);
  std::string out = table.text(document.at("runs"));
  for (Json failure : document.at("failures")) {
    failure.update(
        {{"kind", "static"}, {"model", failure["program"]}, {"size", failure["points"]}});
    out += table.row(failure);
  }
  return out;
}

}  // namespace dlo::cli
