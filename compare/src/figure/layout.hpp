#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dlo::compare {

/// What a point of a curve looks like.
enum class Mark { none, cross, open_square, square, circle, dot, triangle, down_triangle, diamond };

/// How a line is broken.
enum class Dashes { solid, dashed, dotted, dash_dotted, dash_dot_dotted };

/// How a curve is drawn.
struct Look {
  std::string colour = "#000000";  ///< "#RRGGBB"
  double width = 1;                ///< of its line; 0: none
  Dashes dashes = Dashes::solid;
  Mark mark = Mark::none;
  double mark_size = 1;
  std::string fill;  ///< colour of what the line surrounds; empty: nothing
};

/// How many colours curves have.
inline constexpr std::size_t curve_colours = 6;

/// The look of the i-th curve, line and marks, in a colour that colour-blind readers tell apart,
/// with dashes and marks of its own; they come again.
[[nodiscard]] Look curve_look(std::size_t i);
/// The same without marks.
[[nodiscard]] Look curve_line(std::size_t i);
/// The same without a line.
[[nodiscard]] Look curve_marks(std::size_t i);

/// What is drawn in one look. Coordinates that are infinite are at the plot's edge; at NaN a line
/// ends, and the next begins after it.
struct PlottedCurve {
  std::string id;     ///< its name in the script
  std::string title;  ///< in the legend; empty: not there
  Look look;
  std::vector<double> x, y;
  std::vector<double> z;  ///< in a plot in space
};

/// Words in a plot.
struct Text {
  double x, y;
  std::string words;
  double dx = 0, dy = 0;  ///< of their left end's middle, from there [pixels]
};

/// Values on a grid, as colours from light to dark: rectangles that meet.
struct Cells {
  std::vector<double> x, y;    ///< their edges, rising
  std::vector<double> values;  ///< row by row from the lowest; NaN: none

  /// Least and largest value.
  [[nodiscard]] std::pair<double, double> range() const;
};

/// The colours of cells, from the least value to the largest.
inline constexpr const char* cell_colours[] = {"#F2F0E6", "#5B9BC8", "#0B2D5B"};

/// A number or word at an axis.
struct Tic {
  double at;
  std::string label;
};

/// An axis of a plot.
struct PlotAxis {
  std::string label;
  std::optional<double> from, to;  ///< none: what is drawn needs it
  bool logarithmic = false;
  std::optional<std::vector<Tic>> tics;  ///< none: those that the plotting program chooses
};

/// A plot of a figure. gnuplot or matplotlib places its tics, and its legend below it.
struct Panel {
  int height = 330;  ///< of the plot itself [pixels]
  PlotAxis x, y;
  std::optional<PlotAxis> z;  ///< of a plot in space
  int upright = 2;            ///< the axis that is upright in space
  std::vector<PlottedCurve> curves;
  std::vector<Text> texts;
  std::optional<Cells> cells;
  bool equal_aspect = false;  ///< as many pixels a metre on all axes
  bool has_legend = true;     ///< or its curves' titles are in another one's

  /// Whether the legend shows a curve.
  [[nodiscard]] bool shows_title(const PlottedCurve& curve) const {
    return has_legend && !curve.title.empty();
  }
  /// Height of the plot with its axes and legend [pixels].
  [[nodiscard]] int full_height() const;
};

/// Returns a panel as it is drawn: with limits, without infinite coordinates and curves of nothing.
[[nodiscard]] Panel laid_out(Panel panel);

/// A figure: plots below each other.
struct Figure {
  std::string title;  ///< one line
  std::vector<Panel> panels;
};

/// Figures beside each other, each column with figures below each other.
using PictureRow = std::vector<std::vector<Figure>>;

/// Rows of figures below each other, for one file.
struct Picture {
  std::vector<PictureRow> rows;
};

/// Width of every figure [pixels], small enough for its text to be read on a page of 375.
inline constexpr int figure_width = 460;
/// Width of a plot in its figure, about [pixels].
inline constexpr int plot_width = 358;

}  // namespace dlo::compare
