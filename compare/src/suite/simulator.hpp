#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "foreign/foreign_program.hpp"
#include "suite/battery.hpp"

namespace dlo::compare {

/// Simulator that is run on the benchmark set: a foreign program, one of dlo's polygon models, or a
/// function.
struct Simulator {
  /// Name of the program or function, or the name of a model that parse_simulators() reads.
  std::string name;
  std::optional<Model> own;            ///< one of dlo's models; empty: `program` or `function`
  BendingLaw law = BendingLaw::hooke;  ///< joint law of `own`
  ForeignProgram program;              ///< command of the program
  /// Function of this process, called from any thread; empty: `own` or `program`.
  std::function<SimulatorRun(const Scene& scene, int points)> function = {};
};

/// Reads simulators.
/// @param texts  each NAME=COMMAND as parse_foreign_program() reads it, or "chain" or "force" with
///               the law `hooke`, or "chain_paper" or "force_paper" with the law `paper`
/// @throws InputError as parse_foreign_program(), or if two have the same name
[[nodiscard]] std::vector<Simulator> parse_simulators(const std::vector<std::string>& texts);

/// Returns the result that a folder stores of an earlier run with the same version of dlo, program,
/// time limit, scene and number of points; otherwise runs the simulator. Results that are solved or
/// not supported are stored, each in a file of its own. A failed run is not stored, because its
/// cause may be temporary: dlo may have stopped it.
/// @param folder   created if it does not exist; empty: nothing is stored
/// @param version  version of dlo
/// @throws OutputError if a result cannot be stored
[[nodiscard]] SimulatorRun stored_or_new_run(const std::string& folder, const std::string& version,
                                             const Simulator& simulator, const BatteryScene& scene,
                                             int points, double time_limit);

}  // namespace dlo::compare
