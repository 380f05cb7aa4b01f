#include "readers.hpp"

#include <algorithm>
#include <cstdint>
#include <stdexcept>

#include "batch/baseline.hpp"
#include "batch/sweep_grid.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/shape_file.hpp"
#include "reading/scene_template.hpp"

namespace dlo::fuzz {
namespace {

constexpr const char* file = "fuzz.txt";
constexpr const char* model_file = "fuzz.xml";

void require_promise(bool kept, const std::string& what) {
  if (!kept) throw std::logic_error("broken promise: " + what);
}

/// Whether `read` returns a value. If it throws an InputError, throws std::logic_error unless the
/// message is one line that begins with `start`. Other exceptions pass.
template <typename Read>
bool reads(const Read& read, const std::string& start) {
  try {
    read();
    return true;
  } catch (const compare::InputError& error) {
    const std::string message = error.what();
    require_promise(message.starts_with(start), "the error names the file: " + message);
    require_promise(std::none_of(message.begin(), message.end(),
                                 [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; }),
                    "the error is one line without control characters: " + message);
    return false;
  }
}

void promise_shape(const compare::MeasuredShape& shape) {
  require_promise(shape.points.cols() >= 2 && shape.points.cols() <= compare::most_shape_points,
                  "number of points");
  require_promise(shape.points.allFinite(), "finite points");
  const auto count = static_cast<std::size_t>(shape.points.cols());
  require_promise(shape.arc_length.empty() || shape.arc_length.size() == count,
                  "an arc length a point");
  require_promise(shape.d1.cols() == 0 || shape.d1.cols() == shape.points.cols(), "a d1 a point");
  require_promise(shape.d1.allFinite(), "finite d1");
}

void promise_scene(const std::string& text, const char* name) {
  (void)reads(
      [&] {
        const compare::Scene scene = compare::parse_scene(text, name);
        require_promise(scene.gamma() >= 0 && !scene.grippers.empty(), "a rod that is held");
      },
      name);
}

}  // namespace

void scene(const std::string& text) { promise_scene(text, file); }

void model(const std::string& text) { promise_scene(text, model_file); }

void parameters(const std::string& text) {
  (void)reads(
      [&] {
        require_promise(compare::parse_parameters(text, file).points >= 2, "number of points");
      },
      file);
}

void baseline(const std::string& text) {
  std::string written;
  if (!reads([&] { written = compare::baseline_text(compare::read_baseline(text, file)); }, file)) {
    return;
  }
  // A baseline that dlo has written must be readable.
  require_promise(compare::baseline_text(compare::read_baseline(written, "written")) == written,
                  "a baseline reads as it was written");
}

void shape(const std::string& text) {
  for (const double unit : {1.0, 1e-3}) {
    (void)reads([&] { promise_shape(compare::parse_shape(text, file, unit)); }, file);
  }
}

void vary(const std::string& text) {
  static const compare::SceneTemplate scene(R"(gravity = [0, -9.81, 0]
[rod]
length = 1
diameter = 0.002
material = "copper"
[[gripper]]
at = 0
position = [0, 0, 0]
direction = "0 deg"
)",
                                            file);
  (void)reads(
      [&] {
        const compare::Axis axis = compare::parse_axis(text);
        require_promise(axis.count >= 1, "an axis has values");
        for (const std::int64_t index : {std::int64_t{0}, axis.count / 2, axis.count - 1}) {
          (void)scene.with({{axis.field, axis.value(index)}});
        }
      },
      "");
}

}  // namespace dlo::fuzz
