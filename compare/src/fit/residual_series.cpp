#include "fit/residual_series.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace dlo::compare {
namespace {

/// Principal directions of points, that of their least extent first.
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> extents(const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3Xd centred = points.colwise() - points.rowwise().mean();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(centred * centred.transpose());
}

/// The directions in which a point's residual is seen, as columns.
std::vector<Eigen::Matrix3Xd> seen_directions(const Alignment& alignment, const Curve& curve,
                                              bool flat) {
  const std::vector<double>& s = alignment.shape.arc_length;
  const bool across = alignment.arc_lengths == ArcLengths::nearest;
  const Eigen::Matrix3d principal = extents(alignment.shape.points).eigenvectors();
  const Eigen::Vector3d out_of_plane = principal.col(0);
  std::vector<Eigen::Matrix3Xd> result;
  Eigen::Vector3d normal = out_of_plane;
  for (const double at : s) {
    if (!across) {
      result.emplace_back(flat ? Eigen::Matrix3Xd(principal.rightCols<2>())
                               : Eigen::Matrix3Xd(Eigen::Matrix3d::Identity()));
      continue;
    }
    const Eigen::Vector3d tangent = curve.tangent(at).normalized();
    if (flat) {
      result.emplace_back(out_of_plane.cross(tangent).normalized());
      continue;
    }
    // Carried along the rod without a rotation about it, so that neighbours look the same way.
    normal -= normal.dot(tangent) * tangent;
    if (!(normal.norm() > 1e-3)) normal = tangent.unitOrthogonal();
    normal.normalize();
    Eigen::Matrix3Xd both(3, 2);
    both << normal, tangent.cross(normal);
    result.push_back(std::move(both));
  }
  return result;
}

/// Derivatives of a point by the free coordinates of its motion.
Eigen::Matrix3Xd frame_derivatives(PoseFreedom pose, const Eigen::Vector3d& arm,
                                   const Eigen::Vector3d& up) {
  const Eigen::Matrix3d shift = Eigen::Matrix3d::Identity();
  if (pose == PoseFreedom::known) return shift.leftCols(0);
  if (pose == PoseFreedom::translation) return shift;
  const Eigen::Index turns = pose == PoseFreedom::upright ? 1 : 3;
  Eigen::Matrix3Xd result(3, 3 + turns);
  result.leftCols<3>() = shift;
  for (Eigen::Index k = 0; k < turns; ++k) {
    const Eigen::Vector3d axis =
        pose == PoseFreedom::upright ? up : Eigen::Vector3d(Eigen::Vector3d::Unit(k));
    result.col(3 + k) = axis.cross(arm);
  }
  return result;
}

}  // namespace

bool lies_in_a_plane(const Eigen::Matrix3Xd& points) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen = extents(points);
  return eigen.eigenvalues()[0] < 1e-15 * eigen.eigenvalues()[2];
}

std::vector<ResidualSeries> residual_series(const LaidShape& laid,
                                            const std::vector<Movement>& movements,
                                            Eigen::Index columns) {
  const std::vector<double>& s = laid.alignment.shape.arc_length;
  const Eigen::Matrix3Xd& points = laid.alignment.shape.points;
  const Eigen::Vector3d centre = points.rowwise().mean();
  const std::vector<Eigen::Matrix3Xd> directions =
      seen_directions(laid.alignment, laid.curve, laid.flat);
  std::vector<ResidualSeries> result(static_cast<std::size_t>(directions.front().cols()),
                                     {laid.index, s, Eigen::VectorXd::Zero(points.cols()),
                                      Eigen::MatrixXd::Zero(points.cols(), columns)});
  for (Eigen::Index row = 0; row < points.cols(); ++row) {
    const auto at = static_cast<std::size_t>(row);
    Eigen::Matrix3Xd derivatives = Eigen::Matrix3Xd::Zero(3, columns);
    const Eigen::Matrix3Xd of_frame =
        frame_derivatives(laid.pose, (points.col(row) - centre) / laid.curve.length(), laid.up);
    derivatives.middleCols(laid.first_of_frame, of_frame.cols()) = of_frame;
    for (const auto& [column, velocity] : movements) derivatives.col(column) = velocity.col(row);
    const Eigen::Vector3d gap = points.col(row) - laid.curve.point(s[at]);
    const Eigen::VectorXd values = directions[at].transpose() * gap;
    const Eigen::MatrixXd slopes = directions[at].transpose() * derivatives;
    for (std::size_t k = 0; k < result.size(); ++k) {
      result[k].residual[row] = values[static_cast<Eigen::Index>(k)];
      result[k].design.row(row) = slopes.row(static_cast<Eigen::Index>(k));
    }
  }
  return result;
}

}  // namespace dlo::compare
