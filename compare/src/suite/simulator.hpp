#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"
#include "dlo/compare/solution.hpp"
#include "foreign/foreign_program.hpp"
#include "suite/battery.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {

/// How a run ended.
enum class RunStatus {
  solved,         ///< there is a shape
  not_supported,  ///< the simulator says that it has no such scene
  failed,         ///< anything else
  not_judged,     ///< the reference of the scene did not converge; the simulator was not run
};

/// In words, for files.
template <>
struct Choices<RunStatus> {
  /// In the enumeration's order.
  static constexpr Choice<RunStatus> all[] = {{RunStatus::solved, "solved", ""},
                                              {RunStatus::not_supported, "not supported", ""},
                                              {RunStatus::failed, "failed", ""},
                                              {RunStatus::not_judged, "not judged", ""}};
};

/// A shape or a motion of a scene with so many points, or why there is none.
struct SimulatorRun {
  int points = 0;                        ///< N
  RunStatus status = RunStatus::failed;  ///< how it ended
  std::string problem;                   ///< one line; empty if there is a shape
  double seconds = 0;                    ///< wall time [s]
  std::optional<MeasuredShape> shape;    ///< of a run that is solved
  std::optional<MarkerMotion> motion;    ///< in place of it, of a scene that moves
};

/// What is run on the battery: a program, one of our own polygon models, or a function.
struct Simulator {
  std::string name;          ///< of the program or function, or as parse_simulators() has it
  std::optional<Model> own;  ///< none: `program`
  BendingLaw law = BendingLaw::hooke;  ///< of an own one
  ForeignProgram program;              ///< its command
  /// A function of this process, from any thread. None: one of those.
  std::function<SimulatorRun(const Scene& scene, int points)> function = {};

  /// What its results depend on, in words.
  [[nodiscard]] std::string identity() const;
};

/// @param texts  each NAME=COMMAND as parse_foreign_program() takes it, or "chain" or "force" with
///               the law `hooke`, or "chain_paper" or "force_paper"
/// @throws InputError as that, or if two have the same name
[[nodiscard]] std::vector<Simulator> parse_simulators(const std::vector<std::string>& texts);

/// Runs a simulator. @param time_limit  [s], > 0
/// @throws OutputError as run_foreign()
[[nodiscard]] SimulatorRun run_simulator(const Simulator& simulator, const BatteryScene& scene,
                                         int points, double time_limit);

/// Returns the result that a folder keeps of an earlier run with the same version of dlo, program,
/// time limit and scene; otherwise runs the simulator. Results that are solved or not supported are
/// kept, each in a file of its own. A failed run is not kept, because its cause may be gone: dlo
/// may have ended it.
/// @param folder   is made if it does not exist; empty: nothing is kept
/// @param version  of dlo
[[nodiscard]] SimulatorRun kept_run(const std::string& folder, const std::string& version,
                                    const Simulator& simulator, const BatteryScene& scene,
                                    int points, double time_limit);

/// What a program reads of a scene: scene_document(), and of one that moves also `motion`, with
/// the times of frames that are asked for, the shape that it begins with at equal arc lengths, and
/// the masses that hang on the rod.
[[nodiscard]] std::string battery_document(const BatteryScene& scene, int points);

}  // namespace dlo::compare
