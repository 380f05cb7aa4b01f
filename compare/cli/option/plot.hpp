#pragma once

#include <functional>
#include <string>
#include <vector>

#include "figure/gnuplot.hpp"
#include "figure/layout.hpp"
#include "option/command_line.hpp"
#include "report/page.hpp"

namespace dlo::cli {

/// Draws each figure of a picture for a page. If a figure cannot be drawn, its `failure` states the
/// reason.
/// @param name  prefix of the pictures' identifiers, unique in the page
[[nodiscard]] std::vector<compare::PagePicture> page_pictures(const compare::Picture& picture,
                                                              const std::string& name,
                                                              const std::string& option);

/// Option --plot FILE: a picture of the result, in addition to the result.
class PlotOptions {
 public:
  void add_to(Command& command) { command.add("--plot", file_); }

  /// Whether a picture is requested.
  [[nodiscard]] bool draws() const { return !file_.empty(); }

  /// Checks that the file name extension is a supported format and that gnuplot is installed,
  /// before anything is computed. @throws compare::InputError
  void require_drawable() const;

  /// Draws into the file, which is replaced once the picture is complete. Does nothing if no
  /// picture is requested. @throws compare::OutputError
  void draw(const std::function<compare::Picture()>& picture) const;

 private:
  std::string file_;
};

}  // namespace dlo::cli
