#pragma once

#include <cstdint>
#include <string>

namespace dlo::cli {

/// A bar on standard error while something long runs: only on a terminal that is not "dumb", and
/// gone when it ends. Its calls are those of compare::Progress.
class ProgressBar {
 public:
  explicit ProgressBar(std::string what);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(std::int64_t done, std::int64_t total);
  /// Where no share is known: what is being done.
  void stage(const std::string& text);

 private:
  void draw(const std::string& line);

  std::string what_;
  bool visible_;
  std::string drawn_;
};

/// What takes long, with a bar. @param run  is given what to call with (done, total)
template <typename Run>
auto with_progress(const std::string& what, const Run& run) {
  ProgressBar bar(what);
  return run([&bar](std::int64_t done, std::int64_t total) { bar.show(done, total); });
}

/// A word of a verdict in green or red, if the results go to a terminal that shows colours: not
/// with NO_COLOR, not "dumb", not into a file. @param file  of -o, empty for standard output
[[nodiscard]] std::string verdict_word(const std::string& word, bool good, const std::string& file);

}  // namespace dlo::cli
