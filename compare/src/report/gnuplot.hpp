#pragma once

#include <filesystem>
#include <string>

namespace dlo::compare {

/// A figure that gnuplot draws from a CSV file, both kept beside it.
struct Figure {
  std::string name;         ///< stem of NAME.gp and NAME.svg
  std::string section;      ///< of the page
  std::string title;        ///< one line
  std::string description;  ///< what it shows, for those who do not see it
  std::string command;      ///< of a shell in the report's folder, gives the numbers
  std::string given;        ///< which of the numbers, if not all
  std::string csv_file;
  std::string csv;     ///< what is in it; empty if another figure has the same file
  std::string script;  ///< for gnuplot, run in the report's folder
};

/// A text as a gnuplot string that nothing in it can end or run.
[[nodiscard]] std::string gnuplot_string(const std::string& text);

/// All figures have this width [pixels], small enough for their text to be read on a page of 375.
inline constexpr int figure_width = 460;
/// Margins of a plot in its figure [pixels].
inline constexpr int left_margin = 76;
inline constexpr int right_margin = 26;
inline constexpr int top_margin = 38;

/// First lines of a script: an SVG of this height [pixels] with room for `key_rows` lines of key
/// below the plot.
[[nodiscard]] std::string figure_head(const std::string& name, const std::string& csv_file,
                                      int height, int key_rows);

/// Names of the axes; the upright one's stands level above it, where no number is in its way.
/// @param top  of the plot, from the figure's top [pixels]
[[nodiscard]] std::string axis_labels(const std::string& x, const std::string& y, int height,
                                      double top);

/// Height of a canvas besides its plot [pixels]: top, axis text and key.
[[nodiscard]] int height_besides_plot(int key_rows);

/// Version of the gnuplot that would draw, as it says it; empty if there is none.
/// @param folder  the report's own, where nobody else has files, to run it in
[[nodiscard]] std::string gnuplot_version(const std::filesystem::path& folder);

/// Draws NAME.svg in the folder, where its CSV file and NAME.gp are.
/// @return why not, in one line; empty if it is drawn
[[nodiscard]] std::string draw(const Figure& figure, const std::filesystem::path& folder);

/// An SVG file as an element of a page: without prolog, with the figure's title and description,
/// identifiers beginning with its name.
/// @throws std::invalid_argument if there is no svg element
[[nodiscard]] std::string inline_svg(const std::string& svg, const Figure& figure);

}  // namespace dlo::compare
