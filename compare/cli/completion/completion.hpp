#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "option/help.hpp"

namespace dlo::cli {

/// What a shell may offer for an option's value, or for an argument.
enum class Offer {
  nothing,  ///< there is none: a flag
  words,    ///< one of some
  scenes,   ///< files *.toml
  files,    ///< any file
  folders,  ///< a folder
  own,      ///< a number or a text, of which a shell knows nothing
};

struct Completion {
  Offer offer = Offer::nothing;
  std::vector<std::string> words;
};

[[nodiscard]] Completion completion_of(const OptionText& text);

/// The first clause of a description.
[[nodiscard]] std::string short_description(const std::string& description);

/// Completion for a shell: commands, their options, values of options that have a choice, files.
[[nodiscard]] std::string bash_completion(const CLI::App& app);
[[nodiscard]] std::string fish_completion(const CLI::App& app);
[[nodiscard]] std::string zsh_completion(const CLI::App& app);

}  // namespace dlo::cli
