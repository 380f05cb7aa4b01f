#include "touching/contact_chain.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <Eigen/SparseQR>
#include <algorithm>
#include <cmath>

namespace dlo::energy_model {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;
using Block = Eigen::Matrix<double, Eigen::Dynamic, 12>;

constexpr int most_chain_steps = 30;
constexpr double closed_chain = 1e-9;       // of forces, in EI/l^2 over 1 + the largest one
constexpr double last_step = 1e-8;          // in l, of positions and stations
constexpr double longest_share = 0.3;       // of a piece, by which a station beside it moves
constexpr double smallest_part = 1.0 / 64;  // of a Newton step
constexpr Eigen::Index state = 12;

/// Where the unknowns of a chain stand.
struct Layout {
  std::vector<Eigen::Index> place;  // of stations that move; -1: none
  std::vector<Eigen::Index> force;  // of stations that are pushed; -1: none
  std::vector<Eigen::Index> nodes;  // of a piece's first one
  Eigen::Index size = 0;
};

bool lies_before(const ContactChain& chain, std::size_t j) {
  return j > 0 && chain.pieces[j - 1].surface;
}

bool lies_after(const ContactChain& chain, std::size_t j) {
  return j < chain.pieces.size() && chain.pieces[j].surface;
}

Layout layout_of(const ContactChain& chain) {
  Layout layout;
  for (std::size_t j = 0; j < chain.stations.size(); ++j) {
    const ChainStation& station = chain.stations[j];
    const bool pushed = station.touched || lies_before(chain, j) || lies_after(chain, j);
    layout.place.push_back(station.moves ? layout.size++ : -1);
    layout.force.push_back(pushed && !station.grip ? layout.size++ : -1);
    if (j == chain.pieces.size()) break;
    layout.nodes.push_back(layout.size);
    layout.size += state * static_cast<Eigen::Index>(chain.pieces[j].nodes.size());
  }
  return layout;
}

/// Equations at a station: what they miss and their derivatives by the cross-sections before and
/// after it and by its force.
struct Join {
  Eigen::VectorXd missed = Eigen::VectorXd(0);
  Block by_before = Block(0, state);
  Block by_after = Block(0, state);
  Eigen::VectorXd by_force = Eigen::VectorXd(0);

  /// So many equations, all derivatives zero so far. @return the first one's row
  Eigen::Index add(const Eigen::Ref<const Eigen::VectorXd>& values) {
    const Eigen::Index row = missed.size();
    const Eigen::Index rows = row + values.size();
    missed.conservativeResize(rows);
    missed.tail(values.size()) = values;
    for (Block* block : {&by_before, &by_after}) {
      block->conservativeResize(rows, state);
      block->bottomRows(values.size()).setZero();
    }
    by_force.conservativeResize(rows);
    by_force.tail(values.size()).setZero();
    return row;
  }
};

/// Gap, normal and the normal's derivative at a point.
obstacle::Gap gap_at(const ContactChain& chain, std::size_t j, const Eigen::Vector3d& r) {
  if (chain.stations[j].touched) return chain.stations[j].touched->gap(r);
  const Surface& surface =
      lies_after(chain, j) ? *chain.pieces[j].surface : *chain.pieces[j - 1].surface;
  obstacle::Gap gap;
  gap.value = surface.gap(r);
  gap.gradient = surface.outward(r);
  if (surface.bend() > 0) {
    gap.hessian =
        (surface.across - gap.gradient * gap.gradient.transpose()) / (surface.radius + gap.value);
  }
  return gap;
}

/// A component of the cross-section has a value: position 0, tangent 3, curvature 6.
void hold(Join& join, Block Join::*side, const FlowState<double>& at, Eigen::Index component,
          const Eigen::Vector3d& value) {
  const Eigen::Index row = join.add(at.segment<3>(component) - value);
  (join.*side).block<3, 3>(row, component).setIdentity();
}

void stays(Join& join, const FlowState<double>& before, const FlowState<double>& after,
           Eigen::Index component) {
  const Eigen::Index row = join.add(after.segment<3>(component) - before.segment<3>(component));
  join.by_after.block<3, 3>(row, component).setIdentity();
  join.by_before.block<3, 3>(row, component) = -Eigen::Matrix3d::Identity();
}

void across_tangent(Join& join, const FlowState<double>& after) {
  const Eigen::Vector3d t = after.segment<3>(3);
  const Eigen::Vector3d v = after.segment<3>(6);
  const Eigen::Index row = join.add(Eigen::VectorXd::Constant(1, v.dot(t)));
  join.by_after.block<1, 3>(row, 3) = v.transpose();
  join.by_after.block<1, 3>(row, 6) = t.transpose();
}

/// On a surface, along it, bent as it is, with the force that keeps the rod there.
void lies(Join& join, const Surface& surface, const FlowState<double>& after) {
  const Eigen::Vector3d r = after.head<3>();
  const Eigen::Vector3d t = after.segment<3>(3);
  const Eigen::Vector3d v = after.segment<3>(6);
  const Eigen::Vector3d n = after.segment<3>(9);
  const double bend = surface.bend();
  const bool is_flat = bend == 0;
  const Eigen::Vector3d N =
      is_flat ? surface.normal : Eigen::Vector3d(bend * (surface.across * (r - surface.centre)));
  const Eigen::Matrix3d by_r = bend * surface.across;
  const Eigen::Vector3d across_t = by_r * t;
  const Eigen::Vector3d across_v = by_r * v;
  const Eigen::Vector4d values(surface.gap(r), N.dot(t), N.dot(v) + t.dot(across_t),
                               N.dot(n) - 3 * t.dot(across_v));
  const Eigen::Index row = join.add(values);
  Block& by = join.by_after;
  by.block<1, 3>(row, 0) = surface.outward(r).transpose();
  by.block<1, 3>(row + 1, 0) = across_t.transpose();
  by.block<1, 3>(row + 1, 3) = N.transpose();
  by.block<1, 3>(row + 2, 0) = across_v.transpose();
  by.block<1, 3>(row + 2, 3) = 2 * across_t.transpose();
  by.block<1, 3>(row + 2, 6) = N.transpose();
  by.block<1, 3>(row + 3, 0) = (by_r * n).transpose();
  by.block<1, 3>(row + 3, 3) = -3 * across_v.transpose();
  by.block<1, 3>(row + 3, 6) = -3 * across_t.transpose();
  by.block<1, 3>(row + 3, 9) = N.transpose();
}

/// n falls by what acts at a station; nothing is beyond the rod's ends.
void falls(Join& join, const ContactChain& chain, std::size_t j, const FlowState<double>* before,
           const FlowState<double>* after, bool pushed) {
  const ChainStation& station = chain.stations[j];
  Eigen::Vector3d missed = station.load;
  if (before != nullptr) missed -= before->segment<3>(9);
  if (after != nullptr) missed += after->segment<3>(9);
  obstacle::Gap gap;
  if (pushed) {
    gap = gap_at(chain, j, before != nullptr ? before->head<3>() : after->head<3>());
    missed += station.force * gap.gradient;
  }
  const Eigen::Index row = join.add(missed);
  if (before != nullptr) join.by_before.block<3, 3>(row, 9) = -Eigen::Matrix3d::Identity();
  if (after != nullptr) join.by_after.block<3, 3>(row, 9).setIdentity();
  if (!pushed) return;
  join.by_force.segment<3>(row) = gap.gradient;
  (before != nullptr ? join.by_before : join.by_after).block<3, 3>(row, 0) =
      station.force * gap.hessian;
}

/// @param before, after  null beyond the rod's ends
Join join_at(const ContactChain& chain, std::size_t j, const FlowState<double>* before,
             const FlowState<double>* after, bool pushed) {
  const ChainStation& station = chain.stations[j];
  const bool inside = before != nullptr && after != nullptr;
  const FlowState<double>& here = before != nullptr ? *before : *after;
  Block Join::*side = before != nullptr ? &Join::by_before : &Join::by_after;
  Join join;
  if (inside) {
    stays(join, here, *after, 0);
    stays(join, here, *after, 3);
    if (!station.direction) stays(join, here, *after, 6);
  } else if (!station.direction) {
    hold(join, side, here, 6, Eigen::Vector3d::Zero());
  }
  if (before == nullptr) {
    const Eigen::Vector3d t = after->segment<3>(3);
    const Eigen::Index row = join.add(Eigen::VectorXd::Constant(1, (t.squaredNorm() - 1) / 2));
    join.by_after.block<1, 3>(row, 3) = t.transpose();
  }
  if (after != nullptr && (before == nullptr || station.direction)) across_tangent(join, *after);
  if (station.position) hold(join, side, here, 0, *station.position);
  if (station.direction) hold(join, side, here, 3, *station.direction);
  if (!station.grip) falls(join, chain, j, before, after, pushed);
  if (station.touched) {
    const obstacle::Gap gap = station.touched->gap(here.head<3>());
    const Eigen::Vector3d t = here.segment<3>(3);
    Eigen::Index row = join.add(Eigen::VectorXd::Constant(1, gap.value));
    (join.*side).block<1, 3>(row, 0) = gap.gradient.transpose();
    if (inside) {
      row = join.add(Eigen::VectorXd::Constant(1, gap.gradient.dot(t)));
      (join.*side).block<1, 3>(row, 0) = (gap.hessian * t).transpose();
      (join.*side).block<1, 3>(row, 3) = gap.gradient.transpose();
    }
  }
  if (after != nullptr && lies_after(chain, j)) lies(join, *chain.pieces[j].surface, *after);
  return join;
}

/// What all equations miss and their derivatives.
struct ChainSystem {
  Eigen::VectorXd missed;
  Triplets derivatives;
};

void put(Triplets& triplets, Eigen::Index row, Eigen::Index column,
         const Eigen::Ref<const Eigen::MatrixXd>& block) {
  if (column < 0) return;
  for (Eigen::Index c = 0; c < block.cols(); ++c) {
    for (Eigen::Index r = 0; r < block.rows(); ++r) {
      if (block(r, c) == 0) continue;
      triplets.emplace_back(static_cast<int>(row + r), static_cast<int>(column + c), block(r, c));
    }
  }
}

ChainSystem chain_system(const ContactChain& chain, const Layout& layout, bool differentiate) {
  ChainSystem system;
  std::vector<double> missed;
  const auto add = [&](std::size_t j, const Join& join, Eigen::Index after) {
    const auto row = static_cast<Eigen::Index>(missed.size());
    missed.insert(missed.end(), join.missed.begin(), join.missed.end());
    if (!differentiate) return row;
    if (after >= 0) put(system.derivatives, row, after, join.by_after);
    put(system.derivatives, row, layout.force[j], join.by_force);
    return row;
  };
  add(0, join_at(chain, 0, nullptr, chain.pieces[0].nodes.data(), layout.force[0] >= 0),
      layout.nodes[0]);
  for (std::size_t p = 0; p < chain.pieces.size(); ++p) {
    const ChainPiece& piece = chain.pieces[p];
    const auto arcs = static_cast<double>(piece.nodes.size());
    const double length = chain.length(p) / arcs;
    for (std::size_t a = 0; a < piece.nodes.size(); ++a) {
      const FlowState<double> end = flow(piece.surface, chain.weight, length, piece.nodes[a]);
      const bool last = a + 1 == piece.nodes.size();
      const bool ends = last && p + 1 == chain.pieces.size();
      const FlowState<double>* next = nullptr;
      if (!ends) next = last ? chain.pieces[p + 1].nodes.data() : &piece.nodes[a + 1];
      const Eigen::Index here = layout.nodes[p] + state * static_cast<Eigen::Index>(a);
      Eigen::Index after = here + state;
      Join join;
      if (last) {
        join = join_at(chain, p + 1, &end, next, layout.force[p + 1] >= 0);
        after = ends ? -1 : layout.nodes[p + 1];
      } else {
        for (const Eigen::Index component : {0, 3, 6, 9}) stays(join, end, *next, component);
        join.by_force.setZero();
      }
      Eigen::Index row = 0;
      if (last) {
        row = add(p + 1, join, after);
      } else {
        row = static_cast<Eigen::Index>(missed.size());
        missed.insert(missed.end(), join.missed.begin(), join.missed.end());
        if (differentiate) put(system.derivatives, row, after, join.by_after);
      }
      if (!differentiate) continue;
      put(system.derivatives, row, here,
          join.by_before * transition(piece.surface, chain.weight, length, piece.nodes[a]));
      const Eigen::VectorXd by_length =
          join.by_before * rate_of(piece.surface, chain.weight, end) / arcs;
      put(system.derivatives, row, layout.place[p + 1], by_length);
      put(system.derivatives, row, layout.place[p], -by_length);
    }
  }
  system.missed =
      Eigen::Map<const Eigen::VectorXd>(missed.data(), static_cast<Eigen::Index>(missed.size()));
  return system;
}

void move(ContactChain& chain, const Layout& layout, const Eigen::VectorXd& step) {
  for (std::size_t j = 0; j < chain.stations.size(); ++j) {
    if (layout.place[j] >= 0) chain.stations[j].s += step[layout.place[j]];
    if (layout.force[j] >= 0) chain.stations[j].force += step[layout.force[j]];
    if (j == chain.pieces.size()) break;
    Eigen::Index at = layout.nodes[j];
    for (FlowState<double>& node : chain.pieces[j].nodes) {
      node += step.segment<state>(at);
      at += state;
    }
  }
}

/// How much of a step leaves the stations in their order.
double allowed_part(const ContactChain& chain, const Layout& layout, const Eigen::VectorXd& step) {
  double part = 1;
  for (std::size_t p = 0; p < chain.pieces.size(); ++p) {
    for (const std::size_t j : {p, p + 1}) {
      if (layout.place[j] < 0) continue;
      const double way = std::abs(step[layout.place[j]]);
      if (way > 0) part = std::min(part, longest_share * chain.length(p) / way);
    }
  }
  return part;
}

/// Largest change of a position, tangent or arc length, which forces follow.
double length_of(const ContactChain& chain, const Layout& layout, const Eigen::VectorXd& step) {
  double length = 0;
  for (std::size_t j = 0; j < chain.stations.size(); ++j) {
    if (layout.place[j] >= 0) length = std::max(length, std::abs(step[layout.place[j]]));
    if (j == chain.pieces.size()) break;
    for (std::size_t a = 0; a < chain.pieces[j].nodes.size(); ++a) {
      const Eigen::Index at = layout.nodes[j] + state * static_cast<Eigen::Index>(a);
      length = std::max(length, step.segment<6>(at).lpNorm<Eigen::Infinity>());
    }
  }
  return length;
}

double largest_force(const ContactChain& chain) {
  double force = 1 + chain.weight.norm();
  for (const ChainPiece& piece : chain.pieces) {
    for (const FlowState<double>& node : piece.nodes) {
      force = std::max(force, node.tail<3>().norm());
    }
  }
  return force;
}

}  // namespace

FlowState<double> ContactChain::before(std::size_t station) const {
  return at(station - 1, stations[station].s);
}

FlowState<double> ContactChain::at(std::size_t piece, double s) const {
  const std::vector<FlowState<double>>& nodes = pieces[piece].nodes;
  const auto arcs = static_cast<double>(nodes.size());
  const double from = s - stations[piece].s;
  const double arc = std::clamp(std::floor(from / length(piece) * arcs), 0.0, arcs - 1);
  return flow(pieces[piece].surface, weight, from - length(piece) * arc / arcs,
              nodes[static_cast<std::size_t>(arc)]);
}

bool close_chain(ContactChain& chain, const Deadline& deadline) {
  const Layout layout = layout_of(chain);
  for (int steps = 0; steps < most_chain_steps && !deadline.passed(); ++steps) {
    const ChainSystem system = chain_system(chain, layout, true);
    ++chain.shots;
    const double missed = system.missed.norm();
    chain.residual = missed / largest_force(chain);
    Eigen::SparseMatrix<double> matrix(system.missed.size(), layout.size);
    matrix.setFromTriplets(system.derivatives.begin(), system.derivatives.end());
    matrix.makeCompressed();
    const Eigen::SparseQR<Eigen::SparseMatrix<double>, Eigen::COLAMDOrdering<int>> solver(matrix);
    if (solver.info() != Eigen::Success) return false;
    const Eigen::VectorXd step = -solver.solve(system.missed);
    if (!step.allFinite()) return false;
    chain.step = length_of(chain, layout, step);
    if (chain.residual < closed_chain && chain.step < last_step) {
      move(chain, layout, step);
      return true;
    }
    double part = allowed_part(chain, layout, step);
    bool moved = false;
    for (; part > smallest_part; part /= 2) {
      ContactChain trial = chain;
      move(trial, layout, part * step);
      ++trial.shots;
      if (!(chain_system(trial, layout, false).missed.norm() < (1 - part / 4) * missed)) continue;
      chain = std::move(trial);
      moved = true;
      break;
    }
    if (!moved) return false;
  }
  return false;
}

}  // namespace dlo::energy_model
