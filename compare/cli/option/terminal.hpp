#pragma once

#include <cstdint>
#include <string>

namespace dlo::cli {

/// Progress bar on standard error during long computations. It is shown only on a terminal that is
/// not "dumb", and erased at the end. Its calls are those of compare::Progress.
class ProgressBar {
 public:
  explicit ProgressBar(std::string what);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(std::int64_t done, std::int64_t total);
  /// Shows the current stage if no fraction is known.
  void stage(const std::string& text);

 private:
  void draw(const std::string& line);

  std::string what_;
  bool visible_;
  std::string drawn_;
};

/// Runs a long computation with a progress bar. @param run  called with a function of (done, total)
template <typename Run>
auto with_progress(const std::string& what, const Run& run) {
  ProgressBar bar(what);
  return run([&bar](std::int64_t done, std::int64_t total) { bar.show(done, total); });
}

/// Returns a word of a verdict, in green or red if results go to a terminal with colours: not with
/// NO_COLOR, "dumb" or a file. @param file  file of -o, empty for standard output
[[nodiscard]] std::string verdict_word(const std::string& word, bool good, const std::string& file);

}  // namespace dlo::cli
