#include "dlo/compare/explanation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/timer.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/energy_model/interrupt.hpp"
#include "explain/cause_limits.hpp"
#include "explain/chain_convergence.hpp"
#include "explain/file_causes.hpp"
#include "explain/own_polygon.hpp"
#include "explain/scene_causes.hpp"
#include "shape/aligner.hpp"
#include "shape/curve.hpp"
#include "shape/shape_measure.hpp"

namespace dlo::compare {
namespace {

using energy_model::JointLaw;

namespace limits = cause_limits;

/// Returns the deviation up to which deviations count as equal [m].
double equal_deviation(double before, double length) {
  return std::max(limits::equality_share * std::min(before, limits::different_shape_share * length),
                  limits::equality_length_share * length);
}

/// Returns a criterion that combines the remaining deviation with the number of fitted numbers;
/// smaller is better. Remaining deviations below the limit of equality count as that limit.
/// @param before  deviation to explain [m];  @param length  of the rod [m]
double model_criterion(double rms, int numbers, double before, double length) {
  return std::max(rms, equal_deviation(before, length)) *
         std::pow(1 / limits::required_reduction_per_parameter, std::max(0, numbers));
}

/// Returns a shape with a straight extension of its last segment as last point.
Shape with_straight_extension(Shape shape, double length) {
  const Eigen::Index count = shape.points.cols();
  const Eigen::Vector3d end = 2 * shape.points.col(count - 1) - shape.points.col(count - 2);
  shape.points.conservativeResize(Eigen::NoChange, count + 1);
  shape.points.rightCols<1>() = end;
  shape.arc_length.push_back(length);
  return shape;
}

class Search {
 public:
  Search(const Scene& scene, const MeasuredShape& shape, const ShapeCheck& check,
         const ShapeCheckOptions& options)
      : scene_(scene), shape_(shape), check_(check), options_(options) {
    curves_.emplace_back(check.rod.sample, scene.length);
    for (const energy_model::Equilibrium& rod : check.other_rods) {
      curves_.emplace_back(rod.sample, scene.length);
    }
    align_.pose = options.pose;
    align_.arc_lengths = options.arc_lengths;
    align_.up = upward_direction(scene, options.pose);
    if (check.measured_points == 1) most_numbers_ = 1;
  }

  [[nodiscard]] std::vector<Explanation> run() {
    deviation_to_explain_ = check_.whole_rod_rms_m;
    // Without a deviation the check fails only because too little of the rod is observed.
    if (!(deviation_to_explain_ > limits::equality_length_share * scene_.length)) return {};
    if (options_.pose == PoseFreedom::known) {
      try_single_errors(scene_, shape_, check_,
                        [this](const FileCause& one) { try_file_cause(one); });
    }
    // The smoothed shape is compared with the rod at the points of the file.
    const auto noise = noise_of_points(check_.alignment.shape, check_.rod);
    if (noise && noise->rms_m <= limits::check_left * check_.deviation.rms_m) add(*noise);
    add_unstable_equilibrium();
    if (!cannot_improve_with(0)) add_chain_causes(Springs::rod_stiffness);
    if (!cannot_improve_with(1) && options_.pose == PoseFreedom::known) {
      try_joint_errors(scene_, shape_, check_.stretched_length_m,
                       [this](const FileCause& one) { try_file_cause(one); });
      add_chains_of_corrected_file();
    }
    for (const SceneCause& cause :
         scene_causes(scene_, check_.alignment.shape, estimated_shape_length(), lies_in_plane())) {
      const auto numbers = static_cast<int>(cause.start.size());
      if (numbers <= most_numbers_ && !cannot_improve_with(numbers) && !is_time_up()) fit(cause);
    }
    if (!cannot_improve_with(1)) add_chain_causes(Springs::fitted);
    if (!cannot_improve_with(1)) add_chain_causes(Springs::fitted, JointLaw::paper);
    std::stable_sort(found_.begin(), found_.end(), [this](const auto& a, const auto& b) {
      return criterion(a.first) < criterion(b.first);
    });
    // A combination of several errors of a file is reported if no other explanation is better, and
    // then none of these errors alone.
    const bool is_joint = !found_.empty() && found_.front().second == joint_cause;
    std::vector<Explanation> result;
    result.reserve(found_.size());
    for (auto& [explanation, cause_group] : found_) {
      const bool is_best = result.empty();
      if (!is_best && cause_group == joint_cause) continue;
      if (!is_best && is_joint && explanation.kind == ExplanationKind::file) continue;
      result.push_back(std::move(explanation));
    }
    return result;
  }

 private:
  [[nodiscard]] bool is_time_up() const {
    return timer_.seconds() > options_.solve.time_limit || energy_model::interrupted();
  }

  /// Whether no explanation with so many numbers could be better than the best one found.
  [[nodiscard]] bool cannot_improve_with(int numbers) const {
    return best_ && criterion(*best_) <= criterion({"", 0, numbers, ExplanationKind::scene});
  }

  /// Estimates the length of the shape [m]: its arcs are assumed to exceed their chords by the same
  /// ratio as those of the rod.
  [[nodiscard]] double estimated_shape_length() const {
    const std::vector<double>& s = check_.alignment.shape.arc_length;
    const double chords = arc_lengths_along(check_.reference.points).back();
    return check_.polyline_length_m * (s.back() - s.front()) / chords;
  }

  /// Returns the chains that may have the points of a shape, whose last end may be missing.
  [[nodiscard]] std::vector<CandidateChain> chains_for_shape(
      const Shape& shape, Springs springs, std::optional<JointLaw> law = std::nullopt) const {
    if (!lacks_last_segment_end(shape)) return candidate_chains(scene_, shape, springs, law);
    return candidate_chains(scene_, with_straight_extension(shape, scene_.length), springs, law,
                            LastPoint::missing);
  }

  [[nodiscard]] bool lacks_last_segment_end(const Shape& shape) const {
    const double segment = scene_.length / static_cast<double>(shape.points.cols());
    return lacks_one_segment(shape.points, scene_.length) && shape.arc_length.front() < segment / 4;
  }

  [[nodiscard]] std::string words_of(const CandidateChain& chain, const Shape& shape) const {
    const bool lacks_end = lacks_last_segment_end(shape);
    return dlo::compare::words_of(chain.clamp, shape.points.cols() - (lacks_end ? 0 : 1)) +
           (lacks_end ? ", its last end missing as in MuJoCo's xpos" : "");
  }

  /// Adds the chains that may have the points of the shape. @param law  as candidate_chains(); the
  /// shape of a chain with the paper's law depends on its number of segments
  void add_chain_causes(Springs springs, std::optional<JointLaw> law = std::nullopt) {
    constexpr double rms_floor_strain =
        1e-6;  // strain of a chain's segments; fits are not more accurate
    const Shape& shape = check_.alignment.shape;
    for (const CandidateChain& chain : chains_for_shape(shape, springs, law)) {
      const std::string words = words_of(chain, shape);
      if (law) {
        add({fmt::format("it is {}, with the paper's joint law, c_b = {:.3g} N, which does not "
                         "converge to the rod",
                         words, chain.paper_stiffness),
             std::max(chain.rms_m, rms_floor_strain * scene_.length), 1, ExplanationKind::scene},
            "the paper's joint law");
      } else if (springs == Springs::fitted) {
        const std::string own_law = law_words(chain);
        const std::string weight =
            is_loaded_by_weight_alone(scene_)
                ? fmt::format(", or the weight {:.3g} times", 1 / chain.stiffness)
                : "";
        add({fmt::format("it is {}, with springs of {:.3g} times EI/h{}{}{}", words,
                         chain.stiffness, own_law.empty() ? "" : ", ", own_law, weight),
             chain.rms_m, 1, ExplanationKind::scene},
            words);
      } else if (chain.rms_m <= limits::check_left * deviation_to_explain_ &&
                 chain_convergence(scene_, chain, check_.rod, false).error !=
                     ChainError::different_shape) {
        // Discretisation is the cause only if the chain converges to the rod.
        add({words + springs_clause(chain), chain.rms_m, 0, ExplanationKind::discretisation,
             chain.max_m},
            words);
      }
    }
  }

  /// Adds chains that fit the points of a file after its errors are corrected.
  void add_chains_of_corrected_file() {
    if (!best_corrected_ || cannot_improve_with(best_corrected_->numbers + 1)) return;
    const Shape& shape = best_corrected_->shape;
    for (const CandidateChain& chain : chains_for_shape(shape, Springs::rod_stiffness)) {
      add({best_corrected_->words + ", and it is " + words_of(chain, shape) + springs_clause(chain),
           chain.rms_m, best_corrected_->numbers + 1, ExplanationKind::file, chain.max_m},
          joint_cause);
    }
  }

  [[nodiscard]] bool lies_in_plane() const {
    const std::optional<Eigen::Vector3d> normal = scene_.plane_normal();
    if (!normal) return false;
    return out_of_plane(*normal, check_.alignment.shape.points) <
           limits::equality_share * deviation_to_explain_;
  }

  [[nodiscard]] double criterion(const Explanation& explanation) const {
    return model_criterion(explanation.rms_m, explanation.numbers, deviation_to_explain_,
                           scene_.length);
  }

  /// @param cause_group  name of a group of causes of which only the best is reported; empty: the
  /// cause itself
  void add(Explanation explanation, std::string cause_group = {}) {
    if (!(explanation.rms_m <= limits::check_left * deviation_to_explain_)) return;
    if (explanation.numbers > most_numbers_) return;
    if (!best_ || criterion(explanation) < criterion(*best_)) best_ = explanation;
    if (cause_group.empty()) cause_group = explanation.cause;
    const auto previous = std::find_if(found_.begin(), found_.end(), [&](const auto& other) {
      return other.second == cause_group || other.first.cause == explanation.cause;
    });
    if (previous == found_.end()) {
      found_.emplace_back(std::move(explanation), std::move(cause_group));
    } else if (criterion(explanation) < criterion(previous->first)) {
      previous->first = std::move(explanation);
    }
  }

  /// Adds the nearest unstable equilibrium, if any. A solver may find it if it is confined to the
  /// plane, or if it does not search for a minimum.
  void add_unstable_equilibrium() {
    double least = std::numeric_limits<double>::infinity();
    for (const UncomparedEquilibrium& other : check_.state.others) {
      if (!other.stable) least = std::min(least, other.rms_from_shape_m);
    }
    if (!std::isfinite(least)) return;
    const std::optional<Eigen::Vector3d> normal = scene_.plane_normal();
    const double out = normal ? out_of_plane(*normal, check_.reference.points) : 0;
    const bool left_plane =
        normal && out > limits::out_of_plane * scene_.length &&
        out_of_plane(*normal, check_.alignment.shape.points) < limits::equality_share * out;
    add({left_plane
             ? fmt::format("the file stays in the scene's plane, as a planar model does: the rod "
                           "is unstable there and leaves the plane by up to {:.3g} mm",
                           out * 1e3)
             : std::string("the rod rests at an unstable equilibrium, as found by a solver that "
                           "does not minimise the energy"),
         least, 0, ExplanationKind::scene});
  }

  /// Returns the largest distance of points from the scene's plane [m].
  [[nodiscard]] double out_of_plane(const Eigen::Vector3d& normal,
                                    const Eigen::Matrix3Xd& points) const {
    return (normal.transpose() * (points.colwise() - scene_.grippers.front().position))
        .cwiseAbs()
        .maxCoeff();
  }

  /// Aligns a shape with the stable equilibrium nearest to it. For a file that was read wrongly it
  /// may be another one than check_.rod.
  [[nodiscard]] std::pair<Alignment, Reference> nearest(const Aligner& aligner) const {
    std::pair<Alignment, Reference> result(aligner.align(curves_.front()), check_.rod.sample);
    for (std::size_t i = 1; i < curves_.size(); ++i) {
      Alignment other = aligner.align(curves_[i]);
      if (!(other.rms_m < result.first.rms_m)) continue;
      result = {std::move(other), check_.other_rods[i - 1].sample};
    }
    return result;
  }

  void try_file_cause(const FileCause& cause) {
    if (is_time_up()) return;
    AlignOptions options = align_;
    options.pose = cause.pose;
    try {
      const Aligner aligner(cause.shape, scene_.length, options);
      const auto& [aligned, sample] = nearest(aligner);
      const Measured measured = measure(aligned, sample, scene_.length);
      Explanation explanation{error_clauses(cause, aligned), measured.rms_m, cause.numbers,
                              ExplanationKind::file};
      // If points are omitted, they must have caused the deviation: the others must be near the
      // rod.
      if (cause.part && cause.shape.points.cols() < shape_.points.cols() &&
          !(measured.rms_m <= limits::check_left * check_.deviation.rms_m)) {
        return;
      }
      if (!cause.part) {
        explanation.rms_m = whole_rod_distances(measured, aligned, sample, scene_.length).rms_m;
      }
      const double this_criterion = criterion(explanation);
      const bool has_all_points = cause.shape.points.cols() == shape_.points.cols();
      if (has_all_points && explanation.rms_m <= limits::check_left * deviation_to_explain_ &&
          (!best_corrected_ || this_criterion < best_corrected_->criterion)) {
        best_corrected_ = {explanation.cause, aligned.shape, explanation.numbers, this_criterion};
      }
      add(std::move(explanation), cause.cause_group);
    } catch (const InputError&) {
      // The shape is invalid with this cause.
    }
  }

  /// Describes all errors of a file, including those found by aligning it.
  [[nodiscard]] std::string error_clauses(const FileCause& cause, const Alignment& aligned) const {
    std::string words = cause.words;
    const auto add_clause = [&words](const std::string& clause) {
      words += (words.empty() ? "" : ", and ") + clause;
    };
    if (cause.part && cause.shape.points.cols() == shape_.points.cols()) {
      add_clause(
          missing_ends_clause(aligned.shape.arc_length, aligned.shape.points, scene_.length));
    }
    if (cause.pose == PoseFreedom::translation) {
      const bool may_be_the_gripper = words.empty() && scene_.grippers.size() == 1;
      add_clause(origin_clause(aligned.pose.translation));
      if (may_be_the_gripper) words += ", or the gripper is elsewhere";
    }
    return words;
  }

  /// Returns the RMS deviation of the whole rod in the equilibrium that a cause results in [m].
  [[nodiscard]] double rms_of(const Scene& scene, const energy_model::Equilibrium& rod) const {
    const Alignment aligned =
        Aligner(shape_, scene.length, align_).align(Curve(rod.sample, scene.length));
    return whole_rod_distances(measure(aligned, rod.sample, scene.length), aligned, rod.sample,
                               scene.length)
        .rms_m;
  }

  void fit(const SceneCause& cause) {
    try {
      const std::optional<FittedCause> found =
          fit_cause(cause, shape_, check_.rod, options_,
                    equal_deviation(deviation_to_explain_, scene_.length), timer_);
      if (!found) return;
      const Scene changed = cause.changed(found->numbers);
      add({cause.words(changed, found->numbers), rms_of(changed, found->rod),
           static_cast<int>(found->numbers.size()), ExplanationKind::scene},
          cause.cause_group);
    } catch (const ResultError&) {
      // The scene is invalid, the shape has too few points for the cause, or no time is left.
    }
  }

  const Scene& scene_;
  const MeasuredShape& shape_;
  const ShapeCheck& check_;
  const ShapeCheckOptions& options_;
  std::vector<Curve> curves_;  // curves of the compared rod, then of other_rods
  AlignOptions align_;
  double deviation_to_explain_ = 0;
  int most_numbers_ = std::numeric_limits<int>::max();      // limit of fitted numbers
  std::vector<std::pair<Explanation, std::string>> found_;  // causes with their groups
  std::optional<Explanation> best_;
  /// The shape of a file after correction of the file's errors.
  struct CorrectedShape {
    std::string words;
    Shape shape;  // in the scene's frame
    int numbers;
    double criterion;
  };
  std::optional<CorrectedShape> best_corrected_;  // file with the smallest criterion
  Timer timer_;
};

}  // namespace

std::vector<Explanation> explain_shape(const Scene& scene, const MeasuredShape& shape,
                                       const ShapeCheck& check, const ShapeCheckOptions& options) {
  return Search(scene, shape, check, options).run();
}

std::optional<Explanation> cause_better_than_stiffness(
    const ShapeCheck& check, const std::vector<Explanation>& explanations) {
  if (!is_identified(check.effective_modulus.optimum)) return std::nullopt;
  const auto criterion = [&check](double rms, int numbers) {
    return model_criterion(rms, numbers, check.whole_rod_rms_m, check.length_m);
  };
  // E* counts as no number and each explanation as at least one number, so a cause must leave less
  // than half of the deviation that E* leaves.
  const double of_stiffness = criterion(check.effective_modulus.rms_m, 0);
  for (const Explanation& explanation : explanations) {
    if (criterion(explanation.rms_m, std::max(1, explanation.numbers)) < of_stiffness) {
      return explanation;
    }
  }
  return std::nullopt;
}

}  // namespace dlo::compare
