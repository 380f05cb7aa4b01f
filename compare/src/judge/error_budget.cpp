#include "dlo/compare/error_budget.hpp"

#include <algorithm>
#include <cmath>

#include "dlo/compare/chain.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"
#include "polygon/natural_plane.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

constexpr int field_points = 201;

/// Differences between polygons and the rod, all interpolated at the same arc lengths. They are
/// smooth although polygons are not.
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

  [[nodiscard]] Eigen::Matrix3Xd zero() const {
    return Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(s_.size()));
  }

 private:
  const Reference& reference_;
  std::vector<double> s_;
};

bool reaches_rigid_obstacle(const Scene& scene) {
  const std::vector<std::size_t> reached = obstacles_in_reach(scene, scene.force_model);
  return std::any_of(reached.begin(), reached.end(),
                     [&](std::size_t i) { return std::isinf(scene.obstacles[i].stiffness); });
}

/// Returns the scene with finite stiffnesses of its rigid obstacles, so that they deform a polygon
/// with any c_c as rigid ones deform a polygon with this c_c.
Scene on_obstacles_for(Scene scene, double c_c, double segment_length) {
  for (Obstacle& obstacle : scene.obstacles) {
    if (std::isinf(obstacle.stiffness)) {
      obstacle.stiffness = c_c / (segment_length * segment_length);
    }
  }
  return scene;
}

/// Differences between the rod and rods without properties that the force model neglects.
struct RodsWithout {
  Eigen::Matrix3Xd twist;  ///< without the twist
  Eigen::Matrix3Xd all;    ///< without the natural curvature too, which is the rod that the polygon
                           ///< discretises
};

/// Returns the differences for the lowest shapes of these rods; zero if the force model neglects
/// nothing that the scene has.
/// @param taken  the scene as the polygons model it
RodsWithout rods_without(const Scene& scene, const Scene& taken, const std::vector<double>& s,
                         const Fields& fields, const SolveOptions& options) {
  const auto rod = [&](const Scene& other) {
    const energy_model::Equilibrium lowest = solve_reference(other, options);
    return fields.of({s, lowest.sample(s).points});
  };
  RodsWithout result;
  result.twist = scene.prescribes_twist() && !models_twist(scene, scene.force_model)
                     ? rod(scene.without_twist())
                     : fields.zero();
  const bool leaves_curvature_out =
      scene.naturally_bent() && !taken.naturally_bent() && scene.naturally_curved();
  result.all = leaves_curvature_out ? rod(taken) : result.twist;
  return result;
}

}  // namespace

Budget error_budget(const Scene& scene, const Solution& force, const Reference& reference,
                    const SolveOptions& options) {
  const Fields fields(reference, scene.length);
  const ForceModelSettings& own = scene.force_model;
  // The stretch of the reference itself is no error of the polygons.
  const double stiffer = reference_model(scene) == Model::exact ? 1 : 100;
  const double rigid = stiffer * scene.axial_stiffness();
  // The chains neglect the properties that the force model neglects.
  const Scene taken = without_neglected_properties(scene, own);
  const auto chain_in = [&](const Scene& other, BendingLaw law, Bookkeeping bookkeeping,
                            double c_c) {
    ForceModelSettings settings = own;
    settings.law = law;
    settings.bookkeeping = bookkeeping;
    settings.c_c = c_c;
    return fields.of(chain_from(other, settings, force.shape, options));
  };
  const auto chain = [&](BendingLaw law, Bookkeeping bookkeeping, double c_c) {
    return chain_in(taken, law, bookkeeping, c_c);
  };
  const Eigen::Matrix3Xd base = chain(BendingLaw::hooke, Bookkeeping::consistent, rigid);
  const Eigen::Matrix3Xd other_bookkeeping = own.bookkeeping == Bookkeeping::consistent
                                                 ? base
                                                 : chain(BendingLaw::hooke, own.bookkeeping, rigid);
  const Eigen::Matrix3Xd other_law =
      own.law == BendingLaw::hooke ? base : chain(own.law, Bookkeeping::consistent, rigid);
  const Eigen::Matrix3Xd stiff = chain(own.law, own.bookkeeping, rigid);
  const double c_c = own.c_c.value_or(scene.axial_stiffness());
  const Eigen::Matrix3Xd elastic = chain(own.law, own.bookkeeping, c_c);
  const Eigen::Matrix3Xd on_rigid =
      reaches_rigid_obstacle(taken)
          ? chain_in(on_obstacles_for(taken, rigid, force.parameters.segment_length), own.law,
                     own.bookkeeping, c_c)
          : elastic;
  Shape rested = force.shape;
  rested.points += force.to_rest;
  const Eigen::Matrix3Xd total = fields.of(force.shape);
  const Eigen::Matrix3Xd moving = total - fields.of(rested);
  const RodsWithout without = rods_without(scene, taken, force.shape.arc_length, fields, options);

  Budget budget;
  budget.total_m = fields.part(total, total).rms_m;
  const Eigen::Matrix3Xd law = other_law - base;
  const Eigen::Matrix3Xd bookkeeping = other_bookkeeping - base;
  const Eigen::Matrix3Xd stretch = on_rigid - stiff;
  const Eigen::Matrix3Xd contact = elastic - on_rigid;
  budget.twist = fields.part(without.twist, total);
  budget.natural_curvature = fields.part(without.all - without.twist, total);
  budget.discretisation = fields.part(base - without.all, total);
  budget.bookkeeping = fields.part(bookkeeping, total);
  budget.law = fields.part(law, total);
  budget.stretch = fields.part(stretch, total);
  budget.contact = fields.part(contact, total);
  budget.not_at_rest = fields.part(moving, total);
  budget.interaction =
      fields.part(total - base - bookkeeping - law - stretch - contact - moving, total);
  return budget;
}

}  // namespace dlo::compare
