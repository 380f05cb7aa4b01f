// Rigid obstacles: points that are held against them, and the law of what they resist with.

#include "dynamics/span_contact.hpp"

#include <algorithm>
#include <cmath>

namespace dlo::energy_model {

ContactGrid::ContactGrid(const std::vector<Span::Obstacle>& obstacles,
                         const std::vector<Piece>& pieces, const LegendreTable& table,
                         const ContactLaw& law)
    : law_(law) {
  if (obstacles.empty()) return;
  constexpr double widest = 1.0 / 128;
  constexpr double closest = 1.0 / 4096;
  const bool flat = std::all_of(obstacles.begin(), obstacles.end(),
                                [](const Span::Obstacle& o) { return o.body.is_half_space(); });
  const double spacing = flat ? widest : std::clamp(2 * law.depth, closest, widest);
  const Eigen::Index Q = table.nodes.size();
  Eigen::VectorXd values(Q);
  Eigen::VectorXd integrals(Q);
  const Eigen::MatrixXd of_integrals = table.values.transpose() * table.weights.asDiagonal();
  for (const Piece& piece : pieces) {
    const auto count = static_cast<Eigen::Index>(std::max(2.0, std::ceil(piece.length / spacing)));
    Eigen::MatrixXd places(Q, count + 1);
    for (Eigen::Index j = 0; j <= count; ++j) {
      legendre(static_cast<double>(j) / static_cast<double>(count), values, integrals);
      places.col(j) = of_integrals.transpose() * integrals;
    }
    spacings_.push_back(piece.length / static_cast<double>(count));
    places_.push_back(std::move(places));
  }
}

void ContactGrid::find(const obstacle::Body& body, const BodyPlace& place, const Touch& of,
                       const Eigen::Vector3d& begin, const Eigen::MatrixX3d& along,
                       std::vector<Touch>& found) const {
  const Eigen::MatrixXd& places = places_[of.piece];
  for (Eigen::Index j = 0; j < places.cols();) {
    const Eigen::Vector3d at = begin + along.transpose() * places.col(j);
    const double clearance = body.clearance(place.inside(at));
    if (clearance < 0) {
      const obstacle::Gap gap = body.gap(place.inside(at));
      Touch touch = of;
      touch.point = j;
      touch.at = at;
      touch.normal = place.turn * gap.gradient;
      touch.velocity = place.velocity_at(at);
      touch.depth = -gap.value;
      found.push_back(touch);
    }
    // The rod cannot come to the body within as much of its length; less, as polynomials do.
    constexpr double sure = 0.9;
    j += std::max<Eigen::Index>(
        1, static_cast<Eigen::Index>(std::min(sure * clearance / spacings_[of.piece], 1e6)));
  }
}

void ContactGrid::resist(double rate, Touch& touch) const {
  // Ends have half of the length that others stand for.
  const bool inside = touch.point > 0 && touch.point + 1 < places_[touch.piece].cols();
  const double stiffness = law_.stiffness * spacings_[touch.piece] * (inside ? 1 : 0.5);
  const double d = touch.depth;
  const double elastic = stiffness * d * d;
  const double factor = std::max(0.0, 1 + rate / law_.rebound);
  touch.rate = rate;
  touch.push = elastic * factor;
  touch.kept = elastic * d / 3;
  touch.lost = (touch.push - elastic) * rate;
  touch.by_depth = 2 * stiffness * d * factor;
  touch.by_rate = factor > 0 ? elastic / law_.rebound : 0;
}

}  // namespace dlo::energy_model
