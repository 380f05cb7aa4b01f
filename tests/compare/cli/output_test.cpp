// Tests of writing: every byte is written or its loss is reported, and no other file is destroyed.

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "../../sanitized.hpp"
#include "base/output_file.hpp"
#include "base/temporary_path.hpp"
#include "output_fixture.hpp"

namespace dlo::compare {
namespace {

namespace fs = std::filesystem;

TEST_F(Output, ThatIsLostOnStandardOutputIsAnError) {
  for (const std::string arguments :
       {"", "--help", "--version", "solve --help", "materials", "solve cable.toml",
        "solve cable.toml --format json", "sweep cable.toml --vary gamma=1,2",
        "init mine.toml --force"}) {
    write_scene("cable.toml");
    for (const std::string lost : {">/dev/full", ">&-"}) {
      const RunResult result = bash(words({"$dlo", arguments, lost}));
      EXPECT_EQ(result.status, 5) << arguments << lost;
      EXPECT_TRUE(one_line(result.err)) << arguments << lost << "\n" << result.err;
      EXPECT_TRUE(has_all(result.err, {"standard output: cannot be written"}));
    }
  }
  EXPECT_EQ(bash("$dlo solve cable.toml -o shape.csv >&-").status, 0);
  EXPECT_EQ(read(path("shape.csv")).substr(0, 8), "x,y,z,s\n");
  EXPECT_EQ(bash("$dlo solve cable.toml -o /dev/full").status, 5);
  // SIGXFSZ would end the process by a signal; the file keeps its content.
  const RunResult limited = bash("ulimit -f 1; $dlo solve cable.toml --samples 9999 -o shape.csv");
  EXPECT_EQ(limited.status, 5);
  EXPECT_TRUE(has_all(limited.err, {"shape.csv: cannot be written (File too large)"}));
  EXPECT_EQ(read(path("shape.csv")).substr(0, 8), "x,y,z,s\n");
  EXPECT_EQ(files(), (std::vector<std::string>{"cable.toml", "mine.toml", "shape.csv"}));
}

TEST_F(Output, StandardErrorThatIsGoneFailsNothing) {
  // The command prints a warning, so that it writes to standard error.
  const std::string solve = "$dlo solve " + steel() + " --points 20 --samples 3 --format csv";
  const std::string expected = bash(solve).out;
  EXPECT_EQ(expected.substr(0, 8), "x,y,z,s\n");
  for (const std::string gone : {"2>&-", "2>/dev/full"}) {
    const RunResult result = bash(words({solve, gone}));
    EXPECT_EQ(result.status, 0) << gone;
    EXPECT_EQ(result.out, expected) << gone;
    EXPECT_EQ(bash("$dlo solve nothing.toml " + gone).status, 2) << gone;
  }
  (void)bash("{ sleep 0.05; " + solve + " 2>&1 >kept; echo $? >status; } | true");
  EXPECT_EQ(read(path("status")), "0\n");
  EXPECT_EQ(read(path("kept")), expected);
}

TEST_F(Output, ABrokenPipeIsSilent) {
  const std::string many = "$dlo solve " + steel() + " --samples 50000 --format csv";
  for (const std::string before : {"", "trap '' PIPE; "}) {
    const RunResult result = bash(before + many + " | head -n 1; echo ${PIPESTATUS[0]}");
    EXPECT_EQ(result.out, "x,y,z,s\n141\n") << before;
    EXPECT_EQ(result.err, "") << before;
  }
}

TEST_F(Output, DevicesPipesAndLinksStayWhatTheyAre) {
  write_scene("cable.toml");
  for (const std::string command : {"$dlo solve cable.toml --samples 3 --format csv",
                                    "$dlo sweep cable.toml --vary gamma=1,2"}) {
    ASSERT_EQ(bash(command + " -o plain.csv").status, 0) << command;
    const std::string expected = read(path("plain.csv"));
    EXPECT_GT(expected.size(), 80U);
    fs::remove(path("plain.csv"));
    EXPECT_EQ(bash(command + " -o /dev/stdout | cat").out, expected) << command;
    EXPECT_EQ(bash(command + " -o >(cat >via); wait $!; cat via").out, expected) << command;
    // The output is written after existing content and before later content.
    (void)bash("{ echo first; " + command + " -o /dev/stdout; echo last; } >all");
    EXPECT_EQ(read(path("all")), "first\n" + expected + "last\n") << command;
    EXPECT_EQ(bash(command + " -o /dev/null").status, 0) << command;
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    (void)bash("mkfifo pipe; cat pipe >got & " + command + " -o pipe; wait");
    EXPECT_TRUE(fs::is_fifo(path("pipe"))) << command;
    EXPECT_EQ(read(path("got")), expected) << command;
    // The output is a link to a link to a file in another folder, which does not exist in the first
    // run.
    fs::create_directory(path("folder"));
    fs::create_symlink("folder/real.csv", path("near.csv"));
    fs::create_symlink("near.csv", path("far.csv"));
    for (int times = 0; times < 2; ++times) {
      EXPECT_EQ(bash(command + " -o far.csv").status, 0) << command;
      EXPECT_TRUE(fs::is_symlink(path("far.csv")) && fs::is_symlink(path("near.csv")));
      EXPECT_EQ(read(path("folder/real.csv")), expected) << command;
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(path("folder")), {}), 1) << command;
    for (const char* name : {"pipe", "near.csv", "far.csv", "folder", "all", "got", "via"}) {
      fs::remove_all(path(name));
    }
    EXPECT_EQ(files(), std::vector<std::string>{"cable.toml"}) << command;
  }
}

TEST_F(Output, AReplacedFileKeepsItsPermissionsAndANewOneHasTheUmasks) {
  write_scene("cable.toml");
  write("old.csv", "");
  ASSERT_EQ(::chmod(path("old.csv").c_str(), 0640), 0);
  ASSERT_EQ(
      bash("umask 027; $dlo solve cable.toml -o old.csv; $dlo solve cable.toml -o new.csv").status,
      0);
  for (const char* name : {"old.csv", "new.csv"}) {
    EXPECT_EQ(static_cast<unsigned>(fs::status(path(name)).permissions()), 0640U) << name;
  }
  // The file name has the maximum length.
  EXPECT_EQ(bash("$dlo solve cable.toml --format csv -o " + std::string(255, 'n')).status, 0);
}

TEST_F(Output, AnInputIsNeverWrittenOver) {
  write_scene("scene.toml");
  const std::string text = read(path("scene.toml"));
  fs::create_hard_link(path("scene.toml"), path("hard.toml"));
  fs::create_symlink("scene.toml", path("link.toml"));
  const std::string scene = path("scene.toml");
  succeeds("regress " + scene + " --update --baseline " + path("base.toml"));
  for (const char* name : {"scene.toml", "hard.toml", "link.toml", "./scene.toml"}) {
    const std::string same = path(name);
    expect_refused("solve " + scene + " -o " + same, {"--output", same, "is read too"});
    for (const std::string& output :
         {"compare " + scene + " -o", "calibrate " + scene + " -o", "bench " + scene + " -o",
          "stability " + scene + " --map cF-cc -o", "sweep " + scene + " --vary gamma=1 -o",
          "regress " + scene + " --baseline " + path("base.toml") + " --junit"}) {
      expect_error(words({output, same}), 2, {same, "is read too"});
    }
    expect_error(words({"regress", scene, "--update --baseline", same}), 2, {same, "unknown key"});
    EXPECT_EQ(read(scene), text) << name;
  }
  // Inputs other than scenes: shapes, parameters, materials, baselines.
  succeeds("solve " + scene + " --format csv -o " + path("shape"));
  succeeds("calibrate " + scene + " -o " + path("params.toml"));
  write("materials.toml", read(std::string(DLO_DATA) + "/materials.toml"));
  const auto reads = [&](const std::string& name, const std::string& arguments) {
    const std::string before = read(path(name));
    EXPECT_GT(before.size(), 100U);
    expect_error(arguments + " -o " + path(name), 2, {path(name), "is read too"});
    EXPECT_EQ(read(path(name)), before) << name;
  };
  reads("shape", words({"check", scene, "--shape", path("shape")}));
  reads("shape", words({"calibrate", scene, "--shape", path("shape")}));
  reads("params.toml", words({"solve", scene, "--model chain --parameters", path("params.toml")}));
  reads("materials.toml", words({"solve", scene, "--materials", path("materials.toml")}));
  reads("base.toml", words({"regress", scene, "--baseline", path("base.toml")}));
  expect_error(words({"init --force --materials", path("materials.toml"), path("materials.toml")}),
               2, {"materials.toml", "is read too"});
  expect_refused(words({"regress", scene, "--baseline", path("base.toml"), "--junit", path("twice"),
                        "-o", path("twice")}),
                 {"twice", "written twice"});
  const RunResult appended = bash("$dlo solve scene.toml >>scene.toml");
  EXPECT_EQ(appended.status, 2);
  EXPECT_TRUE(has_all(appended.err, {"standard output"}));
  EXPECT_EQ(read(scene), text);
  // Files that a benchmark set names, and files that its scenes name.
  write("shape.csv",
        "x,y,z\n0,0,0\n0.06,0.001,0\n0.12,0.004,0\n0.18,0.009,0\n0.24,0.016,0\n0.3,0.025,0\n");
  write("rest.toml",
        "[rod]\nlength = 0.3\nbending_stiffness = 1\nmass_per_length = 0\nrest_shape = "
        "\"shape.csv\"\n[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = \"0 deg\"\n");
  write("battery.toml",
        "schema = \"dlo/suite/1\"\nversion = \"1\"\n[[scene]]\nfile = \"rest.toml\"\nclass = "
        "\"a\"\nisolates = \"b\"\n");
  for (const char* name : {"shape.csv", "rest.toml", "battery.toml"}) {
    const std::string before = read(path(name));
    for (const char* option : {"-o", "--markdown", "--junit", "--report"}) {
      expect_error(
          words({"suite --with chain --battery", path("battery.toml"), option, path(name)}), 2,
          {path(name), "is read too"});
      EXPECT_EQ(read(path(name)), before) << option;
    }
  }
  // Updating a baseline reads and writes the same file, which is allowed.
  succeeds("regress " + scene + " --update --baseline " + path("base.toml"));
}

TEST_F(Output, CannotBeAFileThatAFieldNames) {
  const std::string points = "x,y,z\n0,0,0\n0.06,0,0\n0.12,0,0\n0.18,0,0\n0.24,0,0\n0.3,0,0\n";
  for (const char* name : {"a.csv", "b.csv", "frames.npy"}) write(name, points);
  const auto scene = [&](const std::string& file) {
    return write(
        "rest.toml",
        "[rod]\nlength = 0.3\nbending_stiffness = 1\nmass_per_length = 0\nrest_shape = \"" + file +
            "\"\n[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = 0\n");
  };
  expect_refused(words({"solve", scene("frames.npy:1"), "-o", path("frames.npy")}),
                 {"--output " + path("frames.npy") + ": is read too"});
  // The second row of the sweep reads the file that is the output.
  expect_error(
      words({"sweep", scene("a.csv"), "--vary", "rod.rest_shape=a.csv,b.csv", "-o", path("b.csv")}),
      2, {path("b.csv") + ": is read too"});
  for (const char* name : {"b.csv", "frames.npy"}) EXPECT_EQ(read(path(name)), points) << name;
}

TEST_F(Output, ThatHasNoPlaceIsRefusedBeforeAnythingIsComputed) {
  const std::string solve = "solve " + steel() + " -o ";
  expect_refused(solve + path("none/a.csv"),
                 {"--output", "none/a.csv", "there is no folder", path("none")});
  expect_refused(solve + path(""), {"--output", "folder"});
  expect_refused(solve + path("."), {"--output", "folder"});
  expect_refused(solve + steel() + "/a.csv", {"--output", steel() + "/a.csv"});
  fs::create_symlink("loop", path("loop"));
  expect_refused(solve + path("loop"), {"--output", "loop", "symbolic links"});
  expect_refused("regress " + steel() + " --update --baseline " + path("none/b.toml"),
                 {"--baseline", "there is no folder"});
  expect_error("init " + path("none/a.toml"), 2, {"none/a.toml", "there is no folder"});
  if (::geteuid() == 0) return;  // root may write anywhere
  fs::create_directory(path("closed"));
  fs::permissions(path("closed"), fs::perms::owner_read | fs::perms::owner_exec);
  expect_refused(solve + path("closed/a.csv"), {"closed/a.csv", "Permission denied"});
}

// A process that a signal ends leaves its target unchanged, and next to it one file .dlo-*.tmp.
TEST_F(Output, ASignalLeavesTheTargetAsItWas) {
  write("a.csv", "old");
  const pid_t child = ::fork();
  if (child == 0) {
    end_groups_at_signals();
    OutputFile file(path("a.csv"));
    file.append("half");
    (void)std::raise(SIGTERM);
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM) << status;
  EXPECT_EQ(read(path("a.csv")), "old");
  const std::vector<std::string> left = files();
  ASSERT_EQ(left.size(), 2U);
  EXPECT_TRUE(left[0].starts_with(".dlo-") && left[0].ends_with(".tmp")) << left[0];
}

TEST_F(Output, OutOfMemoryIsALineAndAStatus) {
  if (sanitized) GTEST_SKIP() << "a sanitizer needs all address space";
  for (const std::string& arguments :
       {"solve " + steel() + " --samples 1000000 --format json",
        "solve " + steel() + " --model chain --points 1000000",
        "sweep " + steel() +
            " --vary force_model.points=1000000,999999 --model chain --threads 2"}) {
    const RunResult result = bash("ulimit -v 150000; $dlo " + arguments + " >/dev/null");
    EXPECT_EQ(result.status, 4) << arguments << result.err;
    EXPECT_EQ(result.err, "dlo: out of memory\n") << arguments;
  }
}

TEST_F(Output, OutOfThreadsIsALineAndAStatus) {
  // The limit of threads does not apply to root, so root runs the command as another user.
  const std::string unprivileged = ::geteuid() == 0 ? "setpriv --reuid=65534 --clear-groups " : "";
  const std::string limited = unprivileged + "prlimit --nproc=0 $dlo ";
  if (bash(limited + "solve " + steel() + " >/dev/null").status != 0) {
    GTEST_SKIP() << "threads cannot be limited, or others may not read here";
  }
  const RunResult result =
      bash(limited + "sweep " + steel() + " --vary gamma=1,2,3 --threads 3 >/dev/null");
  EXPECT_EQ(result.status, 4) << result.err;
  EXPECT_EQ(result.err,
            "dlo: out of threads or memory (a worker thread: Resource temporarily unavailable)\n");
}

}  // namespace
}  // namespace dlo::compare
