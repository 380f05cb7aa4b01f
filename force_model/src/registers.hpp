#pragma once

#include <cstddef>

#include "lanes.hpp"
#include "step_kernel.hpp"

namespace dlo::force_model::DLO_KERNEL {

/// Elements of a block as vector registers. The registers of a single rod (`stride` 1) contain
/// neighbouring points. Those of a vectorised batch (`stride` 8) contain the same point of several
/// rods, and a block has one column for each register that its eight rods fill.
template <int dimension, std::ptrdiff_t stride>
struct Registers {
  static constexpr std::ptrdiff_t columns = stride == 1 ? 1 : block_lanes / lane_count;
  /// Distance between consecutive registers of a column.
  static constexpr std::ptrdiff_t next = stride == 1 ? lane_count : block_lanes;

  using Vector = LaneVector<dimension>;
  PointBlock block;

  [[nodiscard]] Lanes load(int array, std::ptrdiff_t k) const {
    return read_lanes(block.first + array * block.pitch + k);
  }
  void store(int array, std::ptrdiff_t k, Lanes value) const {
    write_lanes(block.first + array * block.pitch + k, value);
  }
  [[nodiscard]] Vector load_vector(int array, std::ptrdiff_t k) const {
    Vector result;
    for (int i = 0; i < dimension; ++i) result.axis[i] = load(array + i, k);
    return result;
  }
  void store_vector(int array, std::ptrdiff_t k, const Vector& value) const {
    for (int i = 0; i < dimension; ++i) store(array + i, k, value.axis[i]);
  }

  /// Returns registers with a number of each rod in all lanes of that rod.
  static Lanes lanes_of_rods(const PerLane& values, std::ptrdiff_t column) {
    return stride == 1 ? all_lanes(values.lane[0]) : read_lanes(values.lane + column * lane_count);
  }
  /// Stores one number of each rod. For a single rod, `combine` reduces all lanes to one number; in
  /// a batch, each lane is the number of another rod.
  template <Lanes combine(Lanes, Lanes)>
  static void gather(Lanes a, std::ptrdiff_t column, PerLane& values) {
    if constexpr (stride == 1) {
      values.lane[0] = reduce<combine>(a);
    } else {
      write_lanes(values.lane + column * lane_count, a);
    }
  }

  /// Returns the elements of the points before those of a register, given the previous register.
  static Lanes before(Lanes previous, Lanes here) {
    return stride == 1 ? window<lane_count - 1>(previous, here) : previous;
  }
  /// Returns the elements of the points after those of a register, given the following register.
  static Lanes after(Lanes here, Lanes following) {
    return stride == 1 ? window<1>(here, following) : following;
  }
  static Vector before(Vector previous, const Vector& here) {
    for (int i = 0; i < dimension; ++i) previous.axis[i] = before(previous.axis[i], here.axis[i]);
    return previous;
  }
  static Vector after(Vector here, const Vector& following) {
    for (int i = 0; i < dimension; ++i) here.axis[i] = after(here.axis[i], following.axis[i]);
    return here;
  }
};

}  // namespace dlo::force_model::DLO_KERNEL
