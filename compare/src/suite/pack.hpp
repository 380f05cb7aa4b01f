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

/// Writes a pack that needs no dlo to be used: ID.json and ID.csv of each answer, schema.json, and
/// in the end suite.json, the index. Each file is made under another name and renamed. Nothing in
/// it depends on the time or on the machine, so that a pack is the same when it is written again.
/// @param folder  made if it is not there
/// @throws OutputError
void write_pack(const std::string& folder, const std::string& battery_version,
                const std::vector<Answer>& answers);

}  // namespace dlo::compare
