// dlo sweep as a user and a scheduler run it.

#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "../../sanitized.hpp"
#include "command_fixture.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"

namespace {

using dlo::test::says;

class SweepCommand : public dlo::test::Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    // This test may itself run under a scheduler.
    for (const char* name : {"SLURM_ARRAY_TASK_ID", "OMPI_COMM_WORLD_RANK"}) ::unsetenv(name);
  }

  /// Starts a sweep, kills it (SIGKILL) when its part has grown by `bytes`; false if it finished.
  [[nodiscard]] static bool run_and_kill(const std::string& vary, const std::string& output,
                                         std::uintmax_t bytes) {
    std::string words[] = {DLO_COMMAND, "sweep", steel(), "--vary", vary, "-o", output};
    std::array<char*, std::size(words) + 1> arguments{};
    for (std::size_t i = 0; i < std::size(words); ++i) arguments[i] = words[i].data();
    const std::string part = output + ".part";
    const auto size = [&] {
      std::error_code error;
      const std::uintmax_t count = std::filesystem::file_size(part, error);
      return error ? 0 : count;
    };
    const std::uintmax_t enough = size() + bytes;
    pid_t process = 0;
    EXPECT_EQ(::posix_spawn(&process, DLO_COMMAND, nullptr, nullptr, arguments.data(), environ), 0);
    int status = 0;
    while (::waitpid(process, &status, WNOHANG) == 0) {
      if (size() < enough) {
        ::usleep(100);
        continue;
      }
      ::kill(process, SIGKILL);
      ::waitpid(process, &status, 0);
      return WIFSIGNALED(status);
    }
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    return false;
  }

  void expect_same_files(const std::string& a, const std::string& b) const {
    const std::string expected = read(path(a));
    EXPECT_GT(expected.size(), 100U);
    EXPECT_TRUE(read(path(b)) == expected) << a << " and " << b;
  }
};

TEST_F(SweepCommand, WritesATableToStandardOutputOrAFile) {
  const std::string arguments =
      "sweep " + steel() + " --vary gamma=log:0.1:10:3 gripper.0.direction='0 deg,45 deg'";
  const dlo::test::Outcome printed = run(arguments);
  ASSERT_EQ(printed.status, 0) << printed.err;
  EXPECT_EQ(printed.err, "");
  EXPECT_EQ(printed.out.substr(0, 40), "row,gamma,gripper.0.direction [deg],tip_");
  EXPECT_EQ(std::count(printed.out.begin(), printed.out.end(), '\n'), 7);
  succeeds(arguments + " -o " + path("a.csv"));
  EXPECT_EQ(read(path("a.csv")), printed.out);
  EXPECT_EQ(run(arguments + " --threads 5").out, printed.out);
}

TEST_F(SweepCommand, SaysHowManyScenesHaveNoResult) {
  const dlo::test::Outcome result =
      run("sweep " + steel() + " --vary rod.length=-1,1 -o " + path("a.csv"));
  EXPECT_EQ(result.status, 0);
  EXPECT_TRUE(says(result.err, {"1 of 2 scenes"}));
}

TEST_F(SweepCommand, BadGridsAreOneLineAndStatusTwo) {
  const std::string start = "sweep " + steel() + " ";
  expect_error(start, 2, {"--vary"});
  expect_error("sweep --vary gamma=1", 2, {"FILE"});
  expect_error(start + "--vary rod.lenght=1", 2, {"rod.lenght", "unknown key", "length"});
  expect_error(start + "--vary rod.length=lin:1:2", 2, {"rod.length=lin:1:2", "lin:a:b:n"});
  expect_error(start + "--vary rod.length=1 rod.length=2", 2, {"rod.length", "once"});
  expect_error(start + "--vary gamma=1 --model fem", 2, {"fem", "energy"});
  expect_error(start + "--vary gamma=1 --shard 3/2", 2, {"3/2", "i <= n"});
  expect_error(start + "--vary gamma=1 --threads -1", 2, {"--threads"});
  expect_error("sweep " + path("none.toml") + " --vary gamma=1", 2, {"none.toml"});
  expect_error("sweep " + steel() + " " + steel() + " --vary gamma=1", 2, {"2 scene files"});
  expect_error("sweep --merge " + steel() + " -o " + path("a.csv"), 2, {"no shard"});
  expect_error("sweep --merge " + steel(), 2, {"-o"});
}

TEST_F(SweepCommand, RefusesAPictureOverWordsBeforeItComputes) {
  expect_error("sweep " + steel() + " --vary rod.material=copper,nylon -o " + path("words.csv") +
                   " --plot " + path("words.svg"),
               2, {"--plot", "rod.material", "copper is no number"});
  EXPECT_FALSE(std::filesystem::exists(path("words.csv")));
  EXPECT_FALSE(std::filesystem::exists(path("words.csv.part")));
}

TEST_F(SweepCommand, KilledTwentyTimesGivesTheFileOfAnUnbrokenRun) {
  const std::string vary = "gamma=log:0.1:100:20000";
  succeeds("sweep " + steel() + " --vary " + vary + " -o " + path("whole.csv"));
  const std::uintmax_t size = std::filesystem::file_size(path("whole.csv"));
  std::mt19937 random(5);
  std::uniform_int_distribution<std::uintmax_t> bytes(0, size / 24);
  // A run that finishes before the kill reaches it is begun anew and not counted.
  for (int kills = 0; kills < dlo::test::draws(20);) {
    if (run_and_kill(vary, path("killed.csv"), bytes(random))) {
      ++kills;
    } else {
      std::filesystem::remove(path("killed.csv"));
    }
  }
  succeeds("sweep " + steel() + " --vary " + vary + " -o " + path("killed.csv"));
  expect_same_files("whole.csv", "killed.csv");
  EXPECT_FALSE(std::filesystem::exists(path("killed.csv.part")));
}

TEST_F(SweepCommand, MergedShardsHoldEveryRowOfManyBlocks) {
  // Each shard is longer than the blocks of 64 KiB that merging writes.
  constexpr int rows = 2401;
  const std::string vary = "gamma=lin:1:17:2401";
  for (const char* shard : {"1/2", "2/2"}) {
    const std::string line = words({"sweep", steel(), "--vary", vary, "--shard", shard, "-o"});
    succeeds(line + path("part.{shard}.csv"));
  }
  for (const char* part : {"part.1-of-2.csv", "part.2-of-2.csv"}) {
    EXPECT_GT(std::filesystem::file_size(path(part)), 65536U + 1000U);
  }
  succeeds("sweep --merge " + path("part.*") + " -o " + path("all.csv"));
  const std::string all = read(path("all.csv"));
  EXPECT_TRUE(
      all.starts_with("row,gamma,tip_x_m,tip_y_m,tip_z_m,energy_J,evaluations,terms,status\n"));
  const std::vector<dlo::test::CsvRow> table = dlo::test::csv_rows(all);
  ASSERT_EQ(table.size(), 1U + rows);
  const dlo::compare::Scene scene = dlo::compare::load_scene(steel());
  for (int count = 0; count < rows; ++count) {
    const dlo::test::CsvRow& row = table[static_cast<std::size_t>(count) + 1];
    const double gamma = 1 + 16. * count / (rows - 1);
    ASSERT_EQ(row.size(), 9U) << count;
    const auto number = [&row](std::size_t column) { return std::stod(row[column]); };
    EXPECT_EQ(number(0), count);
    EXPECT_NEAR(number(1), gamma, 1e-10 * gamma);
    EXPECT_EQ(row[8], "ok") << count;
    if (count % 80 != 0) continue;
    // A single solve of the same scene.
    dlo::compare::Scene alone = scene;
    alone.gravity *= gamma / scene.gamma();
    const dlo::compare::Solution solution =
        dlo::compare::solve(alone, dlo::compare::Model::energy, {}, {alone.length});
    const Eigen::Vector3d tip = solution.shape.points.rightCols<1>();
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(number(static_cast<std::size_t>(k) + 2), tip[k], 1e-9) << count;
    }
    EXPECT_NEAR(number(5), solution.energy.total(), 1e-9) << count;
  }
}

TEST_F(SweepCommand, SaysThatItGoesOn) {
  const std::string line = "sweep " + steel() + " --vary gamma=1,2,3,4 --shard 1/1 -o ";
  succeeds(line + path("a.csv"));
  const std::string whole = read(path("a.csv"));
  // Two rows and a half are left of a run that was killed.
  const std::string part = whole.substr(0, whole.find("\n2,") + 20);
  std::ofstream(path("b.csv.part")) << part;
  const dlo::test::Outcome result = run(line + path("b.csv"));
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "dlo: " + path("b.csv") + ": resumed: 2 rows kept\n");
  EXPECT_EQ(read(path("b.csv")), whole);
  // A finished shard is not computed again.
  EXPECT_EQ(run(line + path("b.csv")).err,
            "dlo: " + path("b.csv") + ": finished already, 4 rows\n");
  EXPECT_EQ(run(line + path("b.csv") + " --restart").err, "");
}

TEST_F(SweepCommand, RanksOfMpirunAreShards) {
  ::setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
  ::setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  const std::string sweep = "sweep " + steel() + " --vary gamma=log:0.1:10:50 -o ";
  succeeds(sweep + path("whole.csv"));
  const std::string line = "mpirun --oversubscribe -n 3 " DLO_COMMAND " " + sweep + "'" +
                           path("{shard}.csv") + "' 2>" + path("log");
  ASSERT_EQ(std::system(line.c_str()), 0) << read(path("log"));
  EXPECT_TRUE(says(read(path("log")), {"shard 3/3"}));
  succeeds("sweep --merge " + path("*-of-3.csv") + " -o " + path("merged.csv"));
  expect_same_files("whole.csv", "merged.csv");
}

TEST_F(SweepCommand, GnuParallelRunsShards) {
  const std::string sweep = "sweep " + steel() + " --vary gamma=log:0.1:10:50 -o ";
  succeeds(sweep + path("whole.csv"));
  const std::string line = "parallel --will-cite -j 2 " DLO_COMMAND " " + sweep +
                           path("part{}.csv") + " --shard {}/4 ::: 1 2 3 4 2>" + path("log");
  ASSERT_EQ(std::system(line.c_str()), 0) << read(path("log"));
  succeeds("sweep --merge " + path("part*.csv") + " -o " + path("merged.csv"));
  expect_same_files("whole.csv", "merged.csv");
}

TEST_F(SweepCommand, TasksOfASlurmArrayAreShards) {
  const std::string sweep = "sweep " + steel() + " --vary gamma=log:0.1:10:50 -o ";
  succeeds(sweep + path("whole.csv"));
  ::setenv("SLURM_ARRAY_TASK_MIN", "1", 1);
  ::setenv("SLURM_ARRAY_TASK_COUNT", "2", 1);
  for (const char* task : {"1", "2"}) {
    ::setenv("SLURM_ARRAY_TASK_ID", task, 1);
    succeeds(sweep + path("task_{shard}.csv"));
  }
  const dlo::test::Outcome other = run(sweep + path("task_1-of-2.csv"));
  EXPECT_EQ(other.status, 2);
  EXPECT_TRUE(says(other.err, {"is shard 1/2, this is 2/2"}));
  ::unsetenv("SLURM_ARRAY_TASK_ID");
  succeeds("sweep --merge " + path("task_*.csv") + " -o " + path("merged.csv"));
  expect_same_files("whole.csv", "merged.csv");
}

TEST_F(SweepCommand, CountsRowsWithoutResultAndSuggestsFields) {
  const dlo::test::Outcome result =
      run("sweep " + steel() + " --vary gamma=1,10 --max-evaluations 1");
  EXPECT_EQ(result.status, 0);
  EXPECT_TRUE(says(result.err, {"2 of 2 scenes have no result"}));
  EXPECT_EQ(run("sweep " + steel() + " --vary gamma=1,10").err, "");
  expect_error("sweep " + steel() + " --vary E=1,2", 2,
               {"did you mean rod.material.youngs_modulus?"});
}

TEST_F(SweepCommand, HelpHasAnExample) { EXPECT_TRUE(says(run("sweep --help").out, {"Example:"})); }

}  // namespace
