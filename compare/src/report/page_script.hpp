#pragma once

#include <string_view>

namespace dlo::compare::builtin {

/// The script of a report's page; its data stands before it, see page_data.
extern const std::string_view interactive_js;

}  // namespace dlo::compare::builtin
