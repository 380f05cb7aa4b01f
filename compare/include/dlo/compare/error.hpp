#pragma once

#include <stdexcept>
#include <string>

namespace dlo::compare {

/// Base class of the errors that leave no result: InputError and ConvergenceError. The message is
/// one line.
class ResultError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Invalid input by the user: a file, a key, a value. The message is one line. It names those of
/// them that are concerned, and what is allowed.
class InputError : public ResultError {
 public:
  /// @param message  quoted input may contain control characters; each becomes a "?", so that a
  /// malformed file neither breaks the line nor controls a terminal. Of a message above 4096 bytes
  /// the middle is omitted.
  explicit InputError(const std::string& message);

  /// Constructs the error of a key in a file: the message is "where: key" and the problem.
  /// @param key  full name, such as rod.length
  /// @param problem  text after the key: ": missing ..." or " = 3 mm: out of range ..."
  InputError(const std::string& where, const std::string& key, const std::string& problem);

  /// Returns the invalid key; empty if the error is not about a key of a file.
  [[nodiscard]] const std::string& key() const { return key_; }
  /// Returns the text after the key in the message.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  std::string key_;
  std::string problem_;
};

/// A solver did not converge; the message names the solver and the reason.
class ConvergenceError : public ResultError {
  using ResultError::ResultError;
};

}  // namespace dlo::compare
