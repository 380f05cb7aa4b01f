#include <fmt/format.h>

#include "completion/completion.hpp"
#include "option/output.hpp"

namespace dlo::cli {
namespace {

std::string names_of(const std::vector<const CLI::Option*>& options) {
  std::string names;
  for (const CLI::Option* option : options) {
    for (const std::string& name : option_text(*option).names) {
      names += (names.empty() ? "" : " ") + name;
    }
  }
  return names;
}

/// What sets `values`, `files` or `folders` for a word that follows an option or stands alone;
/// empty for a flag.
std::string offered(const OptionText& text) {
  const Completion completion = completion_of(text);
  switch (completion.offer) {
    case Offer::words:
      return fmt::format("values='{}'", fmt::join(completion.words, " "));
    case Offer::scenes:
      return "files='*.toml'";
    case Offer::files:
      return "files='*'";
    case Offer::folders:
      return "folders=1";
    case Offer::own:
      return "values=' '";
    case Offer::nothing:
      break;
  }
  return {};
}

std::string command_case(const CLI::App& command) {
  std::string out;
  append(out, "    {})\n      options='{}'\n", command.get_name(), names_of(options_of(command)));
  for (const CLI::Option* argument : arguments_of(command)) {
    append(out, "      {}\n", offered(option_text(*argument)));
  }
  append(out, "      case $prev in\n");
  for (const CLI::Option* option : options_of(command)) {
    const OptionText text = option_text(*option);
    const std::string completion = offered(text);
    if (completion.empty() || text.optional_value) continue;
    append(out, "        {}) values= files= folders= options= {} ;;\n", fmt::join(text.names, "|"),
           completion);
  }
  append(out, "      esac ;;\n");
  return out;
}

}  // namespace

std::string bash_completion(const CLI::App& app) {
  std::string commands = names_of(options_of(app));
  std::string cases;
  for (const CLI::App* command : commands_of(app)) {
    commands += " " + command->get_name();
    cases += command_case(*command);
  }
  return R"(# Completion of dlo for bash; written by dlo --bash-completion.
_dlo() {
  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]}
  local options= values= files= folders=
  # bash makes --model=chain three words.
  if [[ $cur == = ]]; then
    cur=
  elif [[ $prev == = ]]; then
    prev=${COMP_WORDS[COMP_CWORD-2]}
  fi
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W ')" +
         commands + R"(' -- "$cur")
    return
  fi
  case ${COMP_WORDS[1]} in
)" + cases +
         R"(  esac
  if [[ $cur == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$cur")
  elif [[ -n $values ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$values" -- "$cur")
  elif [[ -n $folders ]]; then
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -d -- "$cur")
  elif [[ -n $files ]]; then
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -f -X "!$files" -- "$cur"; compgen -d -- "$cur")
  fi
}
complete -F _dlo dlo
)";
}

}  // namespace dlo::cli
