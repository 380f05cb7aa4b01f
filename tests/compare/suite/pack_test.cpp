// Tests of the benchmark set and its certified answers.

#include "suite/pack.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "base/input_file.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/shape_file.hpp"
#include "dlo/compare/solve.hpp"
#include "format/scene_document.hpp"
#include "suite/answer.hpp"
#include "suite/battery.hpp"
#include "suite/committed_answer.hpp"

namespace dlo::compare {
namespace {

TEST(Battery, IsTheOneOfItsFile) {
  const Battery read = load_battery(DLO_DATA "/suite/suite.toml");
  ASSERT_EQ(read.scenes.size(), builtin_battery().scenes.size());
  for (std::size_t i = 0; i < read.scenes.size(); ++i) {
    Scene scene = read.scenes[i].scene;
    scene.file = builtin_battery().scenes[i].scene.file;
    EXPECT_EQ(scene_document_text(scene), scene_document_text(builtin_battery().scenes[i].scene));
  }
}

TEST(Answers, AreWhereClosedFormsSay) {
  int forms = 0;
  for (const BatteryScene& scene : builtin_battery().scenes) {
    if (!scene.closed_form) continue;
    ++forms;
    const Eigen::Vector3d point =
        solve(scene.scene, Model::energy, {}, {scene.closed_form->at}).shape.points.col(0);
    EXPECT_LT((point - scene.closed_form->point).norm(), 1e-9 * scene.scene.length) << scene.id;
  }
  EXPECT_GE(forms, 4);
}

TEST(Pack, CommittedAnswersAreThoseOfFreshOnesWithinTheirBounds) {
  const std::vector<std::string> some = {"bending_large", "weight_100",    "clamps_space",
                                         "twist_bending", "helix_hanging", "strip_oblique",
                                         "floor",         "peg",           "stretch_pins"};
  for (const BatteryScene& scene : chosen_scenes(builtin_battery(), some)) {
    const Answer answer = certified_answer(scene);
    const json before = committed_answer(scene.id);
    const json now = answer_json(answer);
    EXPECT_EQ(before["methods"], now["methods"]) << scene.id;
    const double length = scene.scene.length;
    const double bound = before["points_bound_m"].get<double>() + 1e-9 * length;
    for (std::size_t i = 0; i < now["points_m"].size(); ++i) {
      ASSERT_LT((vector_of(before["points_m"][i]) - vector_of(now["points_m"][i])).norm(), bound)
          << scene.id;
    }
    for (std::size_t i = 0; i < now["grippers"].size(); ++i) {
      const Eigen::Vector3d force = vector_of(now["grippers"][i]["force_N"]);
      EXPECT_LT((vector_of(before["grippers"][i]["force_N"]) - force).norm(),
                before["grippers"][i]["force_bound_N"].get<double>() + 1e-6 * force.norm())
          << scene.id;
    }
  }
}

// Written numbers have ten digits and points twelve decimals, however well both methods agree.
TEST(Pack, BoundsHoldTheRoundingOfWhatIsWritten) {
  for (const BatteryScene& scene :
       chosen_scenes(builtin_battery(), {"clamps_space", "clamps_taut", "floor"})) {
    const Answer answer = certified_answer(scene);
    const json written = answer_json(answer);
    const auto expect_within = [&](const Eigen::Vector3d& value, const json& row,
                                   const std::string& name, const std::string& unit) {
      EXPECT_LE((vector_of(row[name + "_" + unit]) - value).norm(),
                row[name + "_bound_" + unit].get<double>())
          << scene.id << " " << name;
    };
    for (std::size_t i = 0; i < answer.first.grippers.size(); ++i) {
      expect_within(answer.first.grippers[i].force, written["grippers"][i], "force", "N");
      expect_within(answer.first.grippers[i].torque, written["grippers"][i], "torque", "Nm");
    }
    for (std::size_t i = 0; i < answer.first.obstacles.size(); ++i) {
      expect_within(answer.first.obstacles[i], written["obstacles"][i], "force", "N");
    }
    for (std::size_t i = 0; i < written["points_m"].size(); ++i) {
      const auto point = static_cast<Eigen::Index>(i);
      EXPECT_LE((vector_of(written["points_m"][i]) - answer.first.shape.points.col(point)).norm(),
                written["points_bound_m"].get<double>());
    }
  }
}

// The tenth digit of this force is a unit of 1e-3, and 4e-4 are lost.
TEST(Pack, BoundsHoldTheRoundingOfANumberJustAboveAPowerOfTen) {
  Answer answer =
      dlo::compare::certified_answer(chosen_scenes(builtin_battery(), {"bending_large"}).front());
  answer.first.grippers.front().force = {1000000.0004, 0, 0};
  answer.bounds.forces_N.front() = 0;
  const json written = dlo::compare::answer_json(answer);
  EXPECT_EQ(written["grippers"][0]["force_N"][0], 1e6);
  EXPECT_EQ(written["grippers"][0]["force_bound_N"], 5.1e-4);
}

TEST(Pack, CommittedOneHasEveryScene) {
  const json index = json::parse(read_file(DLO_DATA "/suite/answers/suite.json"));
  EXPECT_EQ(index["version"], builtin_battery().version);
  ASSERT_EQ(index["answers"].size(), builtin_battery().scenes.size());
  EXPECT_EQ(read_file(DLO_DATA "/suite/answers/schema.json"),
            read_file(DLO_DATA "/suite/schema.json"));
  EXPECT_EQ(read_file(DLO_DATA "/suite/answers/motion_schema.json"),
            read_file(DLO_DATA "/suite/motion_schema.json"));
  std::uintmax_t bytes = 0;
  for (std::size_t i = 0; i < index["answers"].size(); ++i) {
    const BatteryScene& scene = builtin_battery().scenes[i];
    EXPECT_EQ(index["answers"][i]["id"], scene.id);
    const json answer = committed_answer(scene.id);
    // The chains with which rods that stretch or move are compared have discretisation errors.
    const bool by_chain = scene.motion || scene.scene.stretch != Stretch::none;
    EXPECT_LT(answer["points_bound_m"], (by_chain ? 2e-4 : 1e-6) * scene.scene.length);
  }
  for (const auto& file : std::filesystem::directory_iterator(DLO_DATA "/suite/answers")) {
    bytes += file.file_size();
  }
  EXPECT_LT(bytes, 1'000'000U);
}

/// Returns the numbers of the ASCII DataArray in whose opening tag `tag` occurs first.
std::vector<double> numbers_after(const std::string& text, const std::string& tag) {
  const std::size_t begin = text.find('>', text.find(tag)) + 1;
  std::istringstream words(text.substr(begin, text.find('<', begin) - begin));
  return {std::istream_iterator<double>(words), {}};
}

TEST(Pack, VtuHasThePointsOfTheCsv) {
  int files = 0;
  for (const BatteryScene& scene : builtin_battery().scenes) {
    if (scene.motion) continue;
    const std::string stem = DLO_DATA "/suite/answers/" + scene.id;
    const std::string grid = read_file(stem + ".vtu");
    const MeasuredShape table = load_shape(stem + ".csv");
    const std::vector<double> points = numbers_after(grid, "NumberOfComponents");
    ASSERT_EQ(points.size(), static_cast<std::size_t>(table.points.size())) << scene.id;
    ASSERT_EQ(Eigen::Matrix3Xd::Map(points.data(), 3, table.points.cols()), table.points)
        << scene.id;
    ASSERT_EQ(numbers_after(grid, "arc_length_m"), table.arc_length) << scene.id;
    ++files;
  }
  EXPECT_GE(files, 50);
}

TEST(Pack, IsTheSameWithOneThreadAndTwo) {
  const std::vector<BatteryScene> scenes = chosen_scenes(builtin_battery(), {"ends", "loads"});
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / "dlo_pack_of_threads";
  for (const int threads : {1, 2}) {
    write_pack(folder / std::to_string(threads), certified_pack("1", scenes, threads));
  }
  int files = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder / "1")) {
    EXPECT_EQ(read_file(file.path()), read_file(folder / "2" / file.path().filename()));
    ++files;
  }
  EXPECT_EQ(files, static_cast<int>(3 * scenes.size()) + 3);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace dlo::compare
