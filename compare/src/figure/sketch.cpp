#include "figure/sketch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "figure/series.hpp"

namespace dlo::compare {
namespace {

/// Dots of a character.
struct DotCell {
  int across;
  int down;
};

DotCell cell_of(SketchMarks marks) {
  return marks == SketchMarks::braille ? DotCell{2, 4} : DotCell{1, 2};
}

/// Dots that are set or not.
class Dots {
 public:
  Dots(int columns, int rows, const DotCell& cell)
      : cell_(cell),
        width_(columns * cell.across),
        height_(rows * cell.down),
        set_(index(0, height_)) {}

  void set(int x, int y) {
    const int column = std::clamp(x, 0, width_ - 1);
    const int row = std::clamp(y, 0, height_ - 1);
    set_[index(column, row)] = true;
  }
  /// All dots between two places, in steps of no more than one dot.
  void join(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const int steps = static_cast<int>(std::ceil((to - from).cwiseAbs().maxCoeff()));
    for (int i = 0; i <= steps; ++i) {
      const Eigen::Vector2d at = from + (to - from) * (steps > 0 ? 1.0 * i / steps : 0.0);
      set(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
    }
  }
  [[nodiscard]] std::string text(SketchMarks marks) const {
    std::string out;
    for (int row = 0; row < height_ / cell_.down; ++row) {
      std::string line;
      std::size_t end = 0;
      for (int column = 0; column < width_ / cell_.across; ++column) {
        const unsigned bits = bits_at(column, row);
        line += marks == SketchMarks::braille ? braille(bits) : std::string(1, " '.:"[bits]);
        if (bits != 0) end = line.size();
      }
      line.resize(end);
      out += line + "\n";
    }
    return out;
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }
  /// Dot (x, y) of a character is bit x + across * y.
  [[nodiscard]] unsigned bits_at(int column, int row) const {
    unsigned bits = 0;
    for (int y = 0; y < cell_.down; ++y) {
      for (int x = 0; x < cell_.across; ++x) {
        const bool is_set = set_[index(column * cell_.across + x, row * cell_.down + y)];
        if (is_set) bits |= 1U << static_cast<unsigned>(x + cell_.across * y);
      }
    }
    return bits;
  }
  /// Unicode numbers the dots of a braille character 1 to 3 down the left, 4 to 6 down the right, 7
  /// and 8 below.
  static std::string braille(unsigned bits) {
    if (bits == 0) return " ";
    constexpr unsigned unicode_bit[] = {0, 3, 1, 4, 2, 5, 6, 7};
    unsigned pattern = 0;
    for (unsigned i = 0; i < 8; ++i) {
      if ((bits >> i & 1U) != 0) pattern |= 1U << unicode_bit[i];
    }
    // U+2800 + pattern in UTF-8
    return {static_cast<char>(0xE2), static_cast<char>(0xA0U | pattern >> 6U),
            static_cast<char>(0x80U | (pattern & 0x3FU))};
  }

  DotCell cell_;
  int width_, height_;
  std::vector<bool> set_;
};

}  // namespace

std::string sketch(const std::vector<SketchLine>& lines, int columns, int rows, SketchMarks marks) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(HUGE_VAL);
  Eigen::Vector2d high = -low;
  for (const SketchLine& line : lines) {
    if (line.points.cols() == 0) continue;
    low = low.cwiseMin(line.points.rowwise().minCoeff());
    high = high.cwiseMax(line.points.rowwise().maxCoeff());
  }
  const Eigen::Vector2d extent = high - low;
  const DotCell cell = cell_of(marks);
  // Dots are as far apart across as down in both kinds of character.
  const auto fitting = [](double room, double length) {
    return length > 0 ? room / length : HUGE_VAL;
  };
  const double scale = std::min(fitting(columns * cell.across - 1, extent.x()),
                                fitting(rows * cell.down - 1, extent.y()));
  const auto characters = [&](double dots, int each) {
    return std::isfinite(dots) ? static_cast<int>(std::lround(dots)) / each + 1 : 1;
  };
  const bool has_extent = std::isfinite(scale);
  Dots dots(has_extent ? std::min(columns, characters(extent.x() * scale, cell.across)) : 1,
            has_extent ? std::min(rows, characters(extent.y() * scale, cell.down)) : 1, cell);
  const auto place = [&](const Eigen::Vector2d& point) -> Eigen::Vector2d {
    if (!has_extent) return Eigen::Vector2d::Zero();
    return {(point.x() - low.x()) * scale, (high.y() - point.y()) * scale};
  };
  for (const SketchLine& line : lines) {
    for (Eigen::Index i = 0; i < line.points.cols(); ++i) {
      const Eigen::Index before = line.joined && i > 0 ? i - 1 : i;
      dots.join(place(line.points.col(before)), place(line.points.col(i)));
    }
  }
  return dots.text(marks);
}

std::string sketch_of(const Scene& scene, const std::vector<SpatialLine>& lines, int columns,
                      int rows, SketchMarks marks) {
  const View view = views_of(scene, lines.front().points).front();
  std::vector<SketchLine> seen;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(HUGE_VAL);
  Eigen::Vector2d high = -low;
  for (const SpatialLine& line : lines) {
    SketchLine projected{.points = Eigen::Matrix2Xd(2, line.points.cols()), .joined = line.joined};
    projected.points << line.points.row(view.right), line.points.row(view.up);
    low = low.cwiseMin(projected.points.rowwise().minCoeff());
    high = high.cwiseMax(projected.points.rowwise().maxCoeff());
    seen.push_back(std::move(projected));
  }
  return fmt::format("{} to the right, {:.4g} to {:.4g} m; {} up, {:.4g} to {:.4g} m\n",
                     axis_names[view.right], low.x(), high.x(), axis_names[view.up], low.y(),
                     high.y()) +
         sketch(seen, columns, rows, marks);
}

}  // namespace dlo::compare
