// Rigid obstacles in motion: contact points and the contact law.

#include "dynamics/span_contact.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace dlo::energy_model {

Touch::Touch(const Span::Obstacle& of, const BodyPlace& place, const Eigen::Vector3d& where)
    : obstacle(of.index),
      at(where),
      velocity(place.velocity + place.spin.cross(where - place.origin)) {
  const obstacle::Gap gap = of.body.gap(place.inside(where));
  normal = place.turn * gap.gradient;
  depth = -gap.value;
}

ContactGrid::ContactGrid(const std::vector<Span::Obstacle>& obstacles,
                         const PositionOperator& reach, const ContactLaw& law)
    : law_(law) {
  if (obstacles.empty()) return;
  constexpr double widest = 1.0 / 128;
  constexpr double closest = 1.0 / 4096;
  const bool flat = std::all_of(obstacles.begin(), obstacles.end(),
                                [](const Span::Obstacle& o) { return o.body.is_half_space(); });
  const double spacing = flat ? widest : std::clamp(2 * law.depth, closest, widest);
  for (const Piece& piece : reach.pieces()) {
    const auto parts = static_cast<Eigen::Index>(std::max(2.0, std::ceil(piece.length / spacing)));
    spacings_.push_back(piece.length / static_cast<double>(parts));
    pieces_.push_back(
        reach.points(std::ssize(pieces_), Eigen::VectorXd::LinSpaced(parts + 1, 0, 1)));
  }
}

void ContactGrid::find(std::size_t piece, const Span::Obstacle& obstacle, const BodyPlace& place,
                       const Eigen::Vector3d& begin, const Eigen::MatrixX3d& tangents,
                       std::vector<Touch>& found) const {
  const PointsReach& points = pieces_[piece];
  for (Eigen::Index j = 0; j < points.points();) {
    const Eigen::Vector3d at = begin + points.from_begin(j, tangents);
    const double clearance = obstacle.body.clearance(place.inside(at));
    if (clearance < 0) {
      found.emplace_back(obstacle, place, at);
      found.back().piece = piece;
      found.back().point = j;
    }
    // The rod cannot reach the body within a length equal to the clearance; the factor accounts for
    // the polynomials, which are not exactly inextensible.
    constexpr double sure = 0.9;
    j += std::max<Eigen::Index>(
        1, static_cast<Eigen::Index>(std::min(sure * clearance / spacings_[piece], 1e6)));
  }
}

void ContactGrid::resist(double rate, Touch& touch) const {
  // End points represent half the length of inner points.
  const bool inside = touch.point > 0 && touch.point + 1 < pieces_[touch.piece].points();
  const double stiffness = law_.stiffness * spacings_[touch.piece] * (inside ? 1 : 0.5);
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
