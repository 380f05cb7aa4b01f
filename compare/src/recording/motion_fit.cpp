#include "recording/motion_fit.hpp"

#include <fmt/format.h>
#include <gsl/gsl_multifit_nlinear.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <utility>

#include "base/gsl.hpp"
#include "dlo/compare/error.hpp"
#include "recording/motion_residuals.hpp"

namespace dlo::compare {
namespace {

/// Of the logarithms of the numbers: derivatives by differences, which errors of the simulation
/// (1e-7 l a step) hardly disturb.
constexpr double log_difference = 3e-3;
constexpr int most_fit_steps = 40;
/// On the beginning, where next to nothing says how it is damped.
constexpr int most_first_steps = 6;
/// Movement of the rod that is none, divided by the rod length: ten times the error of a step of
/// the simulation.
constexpr double no_movement = 1e-6;
/// A number is looked for within this factor of where it begins.
constexpr double widest_factor = 1e4;

enum class Sought { stiffness, material, air, quadratic };

/// Rows of one time: indices of MarkerMotion::positions.
struct RecordedFrame {
  double time = 0;
  std::size_t begin = 0, end = 0;
};

std::vector<RecordedFrame> frames_of(const MarkerMotion& recorded) {
  std::vector<RecordedFrame> frames;
  for (std::size_t i = 0; i < recorded.positions.size(); ++i) {
    const double time = recorded.positions[i].time;
    if (frames.empty() || time > frames.back().time) frames.push_back({time, i, i});
    frames.back().end = i + 1;
  }
  return frames;
}

/// Simulations of one scene beside its recording.
class MotionMisfit {
 public:
  MotionMisfit(const Scene& scene, const MarkerMotion& recorded, const MotionFitOptions& options)
      : scene_(scene), recorded_(recorded), options_(options), frames_(frames_of(recorded)) {
    for (const MarkerPosition& at : recorded.positions) {
      if (on_rod(at.arc_length, scene.length)) continue;
      throw InputError(fmt::format("{}: a marker at s = {:g} m (allowed: 0 to the rod's {:g} m)",
                                   recorded.file, at.arc_length, scene.length));
    }
    if (frames_.size() < 2)
      throw InputError(recorded.file + ": one time only (allowed: two or more)");
    const double time =
        std::sqrt(scene.mass() * std::pow(scene.length, 3) / scene.softer_bending_stiffness());
    const double drag = scene.mass() / scene.length / time;
    const auto seek = [&](bool wanted, Sought what, double known, double usual) {
      if (!wanted) return;
      sought_.push_back(what);
      first_.push_back(known > 0 ? known : usual);
    };
    // What vibrates in the natural time then loses some percent in each period.
    constexpr double light = 0.02;
    seek(true, Sought::stiffness, 1, 1);
    seek(options.material, Sought::material, options.damping.material, light * time);
    seek(options.air, Sought::air, options.damping.air, light * drag);
    seek(options.quadratic, Sought::quadratic, options.damping.quadratic,
         light * drag * time / scene.length);
    look_at(1);
  }

  /// The first so many of the times, as a share of all.
  void look_at(double share) {
    const auto all = static_cast<double>(frames_.size());
    looked_at_ = std::clamp<std::size_t>(static_cast<std::size_t>(share * all), 2, frames_.size());
  }

  [[nodiscard]] const std::vector<RecordedFrame>& frames() const { return frames_; }
  [[nodiscard]] const std::vector<Sought>& sought() const { return sought_; }
  [[nodiscard]] std::size_t coordinates() const { return 3 * frames_[looked_at_ - 1].end; }
  [[nodiscard]] int simulations() const { return simulations_; }
  [[nodiscard]] int terms() const { return terms_; }
  [[nodiscard]] bool in_motion() const { return in_motion_; }

  /// Of the numbers' logarithms over where they begin.
  [[nodiscard]] double value(std::size_t number, double log) const {
    const double most = std::log(widest_factor);
    return first_[number] * std::exp(std::clamp(log, -most, most));
  }
  [[nodiscard]] RodDamping damping(const Eigen::VectorXd& logs) const {
    RodDamping result = options_.damping;
    for (std::size_t i = 0; i < sought_.size(); ++i) {
      const double at = value(i, logs[static_cast<Eigen::Index>(i)]);
      if (sought_[i] == Sought::material) result.material = at;
      if (sought_[i] == Sought::air) result.air = at;
      if (sought_[i] == Sought::quadratic) result.quadratic = at;
    }
    return result;
  }

  /// Simulated less recorded coordinates; far off where the simulation does not come to its end.
  Eigen::VectorXd residuals(const Eigen::VectorXd& logs) {
    Scene scene = scene_;
    scene.scale_modulus(value(0, logs[0]));
    return simulated(scene, damping(logs));
  }
  /// Of the scene as it is.
  Eigen::VectorXd given() { return simulated(scene_, options_.damping); }

  /// Checks that the last simulation moves the rod at the markers between the recorded times.
  /// @throws InputError if it does not: every stiffness and damping then fits the recording
  void require_movement() const {
    if (!stopped_.empty() || movement_ > no_movement * scene_.length) return;
    const TimeSpan motion = *motion_of(scene_);
    throw InputError(fmt::format(
        "{}: the rod does not move at the markers of all {} rows, time = {:g} to {:g} s, so they "
        "identify neither stiffness nor damping (allowed: times in which it moves; {} moves it "
        "from {:g} to {:g} s)",
        recorded_.file, recorded_.positions.size(), frames_.front().time, frames_.back().time,
        scene_.file, motion.begin, motion.end));
  }

  /// Why the last simulation did not come to its end; empty: it did.
  [[nodiscard]] const std::string& stopped() const { return stopped_; }

 private:
  Eigen::VectorXd simulated(const Scene& scene, const RodDamping& damping) {
    ++simulations_;
    std::vector<double> times;
    for (std::size_t k = 0; k < looked_at_; ++k) times.push_back(frames_[k].time);
    const FrameClock clock(
        scene, {times.front(), times.back()},
        {.frames = static_cast<double>(looked_at_ - 1) / (times.back() - times.front())});
    const MovingScene moving(scene, clock, damping, options_.solve);
    const SimulatedMotion run = moving.run(times, terms_);
    in_motion_ = moving.in_motion();
    Eigen::VectorXd result =
        Eigen::VectorXd::Constant(static_cast<Eigen::Index>(coordinates()), scene.length);
    stopped_ = run.moved.frames.size() < times.size() ? run.why_stopped() : "";
    if (!stopped_.empty()) return result;
    terms_ = run.moved.terms;
    movement_ = 0;
    for (std::size_t k = 0; k < looked_at_; ++k) {
      std::vector<double> s;
      for (std::size_t i = frames_[k].begin; i < frames_[k].end; ++i) {
        s.push_back(*on_rod(recorded_.positions[i].arc_length, scene.length));
      }
      const Eigen::Matrix3Xd points = run.moved.frames[k].sample(s).points;
      const Eigen::Matrix3Xd moved = points - run.moved.frames.front().sample(s).points;
      movement_ = std::max(movement_, moved.colwise().norm().maxCoeff());
      for (std::size_t i = 0; i < s.size(); ++i) {
        const std::size_t row = frames_[k].begin + i;
        result.segment<3>(static_cast<Eigen::Index>(3 * row)) =
            points.col(static_cast<Eigen::Index>(i)) - recorded_.positions[row].position;
      }
    }
    return result;
  }

  const Scene& scene_;
  const MarkerMotion& recorded_;
  const MotionFitOptions& options_;
  std::vector<RecordedFrame> frames_;
  std::vector<Sought> sought_;
  std::vector<double> first_;
  std::size_t looked_at_ = 0;
  int simulations_ = 0;
  int terms_ = 0;  // that the last one took; 0: none yet
  bool in_motion_ = false;
  double movement_ = 0;  // largest distance of a marker from where the last simulation began [m]
  std::string stopped_;
};

/// Residuals and their derivatives by the logarithms, where the least squares are.
struct NearestMotion {
  Eigen::VectorXd logs, residuals;
  Eigen::MatrixXd design;
};

/// (J^T J)^-1; of what the residuals do not see none.
Eigen::MatrixXd inverse_normal(const Eigen::MatrixXd& design) {
  return (design.transpose() * design).completeOrthogonalDecomposition().pseudoInverse();
}

/// Whether a full step would move no number by as much as this share of its standard deviation.
bool is_least(const NearestMotion& at) {
  constexpr double last_step = 0.01;
  const Eigen::MatrixXd inverse = inverse_normal(at.design);
  const Eigen::VectorXd step = inverse * (at.design.transpose() * at.residuals);
  const double variance =
      at.residuals.squaredNorm() / static_cast<double>(at.residuals.size() - at.logs.size());
  return (step.array().abs() <= last_step * (variance * inverse.diagonal()).array().sqrt()).all();
}

Eigen::MatrixXd design_at(MotionMisfit& misfit, const Eigen::VectorXd& logs,
                          const Eigen::VectorXd& here) {
  Eigen::MatrixXd result(here.size(), logs.size());
  for (Eigen::Index i = 0; i < logs.size(); ++i) {
    Eigen::VectorXd beside = logs;
    beside[i] += log_difference;
    result.col(i) = (misfit.residuals(beside) - here) / log_difference;
  }
  return result;
}

Eigen::Map<const Eigen::VectorXd> mapped(const gsl_vector* v) {
  return {v->data, static_cast<Eigen::Index>(v->size)};
}

auto rows_of(const gsl_matrix* J) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<Rows, 0, Eigen::OuterStride<>>(
      J->data, static_cast<Eigen::Index>(J->size1), static_cast<Eigen::Index>(J->size2),
      Eigen::OuterStride<>(static_cast<Eigen::Index>(J->tda)));
}

/// The misfit as GSL calls it: no exception passes GSL, the first is kept.
struct GslProblem {
  MotionMisfit& misfit;
  Eigen::VectorXd logs, residuals;  // of the last call
  std::exception_ptr failed;

  template <typename Function>
  int guarded(const Function& function) {
    try {
      function();
    } catch (...) {
      failed = std::current_exception();
      return GSL_EFAILED;
    }
    return GSL_SUCCESS;
  }
  int evaluate(const gsl_vector* x, gsl_vector* f) {
    return guarded([&] {
      logs = mapped(x);
      residuals = misfit.residuals(logs);
      Eigen::Map<Eigen::VectorXd>(f->data, residuals.size()) = residuals;
    });
  }
  int differentiate(const gsl_vector* x, gsl_matrix* J) {
    return guarded([&] {
      const Eigen::VectorXd at = mapped(x);
      const bool known = logs.size() == at.size() && logs == at;
      rows_of(J) = design_at(misfit, at, known ? residuals : misfit.residuals(at));
    });
  }
};

/// Levenberg's and Marquardt's steps by GSL.
NearestMotion least_squares(MotionMisfit& misfit, const Eigen::VectorXd& start, int most_steps) {
  GslProblem problem{misfit, {}, {}, nullptr};
  silence_gsl();
  gsl_multifit_nlinear_fdf fdf{};
  fdf.n = misfit.coordinates();
  fdf.p = static_cast<std::size_t>(start.size());
  fdf.params = &problem;
  fdf.f = [](const gsl_vector* x, void* data, gsl_vector* f) {
    return static_cast<GslProblem*>(data)->evaluate(x, f);
  };
  fdf.df = [](const gsl_vector* x, void* data, gsl_matrix* J) {
    return static_cast<GslProblem*>(data)->differentiate(x, J);
  };
  const gsl_multifit_nlinear_parameters parameters = gsl_multifit_nlinear_default_parameters();
  const auto work =
      gsl_owned(gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &parameters, fdf.n, fdf.p),
                gsl_multifit_nlinear_free);
  const gsl_vector_const_view first = gsl_vector_const_view_array(start.data(), fdf.p);
  int status = gsl_multifit_nlinear_init(&first.vector, &fdf, work.get());
  NearestMotion result;
  for (int step = 0; step < most_steps && status == GSL_SUCCESS; ++step) {
    status = gsl_multifit_nlinear_iterate(work.get());
    result.logs = mapped(gsl_multifit_nlinear_position(work.get()));
    result.residuals = mapped(gsl_multifit_nlinear_residual(work.get()));
    result.design = rows_of(gsl_multifit_nlinear_jac(work.get()));
    if (is_least(result)) break;
  }
  if (problem.failed) std::rethrow_exception(problem.failed);
  // Without progress the last position is the least to rounding.
  if (status != GSL_SUCCESS && status != GSL_ENOPROG)
    throw ConvergenceError(fmt::format("the fit to the recording: {}", gsl_strerror(status)));
  return result;
}

/// By how much more the mean of residuals scatters than if neighbours in time were independent:
/// 1 + 2 (rho_1 + rho_2 + ..) up to the first that is not above zero, of all markers together.
double correlated_share(const MarkerMotion& recorded, const Eigen::VectorXd& residuals) {
  std::map<double, std::vector<Eigen::Vector3d>> series;
  for (std::size_t i = 0; i < recorded.positions.size(); ++i) {
    series[recorded.positions[i].arc_length].emplace_back(
        residuals.segment<3>(static_cast<Eigen::Index>(3 * i)));
  }
  const auto product = [&](std::size_t lag) {
    double sum = 0;
    for (const auto& [s, at] : series) {
      for (std::size_t k = lag; k < at.size(); ++k) sum += at[k].dot(at[k - lag]);
    }
    return sum;
  };
  const double square = product(0);
  double result = 1;
  for (std::size_t lag = 1; lag < recorded.positions.size(); ++lag) {
    const double rho = product(lag) / square;
    if (!(rho > 0)) break;
    result += 2 * rho;
  }
  return result;
}

/// The first guess of the stiffness: the nearest of a few, where vibrations are not a period late
/// yet.
Eigen::VectorXd first_guess(MotionMisfit& misfit) {
  constexpr double finest = 0.35;  // of the logarithm
  constexpr int most = 6;
  Eigen::VectorXd best;
  double least = std::numeric_limits<double>::infinity();
  for (int k = -most; k <= most; ++k) {
    Eigen::VectorXd logs = Eigen::VectorXd::Zero(std::ssize(misfit.sought()));
    logs[0] = finest * k;
    const double sum = misfit.residuals(logs).squaredNorm();
    if (!(sum < least) || !misfit.stopped().empty()) continue;
    least = sum;
    best = logs;
  }
  if (best.size() == 0) throw ConvergenceError("the moving rod stopped: " + misfit.stopped());
  return best;
}

/// The numbers sought, with their intervals.
/// @param share  correlated_share() of the residuals
void add_numbers(const Scene& scene, const MotionMisfit& misfit, const NearestMotion& nearest,
                 double share, MotionFit& result) {
  result.effective_coordinates = static_cast<double>(result.coordinates) / share;
  const auto numbers = static_cast<double>(nearest.logs.size());
  const double freedom = std::max(1.0, result.effective_coordinates - numbers);
  const double variance =
      nearest.residuals.squaredNorm() / (static_cast<double>(result.coordinates) - numbers);
  result.noise = std::sqrt(variance);
  const Eigen::MatrixXd covariance = share * variance * inverse_normal(nearest.design);
  const double quantile = gsl_distribution(gsl_cdf_tdist_Pinv, 0.975, freedom);
  for (std::size_t i = 0; i < misfit.sought().size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double value = misfit.value(i, nearest.logs[k]);
    const double half = quantile * value * std::sqrt(covariance(k, k));
    const MotionNumber found{value, std::max(0.0, value - half), value + half};
    const auto times = [&](double factor) {
      return MotionNumber{factor * found.value, factor * found.low, factor * found.high};
    };
    switch (misfit.sought()[i]) {
      case Sought::stiffness:
        result.stiffness = times(scene.bending_stiffness() / scene.mass_per_length());
        result.scene_stiffness = times(scene.stiffness().value);
        break;
      case Sought::material:
        result.material = found;
        break;
      case Sought::air:
        result.air = found;
        break;
      case Sought::quadratic:
        result.quadratic = found;
        break;
    }
  }
}

/// What is left of the distances, by marker and of the worst time.
void add_errors(const MarkerMotion& recorded, const Eigen::VectorXd& residuals, double length,
                MotionFit& result) {
  const MotionErrors errors = motion_errors(recorded, residuals.reshaped(3, residuals.size() / 3),
                                            length, recorded.positions.size());
  result.rms = errors.rms_m;
  for (const PartError& marker : errors.markers) {
    result.by_marker.push_back({marker.from_m, marker.rms_m});
  }
  result.markers = errors.markers.size();
  const FrameError& worst = errors.frames[errors.worst_frame];
  result.worst = {worst.time, worst.rms_m};
}

}  // namespace

MotionFit fit_motion(const Scene& scene, const MarkerMotion& recorded,
                     const MotionFitOptions& options) {
  MotionMisfit misfit(scene, recorded, options);
  MotionFit result;
  result.file = recorded.file;
  const std::vector<RecordedFrame>& frames = misfit.frames();
  result.times = frames.size();
  result.from = frames.front().time;
  result.to = frames.back().time;
  result.coordinates = misfit.coordinates();
  if (result.coordinates <= misfit.sought().size())
    throw InputError(recorded.file + ": too few rows");
  const Eigen::VectorXd given = misfit.given();
  misfit.require_movement();
  result.given_rms = rms_of(given.reshaped(3, given.size() / 3));
  constexpr double beginning = 0.2;
  misfit.look_at(beginning);
  Eigen::VectorXd start = first_guess(misfit);
  start[0] = least_squares(misfit, start, most_first_steps).logs[0];
  misfit.look_at(1);
  const NearestMotion nearest = least_squares(misfit, start, most_fit_steps);
  (void)misfit.residuals(nearest.logs);
  if (!misfit.stopped().empty())
    throw ConvergenceError("the moving rod stopped: " + misfit.stopped());
  add_numbers(scene, misfit, nearest, correlated_share(recorded, nearest.residuals), result);
  result.damping = misfit.damping(nearest.logs);
  add_errors(recorded, nearest.residuals, scene.length, result);
  result.in_motion = misfit.in_motion();
  result.terms = misfit.terms();
  result.simulations = misfit.simulations();
  return result;
}

}  // namespace dlo::compare
