#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/progress.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "foreign/foreign_program.hpp"

namespace dlo::compare {

/// Settings of dlo bench: runs, tracking motion and time budget.
struct BenchmarkOptions {
  /// Time budget of all runs [s], > 0. A run is skipped if its time, predicted from earlier runs,
  /// exceeds a quarter of the time that is left for its scene.
  double budget_s = 40;
  /// Runs per median, >= 1; quick runs are repeated more often, and fewer runs are made if little
  /// time is left.
  int repeats = 5;
  /// Speed v of the grippers in tracking runs [m/s], > 0; they also rotate at v/l.
  double gripper_speed = 0.1;
  int frames = 200;                           ///< frames of 1 ms per tracking run, >= 1
  std::vector<ForeignProgram> programs = {};  ///< foreign programs, for the static runs
  double program_time_limit = 20;             ///< limit of one run of a foreign program [s], > 0
};

/// Median and quartiles of repeated runs [s].
struct Timing {
  double median_s = 0;          ///< median [s]
  double lower_quartile_s = 0;  ///< lower quartile [s]
  double upper_quartile_s = 0;  ///< upper quartile [s]
  int repeats = 0;              ///< number of runs
};

/// Settings of the force model or of the chain in the benchmark.
struct ForceVariant {
  BendingLaw law = BendingLaw::hooke;                 ///< joint law
  Bookkeeping bookkeeping = Bookkeeping::consistent;  ///< end and mass convention of the polygon
  Stepper stepper = Stepper::automatic;               ///< stepper of `force`; a chain has no steps
  double stretch_share = 1;                           ///< c_c divided by AE [-]

  /// Returns the force model's settings for a scene, with N points.
  [[nodiscard]] ForceModelSettings settings(const Scene& scene, int points) const;
  bool operator==(const ForceVariant&) const = default;
};

/// Timing and error of one model with one setting on one scene.
struct BenchmarkRun {
  std::string scene;            ///< name of the scene
  Model model = Model::energy;  ///< model that was timed, if `program` is empty
  std::string program = {};     ///< name of the foreign program; empty for a model
  /// K of energy (0: as many as needed), N of chain, force and programs, 0 for exact.
  int size = 0;
  std::optional<ForceVariant> variant;  ///< settings of chain and force
  /// Time of a solution from the straight rod. Tracking runs: time of one frame; programs: of the
  /// process.
  Timing time;
  long evaluations = 0;  ///< or steps; tracking runs: mean of one frame; programs: 0
  /// RMS distance from the reference (of `exact`, which is the reference, from `energy`), divided
  /// by the length; tracking runs: RMS over the compared frames.
  double rms_over_length = 0;
  bool front = false;  ///< see mark_pareto_front()
};

/// Returns the setting in words: law and convention, for `force` also stepper and c_c, for `energy`
/// "K as needed" if K is not fixed; empty for `exact` and programs.
[[nodiscard]] std::string setting_of(const BenchmarkRun& run);

/// Returns model, size and setting in words.
[[nodiscard]] std::string name_of(const BenchmarkRun& run);

/// Returns the model, such as "exact", or the name of the program.
[[nodiscard]] std::string model_of(const BenchmarkRun& run);

/// Fastest run of a scene for a required accuracy.
struct BenchmarkAnswer {
  double error = 0;  ///< required accuracy, divided by the length
  /// Index of the fastest run of the scene within it; empty if there is none.
  std::optional<std::size_t> best;
};

/// Run of a foreign program that returned no valid shape.
struct BenchmarkFailure {
  std::string scene;    ///< name of the scene
  std::string program;  ///< name of the program
  int points = 0;       ///< requested number of points
  std::string problem;  ///< one line
};

/// All runs of one scene.
struct SceneBenchmark {
  std::string scene;  ///< name of the scene
  double gamma = 0;   ///< w l^3 / (EI) [-]
  /// Model of the reference; energy if exact does not solve the scene.
  Model reference = Model::exact;
  std::vector<BenchmarkRun> runs;      ///< static runs
  std::vector<BenchmarkRun> tracking;  ///< tracking runs, timed per frame behind a moving gripper
  /// Answers of the static runs, for errors of 10 %, 1 %, 0.1 % and 1e-6.
  std::vector<BenchmarkAnswer> answers;
  /// Answers of the tracking runs, for the same errors.
  std::vector<BenchmarkAnswer> tracking_answers;
  /// Static runs: the fastest `energy` run within 1e-6 l and the fastest `force` run within 1e-3 l.
  std::optional<std::size_t> energy_at_1e6, force_at_1e3;  ///< empty if there is none
};

/// Results of a benchmark on all its scenes.
struct BenchmarkReport {
  BenchmarkOptions options;            ///< the given options
  std::vector<SceneBenchmark> scenes;  ///< results in the given order
  std::vector<std::string> skipped;  ///< runs that did not fit into the budget or did not converge
  std::vector<BenchmarkFailure> failures;  ///< failed runs of programs, in the order of the runs
  /// How the first shape of each program on each scene was interpreted, one line per note.
  std::vector<std::string> notes;
  double seconds = 0;  ///< wall time of the benchmark [s]
};

/// Sets BenchmarkRun::front of the runs that no other run beats. A run beats another if neither its
/// time (median) nor its error is larger, and one of both is smaller. Errors must not be NaN.
void mark_pareto_front(std::vector<BenchmarkRun>& runs);

/// Returns the index of the fastest run with an error of at most `error`, of all runs or of one
/// model's; std::nullopt if no run is so accurate.
[[nodiscard]] std::optional<std::size_t> fastest_within(const std::vector<BenchmarkRun>& runs,
                                                        double error,
                                                        std::optional<Model> model = {});

/// Whether there is any run, or any run of one model. If there is none, an empty result of
/// fastest_within() has no meaning.
[[nodiscard]] bool has_run(const std::vector<BenchmarkRun>& runs, std::optional<Model> model = {});

/// Times every model on every scene, in one thread. The smallest K or N of every model is run
/// first, then the tracking runs, then the other sizes in turn, so that a small budget leaves some
/// runs of each model. The static runs are `exact`, `energy` over K, `chain` over N, and `force`
/// over N, laws, steppers (auto, implicit, and dynamic with the paper's constants) and c_c (AE and
/// AE/1000, which the paper used). Each starts from the straight rod, or from the model's own
/// initial guess, and ends at rest. Times include the set-up of the scene, as a caller observes
/// them. The rest tolerance of `force` is a tenth of the discretisation error of its N. Programs
/// are run with the same N.
///
/// Tracking: after the rod has come to rest, all grippers move along +x at the given speed v and
/// rotate as one body about z at v/l, which changes the shape. In each frame of 1 ms the energy
/// model follows, and the force model makes the steps that fit into a frame on this machine
/// (measured before; at least one), or one step with stepper implicit. The error is measured in
/// every tenth frame, against the quasi-static shape of the reference model.
/// @param scenes    empty: the paper's steel rod, and one with a hundredth of its modulus
/// @param progress  called with the name of each scene
/// @throws std::invalid_argument if an option is out of range, InputError, ConvergenceError
[[nodiscard]] BenchmarkReport run_benchmark(const std::vector<Scene>& scenes,
                                            const BenchmarkOptions& options = {},
                                            const Stages& progress = {});

}  // namespace dlo::compare
