#include "dlo/compare/explanation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "explain/file_causes.hpp"
#include "explain/own_polygon.hpp"
#include "explain/scene_causes.hpp"
#include "least_squares/gauss_newton.hpp"
#include "shape/aligner.hpp"
#include "shape/arc_lengths.hpp"
#include "shape/shape_measure.hpp"

namespace dlo::compare {
namespace {

/// What an explanation may leave of the deviation.
constexpr double most_left = 0.5;
/// A number more has to take away this share of what is left.
constexpr double worth_of_a_number = 0.5;
/// What is nearer than this share of the deviation, or of the length, is the same.
constexpr double same_share = 0.02;
constexpr double same_length = 1e-5;
/// Share of its mean square that a step towards the shape has to take away.
constexpr double least_gain = 0.1;
/// Deviation beyond which a shape is just another one, in lengths.
constexpr double another_shape = 0.05;
/// Of a tolerance: how far a file is that is so far off because of how it was read, says nothing.
constexpr double far_beyond = 10;
/// By how much a rod that has left its plane is out of it, in lengths.
constexpr double another_shape_out = 1e-3;

/// What is left and the numbers that it takes, in one: the less the better. What is left below the
/// rest that is the same counts as that.
/// @param before  the deviation that is to be explained [m];  @param length  of the rod [m]
double price_of(double rms, int numbers, double before, double length) {
  const double same =
      std::max(same_share * std::min(before, another_shape * length), same_length * length);
  return std::max(rms, same) * std::pow(1 / worth_of_a_number, std::max(0, numbers));
}

/// What a chain's springs are, if that shows.
std::string and_springs(const OwnPolygon& chain) {
  const std::string law = law_words(chain);
  return law.empty() ? "" : ", its springs EI/h and " + law;
}

class Search {
 public:
  Search(const Scene& scene, const MeasuredShape& shape, const ShapeCheck& check,
         const ShapeCheckOptions& options)
      : scene_(scene), shape_(shape), check_(check), options_(options) {
    align_.pose = options.pose;
    align_.arc_lengths = options.arc_lengths;
    align_.up = up_of(scene, options.pose);
  }

  [[nodiscard]] std::vector<Explanation> run() {
    const energy_model::Equilibrium& rod = check_.rod;
    before_ = check_.whole_rms_m;
    // It fails because too little is seen.
    if (!(before_ > same_length * scene_.length)) return {};
    if (options_.pose == PoseFreedom::known) {
      for (const FileCause& cause : file_causes(scene_, shape_, check_)) look_at(cause, rod);
    }
    look_at_noise();
    look_at_unstable();
    if (!is_found(0)) look_at_chains(Springs::as_the_rod);
    for (const SceneCause& cause :
         scene_causes(scene_, check_.alignment.shape, length_of_shape(), lies_in_plane())) {
      if (!is_found(static_cast<int>(cause.start.size())) && !is_over()) fit(cause, rod);
    }
    if (!is_found(1)) look_at_chains(Springs::fitted);
    std::stable_sort(found_.begin(), found_.end(), [this](const auto& a, const auto& b) {
      return price(a.first) < price(b.first);
    });
    std::vector<Explanation> result;
    result.reserve(found_.size());
    for (auto& [explanation, same_as] : found_) result.push_back(std::move(explanation));
    return result;
  }

 private:
  [[nodiscard]] bool is_over() const {
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin_;
    return spent.count() > options_.solve.time_limit;
  }

  /// Whether nothing with so many numbers could be better than what has been found.
  [[nodiscard]] bool is_found(int numbers) const {
    return best_ && price(*best_) <= price({"", 0, numbers, ExplanationKind::scene});
  }

  /// Of the shape, if the way between two points is as much longer as on the rod [m].
  [[nodiscard]] double length_of_shape() const {
    const std::vector<double>& s = check_.alignment.shape.arc_length;
    const double chords = lengths_along(check_.reference.points).back();
    return check_.polyline_length_m * (s.back() - s.front()) / chords;
  }

  void look_at_chains(Springs springs) {
    const Shape& shape = check_.alignment.shape;
    for (const OwnPolygon& chain : own_polygons(scene_, shape, springs)) {
      const std::string words = words_of(chain.clamp, shape.points.cols() - 1);
      if (springs == Springs::as_the_rod) {
        add({words + and_springs(chain), chain.rms_m, 0, ExplanationKind::discretisation,
             chain.max_m},
            words);
      } else {
        const std::string law = law_words(chain);
        add({fmt::format("it is {}, with springs of {:.3g} times EI/h{}{}", words, chain.stiffness,
                         law.empty() ? "" : ", ", law),
             chain.rms_m, 1, ExplanationKind::scene},
            words);
      }
    }
  }

  [[nodiscard]] bool lies_in_plane() const {
    const std::optional<Eigen::Vector3d> normal = scene_.plane_normal();
    if (!normal) return false;
    return out_of_plane(*normal, check_.alignment.shape.points) < same_share * before_;
  }

  [[nodiscard]] double price(const Explanation& explanation) const {
    return price_of(explanation.rms_m, explanation.numbers, before_, scene_.length);
  }

  /// @param same_as  what of several only the best is told; empty: its own words
  void add(Explanation explanation, std::string same_as = {}) {
    if (!(explanation.rms_m <= most_left * before_)) return;
    if (!best_ || price(explanation) < price(*best_)) best_ = explanation;
    if (same_as.empty()) same_as = explanation.cause;
    const auto told = std::find_if(found_.begin(), found_.end(), [&](const auto& other) {
      return other.second == same_as || other.first.cause == explanation.cause;
    });
    if (told == found_.end()) {
      found_.emplace_back(std::move(explanation), std::move(same_as));
    } else if (price(explanation) < price(told->first)) {
      told->first = std::move(explanation);
    }
  }

  /// What a solver keeps at rest that does not see which way the rod leaves: one in the plane, or
  /// one that looks for no minimum.
  void look_at_unstable() {
    double least = std::numeric_limits<double>::infinity();
    for (const OtherState& other : check_.state.others) {
      if (!other.stable) least = std::min(least, other.rms_from_shape_m);
    }
    if (!std::isfinite(least)) return;
    const std::optional<Eigen::Vector3d> normal = scene_.plane_normal();
    const double out = normal ? out_of_plane(*normal, check_.reference.points) : 0;
    const bool left_plane = normal && out > another_shape_out * scene_.length &&
                            out_of_plane(*normal, check_.alignment.shape.points) < same_share * out;
    add({left_plane
             ? fmt::format("the rod keeps to the scene's plane, as a planar model's does: it "
                           "is unstable there and leaves the plane by up to {:.3g} mm",
                           out * 1e3)
             : std::string("the rod rests where it is unstable, as of a solver that looks for "
                           "no minimum"),
         least, 0, ExplanationKind::scene});
  }

  /// The largest distance of points from the scene's plane [m].
  [[nodiscard]] double out_of_plane(const Eigen::Vector3d& normal,
                                    const Eigen::Matrix3Xd& points) const {
    return (normal.transpose() * (points.colwise() - scene_.grippers.front().position))
        .cwiseAbs()
        .maxCoeff();
  }

  void look_at(const FileCause& cause, const energy_model::Equilibrium& rod) {
    AlignOptions options = align_;
    options.pose = cause.pose;
    try {
      const Aligner aligner(cause.shape, scene_.length, options);
      const Alignment laid = aligner.align(Curve(rod.sample, scene_.length));
      const Measured measured = measure(laid, rod.sample, scene_.length);
      Explanation explanation{cause.words, measured.rms_m, cause.numbers, ExplanationKind::file};
      // What points that are left out are blamed for has to be their own.
      if (cause.part && cause.shape.points.cols() < shape_.points.cols() &&
          !(measured.rms_m <= most_left * check_.deviation.rms_m)) {
        return;
      }
      if (!cause.part) {
        explanation.rms_m = whole_of(measured, laid, rod.sample, scene_.length).rms_m;
      }
      if (cause.pose == PoseFreedom::translation) {
        const Eigen::Vector3d way = laid.pose.translation * 1e3;
        explanation.cause +=
            fmt::format(", [{:.4g}, {:.4g}, {:.4g}] mm away", way.x(), way.y(), way.z());
      }
      add(std::move(explanation), cause.same_as);
    } catch (const InputError&) {
      // No file, said in this way.
    }
  }

  /// Of noise, neighbours have nothing in common: little is left of their mean.
  void look_at_noise() {
    const Shape& shape = check_.alignment.shape;
    const Eigen::Matrix3Xd gaps = shape.points - check_.rod.sample(shape.arc_length).points;
    const Eigen::Index count = gaps.cols();
    const Eigen::Index around = std::max<Eigen::Index>(2, count / 10);
    if (count < 4 * around) return;
    Eigen::Matrix3Xd common(3, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index first = std::max<Eigen::Index>(0, i - around);
      const Eigen::Index last = std::min(count - 1, i + around);
      common.col(i) = gaps.middleCols(first, last - first + 1).rowwise().mean();
    }
    const double noise = std::sqrt((gaps - common).colwise().squaredNorm().mean());
    const double left = std::sqrt(common.colwise().squaredNorm().mean());
    add({fmt::format("there were no noise from point to point, {:.3g} mm RMS", noise * 1e3), left,
         0, ExplanationKind::file});
  }

  /// RMS deviation of the whole rod, in the state that a cause leads to [m].
  [[nodiscard]] double rms_of(const Scene& scene, const energy_model::Equilibrium& rod) const {
    const Alignment laid =
        Aligner(shape_, scene.length, align_).align(Curve(rod.sample, scene.length));
    return whole_of(measure(laid, rod.sample, scene.length), laid, rod.sample, scene.length).rms_m;
  }

  void fit(const SceneCause& cause, const energy_model::Equilibrium& rod) {
    try {
      const std::vector<Scene> scene = {cause.changed(cause.start)};
      MeasuredShapes measured(scene, {shape_},
                              {.pose = options_.pose,
                               .arc_lengths = options_.arc_lengths,
                               .weights = PointWeights::by_length,
                               .solve = options_.solve,
                               .flat = FlatShapes::measured},
                              begin_);
      std::vector<Unknown> unknowns;
      for (const double stride : cause.stride) {
        unknowns.push_back({.stride = stride, .longest_step = cause.longest_step});
      }
      FittedRods rods(
          measured, [&](std::size_t, const Eigen::VectorXd& p) { return cause.changed(p); },
          unknowns);
      if (!goes_to_state(cause, rod, rods)) return;
      add_fit(cause, best_numbers(cause, rods), *rods.rods()[0]);
    } catch (const ConvergenceError&) {
      // No time is left.
    } catch (const InputError&) {
      // No scene, or a shape of too few points for one.
    }
  }

  /// To the state near the one that was compared with, or, where the rod is held in another way, to
  /// the lowest if that is nearer to the shape; false if there is none.
  [[nodiscard]] static bool goes_to_state(const SceneCause& cause,
                                          const energy_model::Equilibrium& rod, FittedRods& rods) {
    if (cause.start.isZero()) rods.go_on_from({rod});
    FittedRods::State state = rods.state(cause.start);
    if (cause.other_state) {
      rods.go_on_from({std::nullopt});
      FittedRods::State lowest = rods.state(cause.start);
      if (lowest.squares[0] < state.squares[0]) state = std::move(lowest);
    }
    rods.go_on_from(state.rods);
    return state.rods[0].has_value();
  }

  /// Numbers of a cause whose rod, that of `rods` then, is nearest to the shape.
  [[nodiscard]] Eigen::VectorXd best_numbers(const SceneCause& cause, FittedRods& rods) const {
    if (cause.stride.isZero()) return cause.start;
    const double noise = std::max(same_share * std::min(before_, another_shape * scene_.length),
                                  same_length * scene_.length);
    GaussNewton fit(rods, cause.start,
                    {.noise = noise, .last_step = 0.05, .least_gain = least_gain});
    const FittedRods::Rods start = rods.rods();
    try {
      (void)fit.descend();
    } catch (const ConvergenceError&) {
      // No time is left for more.
    }
    rods.go_on_from(fit.rods().empty() ? start : fit.rods());
    return fit.values();
  }

  void add_fit(const SceneCause& cause, const Eigen::VectorXd& p,
               const energy_model::Equilibrium& rod) {
    add({cause.words(p), rms_of(cause.changed(p), rod), static_cast<int>(p.size()),
         ExplanationKind::scene},
        cause.same_as);
  }

  const Scene& scene_;
  const MeasuredShape& shape_;
  const ShapeCheck& check_;
  const ShapeCheckOptions& options_;
  AlignOptions align_;
  double before_ = 0;
  std::vector<std::pair<Explanation, std::string>> found_;  // and what of several it is the best
  std::optional<Explanation> best_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace

std::vector<Explanation> explain_shape(const Scene& scene, const MeasuredShape& shape,
                                       const ShapeCheck& check, const ShapeCheckOptions& options) {
  return Search(scene, shape, check, options).run();
}

std::optional<Explanation> better_than_stiffness(const ShapeCheck& check,
                                                 const std::vector<Explanation>& explanations) {
  if (!is_identified(check.effective_modulus.optimum)) return std::nullopt;
  const auto price = [&check](double rms, int numbers) {
    return price_of(rms, numbers, check.whole_rms_m, check.length_m);
  };
  // E* is one number; a reason without any has to be as much better.
  const double of_stiffness = price(check.effective_modulus.rms_m, 0);
  for (const Explanation& explanation : explanations) {
    if (price(explanation.rms_m, std::max(1, explanation.numbers)) < of_stiffness) {
      return explanation;
    }
  }
  return std::nullopt;
}

ShapeJudgement judge_with_chains(const Scene& scene, const ShapeCheck& check,
                                 const ShapeTolerance& tolerance) {
  ShapeJudgement result = judge(check, tolerance);
  if (result.pass) return result;
  const Shape& shape = check.alignment.shape;
  for (const OwnPolygon& chain : own_polygons(scene, shape, Springs::as_the_rod)) {
    const double distance = tolerance.largest ? chain.max_m : chain.rms_m;
    if (!(distance <= right_chain * tolerance.allowed_m)) continue;
    result.reason = fmt::format("right for {}, {:.3g} mm away ({})",
                                words_of(chain.clamp, shape.points.cols() - 1) + and_springs(chain),
                                distance * 1e3, tolerance.largest ? "largest" : "RMS") +
                    fmt::format(", allowed {:.4g} mm = {:g} of the tolerance",
                                right_chain * tolerance.allowed_m * 1e3, right_chain) +
                    fmt::format("; the rod itself is {:.4g} mm = {:.3g} % of l away, all of it ",
                                result.judged_m * 1e3, result.judged_m / check.length_m * 100) +
                    "discretisation";
    result.pass = true;
    break;
  }
  return result;
}

ShapeJudgement with_explanation(ShapeJudgement judgement,
                                const std::vector<Explanation>& explanations,
                                const ShapeTolerance& tolerance) {
  if (judgement.pass || explanations.empty()) return judgement;
  const Explanation& best = explanations.front();
  const bool is_misread = judgement.judged_m > far_beyond * tolerance.allowed_m;
  if (best.kind == ExplanationKind::file && is_misread && best.rms_m <= tolerance.allowed_m) {
    judgement.reason = fmt::format("RMS {:.4g} mm if {}; as it was read: {}", best.rms_m * 1e3,
                                   best.cause, judgement.reason);
    return judgement;
  }
  judgement.reason += fmt::format(
      "; it would be {:.4g} mm (RMS) if {}", best.rms_m * 1e3,
      best.kind == ExplanationKind::discretisation ? "it were " + best.cause : best.cause);
  return judgement;
}

}  // namespace dlo::compare
