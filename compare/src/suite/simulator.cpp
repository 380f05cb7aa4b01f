#include "suite/simulator.hpp"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>

#include "base/fingerprint.hpp"
#include "base/input_file.hpp"
#include "base/output_file.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/solve.hpp"
#include "foreign/scene_document.hpp"
#include "record/field.hpp"

namespace dlo::compare {
namespace {

std::optional<Model> own_model(const std::string& text) {
  for (const Model model : {Model::chain, Model::force}) {
    if (text == to_string(model)) return model;
  }
  return std::nullopt;
}

SimulatorRun run_own(Model model, Scene scene, double time_limit) {
  SimulatorRun run;
  const auto begin = std::chrono::steady_clock::now();
  scene.file = "scene";  // scenes of one problem have one message
  try {
    const Solution solution = solve(scene, model, {.time_limit = time_limit});
    if (!solution.neglected.empty()) {
      run.status = RunStatus::not_supported;
      run.problem = fmt::format("neglects {}", fmt::join(solution.neglected, ", "));
    } else {
      run.status = RunStatus::solved;
      run.shape = shape_of(solution.shape.points, solution.shape.arc_length, to_string(model));
    }
  } catch (const InputError& error) {
    run.status = RunStatus::not_supported;
    run.problem = error.what();
  } catch (const ConvergenceError& error) {
    run.problem = error.what();
  }
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return run;
}

SimulatorRun run_program(const ForeignProgram& program, const Scene& scene, int points,
                         double time_limit) {
  ForeignRun run = run_foreign(program, scene, points, time_limit);
  SimulatorRun result;
  result.problem = run.problem;
  result.seconds = run.seconds;
  result.shape = std::move(run.shape);
  if (result.shape) {
    result.status = RunStatus::solved;
  } else if (run.not_supported) {
    result.status = RunStatus::not_supported;
  }
  return result;
}

/// What a run depends on; its own version tells files of another form.
std::string run_fingerprint(const Simulator& simulator, Scene scene, int points) {
  scene.force_model.points = points;
  scene.file.clear();
  return fingerprint("dlo/run/1\n" + simulator.identity() + "\n" + scene_document_text(scene));
}

std::optional<SimulatorRun> read_run(const std::filesystem::path& file, const std::string& known) {
  std::error_code missing;
  if (!std::filesystem::exists(file, missing)) return std::nullopt;
  try {
    const Json document = Json::parse(read_regular_file(file, file));
    if (document.at("fingerprint") != known) return std::nullopt;
    SimulatorRun run;
    run.points = document.at("points");
    run.status = from_name<RunStatus>(document.at("status").get<std::string>());
    run.problem = document.at("problem");
    run.seconds = document.at("wall_s");
    if (run.status == RunStatus::solved)
      run.shape = parse_shape(document.at("shape").dump(), "its shape");
    return run;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;  // of another program: run again
  } catch (const InputError&) {
    return std::nullopt;
  }
}

void write_run(const std::filesystem::path& file, const std::string& known,
               const SimulatorRun& run) {
  Json document = {{"fingerprint", known},
                   {"points", run.points},
                   {"status", to_string(run.status)},
                   {"problem", run.problem},
                   {"wall_s", run.seconds}};
  if (run.shape) {
    document["shape"] = {{"points_m", points_json(run.shape->points)}};
    if (!run.shape->arc_length.empty()) document["shape"]["arc_length_m"] = run.shape->arc_length;
  }
  write_file(file, document.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace

std::string Simulator::identity() const {
  return own ? fmt::format("model {}", to_string(*own))
             : fmt::format("command {}", Json(program.words).dump());
}

std::vector<Simulator> parse_simulators(const std::vector<std::string>& texts) {
  std::vector<Simulator> simulators;
  std::set<std::string> taken;
  for (const std::string& text : texts) {
    Simulator simulator;
    simulator.own = own_model(text);
    if (!simulator.own) simulator.program = parse_foreign_program(text);
    simulator.name = simulator.own ? text : simulator.program.name;
    if (!taken.insert(simulator.name).second) {
      throw InputError(fmt::format("--with {}: given twice (allowed: a name of its own for each)",
                                   simulator.name));
    }
    simulators.push_back(std::move(simulator));
  }
  return simulators;
}

SimulatorRun run_simulator(const Simulator& simulator, Scene scene, int points, double time_limit) {
  scene.force_model.points = points;
  if (simulator.function) {
    SimulatorRun run = simulator.function(scene, points);
    run.points = points;
    return run;
  }
  SimulatorRun run = simulator.own ? run_own(*simulator.own, scene, time_limit)
                                   : run_program(simulator.program, scene, points, time_limit);
  run.points = points;
  return run;
}

SimulatorRun kept_run(const std::string& folder, const std::string& id, const Simulator& simulator,
                      const Scene& scene, int points, double time_limit) {
  if (folder.empty() || simulator.function)
    return run_simulator(simulator, scene, points, time_limit);
  const std::filesystem::path mine = std::filesystem::path(folder) / simulator.name;
  const std::filesystem::path file = mine / fmt::format("{}_{}.json", id, points);
  const std::string known = run_fingerprint(simulator, scene, points);
  if (std::optional<SimulatorRun> run = read_run(file, known)) return std::move(*run);
  SimulatorRun run = run_simulator(simulator, scene, points, time_limit);
  std::error_code error;
  std::filesystem::create_directories(mine, error);
  if (error) throw OutputError(fmt::format("{}: {}", mine.string(), error.message()));
  write_run(file, known, run);
  return run;
}

}  // namespace dlo::compare
