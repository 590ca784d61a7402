// What foci says: mistyped words, help, and facts about recordings.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

using Json = nlohmann::json;

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// One line on standard error, and exit code 2.
void expectRefusal(const std::vector<std::string>& arguments, const std::string& part,
                   const TemporaryFolder& folder) {
  const Outcome outcome = runFoci(arguments, folder.path());
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_TRUE(says(outcome.err, part)) << outcome.err << "wanted: " << part;
}

TEST(Words, MistypedCommandsAndOptionsNameTheNearest) {
  const TemporaryFolder folder;
  expectRefusal({"rendr", "a.toml"}, "unknown command \"rendr\": did you mean render?", folder);
  expectRefusal({"trace", "inof", "a.tsv"}, "did you mean info? (foci trace --help)", folder);
  expectRefusal({"calibrate", "gase"}, "did you mean gaze? (foci calibrate --help)", folder);
  expectRefusal({"convert", "a.tsv"}, "unknown command \"convert\": expected one of replay, render",
                folder);
  expectRefusal({"replay", "a.toml", "--ot", "b"},
                "unknown option \"--ot\": did you mean --out? (foci replay --help)", folder);
  expectRefusal({"render", "--scene", "a.ply", "--out", "a.png"},
                "a scene, which needs no --scene (foci render --help)", folder);
  expectRefusal({"trace", "info"}, "required (foci trace info --help)", folder);
  expectRefusal({"replay", "a.toml", "--banana=3"}, "unknown option \"--banana\" (foci replay",
                folder);
}

TEST(Words, FilesThatAreNeitherSceneNorStudyAreRefused) {
  const TemporaryFolder folder;
  folder.write("a.usd2", "#usda 1.0\n");
  expectRefusal({"render", "a.usd2", "--out", "a.png"}, "is a USD scene, which foci does not read",
                folder);
  folder.write("b.jpg", "\xff\xd8");
  expectRefusal({"render", "b.jpg", "--out", "b.png"}, "is no scene that foci reads", folder);
}

TEST(Words, AFileOfManyPartsIsRemarkedOnOnce) {
  const TemporaryFolder folder;
  folder.write("a.obj", "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
  const std::string part = "[[scene.part]]\nfile = \"a.obj\"\nposition_m = [1, 0, 0]\n";
  folder.write("study.toml", "[scene]\nfile = \"a.obj\"\n" + part + part +
                                 "[eye]\nposition_m = [1, 0, 4]\nlook_at_m = [1, 0, 0]\n");
  const Outcome outcome =
      runFoci({"render", "study.toml", "--size", "64x36", "--out", "a.png"}, folder.path());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::size_t first = outcome.err.find("gone.mtl");
  ASSERT_NE(first, std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("gone.mtl", first + 1), std::string::npos) << outcome.err;
}

TEST(Words, AFlatSceneInFocusHasNoChart) {
  const TemporaryFolder folder;
  folder.write("a.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
  expectRefusal({"chart", "--quick", "--scene", "scan", "--scan", "a.obj", "--eye", "0,0,3",
                 "--look-at", "0,0,0", "--up", "0,1,0", "--out", "chart"},
                "no blur to measure", folder);
}

TEST(Words, KeysThatAreFarFromEveryKeySuggestNothing) {
  const TemporaryFolder folder;
  folder.write("far.toml", "[output]\ncodec = \"h264\"\n");
  expectRefusal({"replay", "far.toml", "--out", "x"},
                "unknown key output.codec; foci keys lists the keys", folder);
  folder.write("section.toml", "[obsever]\npupil_mm = 3\n");
  expectRefusal({"replay", "section.toml", "--out", "x"},
                "unknown section obsever: did you mean observer?", folder);
  folder.write("camera.toml", "[camera]\nposition_m = [0, 0, 0]\n");
  expectRefusal({"replay", "camera.toml", "--out", "x"}, "did you mean eye.position_m?", folder);
}

TEST(Words, HelpOfEventsListsEveryType) {
  const TemporaryFolder folder;
  const Outcome outcome = runFoci({"events", "--help"}, folder.path());
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* type : {"fixation", "saccade", "pso", "pursuit", "blink", "lost"}) {
    EXPECT_TRUE(says(outcome.out, std::string("  ") + type + " ")) << type;
  }
}

std::string degrees(const std::string& header) {
  std::string text = header + "\n";
  for (int i = 0; i < 100; ++i) {
    text += std::to_string(0.01 * i) + "," + std::to_string(0.1 * i - 5.0) + ",2.5\n";
  }
  return text;
}

TEST(TraceInfo, ShowsDegreesAndNoScreenThatNobodyStated) {
  const TemporaryFolder folder;
  folder.write("gaze.csv", degrees("time_s,x_deg,y_deg"));
  const Outcome outcome = runFoci({"trace", "info", "gaze.csv", "--json"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json facts = Json::parse(outcome.out);
  EXPECT_NEAR(facts.at("x_deg")[0].get<double>(), -5.0, 1e-6);
  EXPECT_NEAR(facts.at("x_deg")[1].get<double>(), 4.9, 1e-6);
  EXPECT_NEAR(facts.at("y_deg")[0].get<double>(), 2.5, 1e-6);
  for (const char* key : {"x_px", "screen_px", "screen_m", "distance_m"}) {
    EXPECT_FALSE(facts.contains(key)) << key;
  }
  EXPECT_TRUE(says(facts.at("assumed")[0], "screen: unknown"));

  const Outcome known = runFoci({"trace", "info", "gaze.csv", "--json", "--screen-px", "640x480",
                                 "--screen-m", "0.5x0.4", "--distance-m", "0.6"},
                                folder.path());
  const Json stated = Json::parse(known.out);
  EXPECT_EQ(stated.at("screen_px")[0], 640);
  EXPECT_TRUE(says(stated.at("assumed")[0], "screen.size_px"));
  EXPECT_NEAR(stated.at("x_deg")[0].get<double>(), -5.0, 1e-6);
}

TEST(TraceInfo, MarksUnitsThatWereAssumedAndWarns) {
  const TemporaryFolder folder;
  folder.write("gaze.csv", degrees("time,x,y"));
  const Outcome outcome = runFoci({"trace", "info", "gaze.csv"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(says(outcome.out, "assumed         unit of the positions: px")) << outcome.out;
  EXPECT_TRUE(says(outcome.out, "may be degrees")) << outcome.out;
}

TEST(TraceInfo, NamesTheConverterOfABinaryFile) {
  const TemporaryFolder folder;
  folder.write("a.edf", "SR_RESEARCH_COMBFILE" + std::string(20, '\0'));
  expectRefusal({"trace", "info", "a.edf"}, "SR Research's edf2asc", folder);
  expectRefusal({"events", "a.edf"}, "SR Research's edf2asc", folder);
}

TEST(TraceConvert, SaysThatTheScreenIsNominal) {
  const TemporaryFolder folder;
  folder.write("gaze.csv", degrees("time_s,x_deg,y_deg"));
  const Outcome outcome =
      runFoci({"trace", "convert", "gaze.csv", "--out", "a_physio.tsv.gz"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json sidecar = Json::parse(folder.read("a_recording-eye1_physio.json"));
  EXPECT_TRUE(says(sidecar.at("x_coordinate").at("Description"), "states no screen"));
}

/// A record of a live run: 30 frames, whose pupil changes twice.
void writeRecord(const TemporaryFolder& folder) {
  folder.write("scene.ply", squarePly(8, 1.0));
  folder.write("trace.tsv", steadyTrace());
  std::string frames = "frame\ttime_s\tmethod\n";
  for (int i = 0; i < 30; ++i) {
    frames += std::to_string(i) + "\t" + std::to_string(0.1 + 0.02 * i) + "\tpinhole\n";
  }
  folder.write("frames.tsv", frames);
  folder.write("changes.tsv",
               "time_s\tkey\tvalue\n0.05\tobserver.pupil_mm\t2\n0.3\tobserver.pupil_mm\t4\n"
               "0.5\tobserver.pupil_mm\t8\n0.55\tfocus.fixed_D\t1.5\n");
  folder.write("event_markers.tsv", "time_s\tmarker\n0.4\tstimulus <on>\n");
  folder.write("record.toml", smallStudy() +
                                  "[record]\nframes = \"frames.tsv\"\nchanges = \"changes.tsv\"\n"
                                  "markers = \"event_markers.tsv\"\n");
}

TEST(Report, OfARecordThatChangedSaysSoInItsHeadline) {
  const TemporaryFolder folder;
  writeRecord(folder);
  const Outcome outcome = runFoci({"replay", "record.toml", "--out", "out"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string page = folder.read("out/report.html");
  EXPECT_TRUE(says(page, "<title>scene.ply, seen by trace.tsv - foci replay</title>"));
  EXPECT_TRUE(says(page, "2, 4, 8 mm</b><span>pupil, changed during the run (median 4.0 mm)"));
  EXPECT_FALSE(says(page, "pupil, fixed"));
  EXPECT_TRUE(says(page,
                   "Settings changed during the run: observer.pupil_mm 2, then 4, then 8; "
                   "focus.fixed_D absent, then 1.5."));
  EXPECT_TRUE(says(page, "stimulus &lt;on&gt;"));
  EXPECT_FALSE(says(page, "stimulus <on>"));
  EXPECT_TRUE(says(page, "With a pupil of 2.0 mm"));
  if (says(page, "<div id=\"charts\">")) {
    EXPECT_TRUE(says(page, "1 event marker and 3 changes of settings")) << "in the chart's text";
    EXPECT_TRUE(says(page, "<title>Gaze, focus, pupil and render time over time</title>"));
  }
}

TEST(Report, OfASteadyRunHasAFixedPupil) {
  const TemporaryFolder folder;
  folder.write("scene.ply", squarePly(8, 1.0));
  folder.write("trace.tsv", steadyTrace());
  folder.write("study.toml", smallStudy());
  ASSERT_EQ(runFoci({"replay", "study.toml", "--out", "out"}, folder.path()).exit_code, 0);
  const std::string page = folder.read("out/report.html");
  EXPECT_TRUE(says(page, "pupil, fixed"));
  EXPECT_FALSE(says(page, "changed during the run"));
}

TEST(Words, DoctorWarnsOfNoTrackerThatItAsks) {
  const TemporaryFolder folder;
  const Outcome doctor = runFoci({"doctor", "--json"}, folder.path());
  EXPECT_EQ(doctor.exit_code, 0);
  EXPECT_FALSE(says(doctor.err, "foci: ")) << doctor.err;
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
