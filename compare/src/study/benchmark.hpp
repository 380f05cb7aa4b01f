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

/// What dlo bench measures, and how long.
struct BenchmarkOptions {
  /// Time that all runs may take [s], > 0. A run that would take more than what is left, judged by
  /// the runs before it, is skipped.
  double budget_s = 40;
  int repeats = 5;             ///< runs that a median is taken of, >= 1
  double gripper_speed = 0.1;  ///< v of the tracking runs [m/s], > 0; they also rotate by v/l
  int frames = 200;            ///< of 1 ms that the gripper moves in a tracking run, >= 1
  std::vector<ForeignProgram> programs = {};  ///< other people's, in the static runs
  double program_time_limit = 20;             ///< of each run of one [s], > 0
};

/// Median and quartiles of repeated runs [s].
struct Timing {
  double median_s = 0;          ///< [s]
  double lower_quartile_s = 0;  ///< [s]
  double upper_quartile_s = 0;  ///< [s]
  int repeats = 0;              ///< how many runs
};

/// A force model, or a chain, of the benchmark.
struct ForceVariant {
  BendingLaw law = BendingLaw::hooke;                 ///< of the joints
  Bookkeeping bookkeeping = Bookkeeping::consistent;  ///< of the polygon
  Stepper stepper = Stepper::automatic;               ///< of `force`; a chain has no steps
  double stretch_share = 1;                           ///< c_c over AE [-]

  /// On a scene, with N points.
  [[nodiscard]] ForceModelSettings settings(const Scene& scene, int points) const;
  /// Equal in all.
  bool operator==(const ForceVariant&) const = default;
};

/// One model with one setting on one scene.
struct BenchmarkRun {
  std::string scene;            ///< its name
  Model model = Model::energy;  ///< what was timed, where `program` is empty
  std::string program = {};     ///< name of somebody else's
  int size = 0;  ///< K of energy (0: as many as needed), N of chain, force, programs, 0 of exact
  std::optional<ForceVariant> variant;  ///< of chain and force
  /// From straight to the shape; of tracking runs, of one frame; of a program, of its process.
  Timing time;
  long evaluations = 0;        ///< or steps; of tracking runs, of one frame (mean); 0 of programs
  double rms_over_length = 0;  ///< against the reference; of tracking runs the RMS over all frames
  bool front = false;          ///< no other run of the scene is both faster and nearer
};

/// Law, bookkeeping, and of `force` stepper and c_c, in words; of energy whether K is as needed.
[[nodiscard]] std::string setting_of(const BenchmarkRun& run);

/// Model, size and setting in words.
[[nodiscard]] std::string name_of(const BenchmarkRun& run);

/// "exact", or the name of a program.
[[nodiscard]] std::string model_of(const BenchmarkRun& run);

/// What to use for an error.
struct BenchmarkAnswer {
  double error = 0;                 ///< wanted, share of the length
  std::optional<std::size_t> best;  ///< the fastest run of the scene within it; nothing: none
};

/// A run of somebody else's program that has no shape to measure.
struct BenchmarkFailure {
  std::string scene;    ///< its name
  std::string program;  ///< its name
  int points = 0;       ///< that it was asked for
  std::string problem;  ///< one line
};

/// All runs of one scene.
struct SceneBenchmark {
  std::string scene;                              ///< its name
  double gamma = 0;                               ///< w l^3 / (EI) [-]
  Model reference = Model::exact;                 ///< energy where exact cannot
  std::vector<BenchmarkRun> runs;                 ///< static
  std::vector<BenchmarkRun> tracking;             ///< per frame behind a moving gripper
  std::vector<BenchmarkAnswer> answers;           ///< static, for 10 %, 1 %, 0.1 % and 1e-6
  std::vector<BenchmarkAnswer> tracking_answers;  ///< the same of tracking
  /// Static: the fastest `energy` run within 1e-6 l and the fastest `force` run within 1e-3 l.
  std::optional<std::size_t> energy_at_1e6, force_at_1e3;  ///< nothing: none is
};

/// All scenes of a benchmark.
struct BenchmarkReport {
  BenchmarkOptions options;            ///< as given
  std::vector<SceneBenchmark> scenes;  ///< in the order given
  std::vector<std::string> skipped;    ///< runs that would not have fitted in, or did not converge
  std::vector<BenchmarkFailure> failures;  ///< in the order of the runs
  double seconds = 0;                      ///< all of it
};

/// The paper's steel rod (Gamma = 0.18, horizontal) and one a hundred times softer.
[[nodiscard]] std::vector<Scene> benchmark_scenes();

/// Marks the runs that no other run beats in time (median) and error both; those without an error
/// are never on the front.
void mark_front(std::vector<BenchmarkRun>& runs);

/// The fastest run (of any model, or of one) with an error of at most `error`.
[[nodiscard]] std::optional<std::size_t> fastest_within(const std::vector<BenchmarkRun>& runs,
                                                        double error,
                                                        std::optional<Model> model = {});

/// Whether there is any run (of any model, or of one). Without one, that no run is within an error
/// says nothing: nothing was run.
[[nodiscard]] bool has_run(const std::vector<BenchmarkRun>& runs, std::optional<Model> model = {});

/// Times every model on every scene, one thread. The smallest K or N of every model comes first,
/// then the tracking runs, then the other sizes in turn, so that a small budget leaves some runs of
/// each model. Static: `exact`, `energy` over K, `chain` over N,
/// `force` over N, laws, steppers (auto, implicit, and dynamic with the paper's constants) and c_c
/// (AE and AE/1000, which the paper used), each from straight, or from its own start, to rest.
/// Times are of the solver with the scene's set-up, as a caller sees it. The rest tolerance of
/// `force` is a tenth of the error that its N is good for. Programs are asked for the same N.
///
/// Tracking: after the rod has come to rest all grippers move along +x at the given speed v and
/// turn as one body about z by v/l, which changes the shape. Each frame of 1 ms the energy model
/// follows, and the force model makes the steps that fit a frame on this machine (measured before;
/// at least one), or, with stepper implicit, one. The error, of every tenth frame, is against the
/// quasi-static shape by the reference model.
/// @param progress  called with what is being done
/// @throws std::invalid_argument if an option is out of range, InputError, ConvergenceError
[[nodiscard]] BenchmarkReport run_benchmark(const std::vector<Scene>& scenes,
                                            const BenchmarkOptions& options = {},
                                            const Stages& progress = {});

}  // namespace dlo::compare
