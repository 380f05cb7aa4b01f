#include "suite/cause.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>
#include <utility>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/effective_modulus.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/explanation.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/shape_check.hpp"
#include "explain/cause_limits.hpp"
#include "explain/own_polygon.hpp"
#include "explain/scene_causes.hpp"
#include "polygon/scalar_search.hpp"
#include "suite/answer.hpp"

namespace dlo::compare {
namespace {

namespace limits = cause_limits;

/// Whether the excess of the apparent weight over the scene's is proportional to the number of
/// elements. Above twice the weight the cause is rather springs whose stiffness depends on N and
/// tends to zero.
bool grows_with_elements(const StiffnessFactor& coarse, const StiffnessFactor& fine) {
  constexpr double least = 0.01;
  constexpr double most = 1;
  constexpr double proportionality_tolerance = 0.15;
  const double more = 1 / coarse.factor - 1;
  const double elements = static_cast<double>(fine.points - 1) / (coarse.points - 1);
  return more > least && more < most &&
         std::abs((1 / fine.factor - 1) / (more * elements) - 1) < proportionality_tolerance;
}

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

class Diagnosis {
 public:
  Diagnosis(const Scene& scene, const energy_model::Equilibrium& reference,
            const std::vector<CardShape>& shapes)
      : scene_(scene), reference_(reference), shapes_(shapes) {}

  [[nodiscard]] std::vector<Cause> run() {
    const double order = convergence_order(shapes_);
    const bool converges = !(finest().error > error_floor) || order > limits::second_order;
    // A rod that stretches is compared only with those of scenes that lack a property.
    const bool stretches = scene_.stretch != Stretch::none;
    if (!stretches && find_chain_cause(converges)) return found_;
    if (converges || finest().error <= limits::negligible_error) return found_;
    // Discretisation error without a specific cause.
    if (order > limits::nonconverging_order && !is_error_stagnant()) return found_;
    using CoarserShapes = std::initializer_list<std::pair<const CardShape&, double>>;
    const auto compare_factors = [this](auto fit, CoarserShapes coarser_shapes) {
      const std::optional<double> fine = (this->*fit)(finest(), limits::fitted_left);
      if (!fine) return false;
      for (const auto& [coarser, largest_share] : coarser_shapes) {
        const std::optional<double> coarse = (this->*fit)(coarser, largest_share);
        if (!coarse) continue;
        found_.push_back(
            cause_of_factors(scene_, {coarser.points, *coarse}, {finest().points, *fine}));
        return true;
      }
      return false;
    };
    const auto springs = &Diagnosis::spring_factor;
    const auto modulus = &Diagnosis::modulus_factor;
    (void)(find_neglected_property() || stretches || find_other_equilibrium() ||
           compare_factors(springs, {{coarsest(), limits::fitted_left}}) || find_imbalance() ||
           compare_factors(modulus, {{coarsest(), limits::fitted_left},
                                     {second_finest(), limits::coarse_left}}) ||
           compare_factors(springs, {{second_finest(), limits::coarse_left}}) ||
           find_scene_cause(limits::fitted_left));
    return found_;
  }

 private:
  [[nodiscard]] const CardShape& coarsest() const { return shapes_.front(); }
  [[nodiscard]] const CardShape& finest() const { return shapes_.back(); }
  [[nodiscard]] const CardShape& second_finest() const {
    return shapes_.size() > 1 ? *(shapes_.end() - 2) : shapes_.back();
  }
  [[nodiscard]] double error_m(const CardShape& shape) const { return shape.error * scene_.length; }

  /// Whether the error is not small and no longer decreases with N.
  [[nodiscard]] bool is_error_stagnant() const {
    constexpr double small = 5e-3;
    if (shapes_.size() < 3 || finest().error < small) return false;
    return convergence_order({shapes_.end() - 2, shapes_.end()}) < limits::nonconverging_order;
  }

  void add(std::string name, double factor, std::string words) {
    found_.push_back({std::move(name), factor, std::move(words)});
  }

  /// Searches for a chain that fits the shapes. @return whether they are those of a chain of hinges
  /// with springs EI/h
  bool find_chain_cause(bool converges) {
    if (!(coarsest().error > error_floor)) return false;
    const std::optional<CandidateChain> best =
        nearest_chain(coarsest(), Springs::rod_stiffness, limits::chain_left);
    if (!best) return false;
    // The finest shape excludes an accidental fit of the coarsest one.
    const std::vector<CandidateChain> fine =
        candidate_chains(scene_, finest().shape, Springs::rod_stiffness);
    const auto fine_polygon =
        std::find_if(fine.begin(), fine.end(),
                     [&](const CandidateChain& chain) { return chain.clamp == best->clamp; });
    if (fine_polygon == fine.end() ||
        !(fine_polygon->rms_m <= limits::chain_left * error_m(finest())))
      return false;
    const bool is_clamped =
        std::any_of(scene_.grippers.begin(), scene_.grippers.end(),
                    [](const Gripper& gripper) { return gripper.direction.has_value(); });
    constexpr double half_element = 0.5;
    if (is_clamped && !converges && best->clamp == ChainClamp::welded) {
      add("first element welded", half_element,
          "the first element does not bend: half an element is too stiff at each clamp");
    } else if (is_clamped && !converges && best->clamp == ChainClamp::hinge) {
      add("hinge at the clamp", half_element,
          "the hinge at the clamp has a spring of EI/h, which is too soft by half an element");
    }
    if (best->is_law_identified && best->law == energy_model::JointLaw::linear) {
      add("springs linear in the angle", undefined,
          "springs are linear in the angle, not in 2 tan(angle/2): another error of second order");
      found_.back().defect = false;
    }
    return true;
  }

  /// Returns the chain nearest to a shape, if it leaves at most this fraction of the error.
  [[nodiscard]] std::optional<CandidateChain> nearest_chain(const CardShape& shape, Springs springs,
                                                            double largest_share) const {
    const std::vector<CandidateChain> chains = candidate_chains(scene_, shape.shape, springs);
    const auto best = std::ranges::min_element(chains, {}, &CandidateChain::rms_m);
    const bool is_near = best != chains.end() && best->rms_m <= largest_share * error_m(shape);
    return is_near ? std::optional(*best) : std::nullopt;
  }

  /// Returns the stiffness of the springs of the chain that fits the shape best, divided by EI/h;
  /// std::nullopt as nearest_chain().
  [[nodiscard]] std::optional<double> spring_factor(const CardShape& shape,
                                                    double largest_share) const {
    const std::optional<CandidateChain> best = nearest_chain(shape, Springs::fitted, largest_share);
    return best ? std::optional(best->stiffness) : std::nullopt;
  }

  [[nodiscard]] std::optional<double> modulus_factor(const CardShape& shape,
                                                     double largest_share) const {
    try {
      const EffectiveModulus modulus =
          fit_effective_modulus(scene_, distance_from(shape.shape), reference_);
      if (!is_identified(modulus.optimum)) return std::nullopt;
      if (!(modulus.rms_m <= largest_share * error_m(shape))) return std::nullopt;
      return modulus.ratio;
    } catch (const ResultError&) {
      return std::nullopt;
    }
  }

  /// Adds a cause with this name if the shape is that of a scene without one of its properties, or
  /// converges to it. @return whether it is
  bool is_scene_without(const Scene& without, const std::string& name) {
    try {
      const energy_model::Equilibrium rod = solve_reference(without, answer_model(without));
      const auto left = [&](const CardShape& shape) {
        return distance(shape.shape, rod.sample) / scene_.length;
      };
      const double fine = left(finest());
      const bool is_near = fine <= limits::without_left * finest().error;
      // The shapes may also converge to that rod, if the finest one is much closer to it than to
      // the reference.
      const bool may_converge =
          fine <= limits::coarse_left * finest().error &&
          convergence_order({{coarsest().points, {}, left(coarsest())},
                             {finest().points, {}, fine}}) > limits::approaching_order;
      if (!is_near && !may_converge) return false;
      add(name, undefined, "the shape is that of the scene without it");
      return true;
    } catch (const ResultError&) {
      return false;
    }
  }

  bool find_neglected_property() {
    bool is_found = false;
    const auto try_without = [&](bool has, const char* name, const auto& remove) {
      if (!has || is_found) return;
      Scene without = scene_;
      remove(without);
      is_found = is_scene_without(without, name);
    };
    try_without(scene_.naturally_bent(), "intrinsic curvature ignored",
                [](Scene& scene) { scene = scene.without_natural_strain(); });
    try_without(scene_.prescribes_twist(), "twist not coupled",
                [](Scene& scene) { scene = scene.without_twist(); });
    try_without(scene_.stretch != Stretch::none, "stretch ignored",
                [](Scene& scene) { scene.stretch = Stretch::none; });
    try_without(scene_.given_bending_stiffness_2.has_value(), "second bending stiffness ignored",
                [](Scene& scene) { scene.given_bending_stiffness_2.reset(); });
    try_without(scene_.given_bending_stiffness_2.has_value(), "first bending stiffness ignored",
                [](Scene& scene) {
                  scene.given_bending_stiffness = scene.given_bending_stiffness_2;
                  scene.given_bending_stiffness_2.reset();
                });
    try_without(!scene_.sections.empty(), "sections ignored",
                [](Scene& scene) { scene.sections.clear(); });
    try_without(!scene_.loads.empty(), "loads ignored", [](Scene& scene) { scene.loads.clear(); });
    try_without(!scene_.gravity.isZero(), "weight ignored",
                [](Scene& scene) { scene.gravity.setZero(); });
    try_without(!scene_.obstacles.empty(), "obstacles ignored",
                [](Scene& scene) { scene.obstacles.clear(); });
    return is_found;
  }

  /// Adds a cause if the shape of the largest N is another equilibrium of the scene. @return
  /// whether it is
  bool find_other_equilibrium() {
    constexpr double small = 1e-3;
    if (finest().error < small) return false;
    try {
      for (const energy_model::Equilibrium& state : reference_states(scene_)) {
        if (!(distance(finest().shape, state.sample) <= limits::state_left * error_m(finest())))
          continue;
        const bool unstable = state.status == energy_model::SolveStatus::saddle;
        add(unstable ? "unstable equilibrium" : "other equilibrium", undefined,
            unstable ? "the shape is an equilibrium that is unstable"
                     : "the shape is another stable equilibrium of the scene");
        return true;
      }
    } catch (const ConvergenceError&) {
      return false;
    }
    return false;
  }

  /// Adds a cause if the bending moments balance with spring moments proportional to a power of the
  /// angle other than 1. @return whether they do
  bool find_power_law() {
    constexpr double least = 0.25;
    constexpr double most = 5;
    constexpr int steps = 19;
    constexpr double balanced_residual = 5e-3;
    constexpr double other = 0.2;
    const auto left = [&](const CardShape& shape, double power) {
      const std::optional<MomentBalance> balance = moment_balance(scene_, shape.shape, power);
      return balance ? balance->imbalance : std::numeric_limits<double>::infinity();
    };
    const Function of_finest = [&](double power) { return left(finest(), power); };
    const Scan scanned = scan(of_finest, least, most, steps);
    if (!scanned.is_bracketed()) return false;
    const Minimum best = minimum_near(of_finest, scanned);
    if (!(best.value < balanced_residual) || std::abs(best.x - 1) < other) return false;
    if (!(left(coarsest(), best.x) < limits::rest_imbalance_limit)) return false;
    add("springs with a power of the angle", best.x,
        fmt::format(
            "moments balance if they are proportional to the power {:.2g} of the joints' angles",
            best.x));
    return true;
  }

  bool find_imbalance() {
    const std::optional<MomentBalance> balance = moment_balance(scene_, finest().shape);
    if (!balance) return false;
    constexpr double tolerance = 0.03;
    if (!(balance->imbalance > limits::rest_imbalance_limit)) {
      if (std::abs(balance->stiffness - 1) > tolerance ||
          std::abs(balance->weight - 1) < tolerance) {
        return false;
      }
      add("weight wrong", balance->weight,
          fmt::format("the weight is {:.3g} times the scene's", balance->weight));
      return true;
    }
    if (find_power_law()) return true;
    if (balance->imbalance <= balance->resolution) return false;
    // A shape with loads other than the scene's is out of balance too.
    if (find_scene_cause(limits::unbalanced_left)) return true;
    add("not at rest", balance->imbalance,
        fmt::format("no forces at its ends balance {:.2g} % of its bending moments, whatever the "
                    "stiffness is",
                    balance->imbalance * 100));
    return true;
  }

  /// Searches the explanations of `dlo check` for a cause.
  /// @param left  fraction of the error that it may leave
  bool find_scene_cause(double left) {
    try {
      const MeasuredShape shape =
          shape_of(finest().shape.points, finest().shape.arc_length, "its shape");
      const ShapeCheckOptions options{.modulus = ModulusSearch::no};
      const ShapeCheck check = check_shape(scene_, shape, options);
      const std::vector<Explanation> all = explain_shape(scene_, shape, check, options);
      for (const Explanation& one : all) {
        if (one.kind == ExplanationKind::discretisation) continue;
        if (!(one.rms_m <= left * check.whole_rod_rms_m)) continue;
        add(one.kind == ExplanationKind::file ? "file" : "scene", undefined, one.cause);
        return true;
      }
    } catch (const ResultError&) {
      return false;
    }
    return false;
  }

  const Scene& scene_;
  const energy_model::Equilibrium& reference_;
  const std::vector<CardShape>& shapes_;
  std::vector<Cause> found_;
};

}  // namespace

Cause cause_of_factors(const Scene& scene, const StiffnessFactor& coarse,
                       const StiffnessFactor& fine) {
  const double power = fine.points > coarse.points
                           ? std::log(fine.factor / coarse.factor) /
                                 std::log(static_cast<double>(fine.points) / coarse.points)
                           : 0;
  constexpr double power_tolerance = 0.35;
  const std::string both =
      fmt::format("bending stiffness is {:.3g} times EI with N = {} and {:.3g} times with N = {}",
                  coarse.factor, coarse.points, fine.factor, fine.points);
  if (is_loaded_by_weight_alone(scene) && grows_with_elements(coarse, fine)) {
    // A ball of the caps' radius r on each element of length h adds 4 r / (3 h) of its weight.
    const double h = scene.length / (fine.points - 1);
    return {"weight with caps", 1 / fine.factor,
            fmt::format("the weight is {:.3g} times the scene's with N = {} and {:.3g} times with "
                        "N = {}: each element has more, as caps of radius {:.3g} mm have",
                        1 / coarse.factor, coarse.points, 1 / fine.factor, fine.points,
                        0.75e3 * h * (1 / fine.factor - 1))};
  }
  if (std::abs(power + 1) < power_tolerance) {
    return {"springs without 1/h", fine.factor,
            both + ": it is not divided by the element's length"};
  }
  if (std::abs(power - 1) < power_tolerance) {
    return {"springs with 1/h^2", fine.factor,
            both + ": it is divided by the element's length twice"};
  }
  // Factors of EI below this one give the same shapes, because the rod then acts as a rope.
  constexpr double negligible_factor = 1e-3;
  if (coarse.factor < negligible_factor && fine.factor < negligible_factor) {
    return {
        "bending stiffness ignored", std::numeric_limits<double>::quiet_NaN(),
        fmt::format("the bending stiffness is less than {:g} of the scene's", negligible_factor)};
  }
  if (std::abs(power) < power_tolerance) {
    return {"bending stiffness wrong", fine.factor,
            fmt::format("the bending stiffness is {:.3g} times the scene's{}", fine.factor,
                        is_loaded_by_weight_alone(scene)
                            ? fmt::format(", or the weight {:.3g} times", 1 / fine.factor)
                            : "")};
  }
  return {"bending stiffness depends on N", fine.factor, both};
}

double convergence_order(const std::vector<CardShape>& shapes) {
  if (shapes.size() < 2) return undefined;
  const CardShape& first = shapes.front();
  const CardShape& last = shapes.back();
  if (!(first.error > error_floor) || !(last.error > error_floor)) return undefined;
  return std::log(first.error / last.error) /
         std::log(static_cast<double>(last.points) / first.points);
}

std::vector<Cause> causes_of(const Scene& scene, const energy_model::Equilibrium& reference,
                             const std::vector<CardShape>& shapes) {
  return Diagnosis(scene, reference, shapes).run();
}

}  // namespace dlo::compare
