#include "dlo/force_model/contraction.hpp"

#include "require.hpp"

namespace dlo::force_model {
namespace {

using Points = Eigen::Ref<const Eigen::Matrix3Xd>;

/// Returns the direction in which a segment of zero length is pushed apart.
Eigen::Vector3d neighbour_direction(const Points& points, Eigen::Index i) {
  const Eigen::Index before = std::max<Eigen::Index>(i - 1, 0);
  const Eigen::Index after = std::min<Eigen::Index>(i + 2, points.cols() - 1);
  const Eigen::Vector3d chord = points.col(after) - points.col(before);
  const double length = chord.norm();
  return length > 0 ? Eigen::Vector3d(chord / length) : Eigen::Vector3d::UnitX();
}

void require_arguments(const char* function, const Points& points,
                       const Eigen::Ref<const Eigen::VectorXd>& rest_lengths, double c_c) {
  require_polygon(function, points, rest_lengths);
  require_not_negative(function, "c_c", c_c);
}

}  // namespace

void add_contraction_forces(const Points& points,
                            const Eigen::Ref<const Eigen::VectorXd>& rest_lengths, double c_c,
                            Eigen::Ref<Eigen::Matrix3Xd> forces) {
  require_arguments("add_contraction_forces", points, rest_lengths, c_c);
  require(forces.cols() == points.cols(), "add_contraction_forces", "columns of forces",
          static_cast<double>(forces.cols()), "the number of points");
  for (Eigen::Index i = 0; i < rest_lengths.size(); ++i) {
    const Eigen::Vector3d segment = points.col(i + 1) - points.col(i);
    const double length = segment.norm();
    const Eigen::Vector3d direction =
        length > 0 ? Eigen::Vector3d(segment / length) : neighbour_direction(points, i);
    const Eigen::Vector3d F =
        c_c * (length - rest_lengths[i]) / rest_lengths[i] * direction;  // (1)
    forces.col(i) += F;                                                  // (2)
    forces.col(i + 1) -= F;
  }
}

double contraction_energy(const Points& points,
                          const Eigen::Ref<const Eigen::VectorXd>& rest_lengths, double c_c) {
  require_arguments("contraction_energy", points, rest_lengths, c_c);
  double energy = 0;
  for (Eigen::Index i = 0; i < rest_lengths.size(); ++i) {
    const double extension = (points.col(i + 1) - points.col(i)).norm() - rest_lengths[i];
    energy += c_c * extension * extension / (2 * rest_lengths[i]);
  }
  return energy;
}

}  // namespace dlo::force_model
