#include "explain/own_polygon.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "dlo/compare/bending_rule.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/energy_model/polygon.hpp"
#include "dlo/obstacle/body.hpp"
#include "polygon/shape_loads.hpp"
#include "scene/scene_problem.hpp"
#include "shape/curve.hpp"
#include "solve/held_frames.hpp"

namespace dlo::compare {
namespace {

/// Largest number of segments of a chain that can be distinguished from the rod itself.
constexpr Eigen::Index most_segments = 200;

/// Largest number of energy evaluations for a chain that may be that of the file. A file that is
/// not near a chain would need more.
constexpr int most_evaluations_near_file = 2000;

/// Largest number of energy evaluations for a chain with bisected segments, which starts farther
/// from its equilibrium.
constexpr int most_evaluations_refined = 20000;

using energy_model::JointLaw;

/// Joint laws that are Hookean for small angles; the one of most simulators comes first.
constexpr JointLaw hookean_laws[] = {JointLaw::linear, JointLaw::hooke, JointLaw::binormal};

/// Ratio by which the other laws must be farther from the points for one to be identified.
constexpr double law_identification_ratio = 2;

/// Distance, divided by the length, below which no law is identified: the chain's own stretch
/// contributes as much.
constexpr double least_identifying_distance = 1e-5;

/// Largest strain of a segment of a chain at rest [-]. Segments stretch by a millionth; a crushed
/// or torn one belongs to a polygon that is not the chain.
constexpr double largest_chain_strain = 1e-3;

/// Largest difference between the arc lengths of a gripper and of the file's point that it holds,
/// divided by the rod's length. Axial strain of the segments causes such a difference.
constexpr double same_arc_length = largest_chain_strain;

/// Largest distance of a clamp from the middle of the segment that it holds, in half segments.
constexpr double middle_tolerance = 0.1;

/// Position at which a gripper holds a chain.
struct HoldLocation {
  Eigen::Index point = 0;  ///< index of the held point, or of the first point of the segment
  bool segment = false;    ///< whether a clamp holds the middle of the segment after the point
};

/// Returns the position at which a gripper holds the chain; std::nullopt if it holds neither a
/// point nor, as a clamp, the middle of a segment.
/// @param s  arc lengths of the chain's points [m]
std::optional<HoldLocation> hold_location(const Gripper& gripper, const std::vector<double>& s) {
  const auto above = std::upper_bound(s.begin() + 1, s.end() - 1, gripper.at);
  const Eigen::Index right = above - s.begin();
  const double before = gripper.at - s[static_cast<std::size_t>(right - 1)];
  const double behind = *above - gripper.at;
  if (std::min(before, behind) < same_arc_length * s.back()) {
    return HoldLocation{before < behind ? right - 1 : right};
  }
  const bool is_middle = std::abs(before - behind) < middle_tolerance * (before + behind);
  if (!gripper.direction || !is_middle) return std::nullopt;
  return HoldLocation{right - 1, true};
}

/// Returns the lengths of the segments: the distances of the points, scaled so that between
/// grippers and ends their sum is the rod's length there.
Eigen::VectorXd rest_lengths(const Scene& scene, const Eigen::Matrix3Xd& points) {
  const Eigen::Index n = points.cols() - 1;
  const Eigen::VectorXd chords = chord_lengths(points);
  double along = 0;
  std::vector<double> s = {along};
  for (const double h : chords) s.push_back(along += h * scene.length / chords.sum());
  s.back() = scene.length;  // removes rounding
  std::vector<std::pair<double, double>> known = {{0, 0}, {scene.length, scene.length}};
  for (const Gripper& gripper : scene.grippers) {
    const std::optional<HoldLocation> held = hold_location(gripper, s);
    if (!held || gripper.at <= 0 || gripper.at >= scene.length) continue;
    const auto i = static_cast<std::size_t>(held->point);
    known.emplace_back(held->segment ? (s[i] + s[i + 1]) / 2 : s[i], gripper.at);
  }
  std::ranges::sort(known);
  std::vector<double> from;
  std::vector<double> to;
  for (const auto& [measured, at] : known) {
    from.push_back(measured);
    to.push_back(at);
  }
  s = interpolated(to, from, s);
  const Eigen::Map<const Eigen::VectorXd> at(s.data(), n + 1);
  return at.tail(n) - at.head(n);
}

/// Returns c_b of the paper's law [N] as models force and chain use it in this scene; if they
/// reject the scene, that of Formula 21 for the curvature 1/l.
double paper_stiffness(const Scene& scene, Eigen::Index segments, ChainClamp clamp) {
  ForceModelSettings settings = scene.force_model;
  settings.law = BendingLaw::paper;
  settings.joint_law.reset();
  settings.points = static_cast<int>(segments) + 1;
  settings.bookkeeping = clamp == ChainClamp::middle ? Bookkeeping::consistent : Bookkeeping::paper;
  if (settings.bookkeeping == Bookkeeping::consistent) settings.point_weight.reset();
  try {
    return discretise(scene, settings).parameters.c_b;
  } catch (const InputError&) {
    return paper_bending_stiffness(BendingRule::formula_21, scene.bending_stiffness(),
                                   1 / scene.length, scene.length / static_cast<double>(segments));
  }
}

class Chain {
 public:
  /// @param points  initial guess of the rest shape, with which it is compared too [m]
  /// @param lengths  rest lengths of the segments between the points [m]
  Chain(const Scene& scene, const Eigen::Matrix3Xd& points, Eigen::VectorXd lengths,
        ChainClamp clamp, LastPoint last)
      : scene_(scene), points_(points), clamp_(clamp), last_(last), inner_(std::move(lengths)) {
    s_.push_back(0);
    for (const double L : inner_) s_.push_back(s_.back() + L);
    s_.back() = scene.length;  // removes rounding
  }

  /// Whether the grippers of this scene can hold the chain; prepares its problem.
  [[nodiscard]] bool prepare_if_holdable() {
    // No held point may be moved to where its neighbour in the file is.
    if (!hold() || !(chord_lengths(start()).minCoeff() > 0)) return false;
    lay_out();
    add_twists();
    return true;
  }

  /// Returns the chain's points at rest; std::nullopt if the chain does not come to rest or is
  /// strained.
  /// @param factor  factor on the stiffness of the springs
  [[nodiscard]] std::optional<Eigen::Matrix3Xd> at_rest(
      double factor, JointLaw law, int max_evaluations = most_evaluations_near_file) const {
    energy_model::PolygonProblem problem = problem_;
    problem.law = law;
    problem.stiffness *= factor;
    problem.stiffnesses *= factor;
    for (energy_model::PolygonTwist& twist : problem.twists) twist.compliance /= factor;
    energy_model::PolygonOptions options;
    options.max_evaluations = max_evaluations;
    options.in_stages = false;
    const energy_model::PolygonResult rest = energy_model::solve_polygon(problem, start(), options);
    if (!energy_model::succeeded(rest.status) || is_strained(rest.points)) return std::nullopt;
    return rest.points.middleCols(before_, points_.cols());
  }

  /// Returns the file's points minus the chain's points; zero at a point that the file lacks.
  [[nodiscard]] Eigen::Matrix3Xd gaps(const Eigen::Matrix3Xd& rest) const {
    Eigen::Matrix3Xd gaps = points_ - rest;
    if (last_ == LastPoint::missing) gaps.rightCols<1>().setZero();
    return gaps;
  }

  /// Returns the chain as a result. @param rest  its points at rest
  [[nodiscard]] CandidateChain polygon(Eigen::Matrix3Xd rest, double stiffness,
                                       JointLaw law) const {
    const Eigen::Matrix3Xd gaps = this->gaps(rest);
    CandidateChain result{
        .clamp = clamp_, .rms_m = rms_of(gaps), .stiffness = stiffness, .law = law};
    result.max_m = std::sqrt(gaps.colwise().squaredNorm().maxCoeff());
    result.rest = {s_, std::move(rest)};
    if (law == JointLaw::paper) {
      result.paper_stiffness = stiffness * problem_.stiffness;
      return result;
    }
    const Eigen::VectorXd& h = problem_.rest_lengths;
    for (Eigen::Index j = 0; j + 1 < h.size(); ++j) {
      const double EI =
          problem_.stiffnesses.size() > 0 ? problem_.stiffnesses[j] : problem_.stiffness;
      // With a hinge at the clamp the first joint is at the first point, otherwise at the point
      // behind it.
      result.joints.push_back(s_[static_cast<std::size_t>(j + 1 - before_)]);
      result.springs.push_back(stiffness * EI / ((h[j] + h[j + 1]) / 2));
    }
    return result;
  }

  /// Sets the stiffness of the paper's joint law and, if the chain is welded, the paper's points of
  /// equal weight.
  void set_paper_law() {
    problem_.stiffness = paper_stiffness(scene_, inner_.size(), clamp_);
    problem_.stiffnesses.resize(0);
    if (clamp_ != ChainClamp::welded) return;
    const auto count = static_cast<double>(points_.cols());
    const Eigen::Vector3d weight = scene_.weight_between(0, scene_.length) / count;
    problem_.node_forces += (-weights_).colwise() + weight;
  }

  [[nodiscard]] double rms_of(const Eigen::Matrix3Xd& gaps) const { return rms(s_, gaps); }

 private:
  [[nodiscard]] bool is_strained(const Eigen::Matrix3Xd& points) const {
    const Eigen::VectorXd& h = problem_.rest_lengths;
    return !((chord_lengths(points) - h).cwiseAbs().cwiseQuotient(h).maxCoeff() <=
             largest_chain_strain);
  }

  /// Holds the segment that a clamp inside the rod holds: the one whose middle is at the clamp, or,
  /// if welded to a point, the one that begins there.
  /// @return whether the chain's kind of clamp is possible there; a hinge is not
  [[nodiscard]] bool constrain_inner_segment(const Gripper& clamp, const HoldLocation& at) {
    if (clamp_ != (at.segment ? ChainClamp::middle : ChainClamp::welded)) return false;
    has_inner_clamp_ = true;
    for (const Eigen::Index i : {at.point, at.point + 1}) {
      const double shift = s_[static_cast<std::size_t>(i)] - clamp.at;
      problem_.held.push_back({i + before_, clamp.position + shift * *clamp.direction});
    }
    return true;
  }

  /// Returns the clamp that holds this point of the file; null if none does.
  [[nodiscard]] const Gripper* clamp_at(Eigen::Index point) const {
    const auto clamp = std::ranges::find_if(scene_.grippers, [&](const Gripper& gripper) {
      const std::optional<HoldLocation> held = hold_location(gripper, s_);
      return gripper.direction && held && !held->segment && held->point == point;
    });
    return clamp == scene_.grippers.end() ? nullptr : &*clamp;
  }

  /// Holds the second point of the segment at a clamp at an end of the rod: the file's own segment,
  /// or a segment beyond the rod if the chain has a hinge at the clamp.
  void constrain_end_direction(const Gripper& clamp, bool at_start) {
    const Eigen::Index n = inner_.size();
    const bool hinged = clamp_ == ChainClamp::hinge;
    const double h = at_start ? inner_[0] : inner_[n - 1];
    const double shift = at_start != hinged ? h : -h;
    const Eigen::Index beyond = at_start ? 0 : n + before_ + 1;
    const Eigen::Index inside = at_start ? 1 : n - 1;
    problem_.held.push_back({hinged ? beyond : inside, clamp.position + shift * *clamp.direction});
  }

  /// Whether the segment at each clamp of an end is half as long as the next one.
  [[nodiscard]] bool ends_in_half_segments() const {
    const Eigen::Index n = inner_.size();
    const auto is_half = [](double end, double neighbour) {
      return std::abs(end / neighbour - 0.5) < 0.1;
    };
    return (!is_clamped_at_start_ || is_half(inner_[0], inner_[1])) &&
           (!is_clamped_at_end_ || is_half(inner_[n - 1], inner_[n - 2]));
  }

  /// Sets the held points.
  /// @return whether the grippers can hold the chain in this way at the file's points
  [[nodiscard]] bool hold() {
    const bool hinged = clamp_ == ChainClamp::hinge;
    const Gripper* const first = clamp_at(0);
    const Gripper* const last = clamp_at(inner_.size());
    is_clamped_at_start_ = first != nullptr;
    is_clamped_at_end_ = last != nullptr;
    before_ = is_clamped_at_start_ && hinged ? 1 : 0;
    after_ = is_clamped_at_end_ && hinged ? 1 : 0;
    for (const Gripper& gripper : scene_.grippers) {
      const std::optional<HoldLocation> at = hold_location(gripper, s_);
      if (!at) return false;
      if (gripper.direction && &gripper != first && &gripper != last) {
        if (!constrain_inner_segment(gripper, *at)) return false;
      } else {
        problem_.held.push_back({at->point + before_, gripper.position});
      }
    }
    if (first != nullptr) constrain_end_direction(*first, true);
    if (last != nullptr) constrain_end_direction(*last, false);
    if (has_doubly_held_point()) return false;
    // Chains held only by pins are equal with all three clamps, so only one of them counts.
    if (first == nullptr && last == nullptr) return hinged || has_inner_clamp_;
    return clamp_ != ChainClamp::middle || ends_in_half_segments();
  }

  /// Whether two grippers hold the same point.
  [[nodiscard]] bool has_doubly_held_point() const {
    std::vector<Eigen::Index> points;
    for (const energy_model::HeldPoint& held : problem_.held) points.push_back(held.point);
    std::ranges::sort(points);
    return std::ranges::adjacent_find(points) != points.end();
  }

  void lay_out() {
    const Eigen::Index n = inner_.size();
    problem_.rest_lengths.resize(n + before_ + after_);
    problem_.rest_lengths << Eigen::VectorXd::Constant(before_, inner_[0]), inner_,
        Eigen::VectorXd::Constant(after_, inner_[n - 1]);
    const double stiffness = scene_.bending_stiffness();
    const double l = scene_.length;
    const double force =
        stiffness / (l * l) + scene_.weight_per_length().norm() * l + scene_.total_load_magnitude();
    // The segments stretch by about a millionth.
    problem_.stretch_stiffness = 1e6 * force;
    problem_.stiffness = stiffness;
    if (clamp_ == ChainClamp::middle) {
      // The spring has the stiffness between two whole segments.
      problem_.stiffnesses.setConstant(problem_.rest_lengths.size() - 1, stiffness);
      const auto whole = [&](Eigen::Index half, Eigen::Index next) {
        return (inner_[half] + inner_[next]) / (2 * inner_[half] + inner_[next]);
      };
      if (is_clamped_at_start_) problem_.stiffnesses[0] *= whole(0, 1);
      if (is_clamped_at_end_) problem_.stiffnesses[n - 2] *= whole(n - 1, n - 2);
    }
    const PointForces forces = forces_on_points(scene_, s_);
    weights_.setZero(3, n + 1 + before_ + after_);
    weights_.middleCols(before_, n + 1) = forces.weights;
    problem_.node_forces = weights_;
    problem_.node_forces.middleCols(before_, n + 1) += forces.loads;
    const Eigen::VectorXd h = whole_segment_lengths();
    for (const std::size_t i : obstacles_in_reach(scene_)) {
      const Obstacle& obstacle = scene_.obstacles[i];
      problem_.obstacles.push_back({obstacle.body, problem_.stretch_stiffness / h.maxCoeff(),
                                    obstacle::samples_per_segment(obstacle.body, h.maxCoeff())});
      if (!std::isfinite(obstacle.stiffness)) continue;
      problem_.obstacles.back().stiffnesses = obstacle.stiffness * h;
    }
  }

  /// Returns the lengths of the segments. The file has half of the whole segment that a clamp at an
  /// end of the rod holds in its middle.
  [[nodiscard]] Eigen::VectorXd whole_segment_lengths() const {
    Eigen::VectorXd h = problem_.rest_lengths;
    if (clamp_ == ChainClamp::middle && is_clamped_at_start_) h[0] *= 2;
    if (clamp_ == ChainClamp::middle && is_clamped_at_end_) h[h.size() - 1] *= 2;
    return h;
  }

  /// Adds the twist between clamps that hold frames, with the turns of the points.
  void add_twists() {
    if (!scene_.prescribes_twist()) return;
    const energy_model::Problem rod = scene_problem(scene_);
    const std::vector<std::size_t> framed = framed_grippers(scene_);
    const Eigen::VectorXd h = whole_segment_lengths();
    for (std::size_t k = 1; k < framed.size(); ++k) {
      const force_model::TwistedSpan span =
          held_span(rod, framed[k - 1], framed[k], held_segment(framed[k - 1]),
                    held_segment(framed[k]), start());
      // The torsional compliance of a joint is that of half of both adjacent segments, as in
      // discretise().
      const Eigen::Index joints = span.last_segment - span.first_segment;
      const double length =
          (h.segment(span.first_segment, joints) + h.segment(span.first_segment + 1, joints))
              .sum() /
          2;
      problem_.twists.push_back({span.first_segment, span.last_segment, span.first_d1, span.last_d1,
                                 length / scene_.twisting_stiffness(), span.angle});
    }
  }

  /// Returns the first point of the segment that a clamp holds.
  [[nodiscard]] Eigen::Index held_segment(std::size_t gripper) const {
    const HoldLocation at = *hold_location(scene_.grippers[gripper], s_);
    const Eigen::Index last = problem_.rest_lengths.size() - 1;
    if (at.segment) return at.point;
    return at.point == 0 ? 0 : std::min(at.point + before_, last);
  }

  [[nodiscard]] Eigen::Matrix3Xd start() const {
    Eigen::Matrix3Xd start(3, points_.cols() + before_ + after_);
    start.middleCols(before_, points_.cols()) = points_;
    for (const energy_model::HeldPoint& held : problem_.held) start.col(held.point) = held.position;
    return start;
  }

  const Scene& scene_;
  const Eigen::Matrix3Xd& points_;
  ChainClamp clamp_;
  LastPoint last_;
  Eigen::VectorXd inner_;  // rest lengths of the file's own segments
  std::vector<double> s_;  // arc lengths of the file's points
  energy_model::PolygonProblem problem_;
  Eigen::Matrix3Xd weights_;             // the part of node_forces that is gravity [N]
  Eigen::Index before_ = 0, after_ = 0;  // numbers of points beyond the rod's ends
  bool is_clamped_at_start_ = false, is_clamped_at_end_ = false, has_inner_clamp_ = false;
};

/// Returns the chain with the springs that fit best, by Gauss-Newton steps along the logarithm of
/// their stiffness; std::nullopt if a chain with slightly stiffer springs does not come to rest.
std::optional<CandidateChain> fitted(const Chain& chain, Eigen::Matrix3Xd rest, JointLaw law) {
  constexpr int most_steps = 10;
  constexpr double difference_step = 0.01;
  constexpr double found = 1e-4;
  double log_factor = 0;
  for (int step = 0; step < most_steps; ++step) {
    const std::optional<Eigen::Matrix3Xd> perturbed =
        chain.at_rest(std::exp(log_factor + difference_step), law);
    if (!perturbed) return std::nullopt;
    const Eigen::Matrix3Xd gaps = chain.gaps(rest);
    const Eigen::Matrix3Xd slope = (chain.gaps(*perturbed) - gaps) / difference_step;
    if (!(slope.squaredNorm() > 0)) break;  // a straight chain does not depend on its springs
    const double shift =
        std::clamp(-slope.cwiseProduct(gaps).sum() / slope.squaredNorm(), -1.0, 1.0);
    std::optional<Eigen::Matrix3Xd> next = chain.at_rest(std::exp(log_factor + shift), law);
    if (!next || !(chain.rms_of(chain.gaps(*next)) < chain.rms_of(gaps))) break;
    log_factor += shift;
    rest = std::move(*next);
    if (std::abs(shift) < found) break;
  }
  return chain.polygon(std::move(rest), std::exp(log_factor), law);
}

std::optional<CandidateChain> with_law(const Chain& chain, Springs springs, JointLaw law) {
  std::optional<Eigen::Matrix3Xd> rest = chain.at_rest(1, law);
  if (!rest) return std::nullopt;
  if (springs == Springs::fitted) return fitted(chain, std::move(*rest), law);
  return chain.polygon(std::move(*rest), 1, law);
}

/// Returns the chain with the law that fits best, or with the first law if none is identified.
std::optional<CandidateChain> with_best_law(const Chain& chain, Springs springs, double length) {
  std::vector<CandidateChain> found;
  for (const JointLaw law : hookean_laws) {
    if (std::optional<CandidateChain> one = with_law(chain, springs, law)) found.push_back(*one);
  }
  if (found.empty()) return std::nullopt;
  const CandidateChain first = found.front();
  std::ranges::stable_sort(found, {}, &CandidateChain::rms_m);
  CandidateChain& best = found.front();
  const double next = found.size() > 1 ? found[1].rms_m : 0;  // distance with the second-best law
  best.is_law_identified =
      next > law_identification_ratio * best.rms_m && next > least_identifying_distance * length;
  return best.is_law_identified ? best : first;
}

}  // namespace

std::string words_of(ChainClamp clamp, Eigen::Index segments) {
  return fmt::format("a chain of {} segments{}", segments,
                     clamp == ChainClamp::hinge    ? " with a hinge at the clamp"
                     : clamp == ChainClamp::welded ? ", welded to its clamps"
                                                   : ", clamped in the middle of a segment");
}

std::string law_words(const CandidateChain& chain) {
  if (!chain.is_law_identified) return "";
  return chain.law == JointLaw::linear  ? "linear in the angle"
         : chain.law == JointLaw::hooke ? "linear in 2 tan(angle/2)"
                                        : "those of discrete elastic rods";
}

std::string springs_clause(const CandidateChain& chain) {
  const std::string law = law_words(chain);
  return law.empty() ? "" : ", its springs EI/h and " + law;
}

std::vector<CandidateChain> candidate_chains(const Scene& scene, const Shape& shape,
                                             Springs springs, std::optional<JointLaw> law,
                                             LastPoint last) {
  const Eigen::Index segments = shape.points.cols() - 1;
  const bool plain =
      scene.sections.empty() && !scene.has_material_directors() && !scene.has_couples();
  const bool has_law = law != JointLaw::paper || !scene.prescribes_twist();
  if (!plain || !has_law || segments < 4 || segments > most_segments) return {};
  std::vector<CandidateChain> found;
  for (const ChainClamp clamp : {ChainClamp::hinge, ChainClamp::welded, ChainClamp::middle}) {
    Chain chain(scene, shape.points, rest_lengths(scene, shape.points), clamp, last);
    if (!chain.prepare_if_holdable()) continue;
    if (law == JointLaw::paper) chain.set_paper_law();
    const std::optional<CandidateChain> one =
        law ? with_law(chain, springs, *law) : with_best_law(chain, springs, scene.length);
    if (one) found.push_back(*one);
  }
  return found;
}

std::optional<Shape> chain_at_rest(const Scene& scene, const Shape& start,
                                   const CandidateChain& candidate) {
  const auto n = static_cast<Eigen::Index>(start.arc_length.size()) - 1;
  const Eigen::Map<const Eigen::VectorXd> s(start.arc_length.data(), n + 1);
  Chain chain(scene, start.points, s.tail(n) - s.head(n), candidate.clamp, LastPoint::there);
  if (!chain.prepare_if_holdable()) return std::nullopt;
  std::optional<Eigen::Matrix3Xd> rest =
      chain.at_rest(candidate.stiffness, candidate.law, most_evaluations_refined);
  if (!rest) return std::nullopt;
  return chain.polygon(*std::move(rest), candidate.stiffness, candidate.law).rest;
}

}  // namespace dlo::compare
