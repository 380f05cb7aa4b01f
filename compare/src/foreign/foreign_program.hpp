#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {

/// Somebody else's simulator, as --with names it: NAME=COMMAND (doc/protocol.md).
struct ForeignProgram {
  std::string name;                ///< letters, digits and "_.-+"; none of our models
  std::vector<std::string> words;  ///< of its command, with {scene}, {points} and {shape}
};

/// Whether a name is of letters, digits and "_.-+", so that a folder may have it.
[[nodiscard]] bool is_program_name(const std::string& name);

/// @param text  "NAME=COMMAND", split as command_words() does
/// @throws InputError, also if {shape} is missing
[[nodiscard]] ForeignProgram parse_foreign_program(const std::string& text);

/// All of a command line. @throws InputError as above, or if two have the same name
[[nodiscard]] std::vector<ForeignProgram> parse_foreign_programs(
    const std::vector<std::string>& texts);

/// Its shape of a scene, or why there is none.
struct ForeignRun {
  std::optional<MeasuredShape> shape;  ///< as it wrote it
  std::optional<MarkerMotion> motion;  ///< the same, where that was asked for
  double seconds = 0;                  ///< wall time of the process [s]
  std::string problem;                 ///< one line; empty if there is a shape
  bool too_long = false;               ///< it was killed at the time limit
  /// It has no such scene: exit status 3, or no shape and a last line of standard error that begins
  /// with "not supported".
  bool not_supported = false;
};

/// Runs a program on a scene in a folder of its own in the system's temporary one, which is gone
/// afterwards: {scene} is a file there with the scene's document for that many points, {points}
/// their number, {shape} where it has to write; {shape}.csv and the like are found too. The working
/// directory is ours.
/// @param time_limit  [s], > 0
/// @throws OutputError if that folder cannot be made or written
[[nodiscard]] ForeignRun run_foreign(const ForeignProgram& program, Scene scene, int points,
                                     double time_limit);

/// The same of a motion: {scene} has the document, and the program writes frames as
/// parse_markers() takes them. One shape that it writes is no failure: it has no motion.
[[nodiscard]] ForeignRun run_foreign_motion(const ForeignProgram& program,
                                            const std::string& document, int points,
                                            double time_limit);

/// An end that a gripper holds is where that is: to 1 % of the length, and to what a file says that
/// it has less than the rod.
/// @param told  whether the arc lengths are those of a file;  @throws InputError naming the gripper
void require_held_ends(const Scene& scene, const Shape& laid, bool told);

/// Distances of a foreign shape from a reference, as `dlo check` measures a file that is the whole
/// rod, in the scene's frame. @throws InputError as require_held_ends(), or if the shape is less
/// than half of the rod
[[nodiscard]] Deviation foreign_deviation(const Scene& scene, const MeasuredShape& shape,
                                          const Reference& reference);

}  // namespace dlo::compare
