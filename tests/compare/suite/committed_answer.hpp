#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>

#include "../../helpers.hpp"
#include "base/input_file.hpp"

namespace dlo::test {

using nlohmann::json;

/// Returns the answer of the benchmark set for a scene, as data/suite/answers has it.
inline json committed_answer(const std::string& id) {
  return json::parse(compare::read_file(DLO_DATA "/suite/answers/" + id + ".json"));
}

inline Eigen::Vector3d vector_of(const json& value) {
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

}  // namespace dlo::test
