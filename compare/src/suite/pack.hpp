#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "suite/answer.hpp"

namespace dlo::compare {

/// An answer as a document with schema dlo/answer/1, in SI units: numbers that are rounding are 0,
/// lengths have twelve decimals, others ten significant digits.
[[nodiscard]] nlohmann::ordered_json answer_json(const Answer& answer);

/// Its points: x,y,z,s, as `dlo check` reads a shape.
[[nodiscard]] std::string answer_csv(const Answer& answer);

/// Its points as VTK's XML, for ParaView.
[[nodiscard]] std::string answer_vtu(const Answer& answer);

/// A motion as a document with schema dlo/motion/1; its lengths and times have nine decimals.
[[nodiscard]] nlohmann::ordered_json motion_json(const MotionAnswer& answer);

/// Its frames: time,s,x,y,z, as `dlo check --motion` reads a recording.
[[nodiscard]] std::string motion_csv(const MotionAnswer& answer);

/// What is certified of a battery.
struct Pack {
  std::string version;                ///< of the battery
  std::vector<Answer> answers;        ///< of scenes at rest
  std::vector<MotionAnswer> motions;  ///< of those that move
};

/// Of scenes of both kinds. @param threads  0: all cores;  @throws as their answers
[[nodiscard]] Pack certified_pack(const std::string& version,
                                  const std::vector<BatteryScene>& scenes, int threads,
                                  const SolveOptions& options = {});

/// Requires that a folder has no file that write_pack() would replace, other than those that it
/// wrote itself. @throws InputError that names the file
void require_own_pack(const std::string& folder, const std::vector<BatteryScene>& scenes);

/// Writes a pack that needs no dlo to be used: ID.json and ID.csv of each answer and ID.vtu of one
/// at rest, the schemas, and in the end suite.json, the index. Each file is made under another name
/// and renamed. Nothing in it depends on the time or on the machine, so that a pack is the same
/// when it is written again.
/// @param folder  made if it is not there
/// @throws OutputError
void write_pack(const std::string& folder, const Pack& pack);

}  // namespace dlo::compare
