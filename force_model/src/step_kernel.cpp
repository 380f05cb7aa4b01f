#include "step_kernel.hpp"

#include "registers.hpp"

// Compiled once for each instruction set, DLO_KERNEL naming the namespace (see CMakeLists.txt).
// This file must not use inline functions of a library: the linker keeps one copy of such a
// function, possibly one with instructions that the machine lacks.
//
// It implements total_forces and Formulas 7 to 20, arranged so that each pair of neighbours is
// processed once. With s_k the segment from P_k to P_{k+1}, u_k its direction, a = |s_{k-1}|,
// b = |s_k| and c the cosine of the joint's angle, both bending laws have the form
//     on P_{k+1}:   m_k (s_{k-1} - (s_{k-1}.u_k) u_k)
//     on P_{k-1}:  -m_k (s_k - (s_k.u_{k-1}) u_{k-1})
//     hooke:  m_k = (2 EI/L) / (a b (1 + c))                      (a)
//     paper:  m_k = c_b (1 - c) / |s_{k-1} + s_k|                 (b)
// so what acts through segment k, contraction and the joints at its ends, is one force
//     T_k = c_c (1/L_k - 1/|s_k|) s_k - (h - (h.u_k) u_k)         (c)
//     h = m_k s_{k-1} + m_{k+1} s_{k+1}
// on P_k and its opposite on P_{k+1}; the inner force of a point is T_k - T_{k-1}. Joints that are
// bent at rest (hooke, in the plane z = 0) have constant couples C_k besides, against which a
// segment bears, with s turned to the left by a right angle,
//     T_k += (C_{k+1} - C_k) left(s_k) / |s_k|^2                  (d)
// and joints that bear a twisting moment M (hooke, in space) forces along their binormals
// (twist.hpp)
//     T_k += (w_k + w_{k+1}) / |s_k|                              (e)
//     w_k = M s_{k-1} x s_k / (a b (1 + c)) = M / (2 EI/L) m_k s_{k-1} x s_k

namespace dlo::force_model::DLO_KERNEL {
namespace {

/// cos(hooke_fold_angle), and the least a b (c - fold_cosine) [m^2]. If a joint is below this
/// limit, because it is folded further or next to a short segment, the plain implementation
/// computes all forces of the rod.
constexpr double fold_cosine = -0.98999249660044546;
constexpr double zero_area = 1e-60;

/// Segments k and the joints at P_k, where they begin.
template <int dimension>
struct Segments {
  LaneVector<dimension> s = {};
  LaneVector<dimension> s_before = {};
  Lanes length = all_lanes(1);
  Lanes inverse_length = all_lanes(1);
  Lanes m = {};
};

/// Moments of joints in addition to their bending law.
enum class AdditionalMoment { nothing, couples, twist };

inline LaneVector<3> cross(const LaneVector<3>& a, const LaneVector<3>& b) {
  return {{a.axis[1] * b.axis[2] - a.axis[2] * b.axis[1],
           a.axis[2] * b.axis[0] - a.axis[0] * b.axis[2],
           a.axis[0] * b.axis[1] - a.axis[1] * b.axis[0]}};
}

/// Rotates vectors of the plane z = 0 to the left by a right angle.
inline LaneVector<2> rotate_left(const LaneVector<2>& s) { return {{-s.axis[1], s.axis[0]}}; }

/// Adds the forces of these additional moments to the force through segment k.
template <AdditionalMoment extra, int dimension, std::ptrdiff_t stride>
void add_additional_moment(const Registers<dimension, stride>& all, std::ptrdiff_t k,
                           const Segments<dimension>& here, const Segments<dimension>& following,
                           LaneVector<dimension>& T) {
  using All = Registers<dimension, stride>;
  const Lanes inverse = here.inverse_length;
  if constexpr (extra == AdditionalMoment::couples) {
    const Lanes couple = all.load(natural, k + stride) - all.load(natural, k);
    T = T + (couple * inverse * inverse) * rotate_left(here.s);  // (d)
  }
  if constexpr (extra == AdditionalMoment::twist) {
    const Lanes M_here = all.load(twist_share, k) * here.m;
    const Lanes M_after = all.load(twist_share, k + stride) * All::after(here.m, following.m);
    T = T + inverse * (M_here * cross(here.s_before, here.s) +
                       M_after * cross(here.s, All::after(here.s, following.s)));  // (e)
  }
}

template <BendingLaw law, int dimension, std::ptrdiff_t stride, AdditionalMoment extra>
void compute_forces(const PointBlock& block, PointArray applied, PerLane& regular) {
  using All = Registers<dimension, stride>;
  using Vector = LaneVector<dimension>;
  const All all{block};
  for (std::ptrdiff_t column = 0; column < All::columns; ++column) {
    const std::ptrdiff_t first = column * lane_count;
    Vector P = all.load_vector(positions, first);
    Lanes good = all_lanes(1);
    const auto segments_at = [&](std::ptrdiff_t k, const Segments<dimension>& previous) {
      Segments<dimension> here;
      const Vector P_next = all.load_vector(positions, k + All::next);
      here.s = All::after(P, P_next) - P;
      P = P_next;
      here.s_before = All::before(previous.s, here.s);
      here.length = sqrt(dot(here.s, here.s));
      const Lanes a = All::before(previous.length, here.length);
      const Lanes ab = a * here.length;
      const Lanes product = all.load(is_joint, k) * dot(here.s_before, here.s);
      const Lanes opening = ab + product;  // a b (1 + c)
      good = opening >= (1 + fold_cosine) * ab + zero_area ? good : Lanes{};
      // One division gives both 1/b and m.
      if constexpr (law == BendingLaw::hooke) {
        const Lanes inverse = 1 / (here.length * opening);
        here.inverse_length = opening * inverse;
        here.m = all.load(bend, k) * (here.length * inverse);  // (a)
      } else {
        const Lanes chord = sqrt(a * a + here.length * here.length + 2 * product);
        const Lanes inverse = 1 / (ab * chord);
        here.inverse_length = a * chord * inverse;
        here.m = all.load(bend, k) * ((ab - product) * inverse);  // (b)
      }
      return here;
    };
    Segments<dimension> here = segments_at(first, {});
    Vector T_previous = {};
    for (std::ptrdiff_t k = first; k < block.size; k += All::next) {
      const bool last = k + All::next >= block.size;
      const Segments<dimension> following =
          last ? Segments<dimension>() : segments_at(k + All::next, here);
      const Lanes inverse = here.inverse_length;
      const Lanes tension =
          all.load(stretch, k) * (here.length - all.load(rest_lengths, k));  // (1)
      const Vector h = here.m * here.s_before +
                       All::after(here.m, following.m) * All::after(here.s, following.s);
      const Lanes along = (tension + dot(h, here.s) * inverse) * inverse;
      Vector T = along * here.s - h;  // (c)
      add_additional_moment<extra>(all, k, here, following, T);
      const Vector inner = T - All::before(T_previous, T);   // (2), (4)
      const Vector F = inner + all.load_vector(applied, k);  // (6)
      all.store_vector(forces, k, all.load(is_free, k) * F);
      T_previous = T;
      here = following;
    }
    All::template gather<min>(good, column, regular);
  }
}

/// Returns (16 M' + 4 M) / lever^2 of joints with the angle alpha, with ab = |s_{k-1}| |s_k|,
/// product = s_{k-1}.s_k = ab cos(alpha) and their mean rest length L. A joint next to a segment
/// without direction is treated as straight.
template <BendingLaw law>
Lanes joint_mode(Lanes stiffness, Lanes ab, Lanes product, Lanes L, Lanes lever) {
  const Lanes cosine = ab > zero_area ? product / ab : all_lanes(1);
  if constexpr (law == BendingLaw::hooke) {
    // M = k sin / (1 + cos), M' = k / (1 + cos) with k = 2 EI / L; M stays beyond the fold angle.
    const Lanes followed = max(cosine, all_lanes(fold_cosine));
    const Lanes opening = 1 + followed;
    const Lanes slope = cosine < fold_cosine ? Lanes{} : all_lanes(1);
    const Lanes sine = sqrt(max(1 - followed, Lanes{}) * opening);
    return stiffness * (16 * slope + 4 * sine) / (opening * lever * lever);
  } else {
    // M = 2 c_b L sin^3(alpha/2), M' = 3 c_b L sin^2(alpha/2) cos(alpha/2)
    const Lanes sine_squared = max(1 - cosine, Lanes{}) / 2;
    const Lanes half_cosine = sqrt(max(1 + cosine, Lanes{}) / 2);
    return stiffness * L * sine_squared * (48 * half_cosine + 8 * sqrt(sine_squared)) /
           (lever * lever);
  }
}

template <BendingLaw law, int dimension, std::ptrdiff_t stride, AdditionalMoment extra>
void measure_modes(const PointBlock& block, ModeMeasurement& measured) {
  using All = Registers<dimension, stride>;
  using Vector = LaneVector<dimension>;
  const All all{block};
  for (std::ptrdiff_t column = 0; column < All::columns; ++column) {
    const std::ptrdiff_t first = column * lane_count;
    Lanes contraction = {};
    Lanes bending = {};
    Lanes force_change = {};
    Lanes point_change = {};
    Vector P = all.load_vector(positions, first);
    Vector s_previous = {};
    Lanes length_previous = all_lanes(1);
    Lanes rest_previous = all_lanes(1);
    Lanes bounded_previous = all_lanes(1);
    for (std::ptrdiff_t k = first; k < block.size; k += All::next) {
      const Vector P_next = all.load_vector(positions, k + All::next);
      const Vector s = All::after(P, P_next) - P;
      const Lanes length = sqrt(dot(s, s));
      const Lanes rest = all.load(rest_lengths, k);
      const Lanes bounded = max(length, 0.1 * rest);
      contraction = max(4 * all.load(stretch, k) * rest / min(rest, bounded), contraction);
      const Lanes product = dot(All::before(s_previous, s), s);
      const Lanes mean = (All::before(rest_previous, rest) + rest) / 2;
      const Lanes lever = min(All::before(bounded_previous, bounded), bounded);
      Lanes joint = joint_mode<law>(
          all.load(bend, k), All::before(length_previous, length) * length, product, mean, lever);
      if constexpr (extra == AdditionalMoment::couples) {
        const Lanes couple = all.load(natural, k);
        joint += 4 * max(couple, -couple) / (lever * lever);
      }
      bending = max(all.load(is_joint, k) > 0 ? joint : Lanes{}, bending);

      const Vector F = all.load_vector(forces, k);
      const Vector dF = all.load_vector(last_forces, k) - F;
      const Vector dP = P - all.load_vector(last_positions, k);
      force_change += dot(dF, dP);
      point_change += dot(dP, dP);
      all.store_vector(last_forces, k, F);
      all.store_vector(last_positions, k, P);
      P = P_next;
      s_previous = s;
      length_previous = length;
      rest_previous = rest;
      bounded_previous = bounded;
    }
    All::template gather<max>(contraction, column, measured.contraction);
    All::template gather<max>(bending, column, measured.bending);
    All::template gather<sum>(force_change, column, measured.force_change);
    All::template gather<sum>(point_change, column, measured.point_change);
  }
}

template <int dimension, std::ptrdiff_t stride>
void add_walls(const PointBlock& block, const WallLanes* walls, std::ptrdiff_t count) {
  using All = Registers<dimension, stride>;
  using Vector = LaneVector<dimension>;
  const All all{block};
  for (std::ptrdiff_t column = 0; column < All::columns; ++column) {
    for (std::ptrdiff_t k = column * lane_count; k < block.size; k += All::next) {
      const Vector P = all.load_vector(positions, k);
      Vector F = all.load_vector(loads, k);
      for (const WallLanes* wall = walls; wall != walls + count; ++wall) {
        Vector point;
        Vector normal;
        for (int i = 0; i < dimension; ++i) {
          point.axis[i] = All::lanes_of_rods(wall->point[i], column);
          normal.axis[i] = All::lanes_of_rods(wall->normal[i], column);
        }
        const Lanes depth = max(dot(point - P, normal), Lanes{});
        F = F + (All::lanes_of_rods(wall->stiffness, column) * depth) * normal;
      }
      all.store_vector(external_forces, k, F);
    }
  }
}

template <bool relative, int dimension, std::ptrdiff_t stride>
void propose(const PointBlock& block, int turn, const PerLane& c_F, const PerLane& momentum_factor,
             const PerLane& rounding_squared, ProposedStep& step) {
  using All = Registers<dimension, stride>;
  using Vector = LaneVector<dimension>;
  const All all{block};
  const int proposed = proposals + 3 * turn;
  const int last_proposed = proposals + 3 * (1 - turn);
  for (std::ptrdiff_t column = 0; column < All::columns; ++column) {
    const Lanes per_force = All::lanes_of_rods(c_F, column);
    const Lanes per_movement = All::lanes_of_rods(momentum_factor, column);
    const Lanes rounding = All::lanes_of_rods(rounding_squared, column);
    Lanes largest = {};
    Lanes total = {};
    Lanes oscillating = {};
    const auto movement_at = [&](std::ptrdiff_t k, const Vector& last) {
      return per_force * all.load_vector(forces, k) + per_movement * last;  // (7), (19)
    };
    Vector last = all.load_vector(last_proposed, column * lane_count);
    Vector dP = movement_at(column * lane_count, last);
    for (std::ptrdiff_t k = column * lane_count; k < block.size; k += All::next) {
      all.store_vector(proposed, k, dP);
      const Lanes turned = all.load(turned_back + 1 - turn, k);
      const Lanes turns = dot(dP, last) < -rounding ? all_lanes(1) : Lanes{};
      all.store(turned_back + turn, k, turns);
      oscillating += turns * turned;
      last = all.load_vector(last_proposed, k + All::next);
      const Vector following = movement_at(k + All::next, last);
      Lanes squared = dot(dP, dP);  // (16)
      if constexpr (relative) {
        const Vector difference = All::after(dP, following) - dP;  // (18)
        squared = all.load(is_segment, k) * dot(difference, difference);
      }
      largest = max(squared, largest);
      total += squared;
      dP = following;
    }
    All::template gather<max>(largest, column, step.largest_squared);
    All::template gather<sum>(total, column, step.sum_squared);
    All::template gather<sum>(oscillating, column, step.oscillating);
  }
}

template <int dimension, std::ptrdiff_t stride>
void move(const PointBlock& block, int turn, const PerLane& c_m) {
  using All = Registers<dimension, stride>;
  using Vector = LaneVector<dimension>;
  const All all{block};
  for (std::ptrdiff_t column = 0; column < All::columns; ++column) {
    const Lanes scale = All::lanes_of_rods(c_m, column);
    for (std::ptrdiff_t k = column * lane_count; k < block.size; k += All::next) {
      Vector movement = scale * all.load_vector(proposals + 3 * turn, k);
      // The proposals of a rod that has diverged in a batch may be NaN.
      if constexpr (stride != 1) {
        for (Lanes& axis : movement.axis) axis = scale > 0 ? axis : Lanes{};
      }
      all.store_vector(positions, k, all.load_vector(positions, k) + movement);
    }
  }
}

template <BendingLaw law, int dimension, std::ptrdiff_t stride, AdditionalMoment extra>
constexpr StepKernel kernel = {
    .add_walls = add_walls<dimension, stride>,
    .compute_forces = compute_forces<law, dimension, stride, extra>,
    .measure_modes = measure_modes<law, dimension, stride, extra>,
    .propose_relative = propose<true, dimension, stride>,
    .propose_absolute = propose<false, dimension, stride>,
    .move = move<dimension, stride>,
};

template <BendingLaw law, int dimension, AdditionalMoment extra = AdditionalMoment::nothing>
const StepKernel& kernel_for_stride(std::ptrdiff_t stride) {
  return stride == 1 ? kernel<law, dimension, 1, extra>
                     : kernel<law, dimension, block_lanes, extra>;
}

template <BendingLaw law>
const StepKernel& kernel_for_dimension(int dimension, std::ptrdiff_t stride) {
  return dimension == 2 ? kernel_for_stride<law, 2>(stride) : kernel_for_stride<law, 3>(stride);
}

}  // namespace

const StepKernel& step_kernel(const KernelChoice& choice, std::ptrdiff_t stride);

const StepKernel& step_kernel(const KernelChoice& choice, std::ptrdiff_t stride) {
  if (choice.natural)
    return kernel_for_stride<BendingLaw::hooke, 2, AdditionalMoment::couples>(stride);
  if (choice.twisted) return kernel<BendingLaw::hooke, 3, 1, AdditionalMoment::twist>;
  return choice.law == BendingLaw::hooke
             ? kernel_for_dimension<BendingLaw::hooke>(choice.dimension, stride)
             : kernel_for_dimension<BendingLaw::paper>(choice.dimension, stride);
}

}  // namespace dlo::force_model::DLO_KERNEL
