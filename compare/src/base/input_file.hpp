#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "base/output_file.hpp"

namespace dlo::compare {

/// A file that is read from beginning to end. Only the end of the file ends the reading: any other
/// interruption is an error with the system's reason, and so is a file that is larger than its
/// reader can use. Pipes and devices are read like files.
class InputFile {
 public:
  /// Largest file that is read [bytes]. Scenes, shapes and baselines of users are far smaller.
  static constexpr std::size_t largest_file = std::size_t{1} << 26;

  /// @throws InputError that names the file and the reason if it cannot be opened or is an output
  /// of the command
  explicit InputFile(std::string path);
  /// Takes over an open file. @param name  for messages
  InputFile(int descriptor, std::string name);
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  ~InputFile();

  /// Appends the next bytes, at most `most`, to `text`. Returns false at the end of the file.
  /// @throws InputError that names the file, the reason and the position if it cannot be read
  bool read_block(std::string& text, std::size_t most);

  /// Returns the rest of the file. @throws InputError as read_block, or if it is more than
  /// `largest` bytes
  [[nodiscard]] std::string read_all(std::size_t largest = largest_file);

 private:
  std::string name_;
  int descriptor_ = -1;
  std::size_t bytes_ = 0;  // read so far
};

/// Guard of the input files of a command. While a guard exists, files that were read are not
/// written (OutputFile), and output files that are declared are not read. Only regular files are
/// guarded. A command creates it, because a library cannot know which files are inputs.
class InputsKept {
 public:
  InputsKept();
  ~InputsKept();
  InputsKept(const InputsKept&) = delete;
  InputsKept& operator=(const InputsKept&) = delete;
};

/// Whether an input is written if a command writes an output.
using IsWritten = bool (*)(const std::string& input, const std::string& output);

/// Declares a file that will be written, so that reading it fails before anything is computed. Has
/// no effect unless InputsKept exists.
/// @param name  beginning of the message, such as "--output shape.csv"
void declare_output(const std::string& file, const std::string& name,
                    IsWritten is_written = same_file);

/// Checks that a file may be written.
/// @throws InputError that begins with `name` if InputsKept exists and the file was read
void require_not_read(const std::string& file, const std::string& name);

/// Returns the content of a file. @throws InputError as InputFile and read_all()
[[nodiscard]] std::string read_file(const std::string& path);

/// Returns the content of a file of unknown origin: only a regular file is read, also through a
/// link, so that reading never blocks. InputsKept does not guard it. @param name  for messages
/// @throws InputError if it is not a regular file, cannot be read or is larger than largest_file
[[nodiscard]] std::string read_regular_file(const std::string& path, const std::string& name);

/// Returns a text without the byte order mark with which some programs begin UTF-8.
[[nodiscard]] std::string_view after_byte_order_mark(std::string_view text);

}  // namespace dlo::compare
