#pragma once

#include <fmt/format.h>

#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/quote.hpp"
#include "record/csv_table.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}

namespace dlo::cli {

using compare::append;

class Command;

/// Exit status of a command.
enum class ExitStatus : int {
  good = 0,
  outside_tolerance = 1,
  bad_input = 2,
  not_converged = 3,
  no_resources = 4,  ///< also for internal errors
  not_written = 5,
};

/// Ends a command that has printed its result.
[[noreturn]] void exit_with_status(ExitStatus status);

/// Options --format and -o.
struct OutputOptions {
  std::string format = "text";
  std::string file;
  bool format_is_given = false;  ///< whether --format is given

  /// Adds the options. The format is that of the file's extension unless --format is given.
  void add_to(Command& command);
};

/// Functions that return a result, by the names of its formats.
using Formats = std::map<std::string, std::function<std::string()>>;

/// Writes to standard output, or to a file as compare::OutputFile does.
/// @throws compare::OutputError naming the output that cannot be written
void write_output(const OutputOptions& options, const std::string& content);

/// Returns the formats of a document: text, json, csv. The functions refer to the document.
/// @param more  other formats, or in their place
[[nodiscard]] Formats formats_of(const compare::Document& document, Formats more = {});

/// Writes a result in the requested format.
void write_output(const OutputOptions& options, const Formats& formats);
void write_output(const OutputOptions& options, const compare::Document& document,
                  Formats more = {});

/// Writes to standard output. @throws compare::OutputError if it cannot be written,
/// compare::BrokenPipe if nobody reads it
void write_standard_output(std::string_view text);
/// Closes standard output, which reports delayed write errors. @throws compare::OutputError
void close_standard_output();

/// Writes a line to standard error, after "dlo: ". Errors of this write are ignored.
void print_message_line(const std::string& message);
template <typename... Arguments>
void print_message(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  print_message_line(fmt::format(format, std::forward<Arguments>(arguments)...));
}
/// Writes a text to standard error unchanged. Errors of this write are ignored.
void write_standard_error(std::string_view text);

/// During its lifetime, output of all threads to standard output and standard error is appended to
/// two texts, and neither counts as a terminal. Only one object may exist at a time, or one nested
/// in another.
class RedirectedOutput {
 public:
  /// @param out, err  must outlive the object, and must not be used by others meanwhile
  RedirectedOutput(std::string& out, std::string& err);
  ~RedirectedOutput();
  RedirectedOutput(const RedirectedOutput&) = delete;
  RedirectedOutput& operator=(const RedirectedOutput&) = delete;

  /// Returns the innermost object, or null if there is none.
  [[nodiscard]] static RedirectedOutput* current();

  void append_out(std::string_view text);
  void append_err(std::string_view text);

 private:
  std::string& out_;
  std::string& err_;
  std::mutex writing_;  ///< threads of a scheduler may write warnings
  RedirectedOutput* before_;
};

/// Opens descriptors 0 to 2 if the caller has closed them, so that no file opened later gets their
/// numbers. Writing to a standard output that was closed remains an error.
void reserve_standard_descriptors();

/// Refuses an output that cannot be written, before anything is computed.
/// @param option  name of the option, for messages
/// @throws compare::InputError
void check_output(const std::string& option, const std::string& file);

/// Checks all files that the command's options write, as check_output() does; refuses files that
/// are written twice. Declares them and standard output, so that none of them is read. Commands
/// check folders themselves. @throws compare::InputError
void check_outputs(const CLI::App& command);

}  // namespace dlo::cli
