// Tests of the command `dlo sweep`, by hand and by a scheduler of parts.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "command_fixture.hpp"

namespace dlo::compare {
namespace {

class SweepCommand : public Command {
 protected:
  /// Writes a sweep of 50 rows to whole.csv.
  void SetUp() override {
    Command::SetUp();
    succeeds(sweep + " -o " + path("whole.csv"));
  }
  void expect_merged() const {
    const std::string merge =
        "cd " + path("") + " && { head -qn 1 map.1.csv; tail -qn +2 map.*.csv | sort -n; } >all";
    ASSERT_EQ(std::system(merge.c_str()), 0);
    const std::string expected = read(path("whole.csv"));
    EXPECT_EQ(std::count(expected.begin(), expected.end(), '\n'), 51);
    EXPECT_EQ(read(path("all")), expected);
  }

  const std::string sweep = "sweep " + steel() + " --vary gamma=log:0.1:10:50";
};

TEST_F(SweepCommand, WritesATableToStandardOutputOrAFile) {
  const std::string arguments =
      "sweep " + steel() + " --vary gamma=log:0.1:10:3 gripper.0.direction='0 deg,45 deg'";
  const RunResult printed = run(arguments);
  ASSERT_EQ(printed.status, 0) << printed.err;
  EXPECT_EQ(printed.err, "");
  EXPECT_EQ(printed.out.substr(0, 40), "row,gamma,gripper.0.direction [deg],tip_");
  EXPECT_EQ(std::count(printed.out.begin(), printed.out.end(), '\n'), 7);
  succeeds(arguments + " -o " + path("a.csv"));
  EXPECT_EQ(read(path("a.csv")), printed.out);
  EXPECT_EQ(run(arguments + " --threads 5").out, printed.out);
}

/// Returns points of an arc of a curvature [1/m] in the plane z = 0, 0.3 m long.
std::string arc_text(double curvature) {
  std::string text = "x,y,z\n";
  for (int i = 0; i <= 30; ++i) {
    const double angle = curvature * i / 100;
    text += std::to_string(std::sin(angle) / curvature) + "," +
            std::to_string((1 - std::cos(angle)) / curvature) + ",0\n";
  }
  return text;
}

/// The rod has no weight, so its shape is the rest shape. All files that the scene names are beside
/// it.
const std::string scene_with_files =
    "gravity = [0, 0, 0]\n[rod]\nlength = 0.3\nbending_stiffness = 1\nmass_per_length = 0.1\n"
    "rest_shape = \"a.csv\"\n[[gripper]]\nat = 0\ndirection = [1, 0, 0]\ntrajectory = "
    "\"move.csv\"\n[[obstacle]]\nshape = \"sphere\"\nradius = 0.01\ntrajectory = \"far.csv\"\n"
    "[track]\nstart = \"a.csv\"\n";

TEST_F(SweepCommand, ReadsTheFilesThatFieldsNameBesideTheScene) {
  write("a.csv", arc_text(1));
  write("b.csv", arc_text(4));
  write("move.csv", "time,x,y,z\n0,0,0,0\n1,0.1,0,0\n");
  write("far.csv", "time,x,y,z\n0,0,-1,0\n1,0,-1,0\n");
  const std::string file = write("files.toml", scene_with_files);
  const auto rows = csv_rows(output_of("sweep " + file + " --vary rod.rest_shape=a.csv,b.csv"));
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0][3], "tip_x_m");
  EXPECT_NEAR(std::stod(rows[1][3]), std::sin(0.3), 1e-5);
  EXPECT_NEAR(std::stod(rows[2][3]), std::sin(1.2) / 4, 1e-5);
}

TEST_F(SweepCommand, BadGridsAreOneLineAndStatusTwo) {
  const std::string start = "sweep " + steel() + " ";
  expect_error(start, 2, {"--vary"});
  expect_error(start + "--vary rod.lenght=1", 2, {"rod.lenght", "unknown key", "length"});
  expect_error(start + "--vary rod.length=lin:1:2", 2, {"rod.length=lin:1:2", "lin:a:b:n"});
  expect_error(start + "--vary rod.length=1 rod.length=2", 2, {"rod.length", "once"});
  for (const char* part : {"3/2", "0/3", "1", "1/0", "-1/3", "1/3x", "a/b", "1//3", "/"}) {
    expect_error(start + "--vary gamma=1 --part " + part, 2, {"--part", part, "I <= N"});
  }
  expect_error(start + "--vary gamma=1 --threads -1", 2, {"--threads"});
  expect_error("sweep " + steel() + " " + steel() + " --vary gamma=1", 2, {"2 scene files"});
}

TEST_F(SweepCommand, RefusesAPictureOverWordsBeforeItComputes) {
  expect_error("sweep " + steel() + " --vary rod.material=copper,nylon -o " + path("words.csv") +
                   " --plot " + path("words.svg"),
               2, {"--plot", "rod.material", "copper is no number"});
  EXPECT_FALSE(std::filesystem::exists(path("words.csv")));
}

TEST_F(SweepCommand, RanksOfMpirunComputeParts) {
  ::setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
  ::setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  const std::string line = "mpirun --oversubscribe -n 3 sh -c '" DLO_COMMAND " " + sweep +
                           " --part $((OMPI_COMM_WORLD_RANK + 1))/$OMPI_COMM_WORLD_SIZE -o " +
                           path("map.$((OMPI_COMM_WORLD_RANK + 1)).csv") + "' 2>" + path("log");
  ASSERT_EQ(std::system(line.c_str()), 0) << read(path("log"));
  expect_merged();
}

// A job that failed runs again, one that ended well does not.
TEST_F(SweepCommand, GnuParallelResumesParts) {
  const std::string line = "cd " + path("") + " && parallel --will-cite -j 2 --resume-failed " +
                           "--joblog log " DLO_COMMAND " " + sweep +
                           " --part {}/4 -o map.{}.csv ::: 1 2 3 4 2>errors";
  std::filesystem::create_directory(path("map.2.csv"));
  ASSERT_NE(std::system(line.c_str()), 0);
  std::filesystem::remove(path("map.2.csv"));
  const auto before = std::filesystem::last_write_time(path("map.1.csv"));
  ASSERT_EQ(std::system(line.c_str()), 0) << read(path("errors"));
  EXPECT_EQ(std::filesystem::last_write_time(path("map.1.csv")), before);
  expect_merged();
}

// The command is run by a shell as in a task of sbatch --array=1-2.
TEST_F(SweepCommand, TasksOfASlurmArrayComputeParts) {
  for (const char* task : {"1", "2"}) {
    const std::string line = std::string("SLURM_ARRAY_TASK_COUNT=2 SLURM_ARRAY_TASK_ID=") + task +
                             " sh -c '" DLO_COMMAND " " + sweep +
                             " --part $SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT -o " +
                             path("map.$SLURM_ARRAY_TASK_ID.csv") + "'";
    ASSERT_EQ(std::system(line.c_str()), 0);
  }
  expect_merged();
}

TEST_F(SweepCommand, CountsRowsWithoutResultAndSuggestsFields) {
  expect_output("sweep " + steel() + " --vary gamma=1,10 --max-evaluations 1", 0,
                {"2 of 2 scenes have no result"});
  expect_output("sweep " + steel() + " --vary rod.length=-1,1", 0, {"1 of 2 scenes"});
  EXPECT_EQ(run("sweep " + steel() + " --vary gamma=1,10").err, "");
  expect_error("sweep " + steel() + " --vary E=1,2", 2,
               {"did you mean rod.material.youngs_modulus?"});
}

}  // namespace
}  // namespace dlo::compare
