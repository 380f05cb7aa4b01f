#include "trajectory/trajectory_files.hpp"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "base/output_file.hpp"

namespace dlo::compare {
std::string path_beside(const std::string& name, const std::string& scene_file) {
  return (std::filesystem::path(scene_file).parent_path() / name).string();
}

namespace {

namespace fs = std::filesystem;

/// Whether a name is STEM_00000.vtk, of five digits or more.
bool is_frame_name(std::string_view name, const std::string& stem) {
  constexpr std::string_view ending = ".vtk";
  constexpr std::size_t fewest_digits = 5;
  if (!name.starts_with(stem + "_") || !name.ends_with(ending)) return false;
  name.remove_prefix(stem.size() + 1);
  if (name.size() < fewest_digits + ending.size()) return false;
  name.remove_suffix(ending.size());
  return name.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

std::string series_stem(const std::string& series) {
  fs::path stem = fs::path(series).filename();
  while (stem.has_extension()) stem = stem.stem();
  return stem.string();
}

std::string frame_names(const std::string& series) {
  return series_stem(series) + "_00000.vtk, ..";
}

bool is_frame_of_series(const std::string& file, const std::string& series) {
  const std::string stem = series_stem(series);
  std::error_code unknown;
  const fs::path folder = fs::weakly_canonical(fs::absolute(series).parent_path(), unknown);
  // The path is also compared without resolving a link in its last part: a link that is named like
  // a frame would be opened for writing, which overwrites its target.
  for (const fs::path& path : {fs::weakly_canonical(fs::absolute(file), unknown),
                               fs::weakly_canonical(fs::absolute(file).parent_path(), unknown) /
                                   fs::path(file).filename()}) {
    if (path.parent_path() == folder && is_frame_name(path.filename().string(), stem)) return true;
  }
  const fs::directory_iterator entries(folder, unknown);
  return std::any_of(fs::begin(entries), fs::end(entries), [&](const fs::directory_entry& entry) {
    return is_frame_name(entry.path().filename().string(), stem) &&
           same_file(entry.path().string(), file);
  });
}

}  // namespace dlo::compare
