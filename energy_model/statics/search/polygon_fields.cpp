#include "search/polygon_fields.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/tangent_between.hpp"
#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {
namespace {

constexpr std::size_t most_fields = 12;

/// Maximum number of intervals of a polygon that is relaxed again.
constexpr double most_field_intervals = 600;

Eigen::VectorXd middles_of(const RodMesh& mesh) {
  const Eigen::Index count = mesh.intervals();
  return (mesh.s.head(count) + mesh.s.tail(count)) / 2;
}

}  // namespace

PolygonFields::PolygonFields(const Problem& problem, const PlacedSpan& placed,
                             const Deadline& deadline)
    : deadline_(deadline), reversed_(placed.reversed), frame_(placed.frame) {
  const auto is_clamp = [](const Span::Hold& hold) { return hold.direction.has_value(); };
  if (std::any_of(placed.span.holds.begin(), placed.span.holds.end(), is_clamp)) return;
  const double begin = placed.reversed ? placed.start / problem.length - placed.span.length
                                       : placed.start / problem.length;
  const std::vector<RodSpan> spans = cut_at_clamps(problem);
  span_ = *std::min_element(spans.begin(), spans.end(), [&](const auto& a, const auto& b) {
    return std::abs(a.begin - begin) < std::abs(b.begin - begin);
  });
  // Resolves boundary layers of the loads, but no more than a coarse polygon needs.
  const double load = std::min(total_load(*span_), 1e4);
  longest_ = std::min(span_->length / 16, 1 / std::sqrt(std::max(load, 1.0)));
  const RodMesh mesh = make_mesh(*span_, longest_);
  minima_ = polygon_minima(*span_, mesh, deadline).found;
  if (minima_.size() > most_fields) minima_.resize(most_fields);
}

TangentField PolygonFields::field(std::size_t index) const {
  const RelaxedPolygon& minimum = minima_[index];
  const RodMesh mesh = make_mesh(*span_, longest_);
  Eigen::VectorXd middles = middles_of(mesh);
  Eigen::Matrix3Xd tangents = minimum.tangents();
  const double force = minimum.force.colwise().norm().maxCoeff() / least_bending_stiffness(*span_);
  const double resolving =
      std::max(1 / std::sqrt(std::max(force, 1.0)), span_->length / most_field_intervals);
  if (longest_ > 1.1 * resolving) {
    const RodMesh finer = make_mesh(*span_, resolving);
    middles = middles_of(finer);
    tangents = relax_on(*span_, finer, mesh, minimum, deadline_).tangents();
  }
  return [middles = std::move(middles), tangents = std::move(tangents), length = span_->length,
          reversed = reversed_, frame = frame_](const Eigen::VectorXd& s) {
    Eigen::Matrix3Xd result(3, s.size());
    for (Eigen::Index q = 0; q < s.size(); ++q) {
      const double at = reversed ? length - s[q] : s[q];
      const Eigen::Vector3d t = frame * tangent_between(middles, tangents, at);
      result.col(q) = reversed ? Eigen::Vector3d(-t) : t;
    }
    return result;
  };
}

}  // namespace dlo::energy_model
