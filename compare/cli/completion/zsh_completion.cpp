#include <fmt/format.h>

#include <string_view>

#include "completion/completion.hpp"
#include "option/output.hpp"

namespace dlo::cli {
namespace {

/// Within single quotes, none of its characters a mark of _arguments or _describe.
std::string zsh_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (std::string_view("[]:\\").find(c) != std::string_view::npos) out += '\\';
    out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return out;
}

/// The action of _arguments that offers values.
std::string zsh_action(const OptionText& text) {
  const Completion completion = completion_of(text);
  switch (completion.offer) {
    case Offer::words:
      return fmt::format("({})", fmt::join(completion.words, " "));
    case Offer::scenes:
      return "_files -g \"*.toml(-.)\"";
    case Offer::files:
      return "_files";
    case Offer::folders:
      return "_files -/";
    case Offer::own:
    case Offer::nothing:
      break;
  }
  return " ";
}

void add_zsh_option(const CLI::Option& option, std::string& out) {
  const OptionText text = option_text(option);
  const bool is_flag = completion_of(text).offer == Offer::nothing;
  const std::string description = zsh_text(short_description(text.description));
  for (const std::string& name : text.names) {
    const bool is_long = name.starts_with("--");
    append(out, " \\\n        '{}{}{}[{}]", text.repeated ? "*" : "", name,
           is_flag               ? ""
           : text.optional_value ? "=-"
           : is_long             ? "="
                                 : "+",
           description);
    if (!is_flag) {
      append(out, "{}{}:{}", text.optional_value ? "::" : ":",
             text.value.empty() ? "value" : zsh_text(text.value), zsh_action(text));
    }
    out += "'";
  }
}

}  // namespace

std::string zsh_completion(const CLI::App& app) {
  std::string commands;
  std::string cases;
  for (const CLI::App* command : commands_of(app)) {
    append(commands, "    '{}:{}'\n", command->get_name(), zsh_text(command->get_description()));
    append(cases, "    {})\n      _arguments", command->get_name());
    for (const CLI::Option* option : options_of(*command)) add_zsh_option(*option, cases);
    for (const CLI::Option* argument : arguments_of(*command)) {
      const OptionText text = option_text(*argument);
      append(cases, " \\\n        '{}:{}:{}'", text.repeated ? "*" : "", text.names.front(),
             zsh_action(text));
    }
    cases += " ;;\n";
  }
  std::string options;
  for (const CLI::Option* option : options_of(app)) add_zsh_option(*option, options);
  return "#compdef dlo\n"
         "# Completion of dlo for zsh; written by dlo --zsh-completion.\n"
         "_dlo() {\n"
         "  local -a commands\n"
         "  commands=(\n" +
         commands +
         "  )\n"
         "  if ((CURRENT == 2)); then\n"
         "    _describe command commands\n"
         "    [[ $PREFIX == -* ]] && _arguments" +
         options +
         "\n"
         "    return\n"
         "  fi\n"
         "  shift words\n"
         "  ((CURRENT--))\n"
         "  case $words[1] in\n" +
         cases +
         "  esac\n"
         "}\n"
         "if [[ $funcstack[1] == _dlo ]]; then\n"
         "  _dlo \"$@\"\n"
         "else\n"
         "  compdef _dlo dlo\n"
         "fi\n";
}

}  // namespace dlo::cli
