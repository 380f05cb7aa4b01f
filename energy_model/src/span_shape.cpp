#include "span_shape.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "legendre.hpp"

namespace dlo::energy_model {
namespace {

Eigen::Vector3d tangent_of(double theta, double beta) {
  return {std::cos(beta) * std::cos(theta), std::cos(beta) * std::sin(theta), std::sin(beta)};
}

/// A piece with what is needed to look at any point of it.
struct PlacedPiece {
  Piece piece;
  double theta, beta;        // at its begin
  Eigen::Vector3d point;     // of its begin
  Eigen::Matrix3Xd tangent;  // Legendre coefficients of the tangent, 3 x Q
};

class Sampler {
 public:
  explicit Sampler(const SpanShape& shape)
      : shape_(shape),
        table_(legendre_table(shape.terms)),
        values_(table_.nodes.size()),
        integrals_(table_.nodes.size()) {
    PlacedPiece placed{{}, shape.start_theta, shape.start_beta, Eigen::Vector3d::Zero(), {}};
    for (std::size_t e = 0; e < shape.pieces.size(); ++e) {
      placed.piece = shape.pieces[e];
      placed.tangent = tangent_coefficients(placed, e);
      pieces_.push_back(placed);
      // Over a whole piece only p_0 adds up.
      const double root = std::sqrt(placed.piece.length);
      placed.theta += root * coefficients(shape_.theta, e)[0];
      if (!shape_.planar) placed.beta += root * coefficients(shape_.beta, e)[0];
      placed.point += placed.piece.length * placed.tangent.col(0);
      if (std::abs(placed.piece.end() - shape.anchor) < closest_cuts) anchor_ = placed.point;
    }
  }

  void look(double at, Eigen::Ref<Eigen::Vector3d> point, Eigen::Ref<Eigen::Vector3d> tangent,
            Eigen::Ref<Eigen::Vector3d> curvature) {
    std::size_t e = 0;
    while (e + 1 < pieces_.size() && at > pieces_[e].piece.end()) ++e;
    const PlacedPiece& placed = pieces_[e];
    const double length = placed.piece.length;
    legendre(std::clamp((at - placed.piece.begin) / length, 0.0, 1.0), values_, integrals_);
    point = placed.point + length * (placed.tangent * integrals_) - anchor_;
    const Eigen::Index K = shape_.terms;
    const double root = std::sqrt(length);
    const Eigen::VectorXd theta = coefficients(shape_.theta, e);
    const double azimuth = placed.theta + root * integrals_.head(K).dot(theta);
    const double azimuth_rate = values_.head(K).dot(theta) / root;
    const double s = std::sin(azimuth);
    const double c = std::cos(azimuth);
    if (shape_.planar) {
      tangent << c, s, 0;
      curvature << -azimuth_rate * s, azimuth_rate * c, 0;
      return;
    }
    const Eigen::VectorXd beta = coefficients(shape_.beta, e);
    const double elevation = placed.beta + root * integrals_.head(K).dot(beta);
    const double elevation_rate = values_.head(K).dot(beta) / root;
    const double sb = std::sin(elevation);
    const double cb = std::cos(elevation);
    tangent << cb * c, cb * s, sb;
    curvature = azimuth_rate * cb * Eigen::Vector3d(-s, c, 0) +
                elevation_rate * Eigen::Vector3d(-sb * c, -sb * s, cb);
  }

 private:
  [[nodiscard]] Eigen::VectorXd coefficients(const Eigen::VectorXd& field, std::size_t e) const {
    return field.segment(static_cast<Eigen::Index>(e) * shape_.terms, shape_.terms);
  }

  [[nodiscard]] Eigen::Matrix3Xd tangent_coefficients(const PlacedPiece& placed,
                                                      std::size_t e) const {
    const Eigen::Index Q = table_.nodes.size();
    const double root = std::sqrt(placed.piece.length);
    const Eigen::VectorXd theta =
        root * (table_.integrals.leftCols(shape_.terms) * coefficients(shape_.theta, e));
    Eigen::VectorXd beta = Eigen::VectorXd::Zero(Q);
    if (!shape_.planar) {
      beta = root * (table_.integrals.leftCols(shape_.terms) * coefficients(shape_.beta, e));
    }
    Eigen::Matrix3Xd weighted(3, Q);
    for (Eigen::Index q = 0; q < Q; ++q) {
      weighted.col(q) =
          table_.weights[q] * tangent_of(placed.theta + theta[q], placed.beta + beta[q]);
    }
    return weighted * table_.values;
  }

  const SpanShape& shape_;
  const LegendreTable& table_;
  Eigen::VectorXd values_, integrals_;
  std::vector<PlacedPiece> pieces_;
  Eigen::Vector3d anchor_ = Eigen::Vector3d::Zero();
};

}  // namespace

std::vector<Piece> pieces_of(const Span& span) {
  std::vector<double> cuts;
  cuts.reserve(8 + span.holds.size() + span.loads.size());
  cuts.insert(cuts.end(), {0, span.length, span.anchor});
  for (const Span::Hold& hold : span.holds) cuts.push_back(hold.at);
  for (const Span::Load& load : span.loads) cuts.push_back(load.at);
  const double layer = 1 / std::sqrt(std::max(1.0, span.total_load()));
  constexpr std::array<double, 2> depths = {6, 24};
  const double room = span.end_direction ? 0.4 : 0.7;
  if (depths[1] * layer < room * span.length) {
    for (const double depth : depths) {
      cuts.push_back(depth * layer);
      if (span.end_direction) cuts.push_back(span.length - depth * layer);
    }
  }
  std::sort(cuts.begin(), cuts.end());
  std::vector<Piece> pieces;
  double begin = 0;
  for (const double c : cuts) {
    if (c - begin < closest_cuts) continue;
    const double end = span.length - c < closest_cuts ? span.length : c;
    pieces.push_back({begin, end - begin});
    begin = end;
  }
  return pieces;
}

SpanSamples SpanShape::sample(std::span<const double> s) const {
  const auto count = static_cast<Eigen::Index>(s.size());
  SpanSamples samples{Eigen::Matrix3Xd(3, count), Eigen::Matrix3Xd(3, count),
                      Eigen::Matrix3Xd(3, count)};
  Sampler sampler(*this);
  for (Eigen::Index i = 0; i < count; ++i) {
    sampler.look(s[static_cast<std::size_t>(i)], samples.points.col(i), samples.tangents.col(i),
                 samples.curvature.col(i));
  }
  return samples;
}

}  // namespace dlo::energy_model
