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
  std::string csv_file;
  std::string csv;     ///< what is in it; empty if another figure has the same file
  std::string script;  ///< for gnuplot, run in the report's folder
};

/// A text as a gnuplot string that nothing in it can end or run.
[[nodiscard]] std::string gnuplot_string(const std::string& text);

/// First lines of a script: an SVG of this size [pixels] with room for `key_rows` lines of key
/// below the plot. Text is big enough to read on a page of 375 pixels.
[[nodiscard]] std::string figure_head(const std::string& name, const std::string& csv_file,
                                      int width, int height, int key_rows);

/// Height of a canvas besides its plot [pixels]: top, axis text and key.
[[nodiscard]] int height_besides_plot(int key_rows);

/// Version of the gnuplot that would draw, as it says it; empty if there is none.
[[nodiscard]] std::string gnuplot_version();

/// Draws NAME.svg in the folder, where its CSV file and NAME.gp are.
/// @return why not, in one line; empty if it is drawn
[[nodiscard]] std::string draw(const Figure& figure, const std::filesystem::path& folder);

/// An SVG file as an element of a page: without prolog, with the figure's title and description,
/// identifiers beginning with its name.
/// @throws std::invalid_argument if there is no svg element
[[nodiscard]] std::string inline_svg(const std::string& svg, const Figure& figure);

}  // namespace dlo::compare
