#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "base/deadline.hpp"
#include "dlo/obstacle/body.hpp"
#include "touching/surface_flow.hpp"

namespace dlo::energy_model {

/// Where something acts on a rod or a contact begins or ends. Units: l, EI/l^2.
struct ChainStation {
  double s = 0;
  bool moves = false;                        ///< s is unknown
  std::optional<Eigen::Vector3d> position;   ///< of a grip
  std::optional<Eigen::Vector3d> direction;  ///< of a clamp, unit
  std::optional<std::size_t> grip;           ///< in Problem::grips
  Eigen::Vector3d load = Eigen::Vector3d::Zero();
  std::optional<obstacle::Body> touched;  ///< at this point alone
  double force = 0;                       ///< of it, along its normal
};

/// What is between two stations.
struct ChainPiece {
  std::optional<Surface> surface;        ///< on which it lies; of a free piece none
  std::vector<FlowState<double>> nodes;  ///< where its arcs begin, which share it in equal parts
};

/// A rod in contact by multiple shooting. At a lift-off gap, slope and curvature are those of the
/// surface, which may push with a concentrated force there; at a point that is touched gap and
/// slope vanish, at a tip the gap.
struct ContactChain {
  Eigen::Vector3d weight = Eigen::Vector3d::Zero();
  std::vector<ChainStation> stations;  ///< by growing s, the first at 0, the last at 1
  std::vector<ChainPiece> pieces;      ///< one less
  double residual = 1;                 ///< largest of what the equations miss
  double step = 1;                     ///< largest component of Newton's last step
  int shots = 0;                       ///< of all arcs

  [[nodiscard]] double length(std::size_t piece) const {
    return stations[piece + 1].s - stations[piece].s;
  }
  /// Before a station that is not the first.
  [[nodiscard]] FlowState<double> before(std::size_t station) const;
  /// At s within a piece.
  [[nodiscard]] FlowState<double> at(std::size_t piece, double s) const;
};

/// Closes the chain by Newton's method, each step the least squares' solution: equations that say
/// one thing twice, as where a clamp holds the rod on what it lies on, do no harm.
/// @return whether the residual came below 1e-9 and the last step below 1e-8
[[nodiscard]] bool close_chain(ContactChain& chain, const Deadline& deadline);

}  // namespace dlo::energy_model
