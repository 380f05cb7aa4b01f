#pragma once

#include <string>

#include "format/json.hpp"

namespace dlo::cli {

/// A scene's document (compare::scene_document) for people.
[[nodiscard]] std::string scene_text(const Json& document);

}  // namespace dlo::cli
