#include "option/output.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "base/input_file.hpp"
#include "base/output_file.hpp"
#include "base/text.hpp"
#include "dlo/compare/error.hpp"
#include "format/json.hpp"
#include "option/command_line.hpp"
#include "trajectory/trajectory_files.hpp"

namespace dlo::cli {
namespace {

constexpr const char* standard_output = "standard output";

// One for the process, as its descriptors are.
std::atomic<RedirectedOutput*> redirected = nullptr;

bool has_long_name(const CLI::Option& option, std::initializer_list<std::string> names) {
  const std::vector<std::string>& long_names = option.get_lnames();
  return std::any_of(names.begin(), names.end(), [&long_names](const std::string& name) {
    return std::find(long_names.begin(), long_names.end(), name) != long_names.end();
  });
}

/// Whether the option names an output file or folder, whatever its value.
bool is_written_file(const CLI::Option& option) {
  return has_long_name(option,
                       {"output", "junit", "paraview", "plot", "report", "markdown", "write"});
}

bool is_written(const CLI::App& command, const CLI::Option& option) {
  if (is_written_file(option)) return true;
  return has_long_name(option, {"baseline"}) &&
         command.get_option_no_throw("--update") != nullptr && command.count("--update") > 0;
}

void require_distinct_outputs(const std::string& option, const std::string& file,
                              const std::vector<std::string>& others) {
  for (const std::string& other : others) {
    // Files that do not exist yet are compared by the targets of their names.
    const bool same = compare::same_file(file, other) ||
                      compare::output_target(file).path == compare::output_target(other).path;
    if (!same) continue;
    throw compare::InputError(fmt::format("{} {}: is written twice{} (allowed: another file)",
                                          option, file,
                                          file == other ? "" : fmt::format(", as {}", other)));
  }
}

/// Refuses outputs that might be frames of a series. The number of frames, and so the names of all
/// its files, is unknown before the computation.
void require_no_frame_of_series(const std::string& series,
                                const std::vector<std::string>& outputs) {
  for (const std::string& file : outputs) {
    if (!compare::is_frame_of_series(file, series)) continue;
    throw compare::InputError(fmt::format(
        "--paraview {}: writes frames {}, and {} is written too (allowed: another file)", series,
        compare::frame_names(series), file));
  }
}

}  // namespace

void exit_with_status(ExitStatus status) { throw CLI::RuntimeError(static_cast<int>(status)); }

void OutputOptions::add_to(Command& command) {
  command.bind("--format", format, "--output", file);
  CLI::App& app = command.app();
  app.parse_complete_callback([this, &app, formats = command.choices("--format")] {
    format_is_given = app.count("--format") > 0;
    const std::string extension = std::filesystem::path(file).extension().string();
    for (const std::string& known : formats) {
      if (format_is_given || extension != "." + known) continue;
      format = known;
      app.get_option("--format")->default_str(format);
    }
  });
}

void write_output(const OutputOptions& options, const std::string& content) {
  if (options.file.empty()) return write_standard_output(content);
  compare::write_file(options.file, content);
}

void write_output(const OutputOptions& options, const Formats& formats) {
  write_output(options, formats.at(options.format)());
}

Formats formats_of(const compare::Document& document, Formats more) {
  more.emplace("text", [&] { return document.text(); });
  more.emplace("json", [&] { return json_text(document.json); });
  more.emplace("csv", [&] { return document.csv(); });
  return more;
}

void write_output(const OutputOptions& options, const compare::Document& document, Formats more) {
  write_output(options, formats_of(document, std::move(more)));
}

RedirectedOutput::RedirectedOutput(std::string& out, std::string& err)
    : out_(out), err_(err), before_(redirected.exchange(this)) {}

RedirectedOutput::~RedirectedOutput() { redirected = before_; }

RedirectedOutput* RedirectedOutput::current() { return redirected; }

void RedirectedOutput::append_out(std::string_view text) {
  const std::scoped_lock lock(writing_);
  out_.append(text);
}

void RedirectedOutput::append_err(std::string_view text) {
  const std::scoped_lock lock(writing_);
  err_.append(text);
}

void write_standard_output(std::string_view text) {
  if (RedirectedOutput* texts = RedirectedOutput::current()) return texts->append_out(text);
  compare::write_all(STDOUT_FILENO, text, standard_output);
}

void close_standard_output() {
  // A standard output that was closed from the beginning is an error only if something was written.
  if (::close(STDOUT_FILENO) == 0 || errno == EBADF || errno == EINTR) return;
  throw compare::OutputError(
      fmt::format("{}: cannot be written ({})", standard_output, std::strerror(errno)));
}

void write_standard_error(std::string_view text) {
  if (RedirectedOutput* texts = RedirectedOutput::current()) return texts->append_err(text);
  try {
    compare::write_all(STDERR_FILENO, text, "standard error");
  } catch (const compare::OutputError&) {
    // There is no other place to report this error, and the result is not affected.
    return;
  }
}

void print_message_line(const std::string& message) {
  write_standard_error("dlo: " + compare::display(message) + "\n");
}

void reserve_standard_descriptors() {
  for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor) {
    if (::fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
    // The descriptor has the lowest free number. Standard output is opened for reading only, so
    // that writing to it fails.
    const int mode = descriptor == STDOUT_FILENO ? O_RDONLY : O_RDWR;
    if (::open("/dev/null", mode) != descriptor) return;  // without /dev there is no more to do
  }
}

void check_output(const std::string& option, const std::string& file) {
  if (file.empty()) {
    throw compare::InputError(fmt::format("{} \"\": empty (allowed: the name of a file)", option));
  }
  try {
    (void)compare::output_target(file);
  } catch (const compare::InputError& error) {
    throw compare::InputError(fmt::format("{} {}", option, error.what()));
  }
}

void check_outputs(const CLI::App& command) {
  std::vector<std::string> outputs;
  std::vector<std::string> series;
  std::error_code unknown;
  for (const CLI::Option* option : command.get_options()) {
    if (!is_written(command, *option)) continue;
    const std::string name = "--" + option->get_lnames().front();
    for (const std::string& file : option->results()) {
      const bool folder = option->get_type_name() == "DIR";
      if (file.empty() && folder) {
        throw compare::InputError(
            fmt::format("{} \"\": empty (allowed: the name of a folder)", name));
      }
      if (folder) continue;
      check_output(name, file);
      if (std::filesystem::is_regular_file(file, unknown) ||
          !std::filesystem::exists(file, unknown)) {
        require_distinct_outputs(name, file, outputs);
      }
      outputs.push_back(file);
      // --update rewrites the baseline that it has read.
      if (is_written_file(*option)) compare::declare_output(file, name + " " + file);
      if (has_long_name(*option, {"paraview"})) series.push_back(file);
    }
  }
  for (const std::string& file : series) {
    require_no_frame_of_series(file, outputs);
    compare::declare_output(
        file,
        fmt::format("--paraview {}, which writes frames {}", file, compare::frame_names(file)),
        compare::is_frame_of_series);
  }
  // If a shell appends to an input by ">>", the command would write to the file that it reads.
  if (RedirectedOutput::current() == nullptr) {
    compare::declare_output("/dev/fd/1", standard_output);
  }
}

}  // namespace dlo::cli
