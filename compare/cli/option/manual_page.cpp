#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <ctime>
#include <sstream>

#include "option/help.hpp"
#include "option/manual.hpp"

namespace dlo::cli {
namespace {

/// For a line of text in mdoc.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else {
      out += c == '-' ? std::string("\\-") : std::string(1, c);
    }
  }
  return out.starts_with('.') || out.starts_with('\'') ? "\\&" + out : out;
}

std::string upper_first(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

/// A paragraph; mdoc wants every sentence on a line of its own.
std::string paragraph(const std::string& text) {
  std::string out;
  std::size_t start = 0;
  while (start < text.size()) {
    const std::size_t end = std::min(text.find(". ", start), text.size() - 1);
    std::istringstream lines(wrap(text.substr(start, end + 1 - start), 0, 72));
    for (std::string line; std::getline(lines, line);) out += escaped(line) + "\n";
    start = end + 2;
  }
  return out;
}

/// One argument of a macro.
std::string quoted(const std::string& text) { return "\"" + escaped(text) + "\""; }

std::string item(const CLI::Option& option) {
  const OptionText text = option_text(option);
  std::string line = ".It";
  if (option.get_positional()) {
    line += " Ar " + quoted(text.names.front());
  } else {
    for (std::size_t i = 0; i < text.names.size(); ++i) {
      line += fmt::format("{} Fl {}", i > 0 ? " ," : "", escaped(text.names[i].substr(1)));
    }
    const std::string value = text.value_text();
    if (!value.empty()) line += " Ar " + quoted(text.optional_value ? "[=" + value + "]" : value);
  }
  return line + "\n" + paragraph(upper_first(text.full_description()));
}

std::string literal(const std::string& lines) {
  std::string out = ".Bd -literal -offset 2n\n";
  std::istringstream stream(lines);
  for (std::string line; std::getline(stream, line);) out += escaped(line) + "\n";
  return out + ".Ed\n";
}

std::string command_section(const CLI::App& command) {
  std::string out = fmt::format(".Ss dlo {}\n", command.get_name());
  out += paragraph(upper_first(command.get_description()) + ".");
  out += ".Bl -tag -width Ds\n";
  for (const CLI::Option* argument : arguments_of(command)) out += item(*argument);
  for (const CLI::Option* option : options_of(command)) out += item(*option);
  return out + ".El\n" + literal(command.get_footer());
}

/// Of the page: SOURCE_DATE_EPOCH, which reproducible builds set, or today.
std::string date() {
  const char* epoch = std::getenv("SOURCE_DATE_EPOCH");
  const std::time_t time = epoch != nullptr ? std::atol(epoch) : std::time(nullptr);
  std::tm parts{};
  ::gmtime_r(&time, &parts);
  constexpr const char* months[] = {"January",   "February", "March",    "April",
                                    "May",       "June",     "July",     "August",
                                    "September", "October",  "November", "December"};
  return fmt::format("{} {}, {}", months[parts.tm_mon], parts.tm_mday, parts.tm_year + 1900);
}

constexpr const char* tail = R"(.Sh ENVIRONMENT
.Bl -tag -width Ds
.It Ev NO_COLOR
If set and not empty, no colours.
.It Ev TERM
If
.Dq dumb ,
neither colours nor progress bars.
.El
.Sh FILES
Scenes, materials, parameters and baselines are TOML files.
Scenes are explained by the comments of the file that
.Nm Cm init
writes.
Shapes are CSV
.Pq columns x, y, z and perhaps s ,
JSON, VTK polylines or NumPy arrays.
Results are written whole or not at all; devices, pipes and links stay what they are.
An output that is also an input is refused.
.Sh EXIT STATUS
.Bl -tag -width Ds
.It 0
Good.
.It 1
A result is outside a tolerance.
.It 2
Bad usage or input.
.It 3
A solver did not converge.
.It 4
Out of memory or threads, or an internal error of
.Nm
itself.
.It 5
An output could not be written.
.El
.Sh EXAMPLES
From nothing to parameters of the force model:
)";

}  // namespace

std::string manual_page(const CLI::App& app) {
  std::string out = ".Dd " + date() + "\n.Dt DLO 1\n.Os\n";
  out +=
      ".Sh NAME\n.Nm dlo\n.Nd compare fast rod models with the physics of bending\n"
      ".Sh SYNOPSIS\n.Nm\n.Ar command\n.Op Ar options\n"
      ".Sh DESCRIPTION\n";
  out += paragraph(app.get_description());
  out += ".Pp\nOptions before a command:\n.Bl -tag -width Ds\n";
  for (const CLI::Option* option : options_of(app)) out += item(*option);
  out += ".El\n.Sh COMMANDS\n";
  std::string group;
  for (const CLI::App* command : commands_of(app)) {
    if (command->get_group() != group) {
      if (!group.empty()) out += ".El\n";
      group = command->get_group();
      out += (out.ends_with(".Sh COMMANDS\n") ? "" : ".Pp\n") + escaped(group) +
             "\n.Bl -tag -width materials -compact -offset 2n\n";
    }
    out += fmt::format(".It Cm {}\n", command->get_name());
    out += paragraph(upper_first(command->get_description()));
  }
  out += ".El\n";
  for (const CLI::App* command : commands_of(app)) out += command_section(*command);
  return out + tail +
         literal(
             "dlo init cable.toml --length \"2 m\" --diameter \"6 mm\" --material silicone\n"
             "dlo solve cable.toml\n"
             "dlo calibrate cable.toml --target 0.5% -o params.toml\n"
             "dlo compare cable.toml --parameters params.toml");
}

}  // namespace dlo::cli
