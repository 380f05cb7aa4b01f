#include "dlo/compare/report_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <system_error>

#include "dlo/compare/error.hpp"
#include "report_figures.hpp"
#include "report_page.hpp"
#include "strict_table.hpp"

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

/// A folder that is gone when it is left, unless it was renamed.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(fs::path path) : path_(std::move(path)) {
    std::error_code error;
    fs::create_directory(path_, error);
    if (error) fail(error.message());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  TemporaryFolder(TemporaryFolder&&) = delete;
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;

  void write(const std::string& name, const std::string& content) {
    std::error_code error;
    fs::create_directories((path_ / name).parent_path(), error);
    errno = 0;
    std::ofstream stream(path_ / name, std::ios::binary);
    stream << content;
    stream.close();
    if (!stream) fail(std::strerror(errno));
    list(name);
  }
  void list(const std::string& name) { files_.insert(name); }

  /// Gives the folder its name; a report of that name is replaced.
  void rename(const fs::path& to) {
    std::string text = std::string(list_head) + "\n";
    for (const std::string& file : files_) text += file + "\n";
    write(list_file, text);
    const fs::path old = path_.string() + ".old";
    std::error_code error;
    const bool replace = fs::exists(to);
    if (replace) fs::rename(to, old, error);
    if (!error) fs::rename(path_, to, error);
    if (error) {
      std::error_code ignored;
      if (fs::exists(old)) fs::rename(old, to, ignored);
      fail(error.message());
    }
    if (replace) fs::remove_all(old, error);
  }

  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw InputError(fmt::format("report: {}: cannot be written ({})", path_.string(), why));
  }

  fs::path path_;
  std::set<std::string> files_;
};

PageFigure draw_into(TemporaryFolder& folder, Figure figure) {
  if (!figure.csv.empty()) folder.write(figure.csv_file, figure.csv);
  folder.write(figure.name + ".gp", figure.script);
  PageFigure result;
  result.failure = draw(figure, folder.path());
  if (result.failure.empty()) {
    const std::string file = figure.name + ".svg";
    folder.list(file);
    result.svg = inline_svg(read_file((folder.path() / file).string()), figure);
  }
  result.figure = std::move(figure);
  return result;
}

}  // namespace

void check_report_folder(const std::string& folder) {
  const fs::path path = target_folder(folder);
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    if (fs::is_directory(path.parent_path(), error)) return;
    throw InputError(fmt::format("report: -o {}: there is no folder {} to put it in ({})", folder,
                                 path.parent_path().string(), allowed));
  }
  if (!fs::is_directory(status)) {
    throw InputError(fmt::format("report: -o {}: is a file ({})", folder, allowed));
  }
  try {
    const std::string foreign = foreign_file(path);
    if (foreign.empty()) return;
    throw InputError(fmt::format("report: -o {}: holds {}, which is not of a report ({})", folder,
                                 foreign, allowed));
  } catch (const fs::filesystem_error& problem) {
    throw InputError(fmt::format("report: -o {}: cannot be read ({}; {})", folder,
                                 problem.code().message(), allowed));
  }
}

WrittenReport write_report(const Report& report, const ReportMaker& maker,
                           const std::string& folder) {
  check_report_folder(folder);
  const fs::path target = target_folder(folder);
  TemporaryFolder temporary(fmt::format("{}.{}.tmp", target.string(), ::getpid()));
  for (const SceneReport& scene : report.scenes) {
    temporary.write("scenes/" + scene.file.name, scene.file.text);
  }
  WrittenReport result;
  std::vector<PageFigure> figures;
  for (Figure& figure : report_figures(report)) {
    figures.push_back(draw_into(temporary, std::move(figure)));
    const std::string& failure = figures.back().failure;
    ++(failure.empty() ? result.figures : result.figures_missing);
    if (result.why_missing.empty()) result.why_missing = failure;
  }
  temporary.write("index.html", report_page(report, figures, maker));
  temporary.rename(target);
  result.page = (fs::path(folder) / "index.html").string();
  return result;
}

}  // namespace dlo::compare
