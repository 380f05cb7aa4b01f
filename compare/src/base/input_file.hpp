#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace dlo::compare {

/// A file that is read from its beginning to its end. Nothing but the end of the file is taken for
/// it: whatever else stops the reading is an error with the system's reason, and so is a file that
/// is larger than its reader has a use for. Pipes and devices are read as they are.
class InputFile {
 public:
  /// No scene, shape or baseline of a user comes near it [bytes].
  static constexpr std::size_t largest_file = std::size_t{1} << 26;

  /// @throws InputError naming the file and why it cannot be opened
  explicit InputFile(std::string path);
  /// Takes over an open file. @param name  for messages
  InputFile(int descriptor, std::string name);
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  ~InputFile();

  /// Appends the next bytes, at most `most`, to `text`; false at the end of the file.
  /// @throws InputError naming the file, why it cannot be read, and where
  bool read_some(std::string& text, std::size_t most);

  /// All that is left. @throws InputError as read_some, or if it is more than `largest` bytes
  [[nodiscard]] std::string read_all(std::size_t largest = largest_file);

 private:
  std::string name_;
  int descriptor_ = -1;
  std::size_t bytes_ = 0;  // read so far
};

/// While one exists, no file that was read during its lifetime is replaced: output files that are
/// declared are not read, and files that were read are not written (OutputFile). Only regular files
/// count. Meant for a command, whose inputs a library cannot know.
class InputsKept {
 public:
  InputsKept();
  ~InputsKept();
  InputsKept(const InputsKept&) = delete;
  InputsKept& operator=(const InputsKept&) = delete;
};

/// Declares a file that will be written, so that reading it is an error before anything is
/// computed.
/// @param name  begin of the message, such as "--output shape.csv"
void declare_output(const std::string& file, const std::string& name);

/// @throws InputError that begins with `name` if InputsKept exists and the file was read
void require_not_read(const std::string& file, const std::string& name);

/// A whole file. @throws InputError as InputFile
[[nodiscard]] std::string read_file(const std::string& path);

/// A whole file that others have written, which may be anything: only a regular file is read, also
/// through a link; nothing is waited for. @param name  for messages @throws InputError as InputFile
[[nodiscard]] std::string read_regular_file(const std::string& path, const std::string& name);

/// A text without the mark by which some programs begin UTF-8.
[[nodiscard]] std::string_view after_byte_order_mark(std::string_view text);

}  // namespace dlo::compare
