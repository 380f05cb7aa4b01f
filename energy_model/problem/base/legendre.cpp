#include "base/legendre.hpp"

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <mutex>
#include <numbers>

#include "base/require.hpp"

namespace dlo::energy_model {
namespace {

/// Legendre polynomial P_n(x) and its derivative.
struct Polynomial {
  double value, slope;
};

Polynomial legendre_polynomial(Eigen::Index n, double x) {
  double previous = 1;
  double current = x;
  for (Eigen::Index k = 1; k < n; ++k) {
    const auto order = static_cast<double>(k);
    const double next = ((2 * order + 1) * x * current - order * previous) / (order + 1);
    previous = current;
    current = next;
  }
  return {current, static_cast<double>(n) * (x * current - previous) / (x * x - 1)};
}

/// Computes the Gauss-Legendre rule on [0, 1] by Newton's method. GSL's tables are accurate to
/// 1e-10 only for most sizes.
void gauss_legendre(Eigen::VectorXd& nodes, Eigen::VectorXd& weights) {
  const Eigen::Index n = nodes.size();
  for (Eigen::Index i = 0; i < n; ++i) {
    double x = -std::cos(std::numbers::pi * (static_cast<double>(i) + 0.75) /
                         (static_cast<double>(n) + 0.5));
    for (int step = 0; step < 6; ++step) {
      const Polynomial p = legendre_polynomial(n, x);
      x -= p.value / p.slope;
    }
    const double slope = legendre_polynomial(n, x).slope;
    nodes[i] = (1 + x) / 2;
    weights[i] = 1 / ((1 - x * x) * slope * slope);
  }
}

LegendreTable make_table(int terms, Eigen::Index Q) {
  LegendreTable table;
  table.nodes.resize(Q);
  table.weights.resize(Q);
  gauss_legendre(table.nodes, table.weights);
  table.values.resize(Q, Q);
  table.integrals.resize(Q, Q);
  Eigen::VectorXd values(Q);
  Eigen::VectorXd integrals(Q);
  for (Eigen::Index q = 0; q < Q; ++q) {
    legendre(table.nodes[q], values, integrals);
    table.values.row(q) = values;
    table.integrals.row(q) = integrals;
  }
  table.integration = table.integrals * table.values.transpose() * table.weights.asDiagonal();
  table.values_transposed = table.values.transpose();
  table.integration_transposed = table.integration.transpose();
  const Eigen::VectorXd root = table.weights.cwiseSqrt();
  Eigen::MatrixXd basis(Q, terms + 1);
  basis << root, root.asDiagonal() * table.integrals.leftCols(terms);
  table.fit = basis.householderQr().solve(Eigen::MatrixXd(root.asDiagonal()));
  return table;
}

/// Tables for each number of terms, computed at the first request.
class Tables {
 public:
  const LegendreTable& of(int terms, int nodes) {
    require(terms >= 1 && terms <= max_terms, "LegendreTable", "terms", terms, "1 to 128");
    const auto index = static_cast<std::size_t>(terms);
    std::call_once(made_[index], [&] { tables_[index] = make_table(terms, nodes); });
    return tables_[index];
  }

 private:
  std::array<LegendreTable, max_terms + 1> tables_;
  std::array<std::once_flag, max_terms + 1> made_;
};

}  // namespace

void legendre(double xi, Eigen::Ref<Eigen::VectorXd> values,
              Eigen::Ref<Eigen::VectorXd> integrals) {
  // P_{k+1} = ((2k+1) x P_k - k P_{k-1}) / (k+1); int P_k = (P_{k+1} - P_{k-1}) / (2k+1)
  const double x = 2 * xi - 1;
  double previous = 0;
  double current = 1;
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const auto order = static_cast<double>(k);
    const double next = ((2 * order + 1) * x * current - order * previous) / (order + 1);
    const double scale = std::sqrt(2 * order + 1);
    values[k] = scale * current;
    integrals[k] = k == 0 ? xi : (next - previous) / (2 * scale);
    previous = current;
    current = next;
  }
}

void legendre_slopes(double xi, Eigen::Ref<Eigen::VectorXd> slopes) {
  const double x = 2 * xi - 1;
  double before = 0;  // P_{k-1} and P_k
  double here = 1;
  double slope_before = 0;
  double slope = 0;
  for (Eigen::Index k = 0; k < slopes.size(); ++k) {
    const auto order = static_cast<double>(k);
    slopes[k] = 2 * std::sqrt(2 * order + 1) * slope;
    // P'_{k+1} = P'_{k-1} + (2 k + 1) P_k
    const double next = ((2 * order + 1) * x * here - order * before) / (order + 1);
    const double next_slope = slope_before + (2 * order + 1) * here;
    before = here;
    here = next;
    slope_before = slope;
    slope = next_slope;
  }
}

const LegendreTable& legendre_table(int terms) {
  static Tables tables;
  return tables.of(terms, terms + 6);
}

const LegendreTable& director_table(int terms) {
  static Tables tables;
  return tables.of(terms, 3 * terms / 2 + 8);
}

FittedAngle fit_angle(const LegendreTable& table, const std::vector<double>& turns,
                      const Eigen::VectorXd& angles, std::optional<double> start) {
  const Eigen::Index Q = table.nodes.size();
  const Eigen::Index K = table.fit.rows() - 1;
  const auto count = static_cast<Eigen::Index>(turns.size());
  // The angle is fitted on each element separately, with its value at the begin. The coefficient of
  // p_0 then makes neighbouring elements meet.
  Eigen::MatrixXd own(K + 1, count);
  for (Eigen::Index e = 0; e < count; ++e) {
    own.col(e).noalias() = table.fit * angles.segment(e * Q, Q);
  }
  const double end = own(0, count - 1) + own(1, count - 1);
  if (start) own(0, 0) = *start;
  FittedAngle fitted{own(0, 0), Eigen::VectorXd(K * count)};
  for (Eigen::Index e = 0; e < count; ++e) {
    own(1, e) = (e + 1 < count ? own(0, e + 1) : end) - own(0, e);
    fitted.coefficients.segment(e * K, K) = own.col(e).tail(K) / turns[static_cast<std::size_t>(e)];
  }
  return fitted;
}

}  // namespace dlo::energy_model
