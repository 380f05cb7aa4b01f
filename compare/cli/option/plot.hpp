#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "figure/gnuplot_script.hpp"
#include "figure/layout.hpp"
#include "figure/sketch.hpp"
#include "option/output.hpp"

namespace dlo::cli {

/// Whether a command also sketches in characters, with --plot -.
enum class Sketches { offered, none };

/// A picture drawn by gnuplot, as the bytes of its file.
/// @throws compare::OutputError, which says `option`
[[nodiscard]] std::string drawn_picture(const compare::Picture& picture,
                                        compare::PictureFormat format, const std::string& option);

/// --plot FILE: a picture of the result, beside the result itself.
class PlotOptions {
 public:
  /// @param what  is drawn, for the help
  /// @return the option
  CLI::Option* add_to(CLI::App& command, const std::string& what, Sketches sketches);

  /// Whether a file is asked for.
  [[nodiscard]] bool draws() const { return !file_.empty() && !sketches(); }
  /// Whether a sketch is asked for.
  [[nodiscard]] bool sketches() const { return offers_sketch_ && file_ == "-"; }

  /// Before anything is computed: the ending is one that can be drawn, and there is a gnuplot; a
  /// sketch goes with text only. @throws compare::InputError
  void require_drawable(const OutputOptions& output) const;

  /// Draws into the file, which is replaced when the picture is whole; nothing if none is asked
  /// for. @throws compare::OutputError
  void draw(const std::function<compare::Picture()>& picture) const;

  /// A sketch on standard output, as wide as the terminal; nothing if none is asked for.
  /// @param lines  of the rod and what it is compared with, in space
  void sketch(const compare::Scene& scene,
              const std::function<std::vector<compare::SpatialLine>()>& lines) const;

 private:
  std::string file_;
  bool offers_sketch_ = false;
};

}  // namespace dlo::cli
