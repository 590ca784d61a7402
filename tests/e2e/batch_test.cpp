// Many recordings, parts of a run, and any key from the command line.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// A recording that jumps between two points of a screen of 640x480 px.
std::string jumpingTrace(double x_px = 500.0) {
  std::string trace = "time_s\tx_px\ty_px\n";
  for (int i = 0; i < 100; ++i) {
    const bool there = i % 50 >= 25;
    trace += std::to_string(0.01 * i) + "\t" + std::to_string(there ? x_px : 150.0) + "\t240\n";
  }
  return trace;
}

class Batch : public testing::Test {
 protected:
  void SetUp() override {
    folder.write("study.toml", smallStudy());
    // A staircase of depths: focus, blur and quality level change with the gaze.
    folder.write("scene.ply", reliefPly([](int x, int) { return x < 30 ? 0.6 : 2.0; }));
    folder.write("trace.tsv", jumpingTrace());
  }

  Outcome foci(std::vector<std::string> arguments) { return runFoci(arguments, folder.path()); }

  Json json(const std::string& file) { return Json::parse(folder.read(file)); }

  /// frames.tsv without its last column, the times that rendering took.
  std::vector<std::vector<std::string>> framesOf(const std::string& out) {
    auto table = tableOf(folder.read(out + "/frames.tsv"));
    for (auto& row : table) row.pop_back();
    return table;
  }

  /// Replays in one run and in parts, with the same options.
  void expectJoinedEqual(const std::vector<std::string>& options,
                         const std::vector<std::string>& spans) {
    const auto with = [&](std::vector<std::string> arguments) {
      arguments.insert(arguments.end(), options.begin(), options.end());
      return foci(arguments);
    };
    const Outcome whole = with({"replay", "study.toml", "--out", "whole"});
    ASSERT_EQ(whole.exit_code, 0) << whole.err;
    std::vector<std::string> join = {"join"};
    for (const std::string& span : spans) {
      join.push_back("part" + std::to_string(join.size()));
      const Outcome part = with({"replay", "study.toml", "--out", join.back(), "--frames", span});
      ASSERT_EQ(part.exit_code, 0) << part.err;
    }
    join.insert(join.end(), {"--out", "joined"});
    const Outcome joined = foci(join);
    ASSERT_EQ(joined.exit_code, 0) << joined.err;
    EXPECT_EQ(framesOf("joined"), framesOf("whole"));
    for (const std::string table : {"events", "fixations", "saccades", "gaze3d", "objects"}) {
      EXPECT_EQ(folder.read("joined/" + table + ".tsv"), folder.read("whole/" + table + ".tsv"));
    }
    EXPECT_TRUE(folder.read("joined/video.mp4") == folder.read("whole/video.mp4"));
    Json a = json("joined/manifest.json"), b = json("whole/manifest.json");
    EXPECT_EQ(a["frames_sha256"], b["frames_sha256"]);
    EXPECT_EQ(a["inputs"], b["inputs"]);
    EXPECT_EQ(a["configuration"], b["configuration"]);
    EXPECT_EQ(a["study"], b["study"]);
    EXPECT_EQ(a["screen_is_default"], b["screen_is_default"]);
    EXPECT_EQ(a["summary"]["frames_rendered"], b["summary"]["frames_rendered"]);
  }

  TemporaryFolder folder;
};

TEST_F(Batch, JoinedPartsHaveTheBytesOfOneRun) {
  expectJoinedEqual({"--seconds", "0:0.99", "--set", "output.fps=40"},
                    {"31:", "0:1", "1:14", "14:31"});
}

TEST_F(Batch, JoinedPartsHaveMarkersSplitsAndStereo) {
  expectJoinedEqual({"--set", "output.fps=20", "--marker", "--split", "--view", "side-by-side",
                     "--set", "observer.chromatic=true"},
                    {"0:7", "7:"});
}

TEST_F(Batch, JoinedPartsHaveThePupilOfTheLuminance) {
  expectJoinedEqual({"--pupil", "luminance", "--set", "output.fps=20"}, {"0:9", "9:"});
}

TEST_F(Batch, AFoveatedRunHasParts) {
  expectJoinedEqual({"--set", "quality.foveated=true", "--set", "output.fps=40"}, {"0:17", "17:"});
}

TEST_F(Batch, AnotherMethodHasParts) {
  expectJoinedEqual({"--method", "sweep", "--set", "output.images=true"}, {"3/3", "1/3", "2/3"});
  EXPECT_EQ(folder.read("joined/frame-000003.png"), folder.read("whole/frame-000003.png"));
}

TEST_F(Batch, JoinedPartsNameTheFilesOfTheStudyAsItDoes) {
  folder.write("eye.csv", "n,m,um\n4,0,0.1\npupil_mm,6\n");
  folder.write("primaries.csv",
               "wavelength,red,green,blue\n400,0,0,0.2\n440,0,0,1\n480,0,0.1,1\n520,0,1,0.2\n"
               "560,0.1,1,0\n600,1,0.2,0\n640,1,0,0\n680,0.2,0,0\n");
  folder.write("more.ply", folder.read("scene.ply"));
  folder.write("study.toml", smallStudy() +
                                 "[observer]\nwavefront = \"eye.csv\"\nchromatic = true\n"
                                 "wavelengths = 3\n[[scene.part]]\nfile = \"more.ply\"\n");
  expectJoinedEqual({"--set", "output.fps=10", "--set", "screen.spectra=primaries.csv"},
                    {"0:4", "4:"});
  EXPECT_EQ(json("joined/manifest.json")["configuration"]["observer"]["wavefront"], "eye.csv");
}

TEST_F(Batch, JoinedPartsHaveMaps) {
  expectJoinedEqual({"--set", "output.maps=[\"depth\", \"defocus\"]", "--set", "output.fps=20"},
                    {"0:7", "7:"});
  for (const std::string map : {"depth-000003.exr", "defocus-000009.exr", "defocus-000007.exr"}) {
    EXPECT_TRUE(folder.read("joined/" + map) == folder.read("whole/" + map)) << map;
  }
  folder.write("part1/depth-000003.exr", folder.read("part1/defocus-000000.exr"));
  const Outcome outcome = foci({"join", "part1", "part2", "--out", "joined"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("is not the map that the part rendered"), std::string::npos)
      << outcome.err;
}

TEST_F(Batch, APartOfAnEyeAtRestBeginsWithAReusedFrame) {
  folder.write("trace.tsv", steadyTrace());
  expectJoinedEqual({"--set", "output.fps=40"}, {"0:20", "20:"});
  EXPECT_FALSE(json("part2/part.json")["frames_seen"][0]["rendered"]);
}

TEST_F(Batch, RefusesPartsThatAreNoRun) {
  const auto part = [&](const std::string& out, const std::string& span,
                        const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"replay", "study.toml", "--out", out, "--frames", span};
    arguments.insert(arguments.end(), more.begin(), more.end());
    ASSERT_EQ(foci(arguments).exit_code, 0);
  };
  part("a", "0:2");
  part("b", "2:4");
  part("c", "3:");
  part("d", "4:", {"--pupil", "3"});
  const auto expectRefused = [&](std::vector<std::string> parts, const std::string& says) {
    parts.insert(parts.begin(), "join");
    parts.insert(parts.end(), {"--out", "joined"});
    const Outcome outcome = foci(parts);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_FALSE(fs::exists(folder.path() / "joined"));
  };
  expectRefused({"a", "b"}, "frames 4:6: are in none of the parts");
  expectRefused({"b", "c"}, "frames 0:2: are in none of the parts");
  expectRefused({"a", "b", "c"}, "frames 3:4 are in another part");
  expectRefused({"a", "b", "d"}, "different studies");
  expectRefused({"a", "nowhere"}, "nowhere/part.json");
  folder.write("b/part.json", "{}");
  expectRefused({"a", "b", "c"}, "expected what foci replay --frames wrote");
}

TEST_F(Batch, RefusesAnImageThatIsNotThePartsOwn) {
  ASSERT_EQ(foci({"replay", "study.toml", "--out", "a", "--frames", "0:"}).exit_code, 0);
  folder.write("a/frame-000000.png", "no image");
  const Outcome outcome = foci({"join", "a", "--out", "joined"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("frame-000000.png"), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(folder.path() / "joined"));
}

TEST_F(Batch, RefusesFilesThatThePartsWereNotRenderedFrom) {
  ASSERT_EQ(foci({"replay", "study.toml", "--out", "a", "--frames", "0:"}).exit_code, 0);
  folder.write("study.toml", smallStudy() + "# another experiment\n");  // the part keeps its study
  const auto expectRefused = [&](const std::string& file) {
    const Outcome outcome = foci({"join", "a", "--out", "joined"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.err, "foci: " + file +
                               ": is not the file that the parts were rendered from; render the "
                               "parts again\n");
    EXPECT_FALSE(fs::exists(folder.path() / "joined"));
  };
  const std::string scene = folder.read("scene.ply"), trace = folder.read("trace.tsv");
  folder.write("trace.tsv", jumpingTrace(501.0));
  expectRefused("trace.tsv");
  folder.write("trace.tsv", trace);
  folder.write("scene.ply", reliefPly([](int x, int) { return x < 31 ? 0.6 : 2.0; }));
  expectRefused("scene.ply");
  folder.write("scene.ply", scene);
  EXPECT_EQ(foci({"join", "a", "--out", "joined"}).exit_code, 0);
}

TEST_F(Batch, JoinsFromAnotherFolder) {
  for (const std::string span : {"", "0:3", "3:"}) {
    std::vector<std::string> replay = {"replay", "study.toml", "--out", "run" + span.substr(0, 1)};
    if (!span.empty()) replay.insert(replay.end(), {"--frames", span});
    ASSERT_EQ(foci(replay).exit_code, 0);
  }
  fs::create_directory(folder.path() / "elsewhere");
  const Outcome joined =
      runFoci({"join", "../run0", "../run3", "--out", "joined"}, folder.path() / "elsewhere");
  ASSERT_EQ(joined.exit_code, 0) << joined.err;
  const Json a = json("elsewhere/joined/manifest.json"), b = json("run/manifest.json");
  EXPECT_EQ(a["frames_sha256"], b["frames_sha256"]);
  EXPECT_EQ(a["inputs"], b["inputs"]);
  EXPECT_EQ(a["configuration"], b["configuration"]);
}

TEST_F(Batch, TheManifestsCommandPastesBackIntoAShell) {
  folder.write("the gaze.tsv", jumpingTrace());
  ASSERT_EQ(foci({"replay", "study.toml", "--trace", "the gaze.tsv", "--out", "a"}).exit_code, 0);
  EXPECT_EQ(json("a/manifest.json")["command"],
            "foci replay study.toml --trace 'the gaze.tsv' --out a");
}

TEST_F(Batch, RefusesPartsThatDependOnTimeOrOnTheFrameBefore) {
  const auto expectRefused = [&](const std::vector<std::string>& more, const std::string& says) {
    std::vector<std::string> arguments = {"replay", "study.toml", "--out", "a"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = foci(arguments);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(folder.path() / "a"));
  };
  expectRefused({"--frames", "0:2", "--set", "quality.frame_ms=5"}, "quality.frame_ms");
  expectRefused({"--frames", "2:4", "--set", "quality.frame_ms=5"}, "quality.frame_ms");
  expectRefused({"--frames", "2:4", "--method", "fearing"}, "fearing");
  expectRefused({"--frames", "60:70"}, "the run has frames 0 to 5");
  expectRefused({"--frames", "4:2"}, "FIRST before END");
  expectRefused({"--frames", "4"}, "FIRST:END");
  expectRefused({"--frames", "-1:4"}, "FIRST:END");
  expectRefused({"--frames", "0/2"}, "expected PART/PARTS");
  expectRefused({"--frames", "3/2"}, "expected PART/PARTS");
  expectRefused({"--frames", "1/7"}, "the run has 6 frames");
  expectRefused({"--frames", "0:2", "--trace", "trace.tsv", "study.toml"}, "one recording");
}

TEST_F(Batch, ReplaysManyRecordings) {
  fs::create_directories(folder.path() / "sub-01");
  fs::create_directories(folder.path() / "sub-02");
  folder.write("sub-01/gaze.tsv", jumpingTrace());
  folder.write("sub-02/gaze.tsv", jumpingTrace(600.0));
  folder.write("broken.tsv", "no recording\n");
  const Outcome outcome = foci({"replay", "study.toml", "--trace", "sub-01/gaze.tsv", "broken.tsv",
                                "sub-02/gaze.tsv", "--out", "all"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("without a run: broken.tsv"), std::string::npos) << outcome.err;

  const auto rows = tableOf(folder.read("all/recordings.tsv"));
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[1][0], "sub-01/gaze.tsv");
  EXPECT_EQ(rows[1][1], "sub-01-gaze");
  EXPECT_EQ(rows[1][2], "6");
  EXPECT_EQ(rows[1][10], "n/a");
  EXPECT_EQ(rows[2][2], "n/a");
  EXPECT_NE(rows[2][10].find("broken.tsv"), std::string::npos);
  const std::string page = folder.read("all/index.html");
  EXPECT_NE(page.find("href=\"sub-02-gaze/report.html\""), std::string::npos);
  EXPECT_TRUE(fs::exists(folder.path() / "all/sub-02-gaze/report.html"));
  const auto fixations = tableOf(folder.read("all/fixations.tsv"));
  std::set<std::string> people;
  for (std::size_t i = 1; i < fixations.size(); ++i) {
    ASSERT_EQ(fixations[i].size(), fixations[0].size());
    people.insert(fixations[i][0] + " " + fixations[i][1]);
  }
  EXPECT_EQ(people, (std::set<std::string>{"sub-01-gaze 01", "sub-02-gaze 02"}));

  // Each is as if it were alone.
  ASSERT_EQ(foci({"replay", "study.toml", "--trace", "sub-02/gaze.tsv", "--out", "one"}).exit_code,
            0);
  const Json alone = json("one/manifest.json"), among = json("all/sub-02-gaze/manifest.json");
  EXPECT_EQ(alone["frames_sha256"], among["frames_sha256"]);
  EXPECT_EQ(alone["inputs"], among["inputs"]);
  EXPECT_EQ(framesOf("one"), framesOf("all/sub-02-gaze"));
}

TEST_F(Batch, RefusesARecordingGivenTwice) {
  const Outcome outcome =
      foci({"replay", "study.toml", "--trace", "trace.tsv", "./trace.tsv", "--out", "all"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("twice"), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(folder.path() / "all"));
}

TEST_F(Batch, TheStudyMayComeAfterTheRecording) {
  const Outcome outcome = foci({"replay", "--trace", "trace.tsv", "study.toml", "--out", "one"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(fs::exists(folder.path() / "one/report.html"));
  const Outcome none = foci({"replay", "--trace", "trace.tsv"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("STUDY is required"), std::string::npos) << none.err;
}

TEST_F(Batch, SetsAnyKey) {
  const Outcome outcome =
      foci({"replay", "study.toml", "--out", "out", "--set", "observer.pupil_mm=3.5", "--set",
            "render.method=sweep", "--set", "scene.background=[0.1, 0.2, 0.3]", "--set",
            "gaze.source=trace.tsv", "--set", "focus.fixed_D=2", "--set", "focus.fixed_D=null"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json configuration = json("out/manifest.json")["configuration"];
  EXPECT_EQ(configuration["observer"]["pupil_mm"], 3.5);
  EXPECT_EQ(configuration["render"]["method"], "sweep");
  EXPECT_EQ(configuration["scene"]["background"][2], 0.3);
  EXPECT_TRUE(configuration["focus"]["fixed_D"].is_null());
}

TEST_F(Batch, ASetKeyReplacesTheKeyThatItExcludes) {
  const Outcome outcome = foci({"render", "study.toml", "--out", "a.png", "--set",
                                "scene.builtin=plane", "--set", "eye.position_m=[0, 0, 0]"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST_F(Batch, RefusesBadKeysInOneLine) {
  const auto expectRefused = [&](const std::string& set, const std::string& says) {
    const Outcome outcome = foci({"render", "study.toml", "--out", "a.png", "--set", set});
    EXPECT_EQ(outcome.exit_code, 2) << set;
    EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  };
  expectRefused("observer.pupil_m=3", "did you mean observer.pupil_mm?");
  expectRefused("observer.pupil_mm=40", "expected 0");
  expectRefused("observer.pupil_mm=wide", "expected 0");
  expectRefused("screen.distance_m=60", "expected 0.01 to 20");  // cm
  expectRefused("observer.pupil_mm", "expected KEY=VALUE");
  expectRefused("=3", "expected KEY=VALUE");
  expectRefused("output.marker=1", "true or false");
  expectRefused("render.method=swep", "expected");
  expectRefused("eye.position_m=[0, 1]", "3 numbers");
  expectRefused("seed=1\nobserver.pupil_mm=3", "expected");
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
