#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "figure/gnuplot.hpp"
#include "figure/layout.hpp"
#include "report/page.hpp"

namespace dlo::cli {

/// A picture drawn by gnuplot, as the bytes of its file.
/// @throws compare::OutputError, which says `option`
[[nodiscard]] std::string drawn_picture(const compare::Picture& picture,
                                        compare::PictureFormat format, const std::string& option);

/// Draws each figure of a picture for a page; one that cannot be drawn has the reason.
/// @param name  begins the pictures' identifiers, unique in the page
[[nodiscard]] std::vector<compare::PagePicture> page_pictures(const compare::Picture& picture,
                                                              const std::string& name,
                                                              const std::string& option);

/// --plot FILE: a picture of the result, beside the result itself.
class PlotOptions {
 public:
  /// @param what  is drawn, for the help
  /// @return the option
  CLI::Option* add_to(CLI::App& command, const std::string& what);

  /// Whether a file is asked for.
  [[nodiscard]] bool draws() const { return !file_.empty(); }

  /// Checks before anything is computed that the ending is one that can be drawn, and that gnuplot
  /// is installed. @throws compare::InputError
  void require_drawable() const;

  /// Draws into the file, which is replaced when the picture is whole; nothing if none is asked
  /// for. @throws compare::OutputError
  void draw(const std::function<compare::Picture()>& picture) const;

 private:
  std::string file_;
};

}  // namespace dlo::cli
