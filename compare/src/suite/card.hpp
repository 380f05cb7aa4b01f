#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "batch/regression.hpp"
#include "dlo/compare/progress.hpp"
#include "suite/battery.hpp"
#include "suite/cause.hpp"
#include "suite/simulator.hpp"

namespace dlo::compare {

/// Results of a simulator on one scene.
struct CardScene {
  std::string id;                  ///< id of the scene
  std::string group;               ///< class of the scene
  std::vector<SimulatorRun> runs;  ///< in the order of N, without their shapes and motions
  double order = 0;                ///< convergence_order(); NaN if unknown
  std::vector<Cause> causes;       ///< identified causes of the error

  /// Returns `solved` if all runs are solved, else the status of the first run that is not.
  [[nodiscard]] RunStatus status() const;
  /// Returns the problem of the first run that is not solved; empty if all are.
  [[nodiscard]] std::string problem() const;
  /// Whether all runs are solved, no cause is a defect, and SimulatorRun::error at the largest N is
  /// at most 1 %, the default tolerance of `dlo check`.
  [[nodiscard]] bool is_correct() const;
};

/// Results of a simulator on all scenes of a class.
struct CardGroup {
  std::string name;       ///< name of the class
  int scenes = 0;         ///< number of scenes
  int solved = 0;         ///< number of scenes that are solved
  int right = 0;          ///< number of scenes with CardScene::is_correct()
  int not_supported = 0;  ///< number of scenes that are not supported
  int failed = 0;         ///< number of scenes that failed
  int not_judged = 0;     ///< number of scenes whose reference did not converge
  /// Largest error at each N of the solved scenes; NaN if there is none.
  std::vector<double> largest;
  double order = 0;    ///< smallest order of the solved scenes; NaN if unknown
  double seconds = 0;  ///< wall time of all runs [s]
  std::vector<std::pair<std::string, int>> causes;  ///< names of causes, with the number of scenes
};

/// Results table of a simulator.
struct Card {
  std::string simulator;          ///< name of the simulator
  std::string battery_version;    ///< version of the benchmark set
  std::vector<int> points;        ///< N, 2N, 4N
  std::vector<CardScene> scenes;  ///< in the order of the benchmark set

  /// Returns the results by classes, in the order of the benchmark set.
  [[nodiscard]] std::vector<CardGroup> groups() const;
  /// Returns the results of all scenes as one group without a name.
  [[nodiscard]] CardGroup total() const;
};

/// Settings of make_cards().
struct CardOptions {
  int points = 16;         ///< N of the first run; the others have 2N and 4N points
  int threads = 0;         ///< 0: all cores
  double time_limit = 60;  ///< limit of each run of a simulator, not of references [s], > 0
  std::string state;       ///< folder that stores finished runs; empty: not stored
  std::string version;     ///< version of dlo; runs that another version has stored are repeated
  Progress progress;       ///< counts scenes of all simulators
};

/// Runs simulators on scenes. Except for times, the results do not depend on the number of threads.
/// A scene whose reference does not converge is RunStatus::not_judged.
/// @throws OutputError; InputError as the computation of a reference
[[nodiscard]] std::vector<Card> make_cards(const std::string& battery_version,
                                           const std::vector<BatteryScene>& scenes,
                                           const std::vector<Simulator>& simulators,
                                           const CardOptions& options = {});

/// Returns results tables as a document with schema dlo/card/1; an unknown error or order is NaN.
[[nodiscard]] nlohmann::ordered_json cards_json(const std::vector<Card>& cards);

/// Compares the errors of results tables with a baseline of `dlo regress`. There is a case for each
/// scene, simulator and N, except for scenes that a simulator does not support. Cases of the
/// baseline of other scenes or simulators are not compared, and stay in Regression::cases.
/// @throws InputError if there is nothing to compare; else as judge_regression()
[[nodiscard]] Regression judge_cards(const std::vector<BaselineCase>& baseline,
                                     const std::vector<Card>& cards,
                                     const RegressionTolerance& tolerance = {});

}  // namespace dlo::compare
