#pragma once

#include <stdexcept>
#include <string>

namespace dlo::compare {

/// Bad input by the user: a file, a key, a value. The message is one line that names all of them
/// and what is allowed.
class InputError : public std::runtime_error {
 public:
  /// @param message  a piece of the input that it quotes may hold control characters; each becomes
  /// a "?", so that a malformed file neither breaks the line nor steers a terminal
  explicit InputError(const std::string& message);
};

/// A solver did not converge; the message says which one and why.
class ConvergenceError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace dlo::compare
