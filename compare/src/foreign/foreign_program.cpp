#include "foreign/foreign_program.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <set>
#include <string_view>
#include <system_error>

#include "base/input_file.hpp"
#include "base/output_file.hpp"
#include "base/quote.hpp"
#include "base/temporary_path.hpp"
#include "base/text.hpp"
#include "dlo/compare/alignment.hpp"
#include "dlo/compare/choice.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/solution.hpp"
#include "explain/segment_starts.hpp"
#include "foreign/child_process.hpp"
#include "format/scene_document.hpp"
#include "shape/curve.hpp"
#include "shape/shape_measure.hpp"

namespace dlo::compare {
namespace {

constexpr std::string_view scene_place = "{scene}";
constexpr std::string_view points_place = "{points}";
constexpr std::string_view shape_place = "{shape}";

bool is_mentioned(const std::vector<std::string>& words, std::string_view place) {
  return std::any_of(words.begin(), words.end(), [place](const std::string& word) {
    return word.find(place) != std::string::npos;
  });
}

/// New private folder; the destructor removes it with all its content.
class ProgramFolder {
 public:
  [[nodiscard]] std::string file(const char* name) const { return folder_.path() / name; }

  /// Returns the file named `shape`, else the only one whose name begins with "shape."; empty if
  /// there is none or several. @throws InputError if the folder cannot be read (it was removed)
  [[nodiscard]] std::string shape_file() const {
    namespace fs = std::filesystem;
    std::error_code error;
    // The link itself is checked: a dangling link is reported when it is read.
    if (fs::symlink_status(file("shape"), error).type() != fs::file_type::not_found) {
      return file("shape");
    }
    std::vector<std::string> found;
    fs::directory_iterator entry(folder_.path(), error);
    for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
      if (entry->path().filename().string().starts_with("shape.")) found.push_back(entry->path());
    }
    if (error) {
      throw InputError(fmt::format("the folder of {{shape}} cannot be read ({})", error.message()));
    }
    return found.size() == 1 ? found.front() : "";
  }

 private:
  TemporaryFolder folder_{temporary_directory().string()};
};

/// Returns ": " and the first 200 bytes of the last line of a program's standard error that is not
/// blank. Returns "" if there is none or the file cannot be read: a program may write anything.
std::string last_words(const std::string& file) {
  constexpr std::size_t most_message_bytes = 200;
  try {
    const std::string text = read_regular_file(file, "stderr");
    const std::size_t end = text.find_last_not_of(" \t\r\n");
    if (end == std::string::npos) return "";
    const std::size_t before = text.find_last_of('\n', end);
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    return ": " + display(text.substr(begin, std::min(end + 1 - begin, most_message_bytes)));
  } catch (const InputError&) {
    return "";
  }
}

/// Name of the shape's file in messages. The folder does not exist any more when a message is read.
constexpr const char* shape_name = "its shape";

/// Runs a program on a scene's document. @param read  reads the file that the program wrote; may
/// throw InputError
SimulatorRun run_on_document(
    const ForeignProgram& program, const std::string& document, int points, double time_limit,
    const std::function<void(const std::string& file, SimulatorRun& result)>& read) {
  const ProgramFolder folder;
  write_file(folder.file("scene.json"), document);
  std::vector<std::string> words;
  words.reserve(program.words.size());
  for (const std::string& word : program.words) {
    words.push_back(replace_placeholders(word, {{scene_place, folder.file("scene.json")},
                                                {points_place, fmt::format("{}", points)},
                                                {shape_place, folder.file("shape")}}));
  }
  const ChildOutcome outcome = run_child(words, {.error = folder.file("stderr")}, time_limit);
  SimulatorRun result{.points = points, .seconds = outcome.seconds, .too_long = outcome.too_long};
  const auto refuses = [&] {
    constexpr int unsupported_exit_status = 3;
    return outcome.exit_status == unsupported_exit_status ||
           last_words(folder.file("stderr")).starts_with(": not supported");
  };
  if (!outcome.problem.empty()) {
    if (!outcome.too_long && refuses()) result.status = RunStatus::not_supported;
    result.problem = outcome.problem + last_words(folder.file("stderr"));
    return result;
  }
  try {
    const std::string file = folder.shape_file();
    if (file.empty()) {
      if (refuses()) result.status = RunStatus::not_supported;
      result.problem = "wrote no shape" + last_words(folder.file("stderr"));
      return result;
    }
    read(file, result);
  } catch (const InputError& error) {
    result.problem = error.what();
    const std::string name = folder.file("");
    for (std::size_t at = 0; (at = result.problem.find(name, at)) != std::string::npos;) {
      result.problem.erase(at, name.size());
    }
  }
  return result;
}

/// Whether a text contains one shape, without times.
bool is_shape(const std::string& text) {
  if (text.substr(0, text.find('\n')).find("time") != std::string::npos) return false;
  try {
    (void)parse_shape(text, shape_name);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

void read_motion(const std::string& file, SimulatorRun& result) {
  const std::string text = read_regular_file(file, shape_name);
  if (is_shape(text)) {
    result.status = RunStatus::not_supported;
    result.problem = "wrote a shape at rest, no frames (time,s,x,y,z)";
  } else {
    result.motion = parse_markers(text, shape_name);
    result.status = RunStatus::solved;
  }
}

}  // namespace

bool is_program_name(const std::string& name) {
  constexpr std::string_view name_characters =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-+";
  return !name.empty() && name != "." && name != ".." &&
         name.find_first_not_of(name_characters) == std::string::npos;
}

ForeignProgram parse_foreign_program(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string name = text.substr(0, equals);
  const std::vector<std::string> models = names<Model>();
  const bool is_dlo_model = std::find(models.begin(), models.end(), name) != models.end();
  if (equals == std::string::npos || is_dlo_model || !is_program_name(name)) {
    throw InputError(
        fmt::format("--with = {}: {} (allowed: NAME=COMMAND, NAME of letters, digits and _.-+, not "
                    "energy, chain, exact or force)",
                    quoted_piece(text),
                    equals == std::string::npos ? "no NAME before an =" : "not such a NAME"));
  }
  ForeignProgram program{name, command_words(text.substr(equals + 1), "--with " + name)};
  if (!is_mentioned(program.words, shape_place)) {
    throw InputError(fmt::format(
        "--with {}: no {{shape}} in the command (allowed: a command with {{shape}}, the file to "
        "write, and where it has a use for them {{scene}}, the file to read, and {{points}}, their "
        "number)",
        name));
  }
  return program;
}

std::vector<ForeignProgram> parse_foreign_programs(const std::vector<std::string>& texts) {
  std::vector<ForeignProgram> programs;
  std::set<std::string> taken;
  for (const std::string& text : texts) {
    programs.push_back(parse_foreign_program(text));
    if (taken.insert(programs.back().name).second) continue;
    throw InputError(fmt::format("--with {}: given twice (allowed: a name of its own for each)",
                                 programs.back().name));
  }
  return programs;
}

SimulatorRun run_foreign(const ForeignProgram& program, Scene scene, int points,
                         double time_limit) {
  scene.force_model.points = points;
  return run_on_document(program, scene_document_text(scene), points, time_limit,
                         [&scene](const std::string& file, SimulatorRun& result) {
                           result.shape = complete_segment_starts(
                               scene, parse_shape(read_regular_file(file, shape_name), shape_name));
                           result.status = RunStatus::solved;
                         });
}

SimulatorRun run_foreign_motion(const ForeignProgram& program, const std::string& document,
                                int points, double time_limit) {
  return run_on_document(program, document, points, time_limit, read_motion);
}

void require_held_ends(const Scene& scene, const Shape& aligned, bool has_arc_lengths) {
  constexpr double share = 0.01;
  for (const bool at_start : {true, false}) {
    const double end = at_start ? 0 : scene.length;
    const double outermost = at_start ? aligned.arc_length.front() : aligned.arc_length.back();
    const double allowed = share * scene.length + (has_arc_lengths ? std::abs(end - outermost) : 0);
    const Eigen::Vector3d point = aligned.points.col(at_start ? 0 : aligned.points.cols() - 1);
    for (const Gripper& gripper : scene.grippers) {
      const double distance = (point - gripper.position).norm();
      if (gripper.at != end || distance <= allowed) continue;
      throw InputError(
          fmt::format("wrong end: the shape is {:.3g} m from the gripper at s = {:g} m (allowed: "
                      "{:.3g} m)",
                      distance, end, allowed));
    }
  }
}

Deviation foreign_deviation(const Scene& scene, const MeasuredShape& shape,
                            const Reference& reference) {
  const Alignment alignment = align(shape, reference, scene.length);
  const Shape& aligned = alignment.shape;
  require_held_ends(scene, aligned, alignment.arc_lengths == ArcLengths::file);
  const double covered_share =
      (aligned.arc_length.back() - aligned.arc_length.front()) / scene.length;
  if (covered_share < 0.5) {
    throw InputError(fmt::format(
        "the shape is {:.3g} % of the rod (allowed: the whole rod, or more than half of it)",
        covered_share * 100));
  }
  const Measured measured = measure(alignment, reference, scene.length);
  const WholeRod whole = whole_rod_distances(measured, alignment, reference, scene.length);
  Deviation result;
  result.rms_m = whole.rms_m;
  result.max_m = whole.max_m;
  result.rms_over_length = whole.rms_m / scene.length;
  Eigen::Matrix3Xd ends(3, 2);
  ends << aligned.points.leftCols<1>(), aligned.points.rightCols<1>();
  result.tip_m = shape_deviation(scene, {{0, scene.length}, ends}, reference).tip_m;
  return result;
}

}  // namespace dlo::compare
