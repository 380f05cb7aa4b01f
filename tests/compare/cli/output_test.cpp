// What leaves the command: every byte is written or its loss is told, nothing is destroyed on the
// way, and no name or number breaks a format.

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "../../sanitized.hpp"
#include "base/display.hpp"
#include "base/number.hpp"
#include "base/output_file.hpp"
#include "base/quote.hpp"
#include "base/temporary_path.hpp"
#include "command_fixture.hpp"
#include "dlo/compare/error.hpp"
#include "format/json.hpp"
#include "format/solution_output.hpp"
#include "scene_text.hpp"

namespace {

using dlo::test::says;
using dlo::test::says_none;

namespace fs = std::filesystem;

using dlo::compare::display;
using dlo::compare::InputError;
using dlo::compare::OutputError;
using dlo::compare::OutputFile;
using dlo::compare::OutputTarget;
using dlo::compare::valid_utf8;
using dlo::test::Outcome;

const std::string held_at_both_ends =
    "name = \"both ends\"\n" + dlo::test::steel_rod + dlo::test::level_clamp + R"([[gripper]]
at = "50 cm"
position = [0.45, 0, 0]
direction = "0 deg"
)";

class Output : public dlo::test::Command {
 protected:
  /// A line of bash that may be more than one command; its standard error is what they write there.
  [[nodiscard]] Outcome bash(const std::string& script) const {
    std::ofstream(path("script")) << "cd " << path("") << "\ndlo=" << DLO_COMMAND << "\n"
                                  << script << "\n";
    return run_line("bash " + path("script"));
  }

  void write_scene(const std::string& name) const { write(name, read(steel())); }

  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names = Command::files();
    std::erase_if(names, [](const auto& name) { return name == "script" || name == "stderr"; });
    return names;
  }

  [[nodiscard]] static bool one_line(const std::string& text) {
    return std::count(text.begin(), text.end(), '\n') == 1 && text.ends_with('\n');
  }

  /// Refused with status 2 before the scene is solved, which would end with status 3.
  void expect_refused(const std::string& arguments, const std::vector<std::string>& names) const {
    expect_error(arguments + " --max-evaluations 1", 2, names);
  }
};

TEST_F(Output, ThatIsLostOnStandardOutputIsAnError) {
  for (const std::string arguments :
       {"", "--help", "--version", "--man-page", "--bash-completion", "--fish-completion",
        "--zsh-completion", "solve --help", "materials", "solve cable.toml",
        "solve cable.toml --format json", "sweep cable.toml --vary gamma=1,2",
        "init mine.toml --force"}) {
    write_scene("cable.toml");
    for (const std::string lost : {">/dev/full", ">&-"}) {
      const Outcome result = bash(words({"$dlo", arguments, lost}));
      EXPECT_EQ(result.status, 5) << arguments << lost;
      EXPECT_TRUE(one_line(result.err)) << arguments << lost << "\n" << result.err;
      EXPECT_TRUE(says(result.err, {"standard output: cannot be written"}));
    }
  }
  EXPECT_EQ(bash("$dlo solve cable.toml -o shape.csv >&-").status, 0);
  EXPECT_EQ(read(path("shape.csv")).substr(0, 8), "x,y,z,s\n");
  EXPECT_EQ(bash("$dlo solve cable.toml -o /dev/full").status, 5);
  // SIGXFSZ would end it by a signal; the file keeps what it had.
  const Outcome limited = bash("ulimit -f 1; $dlo solve cable.toml --samples 9999 -o shape.csv");
  EXPECT_EQ(limited.status, 5);
  EXPECT_TRUE(says(limited.err, {"shape.csv: cannot be written (File too large)"}));
  EXPECT_EQ(read(path("shape.csv")).substr(0, 8), "x,y,z,s\n");
  EXPECT_EQ(files(), (std::vector<std::string>{"cable.toml", "mine.toml", "shape.csv"}));
}

TEST_F(Output, StandardErrorThatIsGoneFailsNothing) {
  // With a warning to write.
  const std::string solve = "$dlo solve " + steel() + " --points 20 --samples 3 --format csv";
  const std::string expected = bash(solve).out;
  EXPECT_EQ(expected.substr(0, 8), "x,y,z,s\n");
  for (const std::string gone : {"2>&-", "2>/dev/full"}) {
    const Outcome result = bash(words({solve, gone}));
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
    const Outcome result = bash(before + many + " | head -n 1; echo ${PIPESTATUS[0]}");
    EXPECT_EQ(result.out, "x,y,z,s\n141\n") << before;
    EXPECT_EQ(result.err, "") << before;
  }
}

TEST_F(Output, DevicesPipesAndLinksStayWhatTheyAre) {
  write_scene("cable.toml");
  ASSERT_EQ(bash("$dlo sweep cable.toml --vary gamma=1,2,3 --shard 1/1 -o part.csv").status, 0);
  for (const std::string command :
       {"$dlo solve cable.toml --samples 3 --format csv", "$dlo sweep cable.toml --vary gamma=1,2",
        "$dlo sweep --merge part.csv"}) {
    ASSERT_EQ(bash(command + " -o plain.csv").status, 0) << command;
    const std::string expected = read(path("plain.csv"));
    EXPECT_GT(expected.size(), 80U);
    fs::remove(path("plain.csv"));
    EXPECT_EQ(bash(command + " -o /dev/stdout | cat").out, expected) << command;
    EXPECT_EQ(bash(command + " -o >(cat >via); wait $!; cat via").out, expected) << command;
    // Behind what is there already, and before what comes later.
    (void)bash("{ echo first; " + command + " -o /dev/stdout; echo last; } >all");
    EXPECT_EQ(read(path("all")), "first\n" + expected + "last\n") << command;
    EXPECT_EQ(bash(command + " -o /dev/null").status, 0) << command;
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    (void)bash("mkfifo pipe; cat pipe >got & " + command + " -o pipe; wait");
    EXPECT_TRUE(fs::is_fifo(path("pipe"))) << command;
    EXPECT_EQ(read(path("got")), expected) << command;
    // A link to a file in another folder, over a link, and to one that is not there yet.
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
    EXPECT_EQ(files(), (std::vector<std::string>{"cable.toml", "part.csv"})) << command;
  }
}

TEST_F(Output, NobodysTemporaryFileIsTaken) {
  write_scene("cable.toml");
  for (const char* name : {"a.csv.tmp", "b.csv.tmp"}) write(name, "precious");
  ASSERT_EQ(bash("$dlo sweep cable.toml --vary gamma=1,2 -o a.csv").status, 0);
  ASSERT_EQ(bash("$dlo solve cable.toml -o b.csv").status, 0);
  EXPECT_EQ(read(path("a.csv.tmp")) + read(path("b.csv.tmp")), "preciousprecious");
  EXPECT_EQ(files(),
            (std::vector<std::string>{"a.csv", "a.csv.tmp", "b.csv", "b.csv.tmp", "cable.toml"}));
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
}

TEST_F(Output, AnInputIsNeverWrittenOver) {
  write_scene("scene.toml");
  const std::string text = read(path("scene.toml"));
  fs::create_hard_link(path("scene.toml"), path("hard.toml"));
  fs::create_symlink("scene.toml", path("link.toml"));
  const std::string scene = path("scene.toml");
  for (const char* name : {"scene.toml", "hard.toml", "link.toml", "./scene.toml"}) {
    const std::string same = path(name);
    for (const std::string command : {"solve", "compare", "calibrate"}) {
      expect_refused(words({command, scene, "-o", same}), {"--output", same, "is read too"});
    }
    expect_error(words({"bench", scene, "-o", same}), 2, {same, "is read too"});
    expect_error(words({"stability", scene, "--map cF-cc -o", same}), 2, {same, "is read too"});
    expect_refused(words({"sweep", scene, "--vary gamma=1 -o", same}), {same, "is read too"});
    expect_refused(words({"regress", scene, "--baseline b.toml --junit", same}),
                   {"--junit", same, "is read too"});
    expect_refused(words({"regress", scene, "--update --baseline", same}),
                   {"--baseline", same, "is read too"});
    EXPECT_EQ(read(scene), text) << name;
  }
  // What else is read: shapes, parameters, materials, shards, baselines, a sweep's part.
  ASSERT_EQ(run("solve " + scene + " --format csv -o " + path("shape")).status, 0);
  ASSERT_EQ(run("calibrate " + scene + " -o " + path("params.toml")).status, 0);
  ASSERT_EQ(run("regress " + scene + " --update --baseline " + path("base.toml")).status, 0);
  ASSERT_EQ(run("sweep " + scene + " --vary gamma=1 --shard 1/1 -o " + path("shard")).status, 0);
  write("materials.toml", read(std::string(DLO_DATA) + "/materials.toml"));
  write("x.part", text);
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
  reads("shard", words({"sweep --merge", path("shard")}));
  expect_error(words({"sweep", path("x.part"), "--restart --vary gamma=1 -o", path("x")}), 2,
               {"x.part", "is read too"});
  EXPECT_EQ(read(path("x.part")), text);
  expect_error(words({"init --force --materials", path("materials.toml"), path("materials.toml")}),
               2, {"materials.toml", "is read too"});
  expect_refused(words({"regress", scene, "--baseline", path("base.toml"), "--junit", path("twice"),
                        "-o", path("twice")}),
                 {"twice", "written twice"});
  expect_error(words({"report", path(""), "-o", path("")}), 2, {"-o", "is read too"});
  const Outcome appended = bash("$dlo solve scene.toml >>scene.toml");
  EXPECT_EQ(appended.status, 2);
  EXPECT_TRUE(says(appended.err, {"standard output"}));
  EXPECT_EQ(read(scene), text);
  // A baseline that is written anew is its own input.
  EXPECT_EQ(run("regress " + scene + " --update --baseline " + path("base.toml")).status, 0);
}

TEST_F(Output, ThatHasNoPlaceIsRefusedBeforeAnythingIsComputed) {
  const std::string solve = "solve " + steel() + " -o ";
  expect_refused(solve + path("none/a.csv"),
                 {"--output", "none/a.csv", "there is no folder", path("none")});
  expect_refused(solve + path(""), {"--output", "folder"});
  expect_refused(solve + path("."), {"--output", "folder"});
  expect_refused(solve + steel() + "/a.csv", {"--output", steel() + "/a.csv"});
  expect_refused(solve + "''", {"--output", "empty"});
  fs::create_symlink("loop", path("loop"));
  expect_refused(solve + path("loop"), {"--output", "loop", "symbolic links"});
  expect_refused("sweep " + steel() + " --vary gamma=1 -o " + path("none/{shard}.csv"),
                 {"--output", "there is no folder", path("none")});
  expect_refused("sweep " + steel() + " --vary gamma=1 -o ''", {"--output", "empty"});
  expect_refused("regress " + steel() + " --update --baseline " + path("none/b.toml"),
                 {"--baseline", "there is no folder"});
  expect_refused("regress " + steel() + " --baseline b.toml --junit ''", {"--junit", "empty"});
  expect_error("report " + steel() + " -o ''", 2, {"--output", "empty"});
  expect_error("init " + path("none/a.toml"), 2, {"none/a.toml", "there is no folder"});
  if (::geteuid() == 0) return;  // root may write anywhere
  fs::create_directory(path("closed"));
  fs::permissions(path("closed"), fs::perms::owner_read | fs::perms::owner_exec);
  expect_refused(solve + path("closed/a.csv"), {"closed/a.csv", "Permission denied"});
}

TEST_F(Output, ASignalLeavesNothingUnfinished) {
  const auto ended_by = [&](int number, bool ignored) {
    const pid_t child = ::fork();
    if (child == 0) {
      (void)std::signal(number, ignored ? SIG_IGN : SIG_DFL);
      dlo::compare::remove_temporaries_at_signals();
      OutputFile file(path("a.csv"));
      file.append("half");
      fs::create_directories(path("tree/a/b/c/d/e/f/g"));
      write("tree/a/b/c/d/e/f/g/a.toml", "a");
      const rlimit no_core = {0, 0};
      (void)::setrlimit(RLIMIT_CORE, &no_core);
      const dlo::compare::TemporaryPath tree(path("tree"));
      if (files().size() != 2) ::_exit(9);
      (void)std::raise(number);
      file.finish();
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return status;
  };
  const int last_of_all = SIGRTMAX;
  for (const int number :
       {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGQUIT, SIGABRT, SIGALRM, SIGUSR1, SIGUSR2, SIGXCPU,
        SIGXFSZ, SIGPROF, SIGVTALRM, SIGIO, SIGPWR, SIGSYS, SIGTRAP, last_of_all}) {
    const int status = ended_by(number, false);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == number) << number << " " << status;
    EXPECT_EQ(files(), std::vector<std::string>{}) << number;
  }
  for (const int number : {SIGCHLD, SIGCONT, SIGURG, SIGWINCH}) {
    const int status = ended_by(number, false);  // which end nothing
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << number << " " << status;
    EXPECT_EQ(read(path("a.csv")), "half") << number;
    fs::remove(path("a.csv"));
    fs::remove_all(path("tree"));
  }
  const int status = ended_by(SIGHUP, true);  // as nohup does
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  EXPECT_EQ(files(), (std::vector<std::string>{"a.csv", "tree"}));
  EXPECT_EQ(read(path("a.csv")), "half");
}

TEST_F(Output, WithoutFinishNothingHasHappened) {
  write("a", "old");
  {
    OutputFile file(path("a"));
    file.append("new");
    EXPECT_EQ(files().size(), 2U);
  }
  EXPECT_EQ(read(path("a")), "old");
  EXPECT_EQ(files(), std::vector<std::string>{"a"});
  // A name as long as names can be.
  const std::string longest(255, 'n');
  OutputFile file(path(longest));
  file.append("whole");
  file.finish();
  EXPECT_EQ(read(path(longest)), "whole");
  EXPECT_EQ(files().size(), 2U);
  EXPECT_THROW(OutputFile("/dev/full").append("x"), OutputError);
  EXPECT_THROW((void)dlo::compare::output_target(path("no/folder")), InputError);
  EXPECT_EQ(dlo::compare::output_target("/dev/full").kind, OutputTarget::Kind::device);
}

TEST_F(Output, OutOfMemoryIsALineAndAStatus) {
  if (dlo::test::sanitized) GTEST_SKIP() << "a sanitizer needs all address space";
  for (const std::string& arguments :
       {"solve " + steel() + " --samples 1000000 --format json",
        "solve " + steel() + " --model chain --points 1000000",
        "sweep " + steel() +
            " --vary force_model.points=1000000,999999 --model chain --threads 2"}) {
    const Outcome result = bash("ulimit -v 150000; $dlo " + arguments + " >/dev/null");
    EXPECT_EQ(result.status, 4) << arguments << result.err;
    EXPECT_EQ(result.err, "dlo: out of memory\n") << arguments;
  }
}

TEST_F(Output, OutOfThreadsIsALineAndAStatus) {
  // No limit holds for root.
  const std::string nobody = ::geteuid() == 0 ? "setpriv --reuid=65534 --clear-groups " : "";
  const std::string limited = nobody + "prlimit --nproc=0 $dlo ";
  if (bash(limited + "solve " + steel() + " >/dev/null").status != 0) {
    GTEST_SKIP() << "threads cannot be limited, or others may not read here";
  }
  const Outcome result =
      bash(limited + "sweep " + steel() + " --vary gamma=1,2,3 --threads 3 >/dev/null");
  EXPECT_EQ(result.status, 4) << result.err;
  EXPECT_EQ(result.err,
            "dlo: out of threads or memory (a worker thread: Resource temporarily unavailable)\n");
}

TEST_F(Output, HelpAndManualPageSayEveryExitStatus) {
  const std::string help = run("--help").out;
  EXPECT_TRUE(says(help, {"0 good", "1 outside", "2 bad usage", "3 a solver", "4 out of memory",
                          "5 an output"}));
  const std::string page = run("--man-page").out;
  const std::size_t section = page.find(".Sh EXIT STATUS");
  for (const std::string item : {".It 0", ".It 1", ".It 2", ".It 3", ".It 4", ".It 5"}) {
    EXPECT_NE(page.find(item, section), std::string::npos) << item;
  }
}

/// Fields of a line of CSV without line ends in its fields.
std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

TEST_F(Output, NoNumberIsNanOrInfinity) {
  write("both.toml", held_at_both_ends);
  write("weightless.toml", "gravity = [0, 0, 0]\n" + read(steel()));
  write_scene("cable.toml");
  const std::string own = read(path("weightless.toml"));
  // The scene has a gravity of its own.
  write("weightless.toml",
        std::regex_replace(own, std::regex("\ngravity = [^\n]*"), "\n# gravity: none"));
  ASSERT_EQ(bash("$dlo solve cable.toml --samples 21 --format csv | head -n 16 >seen.csv").status,
            0);
  ASSERT_EQ(bash("$dlo regress both.toml cable.toml --update --baseline base.toml").status, 0);
  const std::regex not_a_number("[+-]?(nan|inf|infinity)(\\([^)]*\\))?", std::regex::icase);
  int empty = 0;
  for (const std::string command :
       {"solve both.toml", "compare both.toml", "compare weightless.toml",
        "check cable.toml --shape seen.csv",
        "check weightless.toml --shape seen.csv --tolerance 99%",
        "calibrate cable.toml --shape seen.csv", "calibrate cable.toml --law hooke --target 5%",
        "stability --case unequal --stepper basic --max-steps 2000", "stability --case pulled",
        "stability --map cF-cc --columns 2 --rows 4 --map-steps 50",
        "sweep both.toml --model compare-chain --vary gamma=0,1",
        "regress both.toml cable.toml --baseline base.toml", "materials"}) {
    const Outcome csv = bash("$dlo " + command + " --format csv");
    std::istringstream lines(csv.out);
    std::string line;
    std::getline(lines, line);
    const std::size_t columns = fields_of(line).size();
    EXPECT_GT(columns, 3U) << command << csv.err;
    int rows = 0;
    for (; std::getline(lines, line); ++rows) {
      const std::vector<std::string> fields = fields_of(line);
      EXPECT_EQ(fields.size(), columns) << command << "\n" << line;
      for (const std::string& field : fields) {
        EXPECT_FALSE(std::regex_match(field, not_a_number)) << command << "\n" << line;
        if (field.empty()) ++empty;
      }
    }
    EXPECT_GT(rows, 0) << command;
    // JSON has one writer; those with most numbers that are none have to do.
    if (command != "compare both.toml" && command != "stability --case pulled") continue;
    const Outcome json = bash("$dlo " + command + " --format json");
    EXPECT_FALSE(nlohmann::json::parse(json.out, nullptr, false).is_discarded()) << command;
  }
  EXPECT_GT(empty, 10);  // or nothing of this was tried
}

TEST(Shown, IsZeroBelowTheErrorOfTheData) {
  using dlo::compare::shown;
  for (const double rounding : {-7.965e-33, 4.8e-18, -0.0, 1e-9}) {
    EXPECT_EQ(shown(rounding, 1), 0);
    EXPECT_FALSE(std::signbit(shown(rounding, 1)));
  }
  for (const double number : {1.1e-9, -2e-9, 3.0}) EXPECT_EQ(shown(number, 1), number);
  EXPECT_EQ(shown(1e-12, 1e-6), 1e-12);  // of a small scene
  EXPECT_EQ(shown(1e-12, 0), 1e-12);     // of one without a size
  EXPECT_TRUE(std::isnan(shown(NAN, 1)));
  EXPECT_EQ(shown(INFINITY, 1), INFINITY);
  // A taut rod's forces are large beside its weight.
  EXPECT_EQ(dlo::cli::shown(Eigen::Vector3d(1e4, -1e-6, 1), 1), Eigen::Vector3d(1e4, 0, 1));
}

// Forces, torques and energies of these scenes have parts that symmetry or balance makes zero.
TEST_F(Output, TextHasNoNumberThatIsRounding) {
  const std::regex rounding("[0-9]e-(?:1[3-9]|[2-9][0-9])");
  const std::string scenes = std::string(DLO_DATA) + "/scenes/";
  const std::string commands[] = {"solve " + scenes + "spring_steel_175.toml",
                                  "solve " + scenes + "spring_steel_175.toml --model exact",
                                  "solve " + scenes + "side_load.toml",
                                  "solve " + scenes + "twisted_wire.toml",
                                  "solve " + scenes + "spliced_cable.toml --model chain",
                                  "compare " + steel() + " --law hooke --bookkeeping consistent",
                                  "track " + scenes + "buckling_wire.toml --no-force",
                                  "track " + scenes + "corner_routing.toml --no-force"};
  for (const std::string& command : commands) {
    const Outcome text = run(command);
    EXPECT_EQ(text.status, 0) << text.err;
    std::smatch found;
    EXPECT_FALSE(std::regex_search(text.out, found, rounding)) << command << "\n" << text.out;
  }
  // Documents keep what they have: nothing is lost there.
  const std::string json = run(commands[6] + " --format json").out;
  EXPECT_TRUE(std::regex_search(json, rounding));
}

TEST(Json, KeysWithANewNameAreThereByTheOldOneToo) {
  const dlo::cli::Json document = {{"equilibria", {{{"smallest_eigenvalue", -3.5}}}},
                                   {"neglected", {"twist"}},
                                   {"events", {{{"smallest_eigenvalue_before", 0.5}}}},
                                   {"not_identified", nullptr},
                                   {"reference_verified", true}};
  const auto read = nlohmann::json::parse(dlo::cli::json_text(document));
  EXPECT_EQ(read.at("equilibria")[0].at("smallest_curvature"), -3.5);
  EXPECT_EQ(read.at("equilibria")[0].at("smallest_eigenvalue"), -3.5);
  EXPECT_EQ(read.at("left_out"), read.at("neglected"));
  EXPECT_EQ(read.at("events")[0].at("smallest_curvature_before"), 0.5);
  EXPECT_TRUE(read.at("not_told").is_null());
  EXPECT_EQ(read.at("reference_resolved"), true);
  EXPECT_EQ(read.size(), 8U);  // nothing else is new
}

TEST(Csv, UndefinedNumbersAreEmpty) {
  using dlo::compare::csv_number;
  EXPECT_EQ(csv_number(NAN) + csv_number(INFINITY) + csv_number(-INFINITY), "");
  EXPECT_EQ(csv_number(-0.0), "0");
  EXPECT_EQ(csv_number(1. / 3), "0.3333333333");
  EXPECT_EQ(csv_number(1. / 3, 3), "0.333");
}

TEST(Display, RepairsUtf8AndShowsNoControls) {
  const std::string good = "\xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80 ~";
  EXPECT_EQ(valid_utf8(good), good);
  EXPECT_EQ(display(good), good);
  const std::string bad = "\xef\xbf\xbd";
  EXPECT_EQ(valid_utf8("a\xffz"), "a" + bad + "z");
  EXPECT_EQ(valid_utf8("\xc3"), bad);                                // cut off
  EXPECT_EQ(valid_utf8("\xc0\x80"), bad + bad);                      // longer than needed
  EXPECT_EQ(valid_utf8("\xed\xa0\x80"), bad + bad + bad);            // a surrogate
  EXPECT_EQ(valid_utf8("\xf4\x90\x80\x80"), bad + bad + bad + bad);  // above U+10FFFF
  EXPECT_EQ(valid_utf8("\n\x1b"), "\n\x1b");
  EXPECT_EQ(display(std::string("a\n\x1b[31m\x7f\0z", 10)), "a??[31m??z");
  EXPECT_EQ(display("\xc2\x9b"
                    "31m"),
            "?31m");  // the one-character escape of terminals
}

TEST_F(Output, NamesThatAreNoTextBreakNoFormat) {
  const std::string name = "w\xff\x1b[31mire";
  write(name + ".toml", std::regex_replace(read(steel()), std::regex("name = [^\n]*\n"), ""));
  const auto quoted = [](const std::string& file) { return "'" + file + "'"; };
  const std::string scene = quoted(name + ".toml");
  ASSERT_EQ(bash("$dlo solve " + scene + " --format csv -o " + quoted(name)).status, 0);
  for (const std::string& command :
       {"solve " + scene, "check " + scene + " --shape " + quoted(name),
        "calibrate " + scene + " --shape " + quoted(name), "compare " + scene}) {
    const Outcome json = bash("$dlo " + command + " --format json");
    EXPECT_EQ(json.status, 0) << json.err;
    EXPECT_FALSE(nlohmann::json::parse(json.out, nullptr, false).is_discarded()) << command;
    const std::string text = bash("$dlo " + command).out;
    EXPECT_EQ(text.find_first_of("\x1b\xff"), std::string::npos) << text;
    EXPECT_TRUE(says(text, {"w\xef\xbf\xbd?[31mire"}));
  }
  // A baseline holds the name that its scene has the next time.
  const std::string regress = "$dlo regress " + scene + " --baseline b.toml --junit j.xml";
  ASSERT_EQ(bash(regress + " --update").status, 0);
  const Outcome again = bash(regress);
  EXPECT_EQ(again.status, 0) << again.out << again.err;
  EXPECT_TRUE(says(again.out, {"1 same"}));
  EXPECT_EQ(again.out.find_first_of("\x1b\xff"), std::string::npos) << again.out;
  const std::string junit = read(path("j.xml"));
  EXPECT_EQ(valid_utf8(junit), junit);
}

TEST_F(Output, TextHoldsNoControlCharactersOfNames) {
  write("evil.toml", std::regex_replace(read(steel()), std::regex("name = [^\n]*\n"),
                                        "name = \"a\\u001b[31m\\u009b\\n  verdict  pass\"\n"));
  ASSERT_EQ(bash("$dlo solve evil.toml --samples 9 --format csv -o shape.csv").status, 0);
  for (const std::string command :
       {"solve evil.toml --explain", "compare evil.toml --explain",
        "check evil.toml --shape shape.csv", "calibrate evil.toml --shape shape.csv",
        "calibrate evil.toml", "regress evil.toml --baseline b.toml --update",
        "regress evil.toml --baseline b.toml",
        "stability evil.toml --map cF-cc --columns 1 --rows 4 --map-steps 50",
        "bench evil.toml --seconds 0.1"}) {
    const Outcome result = bash("$dlo " + command);
    EXPECT_EQ(result.status, 0) << command << result.err;
    for (const std::string& text : {result.out, result.err}) {
      EXPECT_EQ(display(std::regex_replace(text, std::regex("\n"), " ")),
                std::regex_replace(text, std::regex("\n"), " "))
          << command;
      EXPECT_TRUE(says_none(text, {"\n  verdict  pass"})) << command;
    }
    EXPECT_TRUE(says(result.out + result.err, {"a?[31m??"})) << command;
  }
}

}  // namespace
