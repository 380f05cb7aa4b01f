#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {

/// Foreign simulator, as --with names it: NAME=COMMAND (doc/protocol.md).
struct ForeignProgram {
  std::string name;  ///< letters, digits and "_.-+"; none of the names of dlo's models
  std::vector<std::string> words;  ///< words of its command, with {shape} at least once
};

/// Whether a name consists of letters, digits and "_.-+" and is neither "." nor "..", so that a
/// folder may have it.
[[nodiscard]] bool is_program_name(const std::string& name);

/// Reads a foreign program. @param text  "NAME=COMMAND"; the command is split by command_words()
/// @throws InputError, also if {shape} is missing
[[nodiscard]] ForeignProgram parse_foreign_program(const std::string& text);

/// Reads all programs of a command line. @throws InputError as parse_foreign_program(), or if two
/// programs have the same name
[[nodiscard]] std::vector<ForeignProgram> parse_foreign_programs(
    const std::vector<std::string>& texts);

enum class RunStatus {
  solved,         ///< there is a shape or a motion
  not_supported,  ///< the simulator reports that it does not support the scene
  failed,         ///< any other outcome
  not_judged,     ///< the reference of the scene did not converge; the simulator was not run
};

/// Names of the statuses in files.
template <>
struct Choices<RunStatus> {
  /// All statuses, in the order of the enumeration.
  static constexpr Choice<RunStatus> all[] = {{RunStatus::solved, "solved", ""},
                                              {RunStatus::not_supported, "not supported", ""},
                                              {RunStatus::failed, "failed", ""},
                                              {RunStatus::not_judged, "not judged", ""}};
};

/// Shape or motion of a scene with N points, or the reason why there is none. The status of a
/// program that ended within the time limit is not_supported if its exit status is 3, or if it
/// wrote one shape instead of a motion. It is so too if the program failed or wrote no shape, and
/// the last line of its standard error begins with "not supported".
struct SimulatorRun {
  int points = 0;                        ///< N
  RunStatus status = RunStatus::failed;  ///< how the run ended
  std::string problem;                   ///< one line; empty if the status is `solved`
  double seconds = 0;                    ///< wall time of the simulator [s]
  bool too_long = false;                 ///< whether a program was killed at the time limit
  std::optional<MeasuredShape> shape;    ///< shape of a solved run of a scene at rest
  std::optional<MarkerMotion> motion;    ///< motion of a solved run of a scene that moves
  /// RMS distance from the reference, divided by the length, or for a motion by
  /// MotionReference::rms_displacement [-]; NaN without a shape, or if it was not compared.
  double error = std::numeric_limits<double>::quiet_NaN();
};

/// Runs a program on a scene. {scene} is replaced by a file with the scene's document for `points`
/// points, {points} by their number, and {shape} by the file that the program has to write;
/// {shape}.csv or a similar name is found too, if it is the only one. Both files are in a new
/// temporary folder, which is removed afterwards. The working directory is that of this process.
/// A shape of segment starts is completed (complete_segment_starts()).
/// @param time_limit  [s], > 0
/// @throws OutputError if that folder cannot be made or written
[[nodiscard]] SimulatorRun run_foreign(const ForeignProgram& program, Scene scene, int points,
                                       double time_limit);

/// Runs a program on the document of a motion, as run_foreign() does. The program writes frames
/// that parse_markers() reads. If it writes one shape instead, the result is not_supported.
[[nodiscard]] SimulatorRun run_foreign_motion(const ForeignProgram& program,
                                              const std::string& document, int points,
                                              double time_limit);

/// Checks that each end that a gripper holds is at the gripper: within 1 % of the length, plus the
/// part of the rod that the file's arc lengths leave out at that end.
/// @param has_arc_lengths  whether the arc lengths were read from the file
/// @throws InputError naming the gripper
void require_held_ends(const Scene& scene, const Shape& aligned, bool has_arc_lengths);

/// Measures the distances of a foreign shape from a reference, in the scene's frame, as `dlo check`
/// measures a file that contains the whole rod. Sets only rms_m, max_m, rms_over_length and tip_m.
/// @throws InputError as align() and require_held_ends(), or if the shape is less than half of the
/// rod
[[nodiscard]] Deviation foreign_deviation(const Scene& scene, const MeasuredShape& shape,
                                          const Reference& reference);

}  // namespace dlo::compare
