// Points of a span as sums over tangents, against the samples of its shape.

#include "frames/position_operator.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "frames/rod_frames.hpp"
#include "frames/span_shape.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

constexpr int terms = 8;

/// Returns a span with a pin at 0.3, which is its anchor, and a load next to it.
Span anchored_span() {
  Span span;
  span.planar = false;
  span.anchor = 0.3;
  span.loads = {{0.75, Eigen::Vector3d::UnitX()}};
  return span;
}

struct Sampled {
  Span span = anchored_span();
  std::vector<Piece> pieces = pieces_of(span);
  PositionOperator reach = PositionOperator(span, pieces, director_table(terms));
  SpanShape shape;
  Eigen::MatrixX3d tangents;

  Sampled() {
    const RodFrames frames(pieces, terms, Eigen::Matrix3d::Identity(), true);
    shape.terms = terms;
    shape.planar = false;
    shape.anchor = span.anchor;
    shape.pieces = pieces;
    shape.free_start = true;
    shape.strains = Eigen::VectorXd::LinSpaced(2 * frames.columns(), -1, 1.5);
    RodFrames::State state;
    frames.resize(state);
    frames.evaluate(shape.strains, state);
    tangents = state.t.bottomRows(reach.nodes().size());
  }
  [[nodiscard]] Eigen::Vector3d point(double s) const { return test::point_at(shape, s); }
};

TEST(PositionOperator, PointsAreThoseOfTheShape) {
  const Sampled rod;
  ASSERT_EQ(rod.pieces.size(), 3U);
  for (const double s : {0.0, 0.1, 0.3, 0.31, 0.5, 0.75, 1.0}) {
    const Eigen::Vector3d at = rod.tangents.transpose() * rod.reach.at(s);
    EXPECT_LT((at - rod.point(s)).norm(), 1e-14) << s;
  }
  const PointsReach points = rod.reach.points(1, Eigen::Vector3d(0, 0.4, 1));
  const Eigen::Matrix3Xd at = points.positions(rod.tangents);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double s = 0.3 + 0.45 * Eigen::Vector3d(0, 0.4, 1)[i];
    EXPECT_LT((at.col(i) - rod.point(s)).norm(), 1e-14) << s;
    EXPECT_LT((rod.tangents.transpose() * points.weights(i) - at.col(i)).norm(), 1e-14) << s;
  }
}

TEST(PositionOperator, SignsAreOfThePiecesBetweenTheAnchorAndAPoint) {
  const Sampled rod;
  EXPECT_EQ(rod.reach.signs(0), (std::vector<double>{-1, 0, 0}));
  EXPECT_EQ(rod.reach.signs(0.3), (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(rod.reach.signs(1), (std::vector<double>{0, 1, 1}));
}

TEST(SpanReach, HasBeginsNodesAndEndsOfAllPieces) {
  const Sampled rod;
  const SpanReach points(rod.reach);
  const Eigen::MatrixXd at = points.sums(rod.tangents);
  for (std::size_t e = 0; e < rod.pieces.size(); ++e) {
    const Eigen::Index begin = points.begin(static_cast<Eigen::Index>(e));
    const Eigen::Index nodes = points.piece_points() - 2;
    const auto expect_at = [&](Eigen::Index row, double s) {
      EXPECT_LT((at.row(row).transpose() - rod.point(s)).norm(), 1e-14) << s;
    };
    expect_at(begin, rod.pieces[e].begin);
    expect_at(begin + nodes + 1, rod.pieces[e].end());
    for (Eigen::Index q = 0; q < nodes; ++q) {
      expect_at(begin + 1 + q, rod.reach.nodes()[static_cast<Eigen::Index>(e) * nodes + q]);
    }
  }
  EXPECT_EQ(points.begin(3), points.points() - 1);
  EXPECT_NEAR(points.weights().sum(), rod.span.length, 1e-14);
}

// The work of forces at the points equals that of their adjoint on the tangents.
TEST(SpanReach, SpreadsForcesAsItSumsTangents) {
  const Sampled rod;
  const SpanReach points(rod.reach);
  const Eigen::MatrixX3d forces = Eigen::MatrixX3d::Random(points.points(), 3);
  const double work = forces.cwiseProduct(points.sums(rod.tangents)).sum();
  EXPECT_NEAR(points.spread(forces).cwiseProduct(rod.tangents).sum(), work, 1e-13);
}

}  // namespace
}  // namespace dlo::energy_model
