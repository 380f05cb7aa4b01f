#include "dlo/compare/error_budget.hpp"

#include "dlo/compare/chain.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"
#include "polygon/natural_plane.hpp"

namespace dlo::compare {
namespace {

constexpr int field_points = 201;

/// Differences of polygons from the rod, all at the same arc lengths: smooth where a polygon is
/// not.
class Fields {
 public:
  Fields(const Reference& reference, double length)
      : reference_(reference), s_(equal_arc_lengths(length, field_points)) {}

  [[nodiscard]] Eigen::Matrix3Xd of(const Shape& shape) const {
    const Shape difference{shape.arc_length, shape.points - reference_(shape.arc_length).points};
    return resample(difference, s_).points;
  }

  [[nodiscard]] BudgetPart part(const Eigen::Matrix3Xd& field,
                                const Eigen::Matrix3Xd& total) const {
    const double a = rms(s_, field + total);
    const double b = rms(s_, field - total);
    const double size = rms(s_, total);
    // <a, b> = (|a + b|^2 - |a - b|^2) / 4
    return {.rms_m = rms(s_, field), .share = size > 0 ? (a * a - b * b) / (4 * size * size) : 0};
  }

 private:
  const Reference& reference_;
  std::vector<double> s_;
};

}  // namespace

Budget error_budget(const Scene& scene, const Solution& force, const Reference& reference,
                    const SolveOptions& options) {
  const Fields fields(reference, scene.length);
  const ForceModelSettings& own = scene.force_model;
  const double rigid = 100 * scene.axial_stiffness();
  // The chains are of the scene that the force model has taken.
  const Scene taken = as_polygons_take_it(scene, own);
  const auto chain = [&](BendingLaw law, Bookkeeping bookkeeping, double c_c) {
    ForceModelSettings settings = own;
    settings.law = law;
    settings.bookkeeping = bookkeeping;
    settings.c_c = c_c;
    return fields.of(chain_from(taken, settings, force.shape, options));
  };
  const Eigen::Matrix3Xd base = chain(BendingLaw::hooke, Bookkeeping::consistent, rigid);
  const Eigen::Matrix3Xd other_bookkeeping = own.bookkeeping == Bookkeeping::consistent
                                                 ? base
                                                 : chain(BendingLaw::hooke, own.bookkeeping, rigid);
  const Eigen::Matrix3Xd other_law =
      own.law == BendingLaw::hooke ? base : chain(own.law, Bookkeeping::consistent, rigid);
  const Eigen::Matrix3Xd stiff = chain(own.law, own.bookkeeping, rigid);
  const Eigen::Matrix3Xd elastic =
      chain(own.law, own.bookkeeping, own.c_c.value_or(scene.axial_stiffness()));
  Shape rested = force.shape;
  rested.points += force.to_rest;
  const Eigen::Matrix3Xd total = fields.of(force.shape);
  const Eigen::Matrix3Xd moving = total - fields.of(rested);

  // The lowest shapes of the rods without it, of the last of which the polygon is one.
  const auto rod = [&](const Scene& other) {
    const energy_model::Equilibrium lowest = solve_reference(other, Model::energy, options);
    const std::vector<double>& s = force.shape.arc_length;
    return fields.of({s, lowest.sample(s).points});
  };
  const Eigen::Matrix3Xd none = Eigen::Matrix3Xd::Zero(3, total.cols());
  const bool leaves_twist_out = scene.holds_twist() && !takes_twist(scene, own);
  const Eigen::Matrix3Xd twist = leaves_twist_out ? rod(scene.without_twist()) : none;
  const bool leaves_curvature_out =
      scene.naturally_bent() && !taken.naturally_bent() && scene.naturally_curved();
  const Eigen::Matrix3Xd left_out = leaves_curvature_out ? rod(taken) : twist;

  Budget budget;
  budget.total_m = fields.part(total, total).rms_m;
  const Eigen::Matrix3Xd law = other_law - base;
  const Eigen::Matrix3Xd bookkeeping = other_bookkeeping - base;
  const Eigen::Matrix3Xd stretch = elastic - stiff;
  budget.twist = fields.part(twist, total);
  budget.natural_curvature = fields.part(left_out - twist, total);
  budget.discretisation = fields.part(base - left_out, total);
  budget.bookkeeping = fields.part(bookkeeping, total);
  budget.law = fields.part(law, total);
  budget.stretch = fields.part(stretch, total);
  budget.not_at_rest = fields.part(moving, total);
  budget.interaction = fields.part(total - base - bookkeeping - law - stretch - moving, total);
  return budget;
}

}  // namespace dlo::compare
