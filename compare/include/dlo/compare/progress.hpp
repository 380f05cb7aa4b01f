#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace dlo::compare {

/// Called with the completed and the total amount of work, in a unit of the caller's choice. Calls
/// may come from any thread, but one at a time, and `done` grows by one from call to call.
using Progress = std::function<void(std::int64_t done, std::int64_t total)>;

/// Called with the name of the current stage, if the total amount is unknown; one call at a time.
using Stages = std::function<void(const std::string& what)>;

}  // namespace dlo::compare
