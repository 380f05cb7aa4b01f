#include "foreign/foreign_program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/scene_file.hpp"

namespace dlo::compare {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

Scene soft_cable() { return load_scene(std::string(DLO_DATA) + "/scenes/cable.toml"); }

/// Runs a line of sh as the simulator. In the line $0 is the scene file, $1 is "N=" with the number
/// of points, and $2 is the shape file.
SimulatorRun run_shell(const std::string& line, double time_limit = 20) {
  return run_foreign({"sh", {"sh", "-c", line, "{scene}", "N={points}", "{shape}"}}, soft_cable(),
                     24, time_limit);
}

std::string refusal_of_program(const std::string& with) {
  return error_of<InputError>([&] { return parse_foreign_program(with); });
}

/// Fixture with a private temporary folder, which must be empty at the end of the test.
class ForeignFolder : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    ::setenv("TMPDIR", folder_.c_str(), 1);
  }
  void TearDown() override {
    EXPECT_TRUE(std::filesystem::is_empty(folder_));
    ::unsetenv("TMPDIR");
    std::filesystem::remove_all(folder_);
  }

 private:
  std::string folder_ =
      std::filesystem::temp_directory_path() / ("dlo_foreign_test_" + std::to_string(::getpid()));
};

TEST(ForeignProgram, IsANameAndTheWordsOfACommand) {
  const ForeignProgram program = parse_foreign_program("my-sim_2=sim --in={scene} '{shape}' a=b");
  EXPECT_EQ(program.name, "my-sim_2");
  EXPECT_THAT(program.words, ElementsAre("sim", "--in={scene}", "{shape}", "a=b"));
  EXPECT_THAT(
      parse_foreign_program("a=sim \"{shape} \\\"b\\$c\\d\"e\\ f '' $HOME *.csv a|b >c; `d` #")
          .words,
      ElementsAre("sim", "{shape} \"b$c\\de f", "", "$HOME", "*.csv", "a|b", ">c;", "`d`", "#"));
}

TEST(ForeignProgram, BadOnesAreRefused) {
  EXPECT_THAT(refusal_of_program("sim {shape}"), HasSubstr("no NAME before an ="));
  for (const char* text :
       {"=sim {shape}", "a b=sim {shape}", "..=sim {shape}", "force=sim {shape}"}) {
    EXPECT_THAT(refusal_of_program(text), HasSubstr("not such a NAME")) << text;
  }
  EXPECT_THAT(refusal_of_program("a=sim {scene}"), HasSubstr("no {shape} in the command"));
  for (const char* text :
       {"a='sim {shape}", "a=sim \"{shape}", "a=sim {shape} \"\\", "a=sim {shape}\\", "a= "}) {
    EXPECT_THAT(refusal_of_program(text), HasSubstr("--with a: the command ")) << text;
  }
  EXPECT_THROW((void)parse_foreign_programs({"a=b {shape}", "a=c {shape}"}), InputError);
}

TEST_F(ForeignFolder, IsGivenTheSceneAndTheNumberOfPoints) {
  const SimulatorRun run = run_shell(
      "grep -q '\"schema\": \"dlo/scene/1\"' $0 && grep -q '\"points\": 24' $0 && "
      "[ $1 = N=24 ] && printf '0,0,0\\n1,0,0\\n' > $2.csv");
  EXPECT_EQ(run.problem, "");
  ASSERT_TRUE(run.shape);
  EXPECT_EQ(run.shape->points.cols(), 2);
  EXPECT_GT(run.seconds, 0);
}

TEST_F(ForeignFolder, EndOfTheLastSegmentIsAppendedToTheStartsOfTheSegments) {
  const auto run = run_shell("for i in 0 1 2 3 4 5 6 7; do echo 0.${i}00,0,0; done > $2.csv");
  ASSERT_TRUE(run.shape) << run.problem;
  EXPECT_EQ(run.shape->points.cols(), 8);
  Scene rod = soft_cable();
  rod.length = 0.8;
  const SimulatorRun starts = run_foreign(
      {"sh", {"sh", "-c", "for i in 0 1 2 3 4 5 6 7; do echo 0.$i,0,0; done > $0.csv", "{shape}"}},
      rod, 8, 20);
  ASSERT_TRUE(starts.shape) << starts.problem;
  ASSERT_EQ(starts.shape->points.cols(), 9);
  EXPECT_NEAR(starts.shape->points(0, 8), 0.8, 1e-12);
}

TEST_F(ForeignFolder, SaysWhatFailedWithTheLastLineOfItsStandardError) {
  EXPECT_EQ(run_shell("echo one >&2; echo two >&2; echo three; exit 4").problem,
            "exit status 4: two");
  EXPECT_EQ(run_shell("true").problem, "wrote no shape");
  EXPECT_THAT(run_shell("kill -9 $$").problem, StartsWith("ended by signal 9"));
  EXPECT_THAT(run_shell("echo hello > $2").problem, HasSubstr("its shape:1: unknown column"));
  EXPECT_THAT(run_shell("touch $2.csv $2.vtk").problem, HasSubstr("wrote no shape"));
  EXPECT_THAT(run_foreign({"none", {"no such program", "{shape}"}}, soft_cable(), 16, 20).problem,
              StartsWith("could not be started: "));
}

TEST_F(ForeignFolder, ReadsNothingButRegularFiles) {
  const std::string allowed = " (allowed: a regular file)";
  EXPECT_EQ(run_shell("mkdir $2").problem, "its shape: a folder" + allowed);
  EXPECT_EQ(run_shell("mkfifo $2").problem, "its shape: a named pipe" + allowed);
  EXPECT_EQ(run_shell("mkfifo $2.csv").problem, "its shape: a named pipe" + allowed);
  EXPECT_EQ(run_shell("ln -s /dev/zero $2").problem, "its shape: a device" + allowed);
  EXPECT_THAT(run_shell("ln -s shape $2").problem,
              StartsWith("its shape: cannot be read (Too many levels"));
  EXPECT_THAT(run_shell("ln -s nothing $2").problem,
              StartsWith("its shape: cannot be read (No such file"));
  // A pipe in place of the file of error messages is not waited for.
  EXPECT_EQ(run_shell("cd ${2%/*}; rm stderr; mkfifo stderr; exit 3").problem, "exit status 3");
  EXPECT_EQ(run_shell("printf '0,0,0\\n1,0,0\\n' > $2.txt; ln -s $2.txt $2").problem, "");
}

TEST_F(ForeignFolder, MayBeMadeAwayWithByTheProgram) {
  const std::string folder = "the folder of {shape} cannot be read ";
  EXPECT_EQ(run_shell("rm -r ${2%/*}").problem, folder + "(No such file or directory)");
  EXPECT_EQ(run_shell("rm -r ${2%/*}; touch ${2%/*}").problem, folder + "(Not a directory)");
  EXPECT_EQ(run_shell("rm -r ${2%/*}; exit 3").problem, "exit status 3");
}

TEST_F(ForeignFolder, GoesWithAllThatIsInItHoweverDeep) {
  // The program leaves a tree that is deeper than the limits of open folders and of path lengths,
  // and a folder without permissions.
  const std::string deep =
      "cd ${2%/*}; mkdir tree closed closed/in; chmod 0 closed; d=$(printf '/deep%.0s' $(seq "
      "520)); "
      "for i in 1 2; do mkdir -p new$d/beside && touch new$d/file && mv tree new$d && "
      "mv new tree || exit; done";
  EXPECT_EQ(run_shell(deep).problem, "wrote no shape");
}

TEST_F(ForeignFolder, IsKilledAtTheTimeLimitWithAllThatItStartedAndLeftRunning) {
  const std::string mark = std::filesystem::temp_directory_path().string() + "_alive";
  const SimulatorRun run = run_shell("trap '' TERM; (sleep 1; touch " + mark + ") & sleep 60", 0.2);
  EXPECT_TRUE(run.too_long);
  EXPECT_EQ(run.problem, "killed after the time limit of 0.2 s");
  EXPECT_LT(run.seconds, 10);
  EXPECT_EQ(run_shell("(sleep 1; touch " + mark + ") & exit 3").problem, "exit status 3");
  (void)std::system("sleep 1.5");
  EXPECT_FALSE(std::filesystem::exists(mark));
}

TEST(ForeignDeviation, OfTheReferenceItselfIsZeroAndOfAMovedShapeTheWay) {
  const Scene scene = soft_cable();
  const energy_model::Equilibrium rod = solve_reference(scene, Model::energy);
  const std::vector<double> s = equal_arc_lengths(scene.length, 201);
  MeasuredShape shape{"shape", rod.sample(s).points, s};
  EXPECT_LT(foreign_deviation(scene, shape, rod.sample).rms_over_length, 1e-12);
  shape.points.row(2).array() += 0.005;
  const Deviation moved = foreign_deviation(scene, shape, rod.sample);
  EXPECT_NEAR(moved.rms_over_length, 0.005, 1e-12);
  // The points may be in either order, with or without arc lengths.
  shape.points = shape.points.rowwise().reverse().eval();
  shape.arc_length.clear();
  EXPECT_NEAR(foreign_deviation(scene, shape, rod.sample).rms_over_length, 0.005, 1e-5);
}

TEST(ForeignDeviation, AShapeThatIsNotHeldOrNotTheRodIsRefused) {
  const Scene scene = soft_cable();
  const energy_model::Equilibrium rod = solve_reference(scene, Model::energy);
  const std::vector<double> s = equal_arc_lengths(scene.length, 201);
  MeasuredShape shape{"shape", rod.sample(s).points, {}};
  shape.points.row(0).array() += 0.02;
  EXPECT_THROW((void)foreign_deviation(scene, shape, rod.sample), InputError);
  const MeasuredShape part{"shape", rod.sample(equal_arc_lengths(0.4, 81)).points, {}};
  EXPECT_THROW((void)foreign_deviation(scene, part, rod.sample), InputError);
}

}  // namespace
}  // namespace dlo::compare
