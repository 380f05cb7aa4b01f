#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {

/// Foreign simulator, as --with names it: NAME=COMMAND (doc/protocol.md).
struct ForeignProgram {
  std::string name;  ///< letters, digits and "_.-+"; none of the names of dlo's models
  std::vector<std::string> words;  ///< words of its command, with {scene}, {points} and {shape}
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

/// Result of a foreign program on a scene, or the reason why there is none.
struct ForeignRun {
  std::optional<MeasuredShape> shape;  ///< the shape as written; empty for a motion
  std::optional<MarkerMotion> motion;  ///< the motion as written, if a motion was requested
  double seconds = 0;                  ///< wall time of the process [s]
  std::string problem;                 ///< one line; empty if there is a shape or a motion
  bool too_long = false;               ///< killed at the time limit
  /// The program does not support the scene: its exit status is 3, or it failed or wrote no shape
  /// and the last line of its standard error begins with "not supported", or it wrote one shape
  /// instead of a motion.
  bool not_supported = false;
};

/// Runs a program on a scene. {scene} is replaced by a file with the scene's document for `points`
/// points, {points} by their number, and {shape} by the file that the program has to write;
/// {shape}.csv and similar names are found too. Both files are in a new temporary folder, which is
/// removed afterwards. The working directory is that of this process.
/// @param time_limit  [s], > 0
/// @throws OutputError if that folder cannot be made or written
[[nodiscard]] ForeignRun run_foreign(const ForeignProgram& program, Scene scene, int points,
                                     double time_limit);

/// Runs a program on the document of a motion, as run_foreign() does. The program writes frames
/// that parse_markers() reads. If it writes one shape instead, the result is not_supported.
[[nodiscard]] ForeignRun run_foreign_motion(const ForeignProgram& program,
                                            const std::string& document, int points,
                                            double time_limit);

/// Checks that each end that a gripper holds is at the gripper: within 1 % of the length, plus the
/// part of the rod that the file's arc lengths leave out at that end.
/// @param told  whether the arc lengths were read from the file
/// @throws InputError naming the gripper
void require_held_ends(const Scene& scene, const Shape& laid, bool told);

/// Measures the distances of a foreign shape from a reference, in the scene's frame, as `dlo check`
/// measures a file that contains the whole rod. @throws InputError as require_held_ends(), or if
/// the shape is less than half of the rod
[[nodiscard]] Deviation foreign_deviation(const Scene& scene, const MeasuredShape& shape,
                                          const Reference& reference);

}  // namespace dlo::compare
