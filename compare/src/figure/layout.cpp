#include "figure/layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "base/quote.hpp"

namespace dlo::compare {
namespace {

constexpr const char* zero_width_space = "\xe2\x80\x8b";

// Pixels of a plot's surroundings in its figure.
constexpr int left_margin = 76;
constexpr int top_margin = 38;
constexpr int axis_pixels = 78;  // numbers and name of the horizontal axis
constexpr int key_row_pixels = 24;
constexpr int title_line_pixels = 22;
constexpr int title_margin = 14;

/// Colours after Okabe and Ito, darker, so that they stand out inverted as well, each with its own
/// dashes and points, so that none is told by colour alone.
struct Look {
  const char* colour;
  int points;
  int dashes;
};
constexpr Look looks[curve_colours] = {{"#0059A8", 6, 1},  {"#B34700", 4, 2},  {"#00704F", 8, 3},
                                       {"#8A2F85", 12, 4}, {"#7A5600", 10, 5}, {"#404040", 2, 2}};

int height_of(const Panel& panel) {
  return top_margin + panel.height + axis_pixels + panel.key_rows * key_row_pixels;
}

int height_of(const Figure& figure) {
  int height = 0;
  for (const Panel& panel : figure.panels) height += height_of(panel);
  return height;
}

/// A title in lines that fit above a figure.
std::vector<std::string> title_lines(const std::string& title) {
  constexpr std::size_t most = 50;
  std::vector<std::string> lines = {""};
  for (std::size_t at = 0; at < title.size();) {
    const std::size_t end = std::min(title.find(' ', at), title.size());
    const std::string word = title.substr(at, end - at);
    at = end + 1;
    if (!lines.back().empty() && lines.back().size() + 1 + word.size() > most) lines.emplace_back();
    if (!lines.back().empty()) lines.back() += ' ';
    lines.back() += word;
  }
  return lines;
}

int titled_height(const Figure& figure) {
  return title_margin + title_line_pixels * static_cast<int>(title_lines(figure.title).size()) +
         height_of(figure);
}

int height_of(const std::vector<Figure>& column) {
  int height = 0;
  for (const Figure& figure : column) height += titled_height(figure);
  return height;
}

int height_of(const PictureRow& row) {
  int height = 0;
  for (const std::vector<Figure>& column : row) height = std::max(height, height_of(column));
  return height;
}

/// Places on a canvas, from its top left corner [pixels], as gnuplot counts them.
struct Canvas {
  int width = figure_width;
  int height = 0;

  [[nodiscard]] double x(double pixels) const { return pixels / width; }
  [[nodiscard]] double y(double pixels) const { return 1 - pixels / height; }
};

void add_panel(std::string& out, const Panel& panel, const Canvas& canvas, double left,
               double top) {
  constexpr double from_the_left = 8;
  constexpr double above = 20;
  const double plot_top = top + top_margin;
  const double plot_bottom = plot_top + panel.height;
  fmt::format_to(std::back_inserter(out),
                 "reset\n"
                 "set datafile separator comma\n"
                 "set grid linecolor rgb '#808080'\n"
                 "set lmargin at screen {:.6f}\n"
                 "set rmargin at screen {:.6f}\n"
                 "set tmargin at screen {:.6f}\n"
                 "set bmargin at screen {:.6f}\n",
                 canvas.x(left + left_margin), canvas.x(left + left_margin + plot_width),
                 canvas.y(plot_top), canvas.y(plot_bottom));
  if (panel.key_rows > 0) {
    fmt::format_to(std::back_inserter(out),
                   "set key at screen {:.6f},{:.6f} left top vertical maxcols 1 Left reverse "
                   "samplen 2.5\n",
                   canvas.x(left + 0.02 * figure_width), canvas.y(plot_bottom + axis_pixels));
  } else {
    out += "set key off\n";
  }
  // The upright axis's name stands level above it, where no number is in its way.
  fmt::format_to(std::back_inserter(out),
                 "set xlabel {}\nset label 1 {} at screen {:.6f},{:.6f} left\n",
                 gnuplot_string(panel.x_label), gnuplot_string(panel.y_label),
                 canvas.x(left + from_the_left), canvas.y(plot_top - above));
  out += panel.script;
}

void add_panels(std::string& out, const Figure& figure, const Canvas& canvas, double left,
                double top) {
  for (const Panel& panel : figure.panels) {
    add_panel(out, panel, canvas, left, top);
    top += height_of(panel);
  }
}

void add_title(std::string& out, const Figure& figure, const Canvas& canvas, double left,
               double top) {
  constexpr double from_the_left = 8;
  // In a multiplot a label is drawn with the plot after it.
  int number = 10;
  double base = top + title_margin;
  for (const std::string& line : title_lines(figure.title)) {
    base += title_line_pixels;
    fmt::format_to(std::back_inserter(out), "set label {} {} at screen {:.6f},{:.6f} left\n",
                   number++, gnuplot_string(line), canvas.x(left + from_the_left),
                   canvas.y(base - title_line_pixels / 2.0));
  }
}

/// The same picture in every format, as the SVG has it: in PDF a pixel is 0.75 points, and a line
/// of width 1 half a point; cairo's symbols are half as large.
std::string terminal(PictureFormat format, const Canvas& canvas) {
  switch (format) {
    case PictureFormat::svg:
      return fmt::format(
          "set terminal svg size {},{} noenhanced font 'sans-serif,16' linewidth 1.3 background "
          "'#ffffff'\n",
          canvas.width, canvas.height);
    case PictureFormat::png:  // twice as fine, for screens and print
      return fmt::format(
          "set terminal pngcairo size {},{} noenhanced font 'sans-serif,12' fontscale 2 linewidth "
          "2.6 pointscale 4 background '#ffffff'\n",
          2 * canvas.width, 2 * canvas.height);
    case PictureFormat::pdf:  // 96 pixels an inch
      return fmt::format(
          "set terminal pdfcairo size {:.4f}in,{:.4f}in noenhanced font 'sans-serif,12' fontscale "
          "0.75 linewidth 1.95 pointscale 1.5 background '#ffffff'\n",
          canvas.width / 96.0, canvas.height / 96.0);
  }
  return {};
}

}  // namespace

std::string gnuplot_string(const std::string& text) {
  // gnuplot writes texts into an SVG's CDATA sections, which "]]>" would end.
  std::string shown = xml_text(text);
  for (std::size_t at = 0; (at = shown.find("]]>", at)) != std::string::npos;) {
    shown.insert(at + 2, zero_width_space);
  }
  // In single quotes an apostrophe is doubled, which gnuplot mistakes at the beginning; and a
  // backtick runs a command. As octal numbers in double quotes neither is seen before it is drawn.
  if (shown.find_first_of("'`") == std::string::npos) return "'" + shown + "'";
  std::string result = "\"";
  for (const char c : shown) {
    const bool special = c == '\'' || c == '`' || c == '"' || c == '\\';
    result += special ? fmt::format("\\{:03o}", static_cast<unsigned>(c)) : std::string(1, c);
  }
  return result + "\"";
}

std::string curve_style(std::size_t i, const char* with) {
  const Look& look = looks[i % std::size(looks)];
  return fmt::format("with {} linecolor rgb '{}' dashtype {} pointtype {} pointsize 0.8", with,
                     look.colour, look.dashes, look.points);
}

const char* curve_colour(std::size_t i) { return looks[i % std::size(looks)].colour; }

std::string figure_script(const Figure& figure) {
  const Canvas canvas{.height = height_of(figure)};
  std::string out = fmt::format(
      "# gnuplot {0}.gp draws {0}.svg from {1}\n"
      "set terminal svg size {2},{3} dynamic noenhanced font 'sans-serif,16' linewidth 1.3\n"
      "set encoding utf8\n"
      "set output '{0}.svg'\n",
      figure.name, figure.csv_file, canvas.width, canvas.height);
  const bool several = figure.panels.size() > 1;
  if (several) out += "set multiplot\n";
  add_panels(out, figure, canvas, 0, 0);
  if (several) out += "unset multiplot\n";
  return out;
}

std::string picture_script(const Picture& picture, PictureFormat format,
                           const std::string& output) {
  Canvas canvas;
  for (const PictureRow& row : picture.rows) {
    canvas.width = std::max(canvas.width, figure_width * static_cast<int>(row.size()));
    canvas.height += height_of(row);
  }
  std::string out = terminal(format, canvas) + "set encoding utf8\nset output " +
                    gnuplot_string(output) + "\nset multiplot\n";
  double top = 0;
  for (const PictureRow& row : picture.rows) {
    double left = 0;
    for (const std::vector<Figure>& column : row) {
      double below = top;
      for (const Figure& figure : column) {
        Figure titled = figure;
        std::string title;
        add_title(title, figure, canvas, left, below);
        if (!titled.panels.empty()) titled.panels.front().script.insert(0, title);
        const int height = titled_height(figure);
        add_panels(out, titled, canvas, left, below + height - height_of(figure));
        below += height;
      }
      left += figure_width;
    }
    top += height_of(row);
  }
  return out + "unset multiplot\n";
}

}  // namespace dlo::compare
