#pragma once

#include <fmt/format.h>

#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/quote.hpp"
#include "dlo/compare/choice.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}

namespace dlo::cli {

using compare::append;

enum class Format { text, json, csv };

}  // namespace dlo::cli

template <>
struct dlo::compare::Choices<dlo::cli::Format> {
  static constexpr Choice<cli::Format> all[] = {{cli::Format::text, "text", "for people"},
                                                {cli::Format::json, "json", "for programs"},
                                                {cli::Format::csv, "csv", "for tables"}};
};

namespace dlo::cli {

/// --format and -o, which every command has.
struct OutputOptions {
  std::string format = "text";
  std::string file;

  /// Whether it is one that every command has; `vtk`, `toml` and `markdown` are none of them.
  [[nodiscard]] bool is(Format wanted) const { return format == compare::to_string(wanted); }
};

/// A result in each of its formats, made when it is asked for.
struct Formats {
  std::function<std::string()> text, json;
  std::function<std::string()> csv = {};       ///< of a command that has it
  std::function<std::string()> toml = {};      ///< of a command that has it
  std::function<std::string()> markdown = {};  ///< of a command that has it
};

/// The format of a file's extension: "csv" of shape.csv; empty unless it is one of `formats`.
[[nodiscard]] std::string format_of_file(const std::string& file,
                                         const std::vector<std::string>& formats);

/// Writes to standard output, or to the file as compare::OutputFile does.
/// @throws compare::OutputError naming what cannot be written
void write_output(const OutputOptions& options, const std::string& content);

/// The same in the format that was asked for.
void write_output(const OutputOptions& options, const Formats& formats);

/// @throws compare::OutputError if it cannot be written, compare::BrokenPipe if nobody reads it
void write_standard_output(std::string_view text);
/// The last chance to learn that something was not written. @throws compare::OutputError
void close_standard_output();

/// A line of the program's own on standard error, behind "dlo: ". Where nothing can be written
/// there, nothing happens.
void say_line(const std::string& message);
template <typename... Arguments>
void say(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  say_line(fmt::format(format, std::forward<Arguments>(arguments)...));
}
/// A text on standard error as it is; where it cannot be written nothing happens, not even SIGPIPE.
void write_standard_error(std::string_view text);

/// While it lives, what goes to standard output and standard error is appended to two texts, of all
/// threads: one may live at a time, or one within another. Nothing is a terminal then.
class RedirectedOutput {
 public:
  /// @param out, err  have to outlive it; nobody else touches them meanwhile
  RedirectedOutput(std::string& out, std::string& err);
  ~RedirectedOutput();
  RedirectedOutput(const RedirectedOutput&) = delete;
  RedirectedOutput& operator=(const RedirectedOutput&) = delete;

  /// The one that is in force, null if there is none.
  [[nodiscard]] static RedirectedOutput* current();

  void append_out(std::string_view text);
  void append_err(std::string_view text);

 private:
  std::string& out_;
  std::string& err_;
  std::mutex writing_;  ///< threads of a scheduler write warnings
  RedirectedOutput* before_;
};

/// Descriptors 0 to 2 that the caller has closed: nothing that is opened later may take their
/// place. Writing to a standard output that was closed stays an error.
void reserve_standard_descriptors();

/// Refuses an output before anything is computed: one that cannot be written, or that is an input.
/// @param option  that named it, for messages
/// @param inputs  files that are read
/// @throws compare::InputError
void check_output(const std::string& option, const std::string& file,
                  const std::vector<std::string>& inputs);

/// check_output() for every file that the command's options name, standard output included.
/// A folder is its command's own business.
void check_outputs(const CLI::App& command);

/// Files that the command's arguments and options name for reading.
[[nodiscard]] std::vector<std::string> input_files(const CLI::App& command);

}  // namespace dlo::cli
