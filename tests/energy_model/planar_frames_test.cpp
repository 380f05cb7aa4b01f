// Tests of the tangents of a rod in a plane from its curvature, against a closed form, and of their
// adjoint against their Jacobian. span_energy_test.cpp tests the Hessian with that of the energy.

#include "frames/planar_frames.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace dlo::energy_model {
namespace {

constexpr int plane_terms = 4;

/// Two pieces of unlike stiffness, from 0 to 1.
std::vector<Piece> unlike_pieces() { return {{0, 0.4, {1, 1, 0}}, {0.4, 0.6, {2, 2, 0}}}; }

struct PlacedFrames {
  PlanarFrames frames;
  PlanarFrames::State state;
  Eigen::MatrixX3d tangents;

  PlacedFrames(std::optional<double> start_theta, const NaturalStrains& natural = {}) {
    frames.reset(unlike_pieces(), plane_terms, start_theta, natural);
    frames.resize(state);
    tangents.setZero(frames.by_unknown().rows(), 3);
  }
};

TEST(PlanarFrames, OfAConstantCurvatureGoRoundACircle) {
  PlacedFrames rod(0.3);
  const double curvature = 2;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * plane_terms);
  const std::vector<Piece> pieces = unlike_pieces();
  for (int e = 0; e < 2; ++e) {
    x[e * plane_terms] = curvature / pieces[static_cast<std::size_t>(e)].strain(0);
  }
  rod.frames.evaluate(x, rod.tangents, rod.state);
  const LegendreTable& table = legendre_table(plane_terms);
  const Eigen::Index Q = table.nodes.size();
  for (Eigen::Index q = 0; q < 2 * Q; ++q) {
    const Piece& piece = pieces[static_cast<std::size_t>(q / Q)];
    const double theta = 0.3 + curvature * (piece.begin + piece.length * table.nodes[q % Q]);
    EXPECT_NEAR(rod.tangents(q, 0), std::cos(theta), 1e-14);
    EXPECT_NEAR(rod.tangents(q, 1), std::sin(theta), 1e-14);
  }
  EXPECT_NEAR(rod.frames.by_unknown_after(1).dot(x), curvature, 1e-14);
}

TEST(PlanarFrames, HaveTheAdjointOfTheirJacobian) {
  PlacedFrames rod(std::nullopt);
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(2 * plane_terms + 1, -1, 2);
  rod.frames.evaluate(x, rod.tangents, rod.state);
  Eigen::MatrixX3d nodes = Eigen::MatrixX3d::Zero(rod.tangents.rows(), 3);
  nodes.col(0).setLinSpaced(-1, 3);
  nodes.col(1).setLinSpaced(2, 0);
  rod.frames.adjoint(nodes, rod.state);
  const auto jacobian = rod.frames.tangent_jacobian(rod.state);
  const Eigen::VectorXd expected =
      jacobian[0].transpose() * nodes.col(0) + jacobian[1].transpose() * nodes.col(1);
  EXPECT_LT((rod.state.by_unknown - expected).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(PlanarFrames, AreFittedToTheirOwnTangents) {
  for (const std::optional<double> start : {std::optional<double>(0.5), std::optional<double>()}) {
    PlacedFrames rod(start);
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(rod.frames.by_unknown().cols(), 1, 0.2);
    rod.frames.evaluate(x, rod.tangents, rod.state);
    const Eigen::Matrix3Xd tangents = rod.tangents.transpose();
    EXPECT_LT((rod.frames.fit(rod.frames.angles(tangents)) - x).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(PlanarFrames, AreHeldByTheFewestTurns) {
  const PlacedFrames rod(3);
  // -3 is 2 pi - 3 = 3.28 too, which is nearer to 3.
  EXPECT_NEAR(rod.frames.angle_towards({std::cos(3.), -std::sin(3.), 0}, 1), 2 * std::acos(-1.) - 3,
              1e-14);
}

}  // namespace
}  // namespace dlo::energy_model
