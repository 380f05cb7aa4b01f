#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "frames/rod_frames.hpp"

namespace dlo::energy_model {

/// Second derivatives of a function f of a rod's tangents and frames by the unknowns of RodFrames.
/// The members are buffers: only the first call allocates.
class FrameHessian {
 public:
  /// Adds the second derivatives to `hessian`, and computes state.ends as
  /// RodFrames::end_rotation_jacobian() does.
  /// @param f           gradient of the function, with its part by the nodes
  /// @param curvatures  second derivatives of f by rotations of the frame at each element's end;
  ///   not read if f.couples is empty
  /// @param state       of the last RodFrames::evaluate()
  void add(const RodFrames& frames, const FrameGradient& f,
           std::span<const Eigen::Matrix3d> curvatures, RodFrames::State& state,
           Eigen::Ref<Eigen::MatrixXd> hessian);

 private:
  void resize(const RodFrames& frames);
  [[nodiscard]] Eigen::Matrix3d gather_curvatures(const RodFrames& frames,
                                                  const RodFrames::Panel& panel,
                                                  const FrameGradient& f,
                                                  const RodFrames::State& state);
  void compute_rotation_rates(const RodFrames& frames, const RodFrames::Panel& panel,
                              const RodFrames::State& state);
  void pair_unknowns(const RodFrames::Panel& panel, Eigen::Index fields);
  void add_panel(const RodFrames& frames, const RodFrames::Panel& panel,
                 const Eigen::Matrix3d& later_curvature, const RodFrames::State& state,
                 Eigen::Ref<Eigen::MatrixXd> hessian);

  // Buffers of one panel. Rows of curvatures_ and later_curvatures_ are symmetric 3 x 3 matrices of
  // a node: xx, yy, zz, xy, xz, yz.
  Eigen::Matrix<double, Eigen::Dynamic, 6> curvatures_, later_curvatures_;
  std::array<Eigen::MatrixX3d, 3> adjoints_, turns_;  // one matrix per field
  Eigen::MatrixXd pairs_, by_node_, own_block_;
  // Buffers for the coupling with earlier panels.
  Eigen::MatrixXd earlier_coupling_;
  Eigen::Matrix3Xd beside_, turned_;
};

}  // namespace dlo::energy_model
