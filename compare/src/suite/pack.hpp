#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "suite/answer.hpp"

namespace dlo::compare {

/// Returns an answer as a document with schema dlo/answer/1, in SI units. Numbers that are only
/// rounding errors are 0. Points and their arc lengths have twelve decimals, bounds two significant
/// digits, and other results ten significant digits or fewer.
[[nodiscard]] nlohmann::ordered_json answer_json(const Answer& answer);

/// Returns a motion as a document with schema dlo/motion/1. Its points, arc lengths and times have
/// nine decimals.
[[nodiscard]] nlohmann::ordered_json motion_json(const MotionAnswer& answer);

/// Certified answers of a benchmark set.
struct Pack {
  std::string version;                ///< version of the benchmark set
  std::vector<Answer> answers;        ///< answers of scenes at rest
  std::vector<MotionAnswer> motions;  ///< answers of scenes that move
};

/// Computes the answers of scenes of both kinds. @param threads  0: all cores;  @throws as
/// certified_answer() and certified_motion()
[[nodiscard]] Pack certified_pack(const std::string& version,
                                  const std::vector<BatteryScene>& scenes, int threads);

/// Checks that a folder contains no file that write_pack() would replace but did not write itself.
/// ID.csv and ID.vtu count as written by it if ID.json has the schema of an answer.
/// @throws InputError that names the file
void require_own_pack(const std::string& folder, const std::vector<BatteryScene>& scenes);

/// Writes reference data that can be used without dlo: ID.json and ID.csv of each answer, ID.vtu of
/// each answer at rest, the schemas, and at the end the index suite.json. Each file is written
/// under another name and then renamed. The content does not depend on time or machine, so writing
/// it again gives the same files.
/// @param folder  created if it does not exist
/// @throws OutputError
void write_pack(const std::string& folder, const Pack& pack);

}  // namespace dlo::compare
