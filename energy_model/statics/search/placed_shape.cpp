#include "search/placed_shape.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/sized_samples.hpp"
#include "base/spin.hpp"
#include "dlo/energy_model/turns.hpp"
#include "problem/rod_law.hpp"

namespace dlo::energy_model {
namespace {

/// Largest difference of the arc lengths of a grip and of the end of its span, divided by the rod
/// length, by rounding.
constexpr double same_hold = 1e-9;

/// Tangent and material d1 of a shape at an arc length, in space.
struct MaterialAt {
  Eigen::Vector3d tangent, d1;
};

MaterialAt material_at(const PlacedShape& shape, double length, double arc_length) {
  const std::vector<double> at = {arc_length};
  const Samples samples = sample({shape}, length, at);
  return {samples.tangents.col(0), samples.d1.col(0)};
}

/// Rotates the material of a shape so that it has this d1 at an arc length.
void turn_to(PlacedShape& shape, double length, double arc_length, const Eigen::Vector3d& d1) {
  const MaterialAt here = material_at(shape, length, arc_length);
  const double sense = shape.reversed ? -1 : 1;
  const double by = sense * std::atan2(here.tangent.dot(here.d1.cross(d1)), here.d1.dot(d1));
  shape.ahead = [by, before = std::move(shape.ahead)](double s) { return by + before(s); };
}

/// Returns d1 of the frame that the first twisting grip prescribes.
Eigen::Vector3d first_d1(const Problem& problem, double arc_length) {
  const auto grip = std::ranges::find_if(problem.grips, [&](const Grip& each) {
    return each.frame && std::abs(each.at - arc_length) <= same_hold * problem.length;
  });
  return held_frame(*grip, held_d1(problem, *grip)).col(0);
}

}  // namespace

PlacedShape placed_shape(const PlacedSpan& placed, const SpanSolution& solution, double length) {
  const double end = placed.reversed ? placed.start : placed.start + placed.span.length * length;
  return {solution.model->shape(solution.x),
          placed.reversed,
          placed.start,
          end,
          placed.frame.transpose(),
          placed.anchor_position,
          {}};
}

void place_twisted_material(const Problem& problem,
                            const std::vector<const SpanSolution*>& solutions,
                            std::vector<PlacedShape>& shapes) {
  const auto is_twisted = [](const SpanSolution* solution) {
    return solution->model->span().twist.has_value();
  };
  const auto first = std::find_if(solutions.begin(), solutions.end(), is_twisted);
  if (first == solutions.end()) return;
  const double l = problem.length;
  const std::vector<RodPart> parts = rod_parts(problem);
  std::vector<double> begins;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    begins.push_back(i == 0 ? 0 : shapes[i - 1].end);
    shapes[i].ahead = [](double) { return 0.0; };
    if (!is_twisted(solutions[i])) continue;
    const double rate = solutions[i]->model->twist(solutions[i]->x) /
                        torsional_compliance(parts, begins[i], shapes[i].end);
    shapes[i].ahead = [parts, rate, begin = begins[i], l](double s) {
      return rate * torsional_compliance(parts, begin, begin + s * l);
    };
  }
  const auto held = static_cast<std::size_t>(first - solutions.begin());
  turn_to(shapes[held], l, begins[held], first_d1(problem, begins[held]));
  for (std::size_t i = held + 1; i < shapes.size(); ++i) {
    turn_to(shapes[i], l, begins[i], material_at(shapes[i - 1], l, begins[i]).d1);
  }
  for (std::size_t i = held; i-- > 0;) {
    turn_to(shapes[i], l, shapes[i].end, material_at(shapes[i + 1], l, shapes[i].end).d1);
  }
}

Samples sample(const std::vector<PlacedShape>& shapes, double length,
               std::span<const double> arc_lengths) {
  const auto count = static_cast<Eigen::Index>(arc_lengths.size());
  Samples samples = sized_samples(arc_lengths, length);
  if (!shapes.empty() && shapes.front().ahead) samples.d1.resize(3, count);
  std::vector<std::vector<Eigen::Index>> columns(shapes.size());
  std::vector<std::vector<double>> own_s(shapes.size());
  for (Eigen::Index i = 0; i < count; ++i) {
    const double at = arc_lengths[static_cast<std::size_t>(i)];
    std::size_t p = 0;
    while (p + 1 < shapes.size() && at > shapes[p].end) ++p;
    columns[p].push_back(i);
    own_s[p].push_back((shapes[p].reversed ? shapes[p].start - at : at - shapes[p].start) / length);
  }
  for (std::size_t p = 0; p < shapes.size(); ++p) {
    const PlacedShape& placed = shapes[p];
    const SpanSamples own = placed.shape.sample(own_s[p]);
    const double sense = placed.reversed ? -1 : 1;
    for (std::size_t k = 0; k < columns[p].size(); ++k) {
      const Eigen::Index i = columns[p][k];
      const auto from = static_cast<Eigen::Index>(k);
      samples.points.col(i) = placed.anchor + length * (placed.to_space * own.points.col(from));
      samples.tangents.col(i) = sense * (placed.to_space * own.tangents.col(from));
      samples.curvature.col(i) = placed.to_space * own.curvature.col(from) / length;
      if (!placed.ahead) continue;
      const Eigen::AngleAxisd about(placed.ahead(own_s[p][k]), own.tangents.col(from));
      samples.d1.col(i) = placed.to_space * (about * own.d1.col(from));
    }
  }
  return samples;
}

}  // namespace dlo::energy_model
