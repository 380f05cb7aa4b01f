// Tests of the command `dlo track`.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "command_fixture.hpp"

namespace dlo::compare {
namespace {

struct TrackCommand : Command {
  static std::string wire() { return shipped_scene("buckling_wire"); }
};

TEST_F(TrackCommand, TellsFramesAndEventsInEveryFormat) {
  const std::string track = words({"track", wire(), "--frame-rate 20 --to 0.6"});
  const json document = json_of(track);
  EXPECT_EQ(document.at("schema"), "dlo/track/1");
  ASSERT_EQ(document.at("frames").size(), 13U);
  const json& last = document.at("frames").back();
  EXPECT_EQ(last.at("time_s"), 0.6);
  EXPECT_EQ(last.at("contacts")[0].at("kind"), "tip");
  EXPECT_GT(last.at("error_over_length").get<double>(), 0);
  ASSERT_EQ(document.at("events").size(), 1U);
  EXPECT_EQ(document.at("events")[0].at("kind"), "contact");
  EXPECT_EQ(document.at("events")[0].at("obstacle"), 0);
  const std::string csv = run(track + " --every 4 --no-force --format csv").out;
  EXPECT_TRUE(has_all(csv, {",1 tip,,"}));
}

/// Fixture with a wire whose clamp moves by a file next to the scene.
class OutputsOverInputs : public TrackCommand {
 protected:
  void SetUp() override {
    TrackCommand::SetUp();
    write("move.csv", "time,x,y,z\n0,0,0,0\n0.2,0.01,0.02,0\n");
    write("m_00001.toml", scene_);
    write("m_00001.vtk", scene_);
    std::filesystem::create_hard_link(path("move.csv"), path("hard.csv"));
    std::filesystem::create_symlink("move.csv", path("soft.csv"));
  }
  /// Expects that the command is refused with a message that contains `said`, and that the file is
  /// unchanged.
  void expect_untouched(const std::string& command, const std::string& file,
                        const std::string& said) const {
    const std::string before = read(path(file));
    expect_error(command, 2, {said});
    EXPECT_EQ(read(path(file)), before) << command;
  }
  [[nodiscard]] std::string track(const std::string& scene, const std::string& more) const {
    return words({"track", path(scene), "--no-force --frame-rate 10", more});
  }

 private:
  std::string scene_ =
      "[rod]\nlength = 0.25\ndiameter = 0.0006\nmaterial = \"copper\"\n"
      "[[gripper]]\nat = 0\ndirection = 0\ntrajectory = \"move.csv\"\n";
};

TEST_F(OutputsOverInputs, TheTrajectoryThatASceneNamesIsAnInput) {
  for (const char* name : {"move.csv", "./move.csv", "hard.csv", "soft.csv"}) {
    expect_untouched(track("m_00001.toml", "-o " + path(name)), "move.csv", "is read too");
  }
  expect_untouched(words({"solve", path("m_00001.toml"), "-o", path("move.csv")}), "move.csv",
                   "is read too");
  expect_untouched(track("m_00001.toml", "--paraview " + path("move.csv")), "move.csv",
                   "is read too");
  const RunResult appended =
      run_line("cd " + path("") + " && " + DLO_COMMAND + " track m_00001.toml >> soft.csv");
  EXPECT_EQ(appended.status, 2) << appended.err;
}

TEST_F(OutputsOverInputs, NoFileIsAmongTheFramesOfASeries) {
  const std::string series = "--paraview " + path("m.vtk.series");
  expect_untouched(track("m_00001.vtk", series), "m_00001.vtk", "writes frames m_00000.vtk");
  expect_untouched(track("m_00001.toml", series + " -o " + path("m_00002.vtk")), "m_00001.vtk",
                   "is written too");
  std::filesystem::create_hard_link(path("move.csv"), path("m_00003.vtk"));
  expect_untouched(track("m_00001.toml", series), "move.csv", "is read too");
  // These names are not those of frames: m_00001.toml has another extension, m_0001.vtk has too few
  // digits.
  std::filesystem::remove(path("m_00003.vtk"));
  const std::string beside = output_of(track("m_00001.toml", series + " -o " + path("m_0001.vtk")));
}

TEST_F(OutputsOverInputs, TwoOutputsThatAreNotThereYetMayNotBeOneFile) {
  std::filesystem::create_symlink("there.svg", path("to.svg"));
  for (const char* other : {"./there.svg", "to.svg"}) {
    expect_error(track("m_00001.toml", "--paraview " + path("there.svg") + " -o " + path(other)), 2,
                 {"is written twice"});
    EXPECT_FALSE(std::filesystem::exists(path("there.svg"))) << other;
  }
}

TEST_F(TrackCommand, StopsAtTheImpossibleWithStatusThreeAndWhatWasBefore) {
  const std::string file = scene(
      "[rod]\nlength = 1\ndiameter = 0.01\nmaterial = \"silicone\"\n"
      "[[gripper]]\nat = 0\nposition = [0, 0, 0]\nhold = \"pin\"\n"
      "[[gripper]]\nat = 1\nhold = \"pin\"\n"
      "pose = [{ time = 0, position = [0.9, 0, 0] }, { time = 1, position = [1.1, 0, 0] }]\n");
  const RunResult result = run(words(
      {"track", file, "--frame-rate 20 --no-force --dynamic --damping 0.01", "--format json"}));
  EXPECT_EQ(result.status, 3);
  EXPECT_TRUE(has_all(result.err, {"stopped at 0.5 s"}));
  const json document = json::parse(result.out);
  EXPECT_EQ(document.at("frames").size(), 10U);
  EXPECT_EQ(document.at("dynamic").at("stopped").at("time_s"), 0.5);
  EXPECT_EQ(document.at("dynamic").at("frames").size(), 10U);
  EXPECT_TRUE(
      has_all(document.at("stopped").at("why").get<std::string>(), {"less than the 1 m of rod"}));
}

TEST_F(TrackCommand, OtherCommandsTakeTheSceneAtATime) {
  const auto force = [&](const std::string& time) {
    return json_of(words({"solve", wire(), time})).at("grippers")[0].at("force_N")[0].get<double>();
  };
  EXPECT_LT(std::abs(force("--time 0")), 1e-12);
  EXPECT_GT(force("--time 1"), 0.05);
  expect_error(words({"solve", shipped_scene("cable"), "--time 1"}), 2,
               {"--time 1", "nothing moves"});
  expect_error(words({"track", shipped_scene("swung_rod"),
                      "--no-force --frame-rate 100000 --samples 10000"}),
               2, {"10000 samples", "4e+06 points in all"});
  expect_error(words({"track", shipped_scene("cable")}), 2, {"nothing moves", "[[gripper.pose]]"});
}

TEST_F(TrackCommand, HasTheMovingRodInEveryFormat) {
  const std::string file = shipped_scene("swung_rod");
  const std::string track =
      words({"track", file, "--to 0.2 --frame-rate 50 --dynamic --drag 0.02"});
  const std::string with_force = track + " --step-rate 3000";
  const json document = json_of(with_force + " --every 5 --shapes");
  EXPECT_EQ(document.at("schema"), "dlo/track/1");
  const json& dynamic = document.at("dynamic");
  EXPECT_EQ(dynamic.at("drag_N_s_per_m2"), 0.02);
  EXPECT_LT(dynamic.at("energy_error").get<double>(), 1e-6);
  ASSERT_EQ(dynamic.at("frames").size(), document.at("frames").size());
  const json& last = dynamic.at("frames").back();
  EXPECT_EQ(last.at("points_m").size(), 41U);
  EXPECT_GT(last.at("energy_J").at("dissipated"), 0);
  EXPECT_GT(last.at("quasi_static_error_over_length").get<double>(), 0.01);
  EXPECT_EQ(last.at("force_error_over_length"),
            dynamic.at("force_model").at("largest_error_over_length"));
  const std::string csv = run(track + " --every 10 --no-force --format csv").out;
  EXPECT_TRUE(is_table(csv));
}

TEST_F(TrackCommand, HasForcesOfObstaclesAtRestAndMoving) {
  const std::string file = scene(
      "[rod]\nlength = 1\nbending_stiffness = 1\nmass_per_length = 0.5\n"
      "[[obstacle]]\nnormal = [0, 1, 0]\npoint = [0, -0.5, 0]\n"
      "[[gripper]]\nat = 0\ndirection = \"0 deg\"\n"
      "pose = [{ time = 0, position = [0, 0, 0] }, { time = 0.5, position = [0, -0.3, 0] }]\n");
  const std::string track =
      words({"track", file, "--to 2 --frame-rate 10 --no-force --dynamic --damping 0.05"});
  const json document = json_of(track + " --every 20");
  const json& rest = document.at("frames").back().at("obstacles").at(0).at("force_N");
  const json& moving = document.at("dynamic").at("frames").back().at("obstacles").at(0);
  EXPECT_GT(rest.at(1).get<double>(), 0.1);
  EXPECT_NEAR(moving.at("force_N").at(1), rest.at(1), 0.1);
  EXPECT_GT(document.at("dynamic").at("frames").back().at("energy_J").at("lost"), 0);
  const std::string csv = run(track + " --every 20 --format csv").out;
  EXPECT_TRUE(has_all(csv, {",obstacle_fx_1_N,", ",dynamic_obstacle_fz_1_N"}));
  EXPECT_TRUE(is_table(csv));
}

TEST_F(TrackCommand, WritesTheMovingRodForParaView) {
  const std::string swung = shipped_scene("swung_rod");
  const std::string file = path("rod.vtk.series");
  const json document =
      json_of(words({"track", swung, "--frame-rate 10 --to 0.2 --no-force --dynamic",
                     "--shapes --paraview", file}));
  const json series = json::parse(read(file));
  ASSERT_EQ(series.at("files").size(), 3U);
  EXPECT_EQ(series.at("files")[1].at("time"), 0.1);
  std::ifstream frame(path(series.at("files")[2].at("name")));
  std::string line;
  while (std::getline(frame, line) && line.rfind("POINTS", 0) != 0) {
  }
  for (const json& point : document.at("dynamic").at("frames").back().at("points_m")) {
    for (const json& coordinate : point) {
      double written = 0;
      frame >> written;
      EXPECT_NEAR(written, coordinate, 1e-8);
    }
  }
  EXPECT_TRUE(frame.good());
}

TEST_F(TrackCommand, SaysWhatAMovingRodCannotHave) {
  const std::string swung = shipped_scene("swung_rod");
  const std::string curved = scene(
      "[rod]\nlength = 1\nbending_stiffness = 1\nmass_per_length = 1\nnatural_curvature = 1\n"
      "[[gripper]]\nat = 0\nroll = 0\n"
      "[[gripper.pose]]\ntime = 0\nposition = [0, 0, 0]\ndirection = \"0 deg\"\n"
      "[[gripper.pose]]\ntime = 1\nposition = [0.1, 0, 0]\ndirection = \"10 deg\"\n");
  expect_error(words({"track", curved, "--frame-rate 20 --dynamic"}), 2,
               {"--dynamic: a clamp that holds the rod's frame changes its direction", "allowed"});
  expect_error(words({"track", swung, "--damping 0.1"}), 2, {"--damping", "--dynamic"});
  expect_error(words({"track", swung, "--dynamic --drag -1"}), 2, {"--drag", "-1"});
}

}  // namespace
}  // namespace dlo::compare
