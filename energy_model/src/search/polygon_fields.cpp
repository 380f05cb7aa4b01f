#include "search/polygon_fields.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "contact/tangent_between.hpp"
#include "kirchhoff/relaxed_polygon.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {
namespace {

constexpr std::size_t most_fields = 12;

}  // namespace

std::vector<TangentField> polygon_fields(const Problem& problem, const PlacedSpan& placed,
                                         const Deadline& deadline) {
  // The polygon knows no torque that clamps pass on.
  const auto is_clamp = [](const Span::Hold& hold) { return hold.direction.has_value(); };
  if (std::any_of(placed.span.holds.begin(), placed.span.holds.end(), is_clamp)) return {};
  const double begin = (placed.reversed ? placed.start / problem.length - placed.span.length
                                        : placed.start / problem.length);
  const std::vector<RodSpan> spans = cut_at_clamps(problem);
  const auto own = std::min_element(spans.begin(), spans.end(), [&](const auto& a, const auto& b) {
    return std::abs(a.begin - begin) < std::abs(b.begin - begin);
  });
  // Boundary layers of the loads, and no more than a coarse polygon needs.
  const double load = std::min(total_load(*own), 1e4);
  const RodMesh mesh =
      make_mesh(*own, std::min(own->length / 16, 1 / std::sqrt(std::max(load, 1.0))));
  std::vector<RelaxedPolygon> minima;
  for (const bool planar : {true, false}) {
    if ((planar && !own->plane) || deadline.passed()) continue;
    PolygonMinima found = polygon_minima(*own, mesh, planar, deadline);
    for (RelaxedPolygon& polygon : found.found) minima.push_back(std::move(polygon));
  }
  std::stable_sort(minima.begin(), minima.end(),
                   [](const auto& a, const auto& b) { return a.energy < b.energy; });
  if (minima.size() > most_fields) minima.resize(most_fields);
  const Eigen::Index count = mesh.intervals();
  const Eigen::VectorXd middles = (mesh.s.head(count) + mesh.s.tail(count)) / 2;
  std::vector<TangentField> fields;
  fields.reserve(minima.size());
  for (const RelaxedPolygon& polygon : minima) {
    fields.emplace_back([middles, tangents = polygon.tangents, length = own->length,
                         reversed = placed.reversed,
                         frame = placed.frame](const Eigen::VectorXd& s) {
      Eigen::Matrix3Xd result(3, s.size());
      for (Eigen::Index q = 0; q < s.size(); ++q) {
        const double at = reversed ? length - s[q] : s[q];
        const Eigen::Vector3d t = frame * tangent_between(middles, tangents, at);
        result.col(q) = reversed ? Eigen::Vector3d(-t) : t;
      }
      return result;
    });
  }
  return fields;
}

}  // namespace dlo::energy_model
