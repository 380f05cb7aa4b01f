#include "suite/simulator.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>

#include "base/input_file.hpp"
#include "base/output_file.hpp"
#include "base/timer.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/solve.hpp"
#include "format/scene_document.hpp"
#include "reading/read_scene.hpp"
#include "record/field.hpp"
#include "released/hinge_motion.hpp"

namespace dlo::compare {
namespace {

Simulator parsed_simulator(const std::string& text) {
  const std::string_view suffix = "_paper";
  const bool has_paper_law = text.ends_with(suffix);
  const std::string model = text.substr(0, text.size() - (has_paper_law ? suffix.size() : 0));
  if (model == "chain" || model == "force") {
    return {.name = text,
            .own = from_name<Model>(model),
            .law = has_paper_law ? BendingLaw::paper : BendingLaw::hooke,
            .program = {}};
  }
  const ForeignProgram program = parse_foreign_program(text);
  return {.name = program.name, .own = {}, .program = program};
}

ReleasedRod released_rod(const BatteryScene& scene) {
  return {scene.scene, scene.motion.value().begin};
}

void solve_own(Model model, const Scene& scene, double time_limit, SimulatorRun& run) {
  const Solution solution = solve(scene, model, {.time_limit = time_limit});
  if (!solution.neglected.empty()) {
    run.status = RunStatus::not_supported;
    run.problem = fmt::format("neglects {}", fmt::join(solution.neglected, ", "));
    return;
  }
  run.status = RunStatus::solved;
  run.shape = shape_of(solution.shape.points, solution.shape.arc_length, to_string(model));
}

/// Computes a motion by one of dlo's models. Only `chain` has motion: the chain of hinges with
/// point masses.
void run_own_motion(Model model, const BatteryScene& scene, int points, double time_limit,
                    SimulatorRun& run) {
  if (model != Model::chain || scene.scene.force_model.law != BendingLaw::hooke) {
    run.status = RunStatus::not_supported;
    run.problem = "only chain, with law hooke, has motion here";
    return;
  }
  const std::vector<double> times = scene.motion->times();
  const std::vector<Eigen::Matrix3Xd> frames =
      hinge_motion(released_rod(scene), points - 1, times, {.time_limit = time_limit});
  const std::vector<double> s = equal_arc_lengths(scene.scene.length, points);
  MarkerMotion motion{.file = to_string(model), .positions = {}};
  motion.positions.reserve(times.size() * s.size());
  for (std::size_t k = 0; k < times.size(); ++k) {
    for (std::size_t i = 0; i < s.size(); ++i) {
      motion.positions.push_back({times[k], s[i], frames[k].col(static_cast<Eigen::Index>(i))});
    }
  }
  run.motion = std::move(motion);
  run.status = RunStatus::solved;
}

SimulatorRun run_own(Model model, BatteryScene scene, int points, double time_limit) {
  SimulatorRun run;
  const Timer timer;
  scene.scene.file = "scene";  // so that messages do not depend on the name of the scene
  try {
    if (scene.motion) {
      run_own_motion(model, scene, points, time_limit, run);
    } else {
      solve_own(model, scene.scene, time_limit, run);
    }
  } catch (const InputError& error) {
    run.status = RunStatus::not_supported;
    run.problem = error.what();
  } catch (const ConvergenceError& error) {
    run.problem = error.what();
  }
  run.seconds = timer.seconds();
  return run;
}

/// Returns the document of a scene that a program reads: scene_document(), and for a scene that
/// moves also `motion`, with the times of the requested frames, the initial shape at equal arc
/// lengths, and the point masses on the rod.
std::string battery_document(const BatteryScene& scene, int points) {
  Scene numbered = scene.scene;
  numbered.force_model.points = points;
  numbered.file.clear();
  if (!scene.motion) return scene_document_text(numbered);
  Json document = scene_document(numbered);
  const std::vector<double> s = equal_arc_lengths(scene.scene.length, points);
  Json masses = Json::array();
  for (const PointLoad& load : scene.scene.loads) {
    if (load.mass > 0) masses.push_back({{"at_m", load.at}, {"mass_kg", load.mass}});
  }
  const energy_model::Samples begin = released_shape(released_rod(scene))(s);
  document["motion"] = {{"times_s", scene.motion->times()},
                        {"begin_arc_length_m", s},
                        {"begin_points_m", points_json(begin.points)},
                        {"begin_tangents", points_json(begin.tangents)},
                        {"point_masses", std::move(masses)}};
  return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// Returns name, size and modification time of the files that a command names, such as its script.
std::string files_of_command(const std::vector<std::string>& words) {
  std::string text;
  std::error_code none;
  for (const std::string& word : words) {
    if (!std::filesystem::is_regular_file(word, none)) continue;
    text += fmt::format("{} {} {}\n", word, std::filesystem::file_size(word, none),
                        std::filesystem::last_write_time(word, none).time_since_epoch().count());
  }
  return text;
}

/// Returns rows that parse_markers() reads.
std::string marker_rows(const MarkerMotion& motion) {
  std::string text = "time,s,x,y,z\n";
  for (const MarkerPosition& at : motion.positions) {
    text += fmt::format("{},{},{}\n", at.time, at.arc_length, fmt::join(at.position, ","));
  }
  return text;
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
    if (document.contains("motion")) {
      run.motion = parse_markers(document["motion"].get<std::string>(), "its shape");
    } else if (run.status == RunStatus::solved)
      run.shape = parse_shape(document.at("shape").dump(), "its shape");
    return run;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;  // file of another version: the simulator is run again
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
  if (run.motion) document["motion"] = marker_rows(*run.motion);
  if (run.shape) {
    document["shape"] = {{"points_m", points_json(run.shape->points)}};
    if (!run.shape->arc_length.empty()) document["shape"]["arc_length_m"] = run.shape->arc_length;
  }
  write_file(file, document.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n",
             Replaces::own_format);
}

/// Runs a simulator. @param time_limit  [s], > 0
/// @throws OutputError as run_foreign()
SimulatorRun run_simulator(const Simulator& simulator, const BatteryScene& scene, int points,
                           double time_limit) {
  SimulatorRun run;
  BatteryScene numbered = scene;
  numbered.scene.force_model.points = points;
  if (simulator.function && scene.motion) {
    run.status = RunStatus::not_supported;
    run.problem = "a function has no motion";
  } else if (simulator.function) {
    run = simulator.function(numbered.scene, points);
  } else if (simulator.own) {
    numbered.scene.force_model.law = simulator.law;
    run = run_own(*simulator.own, std::move(numbered), points, time_limit);
  } else {
    run = scene.motion ? run_foreign_motion(simulator.program, battery_document(scene, points),
                                            points, time_limit)
                       : run_foreign(simulator.program, scene.scene, points, time_limit);
  }
  run.points = points;
  return run;
}

}  // namespace

std::vector<Simulator> parse_simulators(const std::vector<std::string>& texts) {
  std::vector<Simulator> simulators;
  std::set<std::string> taken;
  for (const std::string& text : texts) {
    Simulator simulator = parsed_simulator(text);
    if (!taken.insert(simulator.name).second) {
      throw InputError(fmt::format("--with {}: given twice (allowed: a name of its own for each)",
                                   simulator.name));
    }
    simulators.push_back(std::move(simulator));
  }
  return simulators;
}

SimulatorRun stored_or_new_run(const std::string& folder, const std::string& version,
                               const Simulator& simulator, const BatteryScene& scene, int points,
                               double time_limit) {
  if (folder.empty()) return run_simulator(simulator, scene, points, time_limit);
  const std::filesystem::path output_folder = std::filesystem::path(folder) / simulator.name;
  const std::filesystem::path file = output_folder / fmt::format("{}_{}.json", scene.id, points);
  const std::string identity =
      simulator.function ? fmt::format("function {}", simulator.name)
      : simulator.own    ? fmt::format("model {}", simulator.name)
                         : fmt::format("command {}", Json(simulator.program.words).dump());
  const std::string known = fingerprint(fmt::format(
      "dlo/run/3\n{}\n{}\n{}{}\n{}", version, identity, files_of_command(simulator.program.words),
      time_limit, battery_document(scene, points)));
  if (std::optional<SimulatorRun> run = read_run(file, known)) return std::move(*run);
  SimulatorRun run = run_simulator(simulator, scene, points, time_limit);
  if (run.status == RunStatus::failed) return run;
  std::error_code error;
  std::filesystem::create_directories(output_folder, error);
  if (error) throw OutputError(fmt::format("{}: {}", output_folder.string(), error.message()));
  write_run(file, known, run);
  return run;
}

}  // namespace dlo::compare
