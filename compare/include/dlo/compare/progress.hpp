#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace dlo::compare {

/// Called with how much is done and how much there is, in a unit of the function's own. From any
/// thread, but one call at a time, and `done` grows by one from call to call.
using Progress = std::function<void(std::int64_t done, std::int64_t total)>;

/// Called with what is being done, where no share of the whole is known; one call at a time.
using Stages = std::function<void(const std::string& what)>;

}  // namespace dlo::compare
