#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/comparison.hpp"
#include "dlo/compare/progress.hpp"
#include "motion/dynamic_track.hpp"
#include "motion/track.hpp"
#include "paper/modulus_history.hpp"
#include "paper/printed_tables.hpp"
#include "report/shape_grid.hpp"
#include "study/benchmark.hpp"
#include "study/stability.hpp"
#include "study/stability_map.hpp"

namespace dlo::compare {

/// A scene with the text that it was read from, so that a report can hand it on.
struct SceneFile {
  std::string name;  ///< letters, digits and "._-" only, ends with ".toml", unique in a report
  std::string text;  ///< the file as it is
  Scene scene;       ///< as read from it
};

/// Reads scene files; of a folder all "*.toml" in it, by name.
/// @throws InputError naming the path, also for a folder without scenes; as load_scene
[[nodiscard]] std::vector<SceneFile> load_scene_files(const std::vector<std::string>& paths);

/// The paper's three scenes, and two that tell more: the same rod longer (Gamma = 10), and in
/// space.
[[nodiscard]] std::vector<SceneFile> report_scene_files();

/// Three that move: a cable around a post, a wire against a wall, a hanging rod that is swung.
[[nodiscard]] std::vector<SceneFile> report_moving_files();

/// What a report computes.
struct ReportOptions {
  /// RMS over the length up to which a shape counts as right, > 0. The report's own choice: there
  /// is no norm.
  double tolerance = 0.01;
  bool quick = false;   ///< of quick_report_options: the page and its commands say so
  bool history = true;  ///< E*/E against simulated time
  /// The parts that take longest; none: the report leaves it out, and says so.
  std::optional<BenchmarkOptions> benchmark = BenchmarkOptions{.budget_s = 20};
  /// The map of the largest stable c_F over c_c.
  std::optional<StabilityMapOptions> map = StabilityMapOptions{};
  /// The hard cases, with all steppers.
  std::optional<StabilityOptions> hard_cases =
      StabilityOptions{.steps_at_rest = 1'000'000, .excluded = {"N = 1000"}};
  /// Frames a second of what moves [Hz], > 0; none: as the scenes say.
  std::optional<double> frame_rate;
  bool motion = true;  ///< what moves is followed
  /// What the sliders of the page show; the same for all scenes.
  std::optional<ShapeGridOptions> grid = ShapeGridOptions{};
  int threads = 0;  ///< at most; 0: as many as the machine has. The benchmark has one, alone
};

/// For a report in seconds: a benchmark of 1 s, a coarse map, no hard cases.
[[nodiscard]] ReportOptions quick_report_options();

/// E*/E of one scene on its way to rest.
struct SceneHistory {
  std::string scene;                             ///< its name
  std::string file;                              ///< name of its SceneFile
  double point_weight = 0;                       ///< of an inner point [N]
  PaperWeight weight = PaperWeight::of_the_rod;  ///< of the points
  EffectiveModulus rest;                         ///< at rest
  ModulusHistory history;                        ///< before
};

/// What a report says of a scene.
struct SceneReport {
  SceneFile file;  ///< the scene
  /// As the scene says, then, unless it says so, with law hooke and bookkeeping consistent.
  std::vector<Comparison> comparisons;
  std::optional<SceneHistory> history;  ///< for rods that start straight
  /// Of the first comparison's rod, at drawn_arc_lengths() [N], positive where it is pulled. Empty
  /// where it is not the energy model's lowest shape, or a yielding obstacle is touched.
  std::vector<double> tension;
};

/// Kelvin-Voigt time of the material [s], of rods with inertia: without damping one that was swung
/// would go on for ever. The report's own choice.
inline constexpr double report_damping = 0.01;

/// What a report says of a scene's motion.
struct MotionReport {
  SceneFile file;        ///< the scene
  TrackOptions options;  ///< that it was followed with
  Track track;           ///< the rod at rest in every frame, the force model beside it
  std::optional<DynamicTrack> moving;  ///< the rod with inertia, where dynamic_track() knows it
};

/// All that a report shows.
struct Report {
  ReportOptions options;            ///< as given
  bool paper = false;               ///< of report_scene_files
  std::vector<SceneReport> scenes;  ///< in the files' order
  /// The paper's scenes with Table 5's weight of a point; of a report on the paper.
  std::vector<SceneHistory> printed_weight;
  std::optional<BenchmarkReport> benchmark;  ///< speed against error
  std::vector<std::string> benchmark_files;  ///< names of its scene files; none: benchmark_scenes
  std::optional<StabilityMap> map;           ///< measured and predicted limits of c_F
  std::string map_file;                      ///< empty: hard_case_scene
  std::vector<StabilityResult> hard_cases;   ///< case by case, stepper by stepper
  std::vector<MotionReport> motions;         ///< of what moves, in the files' order
  std::optional<ShapeGrid> grid;             ///< for the sliders
  std::vector<std::string> failures;  ///< what was asked for but did not converge, one line each
  double seconds = 0;                 ///< wall time of all of it
};

/// Computes a report. First the benchmark, by itself; then, on all threads, the rest. Without scene
/// files it is about report_scene_files, benchmark_scenes and hard_case_scene; else the benchmark
/// takes the given scenes with the least and the largest Gamma, and the map the first one.
///
/// Histories take c_c = AE / 1000 (the paper's proportion: 659.734 N) unless a scene names a c_c,
/// and only rods with one clamp, which start straight. What does not converge, or what a model
/// refuses, is said in `failures` and left out; the rest of the report is not touched by it.
/// @param progress  called with what is being done, also by other threads, but one call at a time
/// @throws InputError if a scene cannot be made into points, before anything is computed;
/// std::invalid_argument if tolerance or threads is out of range
[[nodiscard]] Report make_report(const std::vector<SceneFile>& files, const ReportOptions& options,
                                 const Stages& progress = {});

}  // namespace dlo::compare
