#include <fmt/format.h>

#include "completion/completion.hpp"
#include "option/output.hpp"

namespace dlo::cli {
namespace {

std::string fish_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c;
  }
  return out + "'";
}

/// What says which values are offered; of a flag nothing.
std::string fish_values(const OptionText& text) {
  const Completion completion = completion_of(text);
  // An option's own value needs no word of its own where it stands behind "=" only.
  const char* const needed = text.optional_value ? "" : " -x";
  switch (completion.offer) {
    case Offer::words:
      return fmt::format("{} -a {}", needed,
                         fish_quoted(fmt::format("{}", fmt::join(completion.words, " "))));
    case Offer::scenes:
      return " -x -k -a '(__fish_complete_suffix .toml)'";
    case Offer::files:
      return " -r -F";
    case Offer::folders:
      return " -x -a '(__fish_complete_directories)'";
    case Offer::own:
      return " -x";
    case Offer::nothing:
      break;
  }
  return {};
}

void add_fish_option(const std::string& where, const CLI::Option& option, std::string& out) {
  const OptionText text = option_text(option);
  append(out, "complete -c dlo {}", where);
  for (const std::string& name : text.names) {
    const bool is_long = name.starts_with("--");
    append(out, " {} {}", is_long ? "-l" : "-s", name.substr(is_long ? 2 : 1));
  }
  append(out, "{} -d {}\n", fish_values(text), fish_quoted(short_description(text.description)));
}

}  // namespace

std::string fish_completion(const CLI::App& app) {
  std::string out =
      "# Completion of dlo for fish; written by dlo --fish-completion.\n"
      "complete -c dlo -f\n";
  for (const CLI::Option* option : options_of(app)) {
    add_fish_option("-n __fish_use_subcommand", *option, out);
  }
  for (const CLI::App* command : commands_of(app)) {
    append(out, "complete -c dlo -n __fish_use_subcommand -a {} -d {}\n", command->get_name(),
           fish_quoted(command->get_description()));
    const std::string where =
        fmt::format("-n '__fish_seen_subcommand_from {}'", command->get_name());
    for (const CLI::Option* argument : arguments_of(*command)) {
      const Offer offer = completion_of(option_text(*argument)).offer;
      if (offer == Offer::own) continue;
      append(out, "complete -c dlo {}{}\n", where,
             offer == Offer::files ? " -F" : " -k -a '(__fish_complete_suffix .toml)'");
    }
    for (const CLI::Option* option : options_of(*command)) add_fish_option(where, *option, out);
  }
  return out;
}

}  // namespace dlo::cli
