#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

namespace dlo::compare {

/// An output could not be written: a full disk, a closed standard output. The message names it.
class OutputError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Nobody reads a pipe any more; what a program does not complain about.
class BrokenPipe : public OutputError {
  using OutputError::OutputError;
};

/// What the name of an output stands for.
struct OutputTarget {
  /// How it is written.
  enum class Kind {
    file,        ///< a regular file, or a name that is free: replaced at once when it is whole
    device,      ///< a device, a pipe or a socket: written to as it is
    descriptor,  ///< of this process, as /dev/stdout is: written to where it stands
  };
  Kind kind = Kind::file;  ///< how
  std::string path;        ///< without links where it leads
  int descriptor = -1;     ///< of Kind::descriptor
};

/// Follows links. A file that standard output or standard error goes to already is that descriptor.
/// @param file  as the user wrote it
/// @throws InputError that names it and why: nothing, a folder, in a folder that is not there or
/// may not be written, a link to itself, a file that may not be written
[[nodiscard]] OutputTarget output_target(const std::string& file);

/// Whether two names are the same file: by links of either kind, or by spelling. Files that are not
/// there are no file.
[[nodiscard]] bool same_file(const std::string& a, const std::string& b);

/// Whether an output may replace a file that the command has read.
enum class Replaces {
  no_input,    ///< it may not
  own_format,  ///< it may, because dlo has read its own earlier output to write it anew
};

/// An output that is being written. A regular file is written under a new name beside it, on the
/// disk when finish() returns, and gets its own name then: no reader ever sees half a file, and
/// without finish() nothing has happened. Links stay links. A file that is replaced keeps its
/// permissions.
class OutputFile {
 public:
  /// @throws InputError as output_target(), or if the command has read the file (InputsKept);
  /// @throws OutputError if it cannot be opened
  explicit OutputFile(const std::string& file, Replaces replaces = Replaces::no_input);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// @throws OutputError naming the output, BrokenPipe if it is a pipe that nobody reads
  void append(std::string_view text);
  /// @throws OutputError naming the output
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Writes a whole OutputFile. @throws as that does
void write_file(const std::string& file, std::string_view text,
                Replaces replaces = Replaces::no_input);

/// Writes all of a text to a descriptor, however many calls that takes.
/// @param name  of the output, for messages
/// @throws OutputError naming the output, BrokenPipe if it is a pipe that nobody reads
void write_all(int descriptor, std::string_view text, const std::string& name);

}  // namespace dlo::compare
