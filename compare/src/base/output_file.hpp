#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

namespace dlo::compare {

/// An output could not be written, for example to a full disk or a closed standard output. The
/// message names it.
class OutputError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The reader of a pipe has closed it. Programs end without a message then.
class BrokenPipe : public OutputError {
  using OutputError::OutputError;
};

/// Target of an output's name.
struct OutputTarget {
  /// How the target is written.
  enum class Kind {
    file,    ///< a regular file, or a name that is free: replaced at once when it is whole
    device,  ///< a device or a pipe: written in place; a socket, which cannot be opened
    /// A descriptor of this process, as /dev/stdout is: written at its current position.
    descriptor,
  };
  Kind kind = Kind::file;  ///< how it is written
  std::string path;        ///< path with links resolved, for Kind::descriptor not necessarily all
  int descriptor = -1;     ///< number of the descriptor, for Kind::descriptor
};

/// Resolves the links of an output's name. A file to which standard output or standard error is
/// already redirected is that descriptor.
/// @param file  as the user wrote it
/// @throws InputError that names it and the reason, such as an empty name, a folder, a folder that
/// does not exist or is not writable, a link to itself, a file that is not writable, a descriptor
/// that is not open for writing
[[nodiscard]] OutputTarget output_target(const std::string& file);

/// Whether two names refer to the same file, by links of either kind or by spelling. A file that
/// does not exist equals no other.
[[nodiscard]] bool same_file(const std::string& a, const std::string& b);

/// Whether an output may replace a file that the command has read.
enum class Replaces {
  no_input,    ///< no
  own_format,  ///< yes, because dlo has read its own earlier output to write it again
};

/// An output that is being written. A regular file is written under a temporary name next to its
/// target and is renamed when finish() returns, after it is on the disk: no reader ever sees an
/// incomplete file, and without finish() the target is unchanged. Symbolic links are kept, hard
/// links are not. A replaced file keeps its permissions, and its owner if this user may set it.
class OutputFile {
 public:
  /// @throws InputError as output_target(), or if the command has read the file (InputsKept);
  /// @throws OutputError if it cannot be opened
  explicit OutputFile(const std::string& file, Replaces replaces = Replaces::no_input);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Appends a text. @throws OutputError that names the output, BrokenPipe if it is a pipe without
  /// a reader
  void append(std::string_view text);
  /// Completes the output. @throws OutputError that names the output, InputError if the command has
  /// read the file in the meantime
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Writes a text to an output. @throws InputError, OutputError as OutputFile does
void write_file(const std::string& file, std::string_view text,
                Replaces replaces = Replaces::no_input);

/// Writes a whole text to a descriptor, in as many calls as needed.
/// @param name  of the output, for messages
/// @throws OutputError that names the output, BrokenPipe if it is a pipe without a reader
void write_all(int descriptor, std::string_view text, const std::string& name);

}  // namespace dlo::compare
