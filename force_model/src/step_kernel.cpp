#include "step_kernel.hpp"

#include "lanes.hpp"

// Compiled once for each instruction set, DLO_KERNEL naming the namespace (see CMakeLists.txt). No
// header with inline functions of a library may come in here: of those the linker keeps one copy,
// perhaps one with instructions that the machine lacks.
//
// This is what total_forces and Formulas 7 to 20 say, arranged so that neighbours meet once. With
// s_k the segment from P_k to P_{k+1}, u_k its direction, a = |s_{k-1}|, b = |s_k| and c = u_{k-1}.
// u_k both bending laws have the form
//     on P_{k+1}: m_k (s_{k-1} - (s_{k-1}.u_k) u_k)   on P_{k-1}: -m_k (s_k - (s_k.u_{k-1})
//     u_{k-1}) hooke:  m_k = (2 EI/L) / (a b (1 + c)) = (2 EI/L) / (a b + s_{k-1}.s_k) (a) paper:
//     m_k = c_b (1 - c) / |s_{k-1} + s_k|                                               (b)
// so what acts through segment k, contraction and the joints at its ends, is one force
//     T_k = c_c (1/L_k - 1/|s_k|) s_k - (h - (h.u_k) u_k),   h = m_k s_{k-1} + m_{k+1} s_{k+1}  (c)
// on P_k and its opposite on P_{k+1}; the inner force of a point is T_k - T_{k-1}.

namespace dlo::force_model::DLO_KERNEL {
namespace {

/// cos(hooke_fold_angle): joints folded further are left to the plain implementation, and so are
/// those next to segments so short that a b is below `no_area` [m^2].
constexpr double fold_cosine = -0.98999249660044546;
constexpr double no_area = 1e-60;

Lanes load(PointBlock block, PointArray array, std::ptrdiff_t k) {
  return read_lanes(block.first + array * block.pitch + k);
}

void store(PointBlock block, PointArray array, std::ptrdiff_t k, Lanes value) {
  write_lanes(block.first + array * block.pitch + k, value);
}

/// Of one number per lane those that belong to element k.
Lanes load(const PerLane& values, std::ptrdiff_t k) {
  return read_lanes(values.lane + k % block_lanes);
}

/// Reads and writes the vectors of a block; `stride` elements lie between neighbours.
template <int dimension, std::ptrdiff_t stride>
struct Vectors {
  using Vector = LaneVector<dimension>;
  const PointBlock& block;

  Vector load(PointArray array, std::ptrdiff_t k) const {
    Vector result;
    for (int i = 0; i < dimension; ++i) {
      result.axis[i] = read_lanes(block.first + (array + i) * block.pitch + k);
    }
    return result;
  }
  void store(PointArray array, std::ptrdiff_t k, const Vector& value) const {
    for (int i = 0; i < dimension; ++i) {
      write_lanes(block.first + (array + i) * block.pitch + k, value.axis[i]);
    }
  }
  Vector segment(std::ptrdiff_t k) const {
    return load(positions, k + stride) - load(positions, k);
  }
};

/// A number per lane, gathered over all elements.
struct Gathered {
  Lanes part[block_lanes / lane_count] = {};

  Lanes& at(std::ptrdiff_t k) { return part[k % block_lanes / lane_count]; }
  void write(PerLane& to) const {
    for (int i = 0; i < block_lanes / lane_count; ++i) {
      write_lanes(to.lane + i * lane_count, part[i]);
    }
  }
};

template <int dimension>
void add_walls(PointBlock block, const WallLanes* walls, std::ptrdiff_t count) {
  const Vectors<dimension, 1> vectors{block};
  for (std::ptrdiff_t k = 0; k < block.size; k += lane_count) {
    const LaneVector<dimension> P = vectors.load(positions, k);
    LaneVector<dimension> F = vectors.load(loads, k);
    for (std::ptrdiff_t w = 0; w < count; ++w) {
      LaneVector<dimension> point;
      LaneVector<dimension> normal;
      for (int i = 0; i < dimension; ++i) {
        point.axis[i] = load(walls[w].point[i], k);
        normal.axis[i] = load(walls[w].normal[i], k);
      }
      const Lanes depth = max(dot(point - P, normal), Lanes{});
      F = F + (load(walls[w].stiffness, k) * depth) * normal;
    }
    vectors.store(external_forces, k, F);
  }
}

template <BendingLaw law, int dimension, std::ptrdiff_t stride>
void compute_forces(PointBlock block, PointArray applied, PerLane& regular) {
  using Vector = LaneVector<dimension>;
  const Vectors<dimension, stride> vectors{block};
  for (std::ptrdiff_t k = 0; k < block.size; k += lane_count) {
    const Vector s = vectors.segment(k);
    store(block, lengths, k, sqrt(dot(s, s)));
  }
  LaneMask good[block_lanes / lane_count];
  for (LaneMask& lanes : good) lanes = ~LaneMask{};
  for (std::ptrdiff_t k = 0; k < block.size; k += lane_count) {
    const Lanes a = load(block, lengths, k - stride);
    const Lanes b = load(block, lengths, k);
    const Lanes ab = a * b;
    const Lanes product =
        load(block, is_joint, k) * dot(vectors.segment(k - stride), vectors.segment(k));
    const Lanes opening = ab + product;  // a b (1 + c)
    good[k % block_lanes / lane_count] &= opening >= (1 + fold_cosine) * ab + no_area;
    // One division serves both 1/b and m.
    if constexpr (law == BendingLaw::hooke) {
      const Lanes inverse = 1 / (b * opening);
      store(block, inverse_lengths, k, opening * inverse);
      store(block, joint_factors, k, load(block, bend, k) * b * inverse);  // (a)
    } else {
      const Lanes chord = sqrt(a * a + b * b + 2 * product);
      const Lanes inverse = 1 / (ab * chord);
      store(block, inverse_lengths, k, a * chord * inverse);
      store(block, joint_factors, k, load(block, bend, k) * (ab - product) * inverse);  // (b)
    }
  }
  for (std::ptrdiff_t k = 0; k < block.size; k += lane_count) {
    const Vector s = vectors.segment(k);
    const Lanes inverse = load(block, inverse_lengths, k);
    const Lanes extension = load(block, lengths, k) - load(block, rest_lengths, k);
    const Vector h = load(block, joint_factors, k) * vectors.segment(k - stride) +
                     load(block, joint_factors, k + stride) * vectors.segment(k + stride);
    const Lanes along =
        load(block, stretch, k) * extension * inverse + dot(h, s) * inverse * inverse;
    vectors.store(segment_forces, k, along * s - h);  // (c)
  }
  for (std::ptrdiff_t k = 0; k < block.size; k += lane_count) {
    const Vector inner = vectors.load(segment_forces, k) - vectors.load(segment_forces, k - stride);
    vectors.store(forces, k, load(block, is_free, k) * (inner + vectors.load(applied, k)));  // (6)
  }
  for (int i = 0; i < block_lanes / lane_count; ++i) {
    write_lanes(regular.lane + i * lane_count, good[i] ? 1 - Lanes{} : Lanes{});
  }
}

template <bool relative, int dimension, std::ptrdiff_t stride>
void propose(PointBlock block, const PerLane& c_F, const PerLane& c_h, ProposedStep& step) {
  using Vector = LaneVector<dimension>;
  const Vectors<dimension, stride> vectors{block};
  Gathered largest;
  Gathered sum;
  Gathered oscillating;
  for (std::ptrdiff_t k = 0; k < block.size; k += lane_count) {
    const Lanes step_factor = load(c_F, k);
    const Lanes kept = load(c_h, k);
    const Vector last = vectors.load(movements, k);
    const Vector dP = step_factor * vectors.load(forces, k) + kept * last;  // (7), (19)
    vectors.store(proposals, k, dP);
    Lanes squared = dot(dP, dP);  // (16)
    if constexpr (relative) {
      const Vector difference = step_factor * vectors.load(forces, k + stride) +
                                kept * vectors.load(movements, k + stride) - dP;  // (18)
      squared = load(block, is_segment, k) * dot(difference, difference);
    }
    largest.at(k) = max(squared, largest.at(k));
    sum.at(k) += squared;
    const Lanes turns = dot(dP, last) < 0 ? load(block, turned_back, k) : Lanes{};
    oscillating.at(k) += turns;
  }
  largest.write(step.largest_squared);
  sum.write(step.sum_squared);
  oscillating.write(step.oscillating);
}

template <int dimension>
void move(PointBlock block, const PerLane& c_m) {
  using Vector = LaneVector<dimension>;
  const Vectors<dimension, 1> vectors{block};
  for (std::ptrdiff_t k = 0; k < block.size; k += lane_count) {
    const Lanes scale = load(c_m, k);
    const LaneMask moves = scale > 0;
    const Vector dP = vectors.load(proposals, k);
    const Vector last = vectors.load(movements, k);
    const Lanes turns = dot(dP, last) < 0 ? 1 - Lanes{} : Lanes{};
    store(block, turned_back, k, turns);
    Vector movement = scale * dP;
    for (int i = 0; i < dimension; ++i) {
      movement.axis[i] = moves ? movement.axis[i] : Lanes{};
    }
    vectors.store(movements, k, movement);
    vectors.store(positions, k, vectors.load(positions, k) + movement);
  }
}

template <BendingLaw law, int dimension, std::ptrdiff_t stride>
constexpr StepKernel kernel = {
    .add_walls = add_walls<dimension>,
    .compute_forces = compute_forces<law, dimension, stride>,
    .propose_relative = propose<true, dimension, stride>,
    .propose_absolute = propose<false, dimension, stride>,
    .move = move<dimension>,
};

template <BendingLaw law, int dimension>
const StepKernel& with_stride(std::ptrdiff_t stride) {
  return stride == 1 ? kernel<law, dimension, 1> : kernel<law, dimension, block_lanes>;
}

template <BendingLaw law>
const StepKernel& with_dimension(int dimension, std::ptrdiff_t stride) {
  return dimension == 2 ? with_stride<law, 2>(stride) : with_stride<law, 3>(stride);
}

}  // namespace

const StepKernel& step_kernel(BendingLaw law, int dimension, std::ptrdiff_t stride);

const StepKernel& step_kernel(BendingLaw law, int dimension, std::ptrdiff_t stride) {
  return law == BendingLaw::hooke ? with_dimension<BendingLaw::hooke>(dimension, stride)
                                  : with_dimension<BendingLaw::paper>(dimension, stride);
}

}  // namespace dlo::force_model::DLO_KERNEL
