#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace dlo::compare {

/// A plot of a figure.
struct Panel {
  int height = 330;     ///< of the plot itself [pixels]
  std::string x_label;  ///< name of the horizontal axis
  std::string y_label;  ///< name of the upright one
  int key_rows = 0;     ///< lines of key below
  std::string script;   ///< ranges, tics and the plot command, for gnuplot
};

/// A figure that gnuplot draws from a CSV file: plots below each other.
struct Figure {
  std::string name;         ///< stem of its files
  std::string section;      ///< of the page
  std::string title;        ///< one line
  std::string description;  ///< what it shows, for those who do not see it
  std::string command;      ///< of a shell in the report's folder, gives the numbers
  std::string given;        ///< which of the numbers, if not all
  std::string csv_file;
  std::string csv;  ///< what is in it; empty if another figure has the same file
  std::vector<Panel> panels;
};

/// Figures beside each other, each column with figures below each other.
using PictureRow = std::vector<std::vector<Figure>>;

/// Rows of figures below each other, for one file.
struct Picture {
  std::vector<PictureRow> rows;
};

/// The endings of files that a picture can be drawn into.
enum class PictureFormat { svg, png, pdf };

/// Of every figure [pixels], small enough for its text to be read on a page of 375.
inline constexpr int figure_width = 460;
/// Of a plot in its figure [pixels].
inline constexpr int plot_width = 358;

/// A text as a gnuplot string that nothing in it can end or run.
[[nodiscard]] std::string gnuplot_string(const std::string& text);

/// How the i-th curve is drawn "with lines", "points" or "linespoints": in a colour that
/// colour-blind readers tell apart, with dashes and points of its own.
[[nodiscard]] std::string curve_style(std::size_t i, const char* with);

/// How many colours curves have.
inline constexpr std::size_t curve_colours = 6;

/// The colour of the i-th curve, as "#RRGGBB"; they come again.
[[nodiscard]] const char* curve_colour(std::size_t i);

/// The script that draws NAME.svg, run in the folder of its CSV file.
[[nodiscard]] std::string figure_script(const Figure& figure);

/// The script that draws a picture with its figures' titles, run in the folder of their CSV files.
[[nodiscard]] std::string picture_script(const Picture& picture, PictureFormat format,
                                         const std::string& output);

}  // namespace dlo::compare
