#include "batch/regression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "base/quote.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/shape_check.hpp"
#include "dlo/compare/solve.hpp"
#include "format/scene_document.hpp"
#include "reading/read_scene.hpp"
#include "record/field.hpp"

namespace dlo::compare {
namespace {

std::string case_xml(const JunitCase& one) {
  std::string text = fmt::format("    <testcase classname=\"{}\" name=\"{}\" time=\"{:.3f}\">",
                                 escape_markup(one.group), escape_markup(one.name), one.seconds);
  const std::string message = escape_markup(one.message);
  if (one.outcome.empty()) {
    if (!message.empty()) text += fmt::format("<system-out>{}</system-out>", message);
  } else {
    text += fmt::format("<{} ", one.outcome);
    if (!one.type.empty()) text += fmt::format("type=\"{}\" ", escape_markup(one.type));
    text += fmt::format("message=\"{}\"/>", message);
  }
  return text + "</testcase>\n";
}

std::string counts_of(const std::vector<JunitCase>& cases) {
  const auto count = [&](const char* outcome) {
    return std::count_if(cases.begin(), cases.end(),
                         [outcome](const JunitCase& one) { return one.outcome == outcome; });
  };
  return fmt::format("tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{}\"", cases.size(),
                     count("failure"), count("error"), count("skipped"));
}

RegressionVerdict verdict_of(double expected, double measured,
                             const RegressionTolerance& tolerance) {
  const double margin = tolerance.absolute + tolerance.relative * expected;
  if (measured < expected - margin) return RegressionVerdict::better;
  // The negated comparison classifies a NaN as worse.
  return measured <= expected + margin ? RegressionVerdict::same : RegressionVerdict::worse;
}

std::string percent(const std::optional<double>& share) {
  return share ? fmt::format("{:.4g} %", *share * 100) : std::string("none");
}

void compare_errors(RegressionResult& result, const RegressionTolerance& tolerance) {
  const ShapeErrors& expected = *result.expected;
  const ShapeErrors& measured = *result.measured;
  using Share = std::optional<double>;
  const std::array<std::tuple<const char*, Share, Share>, 3> errors = {
      {{"RMS", expected.rms, measured.rms},
       {"largest", expected.max, measured.max},
       {"tip", expected.tip, measured.tip}}};
  result.verdict = RegressionVerdict::same;
  for (const auto& [what, before, now] : errors) {
    if (!before && !now) continue;
    if (!result.message.empty()) result.message += ", ";
    const RegressionVerdict verdict =
        before && now ? verdict_of(*before, *now, tolerance) : RegressionVerdict::worse;
    const char* mark = verdict == RegressionVerdict::same ? "" : to_string(verdict);
    result.message += fmt::format("{} {} of l (baseline {}){}{}", what, percent(now),
                                  percent(before), *mark != '\0' ? " " : "", mark);
    if (verdict == RegressionVerdict::worse) result.verdict = verdict;
    if (verdict == RegressionVerdict::better && result.verdict == RegressionVerdict::same) {
      result.verdict = verdict;
    }
  }
}

/// Appends a value of a scene's document to a text. Numbers have twelve digits, so that "2 mm"
/// equals 0.002.
void add_content(const Json& value, std::string& text) {
  if (value.is_number()) {
    text += fmt::format("{:.12g} ", value.get<double>() + 0.0);
  } else if (value.is_structured()) {
    for (const auto& [key, item] : value.items()) add_content(item, text += key + ' ');
  } else {
    text += value.dump() + ' ';
  }
}

/// Returns all content of a scene on which its shape depends and that the case's name does not
/// contain. Names and vectors that follow from the other content only up to rounding are omitted.
std::string content_of(const Scene& scene) {
  const ForceModelSettings& settings = scene.force_model;
  Json content = scene_document(scene);
  for (const char* key : {"scene", "file", "gamma", "plane_normal", "force_model"}) {
    content.erase(key);
  }
  for (const char* key : {"material", "mean_weight_N_per_m", "rest_shape", "first_frame"}) {
    content["rod"].erase(key);
  }
  content["stretch"] = static_cast<int>(scene.stretch);
  content["names"] = {to_string(settings.stepper), to_string(settings.bending_rule),
                      settings.joint_law ? to_string(*settings.joint_law) : ""};
  for (const auto& value : {settings.design_curvature, settings.point_weight, settings.c_b,
                            settings.c_c, settings.c_F, settings.c_h, settings.l_s}) {
    content["numbers"].push_back(value ? Json(*value) : Json());
  }
  std::string text;
  add_content(content, text);
  return text;
}

/// Returns the settings in which a case differs from another one of its scene, such as "law hooke,
/// N = 16".
std::string differing_settings(const BaselineCase& entry, const BaselineCase& other) {
  std::string text;
  const auto add = [&](bool differs, const std::string& setting) {
    if (differs) text += (text.empty() ? "" : ", ") + setting;
  };
  add(entry.law != other.law, fmt::format("law {}", to_string(entry.law)));
  add(entry.bookkeeping != other.bookkeeping,
      fmt::format("bookkeeping {}", to_string(entry.bookkeeping)));
  add(entry.points != other.points, fmt::format("N = {}", entry.points));
  return text;
}

/// Describes how a case differs from the baseline's in settings or scene; empty if it does not.
std::string describe_change(const BaselineCase& before, const BaselineCase& now) {
  if (before.name() != now.name()) {
    return fmt::format("{} (baseline {})", differing_settings(now, before),
                       differing_settings(before, now));
  }
  const bool known = !before.fingerprint.empty() && !now.fingerprint.empty();
  return known && before.fingerprint != now.fingerprint ? "the scene is another than the baseline's"
                                                        : "";
}

/// Returns the cases of a baseline, keyed by the names that they have in this run. A case of the
/// run replaces another one of the baseline if both are the only unmatched cases of the same scene
/// and solver.
std::map<std::string, const BaselineCase*> expected_cases(
    const std::vector<BaselineCase>& baseline, const std::vector<MeasuredCase>& measured) {
  std::map<std::string, const BaselineCase*> expected;
  std::map<std::string, const BaselineCase*> now;
  for (const BaselineCase& entry : baseline) expected[entry.name()] = &entry;
  for (const MeasuredCase& measurement : measured) {
    now[measurement.entry.name()] = &measurement.entry;
  }
  using Cases = std::vector<const BaselineCase*>;
  std::map<std::pair<std::string, std::string>, std::pair<Cases, Cases>> unmatched;
  for (const auto& [name, entry] : expected) {
    if (!now.contains(name)) unmatched[{entry->scene, entry->solver()}].first.push_back(entry);
  }
  for (const auto& [name, entry] : now) {
    if (expected.contains(name)) continue;
    unmatched[{entry->scene, entry->solver()}].second.push_back(entry);
  }
  for (const auto& [scene, cases] : unmatched) {
    if (cases.first.size() != 1 || cases.second.size() != 1) continue;
    expected.erase(cases.first.front()->name());
    expected[cases.second.front()->name()] = cases.first.front();
  }
  return expected;
}

/// Returns the result of a case of the baseline that no measured case matches.
RegressionResult not_measured(const BaselineCase& entry,
                              const std::vector<MeasuredCase>& measured) {
  RegressionResult result;
  result.expected = entry.errors;
  result.verdict = RegressionVerdict::not_measured;
  const bool is_run = std::ranges::any_of(measured, [&](const MeasuredCase& measurement) {
    return measurement.entry.program == entry.program;
  });
  result.message = entry.program.empty() || is_run
                       ? "in the baseline, but no scene given is this case"
                       : fmt::format("in the baseline, of a program: --with {}='COMMAND' runs it",
                                     entry.program);
  return result;
}

/// Compares a measured case with the baseline. @param known  the baseline's case that it matches or
/// replaces; null if there is none
void judge_case(RegressionResult& result, const MeasuredCase& measurement,
                const BaselineCase* known, const RegressionTolerance& tolerance) {
  result.message.clear();
  if (!measurement.problem.empty()) {
    result.verdict = RegressionVerdict::not_solved;
    result.message = measurement.problem;
    return;
  }
  result.measured = measurement.entry.errors;
  if (!result.expected) {
    result.verdict = RegressionVerdict::not_in_baseline;
    result.message = fmt::format("RMS {} of l, not in the baseline (--update adds it)",
                                 percent(result.measured->rms));
    return;
  }
  compare_errors(result, {.relative = tolerance.relative,
                          .absolute = tolerance.absolute * measurement.deflection_share});
  const std::string change = describe_change(*known, measurement.entry);
  if (change.empty()) return;
  result.verdict = RegressionVerdict::changed;
  result.message = fmt::format("{}: {}", change, result.message);
}

ShapeErrors errors_of(const Scene& scene, const Deviation& deviation) {
  ShapeErrors errors{deviation.rms_over_length, deviation.max_m / scene.length, std::nullopt};
  if (std::isfinite(deviation.tip_m)) errors.tip = deviation.tip_m / scene.length;
  return errors;
}

/// Runs a foreign program on a scene, with the scene's number of points, and measures the distance
/// of its shape from the energy model's. @throws ConvergenceError, InputError of the energy model;
/// OutputError as run_foreign()
void measure_program(const Scene& scene, const ForeignProgram& program, const SolveOptions& options,
                     MeasuredCase& result) {
  const SimulatorRun run = run_foreign(program, scene, result.entry.points, options.time_limit);
  result.problem = run.problem;
  if (!run.shape) return;
  result.note = fmt::format("{}", fmt::join(run.shape->notes, "; "));
  const energy_model::Equilibrium energy = solve_reference(scene, options);
  try {
    result.entry.errors = errors_of(scene, foreign_deviation(scene, *run.shape, energy.sample));
  } catch (const InputError& error) {
    result.problem = error.what();
  }
}

/// Measures one case; a solver that does not converge is reported as its problem.
/// @param program  foreign program; null: the request's model
MeasuredCase measured_case(const Scene& scene, const RegressRequest& request,
                           const ForeignProgram* program) {
  MeasuredCase unsolved{case_of(scene, program != nullptr ? Model::force : request.model), ""};
  if (program != nullptr) unsolved.entry.program = program->name;
  try {
    MeasuredCase result = unsolved;
    if (program != nullptr) {
      measure_program(scene, *program, request.solve, result);
    } else {
      result.entry = measure_case(scene, request.model, request.solve);
    }
    if (request.tolerance.of_deflection) {
      const energy_model::Equilibrium loaded = solve_reference(scene, request.solve);
      result.deflection_share =
          required_deflection(scene, trivial_shape(scene, loaded, request.solve)) / scene.length;
    }
    return result;
  } catch (const ConvergenceError& error) {
    unsolved.problem = error.what();
    return unsolved;
  }
}

}  // namespace

bool Regression::solved() const {
  return std::none_of(results.begin(), results.end(), [](const RegressionResult& result) {
    return result.verdict == RegressionVerdict::not_solved;
  });
}

bool Regression::passes() const {
  return std::none_of(results.begin(), results.end(),
                      [](const RegressionResult& result) { return failed(result.verdict); });
}

Regression regress(const std::vector<Scene>& scenes, const std::vector<BaselineCase>& baseline,
                   const RegressRequest& request, const Progress& progress) {
  std::vector<MeasuredCase> measured;
  const std::size_t all = scenes.size() * (1 + request.programs.size());
  const auto measure = [&](const Scene& scene, const ForeignProgram* program) {
    measured.push_back(measured_case(scene, request, program));
    if (!progress) return;
    progress(static_cast<std::int64_t>(measured.size()), static_cast<std::int64_t>(all));
  };
  for (const Scene& scene : scenes) {
    measure(scene, nullptr);
    for (const ForeignProgram& program : request.programs) measure(scene, &program);
  }
  Regression result{judge_regression(baseline, measured, request.tolerance), {}};
  for (MeasuredCase& one : measured) result.cases.push_back(std::move(one.entry));
  return result;
}

std::string junit_xml(const std::vector<JunitSuite>& suites) {
  std::string text;
  std::vector<JunitCase> all;
  for (const JunitSuite& suite : suites) {
    text += fmt::format("  <testsuite name=\"{}\" {}>\n", escape_markup(suite.name),
                        counts_of(suite.cases));
    for (const JunitCase& one : suite.cases) text += case_xml(one);
    text += "  </testsuite>\n";
    all.insert(all.end(), suite.cases.begin(), suite.cases.end());
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {}>\n{}</testsuites>\n",
      counts_of(all), text);
}

BaselineCase case_of(const Scene& scene, Model model) {
  BaselineCase result;
  result.scene = scene.name;
  result.model = model;
  result.law = scene.force_model.law;
  result.bookkeeping = scene.force_model.bookkeeping;
  result.points = scene.force_model.points;
  result.fingerprint = fingerprint(content_of(scene));
  return result;
}

BaselineCase measure_case(const Scene& scene, Model model, const SolveOptions& options) {
  const Solution solution = solve(scene, model, options);
  const energy_model::Equilibrium energy = solve_reference(scene, options);
  BaselineCase result = case_of(scene, model);
  result.errors = errors_of(scene, shape_deviation(scene, solution.shape, energy.sample));
  return result;
}

bool failed(RegressionVerdict verdict) {
  return verdict != RegressionVerdict::same && verdict != RegressionVerdict::better;
}

std::vector<RegressionResult> judge_regression(const std::vector<BaselineCase>& baseline,
                                               const std::vector<MeasuredCase>& measured,
                                               const RegressionTolerance& tolerance) {
  const auto allowed = [](double value) { return value >= 0 && std::isfinite(value); };
  if (!allowed(tolerance.relative) || !allowed(tolerance.absolute)) {
    throw std::invalid_argument(
        fmt::format("judge_regression: tolerance relative = {}, absolute = {}, must be >= 0",
                    tolerance.relative, tolerance.absolute));
  }
  // keyed by the case's name in this run
  const std::map<std::string, const BaselineCase*> expected = expected_cases(baseline, measured);
  std::map<std::string, RegressionResult> results;
  for (const auto& [name, entry] : expected) results[name] = not_measured(*entry, measured);
  std::set<std::string> seen;
  for (const MeasuredCase& measurement : measured) {
    const std::string name = measurement.entry.name();
    if (!seen.insert(name).second) {
      throw InputError(fmt::format(
          "{}: two scenes have this case (allowed: a different name for each scene)", name));
    }
    const auto known = expected.find(name);
    judge_case(results[name], measurement, known == expected.end() ? nullptr : known->second,
               tolerance);
    if (!measurement.note.empty()) results[name].message += "; " + measurement.note;
  }
  std::vector<RegressionResult> sorted;
  for (auto& [name, result] : results) {
    result.name = name;
    sorted.push_back(std::move(result));
  }
  return sorted;
}

std::string junit_xml(const std::vector<RegressionResult>& results) {
  JunitSuite suite{"dlo regress", {}};
  for (const RegressionResult& result : results) {
    JunitCase one{.group = "dlo.regress", .name = result.name, .message = result.message};
    if (failed(result.verdict)) {
      one.outcome = result.verdict == RegressionVerdict::not_solved ? "error" : "failure";
      one.type = to_string(result.verdict);
    } else {
      one.message = fmt::format("{}: {}", to_string(result.verdict), result.message);
    }
    suite.cases.push_back(std::move(one));
  }
  return junit_xml(std::vector{std::move(suite)});
}

}  // namespace dlo::compare
