#include "vibration/span_modes.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "base/require.hpp"

namespace dlo::energy_model {
namespace {

/// Returns an orthonormal basis of the null space of the constraints' Jacobian. Some constraints
/// may vanish to first order: the end of a straight rod cannot move along it.
Eigen::MatrixXd null_space_basis(const Eigen::MatrixXd& jacobian) {
  if (jacobian.rows() == 0) return Eigen::MatrixXd::Identity(jacobian.cols(), jacobian.cols());
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(1e-9);
  qr.compute(jacobian.transpose());
  const Eigen::MatrixXd Q = qr.householderQ();
  return Q.rightCols(jacobian.cols() - qr.rank());
}

/// Separates modes of equal frequency, which are determined only up to a rotation, by their
/// movement along the axis.
void separate_equal_frequencies(SpanModes& modes, const Eigen::MatrixXd& outside) {
  const Eigen::Index count = modes.lambdas.size();
  for (Eigen::Index begin = 0; begin < count;) {
    Eigen::Index end = begin + 1;
    while (end < count &&
           modes.lambdas[end] - modes.lambdas[begin] <= 1e-7 * std::abs(modes.lambdas[end])) {
      ++end;
    }
    if (end - begin > 1) {
      auto equal = modes.shapes.middleCols(begin, end - begin);
      const Eigen::MatrixXd of_equal = equal.transpose() * outside * equal;
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> turned(of_equal);
      equal = (equal * turned.eigenvectors()).eval();
    }
    begin = end;
  }
}

}  // namespace

SpanModes span_modes(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian,
                     const Eigen::MatrixXd& mass, const Eigen::MatrixXd& outside,
                     Eigen::Index count) {
  const Eigen::MatrixXd free = null_space_basis(jacobian);
  const Eigen::MatrixXd stiffness = free.transpose() * hessian * free;
  const Eigen::MatrixXd free_mass = free.transpose() * mass * free;
  // 1 / (lambda + shift) are the eigenvalues of M with respect to H + shift M, which has to be
  // positive definite; unstable shapes and rigid-body modes need a shift. The lowest modes are
  // computed most accurately.
  double shift = 1 / free_mass.trace();
  Eigen::LLT<Eigen::MatrixXd> factor;
  for (int i = 0; i < 40; ++i, shift *= 8) {
    factor.compute(stiffness + shift * free_mass);
    if (factor.info() == Eigen::Success) break;
  }
  SpanModes modes;
  if (factor.info() != Eigen::Success) return modes;
  Eigen::MatrixXd inverse = factor.matrixL().solve(free_mass);
  inverse = factor.matrixL().solve(inverse.transpose()).eval();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(inverse);
  const Eigen::VectorXd& values = solver.eigenvalues();  // ascending
  // Directions without inertia follow instantaneously and have no mode.
  Eigen::Index found = 0;
  const Eigen::Index size = values.size();
  while (found < std::min(count, size) && values[size - 1 - found] > 1e-13 * values[size - 1]) {
    ++found;
  }
  modes.lambdas = values.tail(found).reverse().cwiseInverse().array() - shift;
  const Eigen::MatrixXd turned = solver.eigenvectors().rightCols(found).rowwise().reverse();
  modes.shapes = free * factor.matrixU().solve(turned);
  for (Eigen::Index k = 0; k < found; ++k) {
    modes.shapes.col(k) *= std::sqrt(modes.lambdas[k] + shift);
  }
  separate_equal_frequencies(modes, outside);
  modes.outside = (modes.shapes.transpose() * outside * modes.shapes).diagonal();
  return modes;
}

double total_mass(const Problem& problem, const Inertia& inertia) {
  double mass = inertia.mass_per_length * problem.length;
  for (std::size_t i = 0; i < problem.sections.size(); ++i) {
    mass += (inertia.of_sections[i] - inertia.mass_per_length) *
            (problem.sections[i].end - problem.sections[i].begin);
  }
  for (const PointMass& point : inertia.point_masses) mass += point.mass;
  return mass;
}

std::vector<double> masses_per_length(const Problem& problem, const Inertia& inertia,
                                      const PlacedSpan& placed,
                                      const std::vector<Element>& elements) {
  std::vector<double> result(elements.size(), inertia.mass_per_length * problem.length);
  for (std::size_t i = 0; i < problem.sections.size(); ++i) {
    const double begin = placed.s_of(problem.sections[i].begin, problem.length);
    const double end = placed.s_of(problem.sections[i].end, problem.length);
    for (std::size_t e = 0; e < elements.size(); ++e) {
      const double middle = elements[e].begin + elements[e].length / 2;
      if ((begin < middle) == (middle < end)) result[e] = inertia.of_sections[i] * problem.length;
    }
  }
  return result;
}

Eigen::MatrixXd mass_matrix(const SpanPointOperator& reach, const Eigen::VectorXd& masses,
                            const Eigen::MatrixXd& tangents) {
  const Eigen::MatrixXd moved = masses.cwiseSqrt().asDiagonal() * reach.to_points(tangents);
  return moved.transpose() * moved;
}

void check(const Problem& problem, const Inertia& inertia, std::string_view function) {
  require_not_negative(function, "mass_per_length", inertia.mass_per_length);
  require(inertia.of_sections.size() == problem.sections.size(), function, "of_sections.size()",
          static_cast<double>(inertia.of_sections.size()), "the number of sections");
  for (const double mass : inertia.of_sections) {
    require_not_negative(function, "of_sections", mass);
  }
  for (const PointMass& point : inertia.point_masses) {
    require_not_negative(function, "point_masses", point.mass);
    require(point.at >= 0 && point.at <= problem.length, function, "arc length of a point mass",
            point.at, "on the rod");
  }
  const double total = total_mass(problem, inertia);
  require(total > 0, function, "mass of the rod and its point masses", total, "> 0");
}

}  // namespace dlo::energy_model
