#include "touching/chain_stability.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/QR>

namespace dlo::energy_model {
namespace {

constexpr Eigen::Index elements_per_arc = 8;
constexpr double same_row = 1e-9;  // of constraints, over the largest one

/// Nodes of the elements: cross-sections, and two directions across the tangent that are eta's.
struct Grid {
  std::vector<double> s;
  std::vector<FlowState<double>> states;
  std::vector<std::size_t> piece;              // of the element behind each node
  std::vector<Eigen::Index> station;           // node of each
  std::vector<Eigen::Matrix<double, 3, 2>> e;  // across t
};

Grid grid_of(const ContactChain& chain) {
  Grid grid;
  const auto add = [&](double s, std::size_t piece, const FlowState<double>& state) {
    grid.s.push_back(s);
    grid.piece.push_back(piece);
    grid.states.push_back(state);
    Eigen::Matrix<double, 3, 2> e;
    const Eigen::Vector3d t = state.segment<3>(3).normalized();
    e.col(0) = grid.e.empty()
                   ? t.unitOrthogonal()
                   : Eigen::Vector3d(grid.e.back().col(0) - grid.e.back().col(0).dot(t) * t);
    e.col(0).normalize();
    e.col(1) = t.cross(e.col(0));
    grid.e.push_back(e);
  };
  for (std::size_t p = 0; p < chain.pieces.size(); ++p) {
    const auto count = elements_per_arc * static_cast<Eigen::Index>(chain.pieces[p].nodes.size());
    grid.station.push_back(static_cast<Eigen::Index>(grid.s.size()));
    for (Eigen::Index k = 0; k < count; ++k) {
      const double s = chain.stations[p].s +
                       chain.length(p) * static_cast<double>(k) / static_cast<double>(count);
      add(s, p, chain.at(p, s));
    }
  }
  grid.station.push_back(static_cast<Eigen::Index>(grid.s.size()));
  add(1, chain.pieces.size() - 1, chain.before(chain.pieces.size()));
  return grid;
}

/// The second variation and its norm by eta's components, and what has to vanish.
class SecondVariationOfChain {
 public:
  explicit SecondVariationOfChain(const ContactChain& chain)
      : chain_(chain), grid_(grid_of(chain)), size_(2 * static_cast<Eigen::Index>(grid_.s.size())) {
    second_ = norm_ = Eigen::MatrixXd::Zero(size_, size_);
    bend();
    place();
    lie();
    hold();
  }

  [[nodiscard]] bool positive(double margin) const {
    Eigen::MatrixXd fixed(size_, static_cast<Eigen::Index>(rows_.size()));
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      fixed.col(static_cast<Eigen::Index>(k)) = rows_[k].transpose();
    }
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(fixed);
    qr.setThreshold(same_row);
    Eigen::MatrixXd free = second_ - margin * norm_;
    if (!rows_.empty()) {
      const Eigen::Index left = size_ - qr.rank();
      free.applyOnTheLeft(qr.householderQ().transpose());
      free.applyOnTheRight(qr.householderQ());
      free = free.bottomRightCorner(left, left).eval();
    }
    return Eigen::LLT<Eigen::MatrixXd>(free).info() == Eigen::Success;
  }

 private:
  [[nodiscard]] Eigen::Index count() const { return static_cast<Eigen::Index>(grid_.s.size()); }
  [[nodiscard]] const FlowState<double>& state(Eigen::Index i) const {
    return grid_.states[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] const Eigen::Matrix<double, 3, 2>& across(Eigen::Index i) const {
    return grid_.e[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] double width(Eigen::Index i) const {
    return grid_.s[static_cast<std::size_t>(i) + 1] - grid_.s[static_cast<std::size_t>(i)];
  }

  void bend() {
    for (Eigen::Index i = 0; i + 1 < count(); ++i) {
      const double h = width(i);
      Eigen::Matrix<double, 3, 4> turn;
      turn << -across(i), across(i + 1);
      second_.block<4, 4>(2 * i, 2 * i) += turn.transpose() * turn / h;
      norm_.block<4, 4>(2 * i, 2 * i) += turn.transpose() * turn / h;
      const std::size_t p = grid_.piece[static_cast<std::size_t>(i)];
      const FlowState<double> middle = chain_.at(p, grid_.s[static_cast<std::size_t>(i)] + h / 2);
      const double pull =
          middle.tail<3>().dot(middle.segment<3>(3)) - middle.segment<3>(6).squaredNorm();
      turn.leftCols<2>() *= -1;
      Eigen::Matrix4d mass = turn.transpose() * turn * h / 6;
      mass.topLeftCorner<2, 2>() *= 2;
      mass.bottomRightCorner<2, 2>() *= 2;
      second_.block<4, 4>(2 * i, 2 * i) += pull * mass;
      norm_.block<4, 4>(2 * i, 2 * i) += mass;
    }
  }

  /// dr at the nodes by eta's components.
  void place() {
    Eigen::Matrix3Xd at = Eigen::Matrix3Xd::Zero(3, size_);
    for (Eigen::Index i = 0; i < count(); ++i) {
      moved_.push_back(at);
      if (i + 1 == count()) break;
      at.middleCols<2>(2 * i) += width(i) / 2 * across(i);
      at.middleCols<2>(2 * i + 2) += width(i) / 2 * across(i + 1);
    }
    // The first point is held, or else it moves as the rod does: three unknowns more.
    if (chain_.stations.front().grip) return;
    size_ += 3;
    for (Eigen::Matrix3Xd& moved : moved_) {
      moved.conservativeResize(3, size_);
      moved.rightCols<3>().setIdentity();
    }
    for (Eigen::MatrixXd* matrix : {&second_, &norm_}) {
      matrix->conservativeResize(size_, size_);
      matrix->rightCols<3>().setZero();
      matrix->bottomRows<3>().setZero();
    }
    norm_.bottomRightCorner<3, 3>().setIdentity();
  }

  /// Bends with the surface: minus a force times dr.(H dr), and N.dr = 0.
  void press(Eigen::Index i, const Eigen::Vector3d& N, const Eigen::Matrix3d& H, double force) {
    const Eigen::Matrix3Xd& dr = moved_[static_cast<std::size_t>(i)];
    if (!H.isZero(0)) second_ -= force * dr.transpose() * (H * dr);
    rows_.emplace_back(N.transpose() * dr);
  }

  void lie() {
    for (std::size_t p = 0; p < chain_.pieces.size(); ++p) {
      if (!chain_.pieces[p].surface) continue;
      const Surface& surface = *chain_.pieces[p].surface;
      for (Eigen::Index i = grid_.station[p]; i <= grid_.station[p + 1]; ++i) {
        const Eigen::Vector3d N = surface.outward(state(i).head<3>());
        const Eigen::Matrix3d H =
            surface.bend() > 0
                ? Eigen::Matrix3d((surface.across - N * N.transpose()) * surface.bend())
                : Eigen::Matrix3d::Zero();
        double force = 0;
        if (i < grid_.station[p + 1]) force += width(i) / 2;
        if (i > grid_.station[p]) force += width(i - 1) / 2;
        FlowState<double> lying = state(i);
        if (i == grid_.station[p + 1]) lying = chain_.before(p + 1);
        force *= pressure(surface, chain_.weight, lying);
        if (i == grid_.station[p]) force += chain_.stations[p].force;
        if (i == grid_.station[p + 1]) force += chain_.stations[p + 1].force;
        press(i, N, H, force);
      }
    }
  }

  void hold() {
    for (std::size_t j = 0; j < chain_.stations.size(); ++j) {
      const ChainStation& station = chain_.stations[j];
      const Eigen::Index i = grid_.station[j];
      const Eigen::Matrix3Xd& dr = moved_[static_cast<std::size_t>(i)];
      if (station.position) {
        for (Eigen::Index k = 0; k < 3; ++k) rows_.emplace_back(dr.row(k));
      }
      Eigen::Matrix3Xd eta = Eigen::Matrix3Xd::Zero(3, size_);
      eta.middleCols<2>(2 * i) = across(i);
      if (station.direction) {
        for (Eigen::Index k = 0; k < 2; ++k) {
          rows_.emplace_back(Eigen::RowVectorXd::Unit(size_, 2 * i + k));
        }
      }
      if (!station.touched) continue;
      const obstacle::Gap gap = station.touched->gap(state(i).head<3>());
      press(i, gap.gradient, gap.hessian, station.force);
      if (!station.moves) continue;
      const Eigen::Vector3d t = state(i).segment<3>(3);
      const Eigen::RowVectorXd slope =
          gap.gradient.transpose() * eta + (gap.hessian * t).transpose() * dr;
      const double bend = gap.gradient.dot(state(i).segment<3>(6)) + t.dot(gap.hessian * t);
      second_ += station.force / bend * slope.transpose() * slope;
    }
  }

  const ContactChain& chain_;
  Grid grid_;
  Eigen::Index size_;
  Eigen::MatrixXd second_, norm_;
  std::vector<Eigen::Matrix3Xd> moved_;
  std::vector<Eigen::RowVectorXd> rows_;
};

}  // namespace

bool is_stable(const ContactChain& chain, double margin) {
  return SecondVariationOfChain(chain).positive(margin);
}

}  // namespace dlo::energy_model
