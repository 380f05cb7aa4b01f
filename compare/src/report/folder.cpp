#include "report/folder.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <system_error>

#include "base/input_file.hpp"
#include "base/output_file.hpp"
#include "base/temporary_path.hpp"
#include "dlo/compare/error.hpp"
#include "figure/gnuplot.hpp"
#include "figure/gnuplot_script.hpp"
#include "report/figures.hpp"
#include "report/page.hpp"
#include "trajectory/trajectory_files.hpp"

namespace dlo::compare {
namespace {

namespace fs = std::filesystem;

constexpr const char* list_file = "files.txt";
constexpr const char* list_head = "dlo report 1";
constexpr const char* allowed =
    "allowed: a new or empty folder, or a report with nothing else in it";

/// The folder itself, without a slash at its end; a link stays what it is and its target is used.
fs::path target_folder(const std::string& folder) {
  std::error_code error;
  fs::path path = fs::weakly_canonical(fs::absolute(folder), error);
  if (error || folder.empty()) {
    throw InputError(
        fmt::format("report: -o {}: no such place ({}; {})", folder, error.message(), allowed));
  }
  if (path.filename().empty()) path = path.parent_path();
  return path;
}

/// Paths that the folder's list names, itself included; nothing without a list.
std::set<std::string> listed(const fs::path& folder) {
  std::ifstream stream(folder / list_file);
  std::string line;
  std::set<std::string> files;
  if (!std::getline(stream, line) || line != list_head) return files;
  while (std::getline(stream, line)) files.insert(line);
  files.insert(list_file);
  return files;
}

/// What keeps a folder from being replaced; empty: nothing.
std::string foreign_file(const fs::path& folder) {
  const std::set<std::string> files = listed(folder);
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_directory() && !entry.is_symlink()) continue;
    std::string name = entry.path().lexically_relative(folder).string();
    if (!files.contains(name)) return name;
  }
  return {};
}

[[noreturn]] void fail_to_write(const fs::path& path, const std::string& why) {
  throw OutputError(fmt::format("report: {}: cannot be written ({})", path.string(), why));
}

/// A new folder beside the target, for nobody else and gone when it is left. The report is made in
/// a folder in it, which has the permissions that the umask leaves, and the report that it replaces
/// is moved into it.
class FolderInMaking {
 public:
  explicit FolderInMaking(const fs::path& target)
      : folder_(fmt::format("report: {}: cannot be written", target.string()),
                target.parent_path()) {
    std::error_code error;
    fs::create_directory(report(), error);
    if (error) fail_to_write(target, error.message());
  }

  void write(const std::string& name, const std::string& content) {
    const fs::path file = report() / name;
    std::error_code error;
    fs::create_directories(file.parent_path(), error);
    errno = 0;
    std::ofstream stream(file, std::ios::binary);
    stream << content;
    stream.close();
    if (!stream) fail_to_write(file, std::strerror(errno));
    list(name);
  }
  void list(const std::string& name) { files_.insert(name); }

  /// Gives the report its name; a report of that name is replaced.
  void rename(const fs::path& to) {
    std::string text = std::string(list_head) + "\n";
    for (const std::string& file : files_) text += file + "\n";
    write(list_file, text);
    const fs::path old = folder_.path() / "old";
    std::error_code error;
    const bool replace = fs::exists(to);
    if (replace) fs::rename(to, old, error);
    if (error) fail_to_write(to, error.message());
    fs::rename(report(), to, error);
    if (!error) return;
    std::error_code ignored;
    if (replace) fs::rename(old, to, ignored);
    fail_to_write(to, error.message());
  }

  [[nodiscard]] fs::path report() const { return folder_.path() / "report"; }

 private:
  TemporaryFolder folder_;
  std::set<std::string> files_;
};

/// Whether a path is the other, or the other is in it.
bool holds(const fs::path& path, const fs::path& other) {
  return std::mismatch(path.begin(), path.end(), other.begin(), other.end()).first == path.end();
}

/// Whether another file system begins at a folder.
bool is_mount_point(const fs::path& folder) {
  struct stat own = {};
  struct stat parent = {};
  return ::stat(folder.c_str(), &own) == 0 && ::stat(folder.parent_path().c_str(), &parent) == 0 &&
         own.st_dev != parent.st_dev;
}

/// A report is replaced by renaming its folder: those that cannot be renamed, or that a shell would
/// miss, are refused.
void check_replaceable(const std::string& folder, const fs::path& path) {
  std::error_code error;
  const char* const another = "allowed: another folder, such as one in it";
  if (holds(path, fs::current_path(error))) {
    throw InputError(fmt::format(
        "report: -o {}: is the working directory, or holds it, and cannot be replaced ({})", folder,
        another));
  }
  if (is_mount_point(path)) {
    throw InputError(
        fmt::format("report: -o {}: is where a file system is mounted, and cannot be replaced ({})",
                    folder, another));
  }
  if (::access(path.c_str(), W_OK | X_OK) != 0) {
    throw InputError(
        fmt::format("report: -o {}: cannot be replaced ({}; allowed: a folder that "
                    "may be written)",
                    folder, std::strerror(errno)));
  }
}

PageFigure draw_into(FolderInMaking& folder, Figure figure) {
  if (!figure.csv.empty()) folder.write(figure.csv_file, figure.csv);
  folder.write(figure.name + ".gp", figure_script(figure));
  PageFigure result;
  const std::string file = figure.name + ".svg";
  result.failure = run_script(figure.name + ".gp", file, folder.report());
  if (result.failure.empty()) {
    folder.list(file);
    result.svg = inline_svg(read_file((folder.report() / file).string()), figure);
  }
  result.figure = std::move(figure);
  return result;
}

}  // namespace

void refuse_scenes_inside(const std::string& folder, const std::vector<std::string>& scenes) {
  std::error_code error;
  const fs::path inside = fs::canonical(folder, error);
  if (error) return;
  std::vector<std::string> inputs = scenes;
  for (const std::string& scene : scenes) {
    for (std::string& file : trajectory_files(scene)) inputs.push_back(std::move(file));
  }
  for (const std::string& input : inputs) {
    const fs::path read = fs::canonical(input, error);
    if (error) continue;
    if (std::mismatch(inside.begin(), inside.end(), read.begin(), read.end()).first !=
        inside.end()) {
      continue;
    }
    throw InputError(fmt::format(
        "report: -o {}: holds {}, which is read too (allowed: another folder)", folder, input));
  }
}

void check_report_folder(const std::string& folder) {
  const fs::path path = target_folder(folder);
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    if (!fs::is_directory(path.parent_path(), error)) {
      throw InputError(fmt::format("report: -o {}: there is no folder {} to put it in ({})", folder,
                                   path.parent_path().string(), allowed));
    }
    if (fs::is_symlink(fs::symlink_status(path, error))) {
      throw InputError(fmt::format("report: -o {}: is a link to nothing ({})", folder, allowed));
    }
  } else if (!fs::is_directory(status)) {
    throw InputError(fmt::format("report: -o {}: is a file ({})", folder, allowed));
  } else {
    check_replaceable(folder, path);
    try {
      const std::string foreign = foreign_file(path);
      if (!foreign.empty()) {
        throw InputError(fmt::format("report: -o {}: holds {}, which is not of a report ({})",
                                     folder, foreign, allowed));
      }
    } catch (const fs::filesystem_error& problem) {
      throw InputError(fmt::format("report: -o {}: cannot be read ({}; {})", folder,
                                   problem.code().message(), allowed));
    }
  }
  // The one proof that a report can be put here, also on a full or read-only file system.
  try {
    const FolderInMaking proof(path);
  } catch (const OutputError& problem) {
    throw InputError(problem.what());
  }
}

WrittenReport write_report(const Report& report, const ReportMaker& maker,
                           const std::string& folder) {
  check_report_folder(folder);
  const fs::path target = target_folder(folder);
  FolderInMaking temporary(target);
  for (const SceneReport& scene : report.scenes) {
    temporary.write("scenes/" + scene.file.name, scene.file.text);
  }
  for (const MotionReport& motion : report.motions) {
    temporary.write("scenes/" + motion.file.name, motion.file.text);
  }
  WrittenReport result;
  std::vector<PageFigure> figures;
  for (Figure& figure : report_figures(report)) {
    figures.push_back(draw_into(temporary, std::move(figure)));
    const std::string& failure = figures.back().failure;
    ++(failure.empty() ? result.figures : result.figures_missing);
    if (result.why_missing.empty()) result.why_missing = failure;
  }
  temporary.write("index.html",
                  report_page(report, figures, maker, gnuplot_version(temporary.report())));
  temporary.rename(target);
  result.page = (fs::path(folder) / "index.html").string();
  return result;
}

}  // namespace dlo::compare
