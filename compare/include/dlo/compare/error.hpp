#pragma once

#include <stdexcept>
#include <string>

namespace dlo::compare {

/// There is no result: an InputError or a ConvergenceError. The message is one line.
class ResultError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Bad input by the user: a file, a key, a value. The message is one line that names all of them
/// and what is allowed.
class InputError : public ResultError {
 public:
  /// @param message  a piece of the input that it quotes may hold control characters; each becomes
  /// a "?", so that a malformed file neither breaks the line nor steers a terminal
  explicit InputError(const std::string& message);

  /// Of a key in a file: the message is "where: key" and the problem.
  /// @param key  its full name, such as rod.length
  /// @param problem  what follows the key: ": missing ..." or " = 3 mm: out of range ..."
  InputError(const std::string& where, const std::string& key, const std::string& problem);

  /// The key at fault; empty where it is none of a file's.
  [[nodiscard]] const std::string& key() const { return key_; }
  /// What follows the key in the message.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  std::string key_;
  std::string problem_;
};

/// A solver did not converge; the message says which one and why.
class ConvergenceError : public ResultError {
  using ResultError::ResultError;
};

}  // namespace dlo::compare
