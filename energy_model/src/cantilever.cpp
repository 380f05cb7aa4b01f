#include "cantilever.hpp"

#include <algorithm>
#include <cmath>

#include "legendre.hpp"

namespace dlo::energy_model {

namespace {

/// Ends of the pieces: clamp, loads, tip, and for a soft rod two cuts in the layer at the clamp
/// where its bending has decayed by exp(-6) and exp(-24), so that no piece has to resolve all of
/// it.
std::vector<double> cut_points(const PlanarCantilever& rod) {
  std::vector<double> cuts = {0, 1};
  Eigen::Vector2d total = rod.weight;
  for (const PlanarCantilever::Load& load : rod.loads) {
    total += load.force;
    if (load.at < 1) cuts.push_back(load.at);
  }
  const double layer = 1 / std::sqrt(std::max(1.0, total.norm()));
  constexpr double layer_depths[] = {6, 24};
  constexpr double furthest_cut = 0.7;
  if (layer_depths[1] * layer < furthest_cut) {
    for (const double depth : layer_depths) cuts.push_back(depth * layer);
  }
  std::sort(cuts.begin(), cuts.end());
  // Pieces too short to hold a curvature of their own only harm the arithmetic.
  const auto close = [](double a, double b) { return b - a < 1e-9; };
  cuts.erase(std::unique(cuts.begin(), cuts.end(), close), cuts.end());
  cuts.back() = 1;
  return cuts;
}

}  // namespace

CantileverEnergy::CantileverEnergy(const PlanarCantilever& rod, int terms)
    : rod_(rod), terms_(terms) {
  const std::vector<double> cuts = cut_points(rod);
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    Piece piece{cuts[i], cuts[i + 1] - cuts[i]};
    for (const PlanarCantilever::Load& load : rod.loads) {
      if (load.at >= cuts[i + 1] - 1e-9) piece.end_force += load.force;
    }
    pieces_.push_back(piece);
  }

  const LegendreTable& table = legendre_table(terms);
  const Eigen::Index Q = table.nodes.size();
  const Eigen::Index K = terms;
  const auto count = static_cast<Eigen::Index>(pieces_.size());
  angle_by_coefficient_.setZero(count * Q, count * K);
  force_.resize(2, count * Q);
  for (Eigen::Index e = 0; e < count; ++e) {
    const Piece& piece = pieces_[static_cast<std::size_t>(e)];
    const double root = std::sqrt(piece.length);
    angle_by_coefficient_.block(e * Q, e * K, Q, K) = root * table.integrals;
    // Only p_0 turns the tangent over a whole piece.
    angle_by_coefficient_.col(e * K).tail((count - e - 1) * Q).setConstant(root);
    for (Eigen::Index q = 0; q < Q; ++q) {
      const double s = piece.begin + piece.length * table.nodes[q];
      force_.col(e * Q + q) =
          table.weights[q] * piece.length * (piece.end_force + (1 - s) * rod.weight);
    }
  }
  angle_.resize(count * Q);
  cosine_.resize(count * Q);
  sine_.resize(count * Q);
  slope_.resize(count * Q);
}

double CantileverEnergy::value(const Eigen::Ref<const Eigen::VectorXd>& coefficients,
                               Eigen::Ref<Eigen::VectorXd> gradient) {
  angle_.noalias() = angle_by_coefficient_ * coefficients;
  for (Eigen::Index q = 0; q < angle_.size(); ++q) {
    cosine_[q] = std::cos(angle_[q]);
    sine_[q] = std::sin(angle_[q]);
  }
  slope_ = (force_.row(0).transpose().cwiseProduct(sine_)) -
           (force_.row(1).transpose().cwiseProduct(cosine_));
  gradient = coefficients;
  gradient.noalias() += angle_by_coefficient_.transpose() * slope_;
  return coefficients.squaredNorm() / 2 - force_.row(0).dot(cosine_) - force_.row(1).dot(sine_);
}

void CantileverEnergy::hessian(Eigen::MatrixXd& result) const {
  const Eigen::VectorXd along = force_.row(0).transpose().cwiseProduct(cosine_) +
                                force_.row(1).transpose().cwiseProduct(sine_);
  result.noalias() = angle_by_coefficient_.transpose() * along.asDiagonal() * angle_by_coefficient_;
  result.diagonal().array() += 1;
}

Eigen::VectorXd CantileverEnergy::soft_start() const {
  Eigen::Vector2d total = rod_.weight;
  for (const PlanarCantilever::Load& load : rod_.loads) total += load.force;
  const double turn = std::atan2(total.y(), total.x());
  const double rate = std::sqrt(total.norm());
  const double amplitude = std::tan(turn / 4);
  const LegendreTable& table = legendre_table(terms_);
  Eigen::VectorXd coefficients(size());
  Eigen::VectorXd weighted(table.nodes.size());
  for (std::size_t e = 0; e < pieces_.size(); ++e) {
    const Piece& piece = pieces_[e];
    for (Eigen::Index q = 0; q < weighted.size(); ++q) {
      const double decay =
          amplitude * std::exp(-rate * (piece.begin + piece.length * table.nodes[q]));
      weighted[q] = table.weights[q] * 4 * rate * decay / (1 + decay * decay);
    }
    coefficients.segment(static_cast<Eigen::Index>(e) * terms_, terms_) =
        std::sqrt(piece.length) * table.values.transpose() * weighted;
  }
  return coefficients;
}

double CantileverEnergy::tail(const Eigen::VectorXd& coefficients) const {
  double tail = 0;
  for (Eigen::Index end = terms_; end <= coefficients.size(); end += terms_) {
    tail = std::max(
        tail,
        coefficients.segment(end - std::min(terms_, 2), std::min(terms_, 2)).cwiseAbs().maxCoeff());
  }
  return tail;
}

Eigen::VectorXd CantileverEnergy::refine(const Eigen::VectorXd& coefficients, int terms,
                                         int more_terms) {
  const Eigen::Index pieces = coefficients.size() / terms;
  Eigen::VectorXd refined = Eigen::VectorXd::Zero(pieces * more_terms);
  for (Eigen::Index e = 0; e < pieces; ++e) {
    refined.segment(e * more_terms, terms) = coefficients.segment(e * terms, terms);
  }
  return refined;
}

Energies CantileverEnergy::energies(const Eigen::VectorXd& coefficients) {
  Eigen::VectorXd gradient(coefficients.size());
  const double total = value(coefficients, gradient);
  Energies energies;
  energies.bending = coefficients.squaredNorm() / 2;
  std::vector<double> load_points;
  for (const PlanarCantilever::Load& load : rod_.loads) load_points.push_back(load.at);
  const PlanarSamples samples = sample(coefficients, load_points);
  for (std::size_t j = 0; j < rod_.loads.size(); ++j) {
    energies.load -= rod_.loads[j].force.dot(samples.points.col(static_cast<Eigen::Index>(j)));
  }
  energies.gravity = total - energies.bending - energies.load;
  return energies;
}

PlanarSamples CantileverEnergy::sample(const Eigen::VectorXd& coefficients,
                                       const std::vector<double>& distances) const {
  const LegendreTable& table = legendre_table(terms_);
  Eigen::VectorXd values(terms_);
  Eigen::VectorXd integrals(terms_);
  PlanarSamples samples(static_cast<Eigen::Index>(distances.size()));

  // Angle and position after a share `xi` of piece e that starts at the given angle and position.
  const auto advance = [&](std::size_t e, double xi, double start_angle,
                           const Eigen::Vector2d& start) {
    const Eigen::VectorXd a = coefficients.segment(static_cast<Eigen::Index>(e) * terms_, terms_);
    const double root = std::sqrt(pieces_[e].length);
    Eigen::Vector2d point = start;
    for (Eigen::Index q = 0; q < table.nodes.size(); ++q) {
      legendre(xi * table.nodes[q], values, integrals);
      const double angle = start_angle + root * integrals.dot(a);
      point += pieces_[e].length * xi * table.weights[q] *
               Eigen::Vector2d(std::cos(angle), std::sin(angle));
    }
    legendre(xi, values, integrals);
    struct Reached {
      double angle, curvature;
      Eigen::Vector2d point;
    };
    return Reached{start_angle + root * integrals.dot(a), values.dot(a) / root, point};
  };

  std::vector<double> start_angle = {0};
  std::vector<Eigen::Vector2d> start = {Eigen::Vector2d::Zero()};
  for (std::size_t e = 0; e + 1 < pieces_.size(); ++e) {
    const auto end = advance(e, 1, start_angle[e], start[e]);
    start_angle.push_back(end.angle);
    start.push_back(end.point);
  }
  for (std::size_t i = 0; i < distances.size(); ++i) {
    std::size_t e = 0;
    while (e + 1 < pieces_.size() && distances[i] > pieces_[e].begin + pieces_[e].length) ++e;
    const double xi = std::min(1.0, (distances[i] - pieces_[e].begin) / pieces_[e].length);
    const auto reached = advance(e, xi, start_angle[e], start[e]);
    const auto column = static_cast<Eigen::Index>(i);
    samples.points.col(column) = reached.point;
    samples.angle[column] = reached.angle;
    samples.curvature[column] = reached.curvature;
  }
  return samples;
}

}  // namespace dlo::energy_model
