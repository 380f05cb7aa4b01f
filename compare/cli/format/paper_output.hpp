#pragma once

#include <string>

#include "format/json.hpp"
#include "paper/paper.hpp"

namespace dlo::cli {

[[nodiscard]] std::string paper_text(const compare::PaperReport& report);

[[nodiscard]] Json paper_json(const compare::PaperReport& report);

/// One number a line: section, scene, item, quantity, value.
[[nodiscard]] std::string paper_csv(const compare::PaperReport& report);

}  // namespace dlo::cli
