#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "batch/regression_run.hpp"
#include "dlo/compare/progress.hpp"
#include "suite/battery.hpp"
#include "suite/cause.hpp"
#include "suite/simulator.hpp"

namespace dlo::compare {

/// A run of a card.
struct CardRun {
  int points = 0;                        ///< N
  RunStatus status = RunStatus::failed;  ///< how it ended
  std::string problem;                   ///< one line; empty if there is a shape
  /// RMS distance over the length, of a motion over how far the rod moves [-]; NaN without a shape
  double error = 0;
  double seconds = 0;  ///< wall time of the simulator [s]
};

/// A simulator on one scene.
struct CardScene {
  std::string id;             ///< of the scene
  std::string group;          ///< its class
  std::vector<CardRun> runs;  ///< by growing N
  double order = 0;           ///< convergence_order(); NaN: not known
  std::vector<Cause> causes;  ///< what is wrong, if that can be told

  /// Of all runs: solved if all are, else what the first one that is not says.
  [[nodiscard]] RunStatus status() const;
  /// Why it is not solved; empty if it is.
  [[nodiscard]] std::string problem() const;
  /// Solved, without a defect, and no farther from the rod at the largest N than `dlo check` allows
  /// by default, 1 % of the length.
  [[nodiscard]] bool right() const;
};

/// A simulator on all scenes of a class.
struct CardGroup {
  std::string name;             ///< of the class
  int scenes = 0;               ///< of it
  int solved = 0;               ///< of these
  int right = 0;                ///< of these, CardScene::right()
  int not_supported = 0;        ///< of these
  int failed = 0;               ///< of these
  int not_judged = 0;           ///< of these, their reference did not converge
  std::vector<double> largest;  ///< error at each N, of the scenes that are solved; NaN: of none
  double order = 0;             ///< the smallest of these scenes; NaN: not known
  double seconds = 0;           ///< wall time of all runs [s]
  std::vector<std::pair<std::string, int>> causes;  ///< by name, and of how many scenes
};

/// A simulator's score card.
struct Card {
  std::string simulator;          ///< its name
  std::string battery_version;    ///< of the battery
  std::vector<int> points;        ///< N, 2N, 4N
  std::vector<CardScene> scenes;  ///< in the battery's order

  /// By classes, in the battery's order.
  [[nodiscard]] std::vector<CardGroup> groups() const;
  /// All of these in one, without a name.
  [[nodiscard]] CardGroup total() const;
};

/// How cards are made.
struct CardOptions {
  int points = 16;         ///< N of the first run; the others have 2N and 4N
  int threads = 0;         ///< 0: all cores
  double time_limit = 60;  ///< of each run of a simulator, not of references [s], > 0
  std::string state;       ///< folder that keeps finished runs; empty: none
  std::string version;     ///< of dlo; runs that another version has kept are run again
  Progress progress;       ///< of scenes, all simulators
};

/// Runs simulators on scenes. Except for times, the card does not depend on the number of threads.
/// A scene whose reference does not converge is RunStatus::not_judged.
/// @throws OutputError
[[nodiscard]] std::vector<Card> make_cards(const std::string& battery_version,
                                           const std::vector<BatteryScene>& scenes,
                                           const std::vector<Simulator>& simulators,
                                           const CardOptions& options = {});

/// Cards as a document with schema dlo/card/1; an error or order that is not known is NaN.
[[nodiscard]] nlohmann::ordered_json cards_json(const std::vector<Card>& cards);

/// Compares the errors of cards with a baseline of `dlo regress`: a case for each scene, simulator
/// and N, without the scenes that a simulator does not support. Cases of the baseline of other
/// scenes or simulators are not compared, and stay in Regression::cases.
[[nodiscard]] Regression judge_cards(const std::vector<BaselineCase>& baseline,
                                     const std::vector<Card>& cards,
                                     const RegressionTolerance& tolerance = {});

}  // namespace dlo::compare
