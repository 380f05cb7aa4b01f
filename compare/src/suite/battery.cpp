#include "suite/battery.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <set>

#include "base/input_file.hpp"
#include "base/text.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/shape.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {
namespace {

constexpr const char* battery_schema = "dlo/suite/1";
constexpr std::string_view builtin_folder = "data/suite/";

ClosedForm read_closed_form(StrictTable table, double length) {
  ClosedForm result;
  result.formula = table.text("is");
  result.at = table.number("at", Dimension::length, Range::between(0, length, "m"));
  result.point = table.vector("point", Dimension::length);
  table.finish();
  return result;
}

BatteryMotion read_motion(StrictTable table,
                          const std::function<Scene(const std::string& name)>& scene_of) {
  constexpr int least_count = 4;  // cubic interpolation between frames needs four
  constexpr int most_requested_frames = 1000;
  table.only({"begin", "frames", "until"});
  BatteryMotion motion;
  motion.begin = scene_of(table.text("begin"));
  motion.end_time = table.number("until", Dimension::time, Range::positive());
  motion.frames = table.integer("frames", least_count, most_requested_frames);
  table.finish();
  return motion;
}

/// Reads a benchmark set. @param scene_of  returns the scene of a file name
Battery read_battery(const std::string& text, const std::string& file,
                     const std::function<Scene(const std::string& name)>& scene_of) {
  const toml::table root = parse_toml(text, file);
  StrictTable table(root, "", file);
  table.only({"scene", "schema", "version"});
  (void)table.choice("schema", {battery_schema});
  Battery battery;
  battery.version = table.text("version");
  std::set<std::string> ids;
  for (StrictTable& entry : table.tables("scene")) {
    entry.only({"class", "closed_form", "file", "isolates", "motion"});
    BatteryScene scene;
    const std::string name = entry.text("file");
    scene.id = std::filesystem::path(name).stem();
    scene.group = entry.text("class");
    scene.isolates = entry.text("isolates");
    if (!ids.insert(scene.id).second) {
      entry.fail("file", "a second scene with this name (allowed: one)");
    }
    scene.scene = scene_of(name);
    if (entry.has("closed_form")) {
      scene.closed_form = read_closed_form(entry.table("closed_form"), scene.scene.length);
    }
    if (entry.has("motion")) scene.motion = read_motion(entry.table("motion"), scene_of);
    entry.finish();
    battery.scenes.push_back(std::move(scene));
  }
  table.finish();
  if (battery.scenes.empty()) throw InputError(file + ": no scene (allowed: one or more)");
  return battery;
}

}  // namespace

std::vector<double> BatteryMotion::times() const { return equal_arc_lengths(end_time, frames); }

std::string builtin_file(std::string_view name) {
  const auto file = std::find_if(builtin::suite_files.begin(), builtin::suite_files.end(),
                                 [&](const auto& one) { return one.name == name; });
  if (file == builtin::suite_files.end()) {
    throw InputError(fmt::format("{}{}: not compiled into dlo", builtin_folder, name));
  }
  return std::string(file->text);
}

const Battery& builtin_battery() {
  static const Battery battery = read_battery(
      builtin_file("suite.toml"), "data/suite/suite.toml", [](const std::string& name) {
        return parse_scene(builtin_file(name), std::string(builtin_folder) + name);
      });
  return battery;
}

std::string builtin_scene_text(const Scene& scene) {
  const std::string_view file = scene.file;
  return builtin_file(file.substr(std::min(file.size(), builtin_folder.size())));
}

Battery load_battery(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  return read_battery(read_file(path), path,
                      [&](const std::string& name) { return load_scene(folder / name); });
}

std::vector<BatteryScene> chosen_scenes(const Battery& battery,
                                        const std::vector<std::string>& wanted) {
  if (wanted.empty()) return battery.scenes;
  const auto contains = [](const std::vector<std::string>& list, const std::string& word) {
    return std::ranges::find(list, word) != list.end();
  };
  std::vector<std::string> groups;
  for (const BatteryScene& scene : battery.scenes) {
    if (!contains(groups, scene.group)) groups.push_back(scene.group);
  }
  std::vector<std::string> known = groups;
  for (const BatteryScene& scene : battery.scenes) known.push_back(scene.id);
  for (const std::string& word : wanted) {
    if (contains(known, word)) continue;
    throw InputError(
        fmt::format("--scenes = {}: no such class or scene{} (allowed: classes {}; or "
                    "the name of a scene)",
                    word, did_you_mean(word, known), fmt::join(groups, ", ")));
  }
  std::vector<BatteryScene> result = battery.scenes;
  std::erase_if(result, [&](const BatteryScene& scene) {
    return !contains(wanted, scene.group) && !contains(wanted, scene.id);
  });
  return result;
}

}  // namespace dlo::compare
