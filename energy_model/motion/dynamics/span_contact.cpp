// Rigid obstacles in motion: contact points and the contact law.

#include "dynamics/span_contact.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace dlo::energy_model {

ContactPoint::ContactPoint(const Span::Obstacle& of, const ObstaclePose& place,
                           const Eigen::Vector3d& where)
    : obstacle(of.index),
      at(where),
      velocity(place.velocity + place.spin.cross(where - place.origin)) {
  const obstacle::Gap gap = of.body.gap(place.to_body_axes(where));
  normal = place.turn * gap.gradient;
  depth = -gap.value;
}

ContactGrid::ContactGrid(const std::vector<Span::Obstacle>& obstacles,
                         const PositionOperator& reach, const ContactLaw& law)
    : law_(law) {
  if (obstacles.empty()) return;
  constexpr double largest_spacing = 1.0 / 128;
  constexpr double smallest_spacing = 1.0 / 4096;
  const bool flat = std::all_of(obstacles.begin(), obstacles.end(),
                                [](const Span::Obstacle& o) { return o.body.is_half_space(); });
  const double spacing =
      flat ? largest_spacing : std::clamp(2 * law.depth, smallest_spacing, largest_spacing);
  for (const Element& element : reach.elements()) {
    const auto parts =
        static_cast<Eigen::Index>(std::max(2.0, std::ceil(element.length / spacing)));
    spacings_.push_back(element.length / static_cast<double>(parts));
    elements_.push_back(
        reach.points(std::ssize(elements_), Eigen::VectorXd::LinSpaced(parts + 1, 0, 1)));
  }
}

void ContactGrid::find(std::size_t element, const Span::Obstacle& obstacle,
                       const ObstaclePose& place, const Eigen::Vector3d& begin,
                       const Eigen::MatrixX3d& tangents, std::vector<ContactPoint>& found) const {
  const PointOperator& points = elements_[element];
  for (Eigen::Index j = 0; j < points.points();) {
    const Eigen::Vector3d at = begin + points.from_begin(j, tangents);
    const double clearance = obstacle.body.clearance(place.to_body_axes(at));
    if (clearance < 0) {
      found.emplace_back(obstacle, place, at);
      found.back().element = element;
      found.back().point = j;
    }
    // The rod cannot reach the body within a length equal to the clearance; the factor accounts for
    // the polynomials, which are not exactly inextensible.
    j += std::max<Eigen::Index>(
        1, static_cast<Eigen::Index>(std::min(0.9 * clearance / spacings_[element], 1e6)));
  }
}

void ContactGrid::set_contact_force(double rate, ContactPoint& touch) const {
  // End points represent half the length of inner points.
  const bool inside = touch.point > 0 && touch.point + 1 < elements_[touch.element].points();
  const double stiffness = law_.stiffness * spacings_[touch.element] * (inside ? 1 : 0.5);
  const double d = touch.depth;
  const double elastic = stiffness * d * d;
  const double factor = std::max(0.0, 1 + rate / law_.rebound);
  touch.push = elastic * factor;
  touch.kept = elastic * d / 3;
  touch.lost = (touch.push - elastic) * rate;
  touch.by_depth = 2 * stiffness * d * factor;
  touch.by_rate = factor > 0 ? elastic / law_.rebound : 0;
}

}  // namespace dlo::energy_model
