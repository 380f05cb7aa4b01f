#include "option/output.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <filesystem>

#include "base/input_file.hpp"
#include "base/output_file.hpp"
#include "base/text.hpp"
#include "dlo/compare/error.hpp"
#include "format/json.hpp"
#include "option/command_line.hpp"
#include "reading/scene_template.hpp"
#include "trajectory/trajectory_files.hpp"

namespace dlo::cli {
namespace {

constexpr const char* standard_output = "standard output";

// One for the process, as its descriptors are.
std::atomic<RedirectedOutput*> redirected = nullptr;

/// During its lifetime, writing to a pipe that nobody reads does not end the process.
class WithoutBrokenPipes {
 public:
  WithoutBrokenPipes() {
    ::sigemptyset(&pipe_);
    ::sigaddset(&pipe_, SIGPIPE);
    sigset_t pending{};
    ::sigpending(&pending);
    was_pending_ = ::sigismember(&pending, SIGPIPE) == 1;
    ::pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~WithoutBrokenPipes() {
    constexpr timespec now{};
    while (!was_pending_ && ::sigtimedwait(&pipe_, nullptr, &now) < 0 && errno == EINTR) continue;
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  WithoutBrokenPipes(const WithoutBrokenPipes&) = delete;
  WithoutBrokenPipes& operator=(const WithoutBrokenPipes&) = delete;

 private:
  sigset_t pipe_{};
  sigset_t before_{};
  bool was_pending_ = false;
};

bool has_long_name(const CLI::Option& option, std::initializer_list<std::string> names) {
  const std::vector<std::string>& own = option.get_lnames();
  return std::any_of(names.begin(), names.end(), [&own](const std::string& name) {
    return std::find(own.begin(), own.end(), name) != own.end();
  });
}

/// Whether the option names an output file or folder, whatever its value.
bool is_written_file(const CLI::Option& option) {
  return has_long_name(option,
                       {"output", "junit", "paraview", "plot", "report", "markdown", "write"});
}

/// Whether the option names input files, according to its help.
bool is_read(const CLI::Option& option) {
  if (is_written_file(option)) return false;
  const auto names_files = [](const std::string& word) {
    return word.starts_with("SCENE") || word.starts_with("FILE");
  };
  return names_files(option.get_type_name()) || names_files(names_of(option).front());
}

/// Returns the input files, except those of one option.
std::vector<std::string> input_files_but(const CLI::App& command, const CLI::Option* omitted) {
  std::vector<std::string> files;
  for (const CLI::Option* option : command.get_options()) {
    if (option == omitted || !is_read(*option)) continue;
    for (const std::string& word : option->results()) {
      files.push_back(word);
      for (std::string& beside : compare::trajectory_files(word)) files.push_back(beside);
    }
  }
  return files;
}

bool is_written(const CLI::App& command, const CLI::Option& option) {
  if (is_written_file(option)) return true;
  return has_long_name(option, {"baseline"}) &&
         command.get_option_no_throw("--update") != nullptr && command.count("--update") > 0;
}

void refuse_two_outputs(const std::string& option, const std::string& file,
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

/// Refuses files that might be frames of a series. The number of frames, and so the names of all
/// its files, is unknown before the computation.
void refuse_among_frames(const std::string& series, const std::vector<std::string>& inputs,
                         const std::vector<std::string>& outputs) {
  for (const std::vector<std::string>* files : {&inputs, &outputs}) {
    for (const std::string& file : *files) {
      if (!compare::is_frame_of_series(file, series)) continue;
      throw compare::InputError(fmt::format(
          "--paraview {}: writes frames {}, and {} is {} too (allowed: another file)", series,
          compare::frame_names(series), file, files == &inputs ? "read" : "written"));
    }
  }
}

}  // namespace

void end_with(ExitStatus status) { throw CLI::RuntimeError(static_cast<int>(status)); }

std::string format_of_file(const std::string& file, const std::vector<std::string>& formats) {
  const std::string extension = std::filesystem::path(file).extension().string();
  for (const std::string& format : formats) {
    if (extension == "." + format) return format;
  }
  return {};
}

void write_output(const OutputOptions& options, const std::string& content) {
  if (options.file.empty()) return write_standard_output(content);
  compare::write_file(options.file, content);
}

void write_output(const OutputOptions& options, const Formats& formats) {
  write_output(options, formats.at(options.format)());
}

void write_output(const OutputOptions& options, const compare::Document& document,
                  const std::function<std::string()>& csv) {
  write_output(options, Formats{{"text", [&] { return document.text(); }},
                                {"json", [&] { return json_text(document.json); }},
                                {"csv", [&] { return csv ? csv() : document.csv(); }}});
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
  const WithoutBrokenPipes quietly;
  try {
    compare::write_all(STDERR_FILENO, text, "standard error");
  } catch (const compare::OutputError&) {
    // There is no other place to report this error, and the result is not affected.
    return;
  }
}

void say_line(const std::string& message) {
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

void check_output(const std::string& option, const std::string& file,
                  const std::vector<std::string>& inputs) {
  if (file.empty()) {
    throw compare::InputError(fmt::format("{} \"\": empty (allowed: the name of a file)", option));
  }
  for (const std::string& input : inputs) {
    std::error_code unknown;
    if (!compare::same_file(file, input)) continue;
    if (!std::filesystem::is_regular_file(input, unknown)) continue;  // such as /dev/stdin
    throw compare::InputError(fmt::format("{} {}: is read too{} (allowed: another file)", option,
                                          file,
                                          input == file ? "" : fmt::format(", as {}", input)));
  }
  try {
    (void)compare::output_target(file);
  } catch (const compare::InputError& error) {
    throw compare::InputError(fmt::format("{} {}", option, error.what()));
  }
}

void check_outputs(const CLI::App& command) {
  const std::vector<std::string> inputs = input_files_but(command, nullptr);
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
      // --update rewrites the baseline that it has read.
      check_output(name, file, input_files_but(command, option));
      if (std::filesystem::is_regular_file(file, unknown) ||
          !std::filesystem::exists(file, unknown)) {
        refuse_two_outputs(name, file, outputs);
      }
      outputs.push_back(file);
      if (is_written_file(*option)) compare::declare_output(file, name + " " + file);
      if (has_long_name(*option, {"paraview"})) series.push_back(file);
    }
  }
  for (const std::string& file : series) refuse_among_frames(file, inputs, outputs);
  if (RedirectedOutput::current() != nullptr) return;
  compare::declare_output("/dev/fd/1", standard_output);
  // If a shell appends to an input by ">>", the command would write to the file that it reads.
  for (const std::string& input : inputs) {
    struct stat open {};
    struct stat read {};
    if (::fstat(STDOUT_FILENO, &open) != 0 || ::stat(input.c_str(), &read) != 0) continue;
    if (!S_ISREG(open.st_mode) || open.st_dev != read.st_dev || open.st_ino != read.st_ino) {
      continue;
    }
    throw compare::InputError(fmt::format("{}: is {}, which is read too (allowed: another file)",
                                          standard_output, input));
  }
}

}  // namespace dlo::cli
