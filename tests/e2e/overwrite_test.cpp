// Outputs never replace an input, nor a file that foci did not make, and appear together or not at
// all.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

constexpr const char* kPairs =
    "x\ty\tx_target\ty_target\n-8\t-5\t-8\t-5\n8\t-5\t8\t-5\n8\t5\t8\t5\n-8\t5\t-"
    "8\t5\n0\t0\t0\t0\n";

class Overwrite : public testing::Test {
 protected:
  void SetUp() override {
    folder.write("study.toml", smallStudy());
    folder.write("scene.ply", squarePly(16, 1.0));
    folder.write("trace.tsv",
                 "# screen_width_px=640 screen_height_px=480 screen_width_m=0.4 "
                 "screen_height_m=0.3 viewing_distance_m=0.5 units=px\n" +
                     steadyTrace());
    folder.write("pairs.tsv", kPairs);
  }

  /// Every file below the folder, with its content.
  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
      const std::string name = fs::relative(entry.path(), folder.path());
      all[name] = entry.is_regular_file() ? folder.read(name) : "";
    }
    return all;
  }

  /// Exit code 2, one line that says `says`, and no file changed.
  void expectRefused(const Arguments& arguments, const std::string& says) const {
    const auto before = files();
    const Outcome outcome = runFoci(arguments, folder.path());
    std::string typed;
    for (const auto& word : arguments) typed += word + " ";
    SCOPED_TRACE(typed);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
    EXPECT_EQ(files(), before);
  }

  void expectDone(const Arguments& arguments) const {
    const Outcome outcome = runFoci(arguments, folder.path());
    EXPECT_EQ(outcome.exit_code, 0) << arguments.front() << ": " << outcome.err;
  }

  TemporaryFolder folder;
};

TEST_F(Overwrite, NoOutputIsAnInput) {
  const std::string says = "would replace";
  expectRefused({"events", "trace.tsv", "--out", "trace.tsv"}, says);
  expectRefused({"events", "trace.tsv", "--samples", "trace.tsv"}, says);
  expectRefused({"events", "trace.tsv", "--samples", "trace.tsv", "--overwrite"}, says);
  for (const char* input : {"study.toml", "scene.ply", "trace.tsv"}) {
    expectRefused({"render", "study.toml", "--focus", "1", "--out", input, "--overwrite"}, says);
    expectRefused(
        {"render", "study.toml", "--focus", "1", "--out", "a.png", "--depth", input, "--overwrite"},
        says);
  }
  for (const char* option : {"--out", "--report"}) {
    expectRefused({"calibrate", "gaze", "--pairs", "pairs.tsv", option, "pairs.tsv"}, says);
  }
  expectRefused({"calibrate", "binocular", "--pairs", "pairs.tsv", "--out", "pairs.tsv"}, says);
  fs::copy(folder.path() / "scene.ply", folder.path() / "scene.html");
  expectRefused({"prepare", "scene.html", "--out", "scene.foci", "--overwrite"}, says);
}

TEST_F(Overwrite, NoOutputIsAMaterialOrATextureOfTheScene) {
  folder.write("m.obj", "mtllib m.mtl\nusemtl m\nv 0 0 -1\nv 1 0 -1\nv 0 1 -1\nf 1 2 3\n");
  folder.write("m.mtl", "newmtl m\nmap_Kd -clamp on wood.png\n");
  folder.write("wood.png", "a texture");
  for (const char* name : {"m.mtl", "wood.png"}) {
    expectRefused({"render", "study.toml", "--scene", "m.obj", "--out", name, "--overwrite"},
                  "would replace");
  }
}

// Of all commands and spellings: tests/attacks.
TEST_F(Overwrite, AFolderThatDoesNotExistYetHidesNoInput) {
  folder.write("mine.png", "mine");
  expectRefused({"events", "trace.tsv", "--out", "nope/../trace.tsv"}, "would replace");
  expectRefused({"events", "trace.tsv", "--out", "nope/../trace.tsv", "--overwrite"},
                "would replace");
  expectRefused({"render", "study.toml", "--focus", "1", "--out", "nope/../mine.png"},
                "--overwrite");
  expectRefused({"replay", "study.toml", "--out", "out", "--write-study", "nope/../study.toml",
                 "--overwrite"},
                "would replace");
}

TEST_F(Overwrite, LinksToAnInputAreTheInput) {
  fs::create_symlink("trace.tsv", folder.path() / "soft.tsv");
  fs::create_hard_link(folder.path() / "trace.tsv", folder.path() / "hard.tsv");
  fs::create_directory_symlink(".", folder.path() / "here");
  for (const char* name : {"soft.tsv", "hard.tsv", "./trace.tsv", "here/trace.tsv"}) {
    expectRefused({"events", "trace.tsv", "--out", name, "--overwrite"}, "would replace");
    expectRefused({"events", name, "--out", "trace.tsv", "--overwrite"}, "would replace");
  }
}

TEST_F(Overwrite, AReplayNeverReplacesItsOwnRecording) {
  for (const std::string name : {"events.tsv", "frames.tsv", "report.html"}) {
    fs::create_directories(folder.path() / "out");
    folder.write("out/" + name, steadyTrace());
    expectRefused({"replay", "study.toml", "--trace", "out/" + name, "--out", "out", "--overwrite"},
                  "would replace");
    fs::remove(folder.path() / "out" / name);
  }
}

TEST_F(Overwrite, ARecordingIsNotConvertedInPlace) {
  expectDone({"trace", "convert", "trace.tsv", "--out", "a_physio.tsv.gz"});
  const std::string converted = "a_recording-eye1_physio.tsv.gz";
  expectRefused({"trace", "convert", converted, "--out", "a_physio.tsv.gz"}, "would replace");
  expectDone({"trace", "convert", converted, "--out", "b_physio.tsv.gz"});
}

TEST_F(Overwrite, AForeignFileIsReplacedOnlyOnRequest) {
  folder.write("a.png", "mine");
  folder.write("s.html", "mine");
  folder.write("map.html", "mine");
  fs::create_directory(folder.path() / "out");
  folder.write("out/video.mp4", "mine");
  const Arguments render = {"render", "study.toml", "--focus", "1", "--out", "a.png"};
  const Arguments replay = {"replay", "study.toml", "--out", "out"};
  const Arguments prepare = {"prepare", "scene.ply", "--out", "s.foci"};
  const Arguments calibrate = {"calibrate", "gaze", "--pairs", "pairs.tsv", "--out", "map.toml"};
  for (Arguments arguments : {render, replay, prepare, calibrate}) {
    expectRefused(arguments, "--overwrite");
    arguments.push_back("--overwrite");
    expectDone(arguments);
    EXPECT_NE(folder.read("study.toml"), "mine");
    arguments.pop_back();
    expectDone(arguments);  // foci made the files that it now replaces
  }
  for (const auto& [name, content] : files()) EXPECT_NE(content, "mine") << name;
}

TEST_F(Overwrite, AnEditedOutputIsForeign) {
  const Arguments events = {"events", "trace.tsv", "--out", "events.tsv"};
  expectDone(events);
  expectDone(events);
  folder.write("events.tsv", folder.read("events.tsv") + "# checked by hand\n");
  expectRefused(events, "events.tsv");
}

TEST_F(Overwrite, LiveReplacesAStudyAsItsMessageSays) {
  folder.write("w.toml", "mine");
  Arguments live = {"live", "study.toml", "--write-study", "w.toml", "--source", "nothing"};
  expectRefused(live, "or --overwrite");
  live.emplace_back("--overwrite");
  const Outcome outcome = runFoci(live, folder.path());
  EXPECT_NE(outcome.err.find("--source"), std::string::npos) << outcome.err;
  EXPECT_NE(folder.read("w.toml"), "mine");
}

TEST_F(Overwrite, TwoOutputsAreTwoFiles) {
  expectRefused({"events", "trace.tsv", "--out", "a.tsv", "--samples", "./a.tsv"}, "two outputs");
}

TEST_F(Overwrite, NamesThatCannotBeFilesAreRefused) {
  fs::create_directory(folder.path() / "folder.png");
  const Arguments events = {"events", "trace.tsv", "--out", "a.tsv", "--samples"};
  const auto with = [&](const std::string& name) {
    Arguments all = events;
    all.push_back(name);
    return all;
  };
  expectRefused(with("folder.png"), "is a folder");
  expectRefused(with("folder.png/"), "a folder");
  expectRefused(with(std::string(250, 'a')), "a name of 250 bytes");
  expectRefused(with("/dev/null"), "not a file");
  std::string deep;
  for (int i = 0; i < 100; ++i) deep += std::string(60, 'a') + "/";
  expectRefused(with(deep + "b.tsv"), "a path of");
  expectRefused({"render", "study.toml", "--focus", "1", "--out", "folder.png"}, "is a folder");
}

TEST_F(Overwrite, OutputsAppearTogetherOrNotAtAll) {
  // No folder can be made there, which shows only when the outputs are written.
  std::filesystem::create_symlink("nowhere", folder.path() / "file");
  const auto before = files();
  const std::vector<Arguments> failing = {
      {"events", "trace.tsv", "--out", "a.tsv", "--samples", "file/b.tsv"},
      {"render", "study.toml", "--focus", "1", "--out", "a.png", "--depth", "file/b.pfm"},
      {"calibrate", "gaze", "--pairs", "pairs.tsv", "--out", "file/b.toml", "--report", "a.html"},
      {"calibrate", "screen", "--headless", "--size-px", "1920x1080", "--size-m", "0.5x0.3",
       "--distance-m", "0.6", "--psychopy", "a.json", "--out", "file/b.toml"}};
  for (const Arguments& arguments : failing) {
    const Outcome outcome = runFoci(arguments, folder.path());
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("cannot"), std::string::npos) << outcome.err;
    EXPECT_EQ(files(), before) << arguments.front();
  }
}

TEST_F(Overwrite, AFileForAFolderIsBadInput) {
  folder.write("file", "a file where a folder should be");
  for (const Arguments& arguments :
       {Arguments{"replay", "study.toml", "--out", "file"},
        Arguments{"events", "trace.tsv", "--out", "a.tsv", "--samples", "file/b.tsv"}}) {
    const Outcome outcome = runFoci(arguments, folder.path());
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find("is a file: expected a folder"), std::string::npos) << outcome.err;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
