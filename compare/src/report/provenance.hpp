#pragma once

#include <string>
#include <utility>
#include <vector>

namespace dlo::compare {

/// What made a result, as names and values: compiler, libraries, machine, instruction set, time.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> provenance();

}  // namespace dlo::compare
