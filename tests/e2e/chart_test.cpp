// `foci chart`: its files and frontiers; a later run keeps the results of an earlier one.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// From the plan of --quick.
constexpr std::size_t kBlurs = 2;

/// Two squares at different depths, the nearer one smaller.
std::string stepPly() {
  return reliefPly([](int x, int) { return x < 30 ? 2.0 : 1.5; });
}

std::vector<std::string> arguments(std::vector<std::string> more = {}) {
  std::vector<std::string> all = {"chart", "--out",     "out",       "--quick", "--size",
                                  "32",    "--scene",   "scan",      "--scan",  "step.ply",
                                  "--eye", "0,0,0",     "--look-at", "0,0,-1",  "--up",
                                  "0,1,0", "--threads", "2",         "--json"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

std::vector<std::vector<std::string>> csvOf(const std::string& text) {
  std::string tabs = text;
  std::replace(tabs.begin(), tabs.end(), ',', '\t');
  return tableOf(tabs);
}

/// A row lies on the frontier unless another row of its panel beats it.
void expectFrontiers(const std::vector<std::vector<std::string>>& csv) {
  struct Row {
    double ms, dB;
    bool on;
  };
  std::map<std::string, std::vector<Row>> panels;
  for (std::size_t i = 1; i < csv.size(); ++i) {
    const auto& row = csv[i];
    panels[row[0] + " " + row[1] + " " + row[4]].push_back(
        {std::stod(row[5]), std::min(std::stod(row[7]), std::stod(row[11])), row[12] == "yes"});
  }
  EXPECT_EQ(panels.size(), kBlurs);
  for (const auto& [panel, rows] : panels) {
    for (const Row& one : rows) {
      const bool beaten = std::any_of(rows.begin(), rows.end(), [&](const Row& other) {
        return other.ms <= one.ms && other.dB >= one.dB && (other.ms < one.ms || other.dB > one.dB);
      });
      EXPECT_EQ(one.on, !beaten) << panel << ": " << one.ms << " ms, " << one.dB << " dB";
    }
  }
}

TEST(Chart, MeasuresEveryMethodOnceAndWritesTableAndPage) {
  const TemporaryFolder folder;
  folder.write("step.ply", stepPly());
  const Outcome outcome = runFoci(arguments(), folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("charting: "), std::string::npos);
  const Json summary = Json::parse(outcome.out);

  const auto csv = csvOf(folder.read("out/chart.csv"));
  EXPECT_EQ(csv[0], (std::vector<std::string>{
                        "scene", "blur_px", "method", "setting", "threads", "ms_median", "ms_min",
                        "psnr_dB", "ssim", "silhouette_psnr_dB", "coverage_error",
                        "reference_psnr_dB", "on_frontier", "visible_error", "expected_error",
                        "tolerance_met", "quality_level", "flip", "renderer"}));
  EXPECT_EQ(csv.size() - 1, summary.at("points").size());
  std::set<std::string> charted, listed;
  for (std::size_t i = 1; i < csv.size(); ++i) {
    ASSERT_EQ(csv[i].size(), csv[0].size());
    charted.insert(csv[i][2]);
    EXPECT_LE(std::stod(csv[i][6]), std::stod(csv[i][5]));  // min, median
    const std::string setting = csv[i][3] == "n/a" ? "" : "-" + csv[i][3];
    const std::string image = "out/images/scan_" + csv[i][1] + "px_" + csv[i][2] + setting;
    for (const char* end : {".png", "_difference.png"}) {
      EXPECT_TRUE(folder.read(image + end).starts_with("\x89PNG")) << image << end;
    }
  }
  for (const Json& method : Json::parse(runFoci({"methods", "--json"}, folder.path()).out)) {
    listed.insert(method.at("name"));
  }
  EXPECT_EQ(charted, listed);
  expectFrontiers(csv);

  const std::string page = folder.read("out/chart.html");
  EXPECT_NE(page.find("</html>"), std::string::npos);
  EXPECT_EQ(page.find("=\"http"), std::string::npos);  // the page needs only its own folder
  std::size_t links = 0;
  for (std::size_t at = 0; (at = page.find("href=\"images/", at)) != std::string::npos; ++links) {
    at += 6;
    const std::string link = page.substr(at, page.find('"', at) - at);
    EXPECT_TRUE(fs::exists(folder.path() / "out" / link)) << link;
  }
  EXPECT_GE(links, csv.size() - 1);

  // A second run has nothing to measure.
  const Json again = Json::parse(runFoci(arguments(), folder.path()).out);
  EXPECT_EQ(again.at("computed"), 0);
  EXPECT_EQ(again.at("kept"), summary.at("computed"));
  EXPECT_EQ(again.at("points"), summary.at("points"));
}

TEST(Chart, ContinuesAfterAKill) {
  const TemporaryFolder folder;
  folder.write("step.ply", stepPly());
  const auto few = arguments({"--method", "pinhole", "--method", "sweep", "--method", "sweep-lod:1",
                              "--method", "accumulate:9"});
  const fs::path cells = folder.path() / "out/cells";
  const Outcome killed = terminateFoci(few, folder.path(), cells / "scan_4px_accumulate-9.json");
  ASSERT_EQ(killed.exit_code, 1) << killed.err;
  EXPECT_FALSE(fs::exists(folder.path() / "out/chart.csv"));
  const Json before = Json::parse(folder.read("out/cells/scan_4px_sweep.json"));
  Json changed = Json::parse(folder.read("out/cells/scan_4px_pinhole.json"));
  const Json ssim = changed.at("ssim");
  changed["ssim"] = 0.123;  // no figure of foci's: the cell is measured again
  folder.write("out/cells/scan_4px_pinhole.json", changed.dump());

  auto edited = few;  // a file that somebody edits is somebody's own
  EXPECT_EQ(runFoci(edited, folder.path()).exit_code, 2);
  edited.push_back("--overwrite");
  const Outcome rest = runFoci(edited, folder.path());
  ASSERT_EQ(rest.exit_code, 0) << rest.err;
  const auto csv = csvOf(folder.read("out/chart.csv"));
  EXPECT_EQ(csv.size() - 1, kBlurs * 4);
  expectFrontiers(csv);
  for (std::size_t i = 1; i < csv.size(); ++i) {
    if (csv[i][1] == "4" && csv[i][2] == "pinhole") {
      EXPECT_NE(csv[i][8], "0.123000");
    }
  }
  // What is measured once stays.
  const Json after = Json::parse(folder.read("out/cells/scan_4px_sweep.json"));
  EXPECT_EQ(after.at("first_ms"), before.at("first_ms"));
  using Times = std::map<int, std::vector<double>>;  // by threads
  const Times all = after.at("ms").get<Times>();
  for (const auto& [threads, ms] : before.at("ms").get<Times>()) {  // earlier timed runs stay
    for (std::size_t run = 0; run < ms.size(); ++run) EXPECT_EQ(all.at(threads).at(run), ms[run]);
  }

  // Only cells of another program, and damaged cells, are measured again.
  changed = after;
  changed["key"] = "another " + after.at("key").get<std::string>();
  folder.write("out/cells/scan_4px_sweep.json", changed.dump());
  folder.write("out/cells/scan_16px_sweep.json", "{");
  const Json again = Json::parse(runFoci(edited, folder.path()).out);
  EXPECT_EQ(again.at("computed"), 2);
  EXPECT_EQ(again.at("kept"), kBlurs * 4 - 2);
  EXPECT_EQ(Json::parse(folder.read("out/cells/scan_4px_pinhole.json")).at("ssim"), ssim);
}

TEST(Chart, ScoresStabilityAndContinuesAfterAKill) {
  const TemporaryFolder folder;
  const std::vector<std::string> few = {"chart",    "--stability", "--quick",  "--out",
                                        "out",      "--json",      "--scene",  "density",
                                        "--scene",  "gaze-loss",   "--method", "sweep",
                                        "--method", "pinhole",     "--method", "sweep-lod"};
  const fs::path cells = folder.path() / "out/cells";
  const Outcome killed = terminateFoci(few, folder.path(), cells / "density_1_pinhole.json");
  ASSERT_EQ(killed.exit_code, 1) << killed.err;
  EXPECT_FALSE(fs::exists(folder.path() / "out/stability.csv"));

  const Outcome outcome = runFoci(few, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json summary = Json::parse(outcome.out);
  EXPECT_GE(summary.at("kept"), 2);
  const auto csv = csvOf(folder.read("out/stability.csv"));
  ASSERT_EQ(csv.size() - 1, 3u * (3 + 6));  // values, methods and observers
  EXPECT_EQ(csv[0][0], "scene");
  for (std::size_t i = 1; i <= 3 * 3; ++i) {
    // In focus, or by coarse nodes, the wall may be covered without an error.
    EXPECT_TRUE(csv[i][3] != "sweep" || std::stod(csv[i][4]) > 0.0) << csv[i][2];
    EXPECT_EQ(csv[i].back(), "yes")
        << csv[i][2] << " " << csv[i][3];  // each method covers the wall
  }
  const std::string page = folder.read("out/stability.html");
  EXPECT_NE(page.find("</html>"), std::string::npos);
  std::size_t links = 0;
  for (std::size_t at = 0; (at = page.find("\"images/", at)) != std::string::npos; ++links) {
    ++at;
    const std::string link = page.substr(at, page.find('"', at) - at);
    EXPECT_TRUE(fs::exists(folder.path() / "out" / link)) << link;
  }
  EXPECT_GE(links, 2u * 3 * 3);  // each point's image and its reference

  const Json again = Json::parse(runFoci(few, folder.path()).out);
  EXPECT_EQ(again.at("computed"), 0);
  EXPECT_EQ(again.at("points"), summary.at("points"));
}

TEST(Chart, ScoresMotionAndContinues) {
  const TemporaryFolder folder;
  const std::vector<std::string> few = {"chart",    "--motion", "--quick",  "--size", "24",
                                        "--scene",  "plane",    "--out",    "out",    "--json",
                                        "--method", "auto",     "--method", "pinhole"};
  const Outcome outcome = runFoci(few, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json summary = Json::parse(outcome.out);
  const auto csv = csvOf(folder.read("out/motion.csv"));
  ASSERT_EQ(csv.size() - 1, 7u * 3);  // paths; `auto`, the same within a budget, and the pinhole
  std::size_t budgets = 0;
  for (std::size_t i = 1; i < csv.size(); ++i) {
    EXPECT_GE(std::stod(csv[i][5]), std::stod(csv[i][6])) << csv[i][1];  // worst, median
    budgets += csv[i][4] != "n/a" ? 1 : 0;
  }
  EXPECT_EQ(budgets, 7u);
  const std::string page = folder.read("out/motion.html");
  std::size_t links = 0;
  for (std::size_t at = 0; (at = page.find("\"images/", at)) != std::string::npos; ++links) {
    ++at;
    const std::string link = page.substr(at, page.find('"', at) - at);
    EXPECT_TRUE(folder.read("out/" + link).starts_with("\x89PNG")) << link;
  }
  EXPECT_EQ(links, 7u * (3 + 2));  // each point's strip, and the strip below each panel

  const Json again = Json::parse(runFoci(few, folder.path()).out);
  EXPECT_EQ(again.at("computed"), 0);
  EXPECT_EQ(again.at("points"), summary.at("points"));
}

struct Refusal {
  std::string says;
  std::vector<std::string> options;
};

TEST(Chart, StatesTheRemarksOnItsScanOnce) {
  const TemporaryFolder folder;
  std::string scan = stepPly();
  scan.replace(scan.find("3600"), 4, "3601");
  folder.write("step.ply", scan + "nan 0 0 0 0 0\n");
  const Outcome outcome = runFoci(arguments({"--method", "pinhole"}), folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string remark = "step.ply: 1 point left out";
  const std::size_t first = outcome.err.find(remark);
  ASSERT_NE(first, std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find(remark, first + 1), std::string::npos) << outcome.err;
}

TEST(Chart, RefusesInOneLineAndLeavesNothing) {
  const TemporaryFolder folder;
  folder.write("none.ply", "ply\n");
  folder.write("few.ply", squarePly(8, 2.0));
  folder.write("flat.ply", squarePly(60, 2.0));
  const std::vector<Refusal> refusals = {
      {"missing.ply", {"--scan", "missing.ply"}},
      {"none.ply", {"--scan", "none.ply"}},
      {"points in view",
       {"--scan", "few.ply", "--eye", "0,0,0", "--look-at", "0,0,-1", "--up", "0,1,0"}},
      {"are in focus",
       {"--stability", "--scan", "flat.ply", "--eye", "0,0,0", "--look-at", "0,0,-1", "--up",
        "0,1,0"}},
      {"the nearest is plane", {"--scene", "plain"}},
      {"the nearest is sweep", {"--method", "sweeps"}},
      {"accumulate:1 to", {"--method", "accumulate:0"}},
      {"16 to 4096", {"--size", "5"}},
      {"1 to 1024", {"--threads", "0"}},
      {"the nearest is crossing", {"--stability", "--scene", "crosing"}},
      {"a fixed size", {"--stability", "--size", "64"}},
      {"--motion", {"--stability", "--motion"}},
  };
  for (const Refusal& refusal : refusals) {
    std::vector<std::string> all = {"chart", "--out", "made/out", "--quick"};
    all.insert(all.end(), refusal.options.begin(), refusal.options.end());
    const Outcome outcome = runFoci(all, folder.path());
    EXPECT_EQ(outcome.exit_code, 2) << refusal.says << ": " << outcome.err;
    EXPECT_NE(outcome.err.find(refusal.says), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_FALSE(fs::exists(folder.path() / "made")) << refusal.says;
  }
}

/// The options of a chart of the scan, with two methods; `more` first.
std::vector<std::string> caseArguments(std::vector<std::string> more) {
  std::vector<std::string> all = {"chart",     "--quick", "--size",   "32",    "--scene",
                                  "scan",      "--scan",  "step.ply", "--eye", "0,0,0",
                                  "--look-at", "0,0,-1",  "--up",     "0,1,0", "--json"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

/// An entry of times.json that returns the case's own reference.
Json returnedReference() {
  return {{"name", "mine:1"},         {"version", "2.0"},
          {"machine", "a, b"},        {"ms", 12.5},
          {"case", "scan/4px"},       {"image", "scan/4px/reference.exr"},
          {"sharp", "scan/sharp.png"}};
}

TEST(Chart, ExportsCasesAndChartsTheImagesThatComeBack) {
  const TemporaryFolder folder;
  folder.write("step.ply", stepPly());
  const Outcome outcome = runFoci(caseArguments({"--export", "cases"}), folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(Json::parse(outcome.out).at("cases"), kBlurs);
  // The README's last step is the command that follows.
  EXPECT_NE(folder.read("cases/README.md")
                .find("`foci chart --quick --size 32 --scene scan --scan " +
                      (folder.path() / "step.ply").string() +
                      " --eye 0,0,0 --look-at 0,0,-1 --up 0,1,0 --import THIS_FOLDER --out "
                      "out/chart`"),
            std::string::npos);

  // The aperture, the f-number and the one point agree with each other and the camera.
  const Json one = Json::parse(folder.read("cases/scan/16px/case.json"));
  const Json camera = Json::parse(folder.read("cases/scan/transforms.json"));
  const Json &lens = one.at("lens"), &point = lens.at("one_point");
  const double focal_px = camera.at("fl_x"), aperture_m = lens.at("aperture_m");
  EXPECT_NEAR(lens.at("f_number").get<double>(), 0.036 * focal_px / 32 / aperture_m, 1e-6);
  const double off_D =
      1.0 / point.at("depth_m").get<double>() - 1.0 / lens.at("focus_m").get<double>();
  EXPECT_NEAR(point.at("blur_radius_px").get<double>(),
              0.5 * aperture_m * focal_px * std::abs(off_D), 1e-3);
  EXPECT_NEAR(point.at("blur_radius_px").get<double>(), 16.0, 1e-3);
  const auto p = point.at("world_m").get<std::vector<double>>();  // the camera stands at the origin
  EXPECT_NEAR(point.at("image_px")[0].get<double>(), 16.0 + focal_px * p[0] / -p[2], 1e-3);
  EXPECT_NEAR(point.at("image_px")[1].get<double>(), 16.0 - focal_px * p[1] / -p[2], 1e-3);

  folder.write("cases/times.json", Json::array({returnedReference()}).dump());
  const std::vector<std::string> import =
      caseArguments({"--import", "cases", "--out", "out", "--method", "pinhole"});
  const Outcome imported = runFoci(import, folder.path());
  ASSERT_EQ(imported.exit_code, 0) << imported.err;
  bool found = false;
  const auto csv = tableOf([&] {  // the machine has the only comma in quotes
    std::string text = folder.read("out/chart.csv");
    const std::size_t quoted = text.find("\"2.0, a, b\"");
    EXPECT_NE(quoted, std::string::npos) << text;
    text.replace(quoted, 11, "2.0 a b");
    std::replace(text.begin(), text.end(), ',', '\t');
    return text;
  }());
  for (const auto& row : csv) {
    if (row[2] != "mine:1") continue;
    found = true;
    EXPECT_EQ(row[5], "12.5000");
    EXPECT_EQ(row[7], "inf");      // PSNR
    EXPECT_EQ(row[10], "n/a");     // coverage
    EXPECT_EQ(row[17], "0.0000");  // FLIP
    EXPECT_EQ(row[18], "2.0 a b");
  }
  EXPECT_TRUE(found);
  EXPECT_TRUE(folder.read("out/images/scan_4px_by-mine-1.png").starts_with("\x89PNG"));
  EXPECT_NE(folder.read("out/chart.html").find("other renderers"), std::string::npos);
}

TEST(Chart, ImportsNothingOfAListWithAFault) {
  const TemporaryFolder folder;
  folder.write("step.ply", stepPly());
  ASSERT_EQ(runFoci(caseArguments({"--export", "cases"}), folder.path()).exit_code, 0);
  const auto changed = [](const char* key, const Json& value) {
    Json entry = returnedReference();
    entry["name"] = "other";
    entry[key] = value;
    return Json::array({returnedReference(), entry}).dump();
  };
  const std::vector<std::pair<std::string, std::string>> refusals = {
      {"is no JSON", "{"},
      {"\"speed\"", changed("speed", 3)},
      {"entry 2: ms: expected milliseconds", changed("ms", -1)},
      {"name \"sweep\" is a method", changed("name", "sweep")},
      {"a second image of", changed("name", "mine:1")},
      {"the nearest is scan/4px", changed("case", "scan/5px")},
      {"expected 32 x 32", changed("image", "../small/scan/sharp.png")},
      {"is upside down", changed("sharp", "../down/scan/sharp.png")},
  };
  // Images of another size and of a camera on its head, from foci itself.
  for (const auto& [to, option, value] :
       {std::array{"small", "--size", "16"}, {"down", "--up", "0,-1,0"}}) {
    auto arguments = caseArguments({"--export", to});
    *(std::ranges::find(arguments, option) + 1) = value;
    ASSERT_EQ(runFoci(arguments, folder.path()).exit_code, 0);
  }
  const auto import = [&](const std::string& from) {
    return runFoci(caseArguments({"--import", from, "--out", "out", "--method", "pinhole"}),
                   folder.path());
  };
  for (const auto& [says, list] : refusals) {
    folder.write("cases/times.json", list);
    const Outcome outcome = import("cases");
    EXPECT_EQ(outcome.exit_code, 2) << says << ": " << outcome.err;
    EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(folder.path() / "out")) << says;
  }
  folder.write("small/times.json", Json::array({returnedReference()}).dump());
  EXPECT_NE(import("small").err.find("exported with other options"), std::string::npos);
}

TEST(Chart, ShowsHowCostGrows) {
  const TemporaryFolder folder;
  const Outcome outcome = runFoci(
      {"chart", "--growth", "--quick", "--size", "32", "--out", "out", "--threads", "2", "--json"},
      folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("charting: "), std::string::npos);
  const Json summary = Json::parse(outcome.out);
  const auto csv = csvOf(folder.read("out/growth.csv"));
  std::size_t points = 0;
  std::set<std::string> curves;
  for (const Json& curve : summary.at("curves")) {
    points += curve.at("points").size();
    curves.insert(curve.at("curve"));
    for (const Json& point : curve.at("points")) EXPECT_GT(point.at("memory_GB"), 0.0) << curve;
  }
  for (const auto& row : csv) EXPECT_EQ(row.size(), 12U);
  EXPECT_EQ(csv.size() - 1, points);
  EXPECT_EQ(summary.at("computed"), points);
  // Over splats 5 and 4 with `prepare`; over pixels, blur and threads 4 and 3; over views 2 and 2.
  EXPECT_EQ(curves.size(), 9U + 3U * 7U + 4U);
  const std::string page = folder.read("out/growth.html");
  EXPECT_NE(page.find("</html>"), std::string::npos);
  for (const std::string& curve : curves) {
    EXPECT_NE(page.find(curve.substr(0, curve.find(" over ")) + ": "), std::string::npos) << curve;
  }
  const Outcome scan =
      runFoci({"chart", "--growth", "--out", "out", "--scan", "s.ply"}, folder.path());
  EXPECT_EQ(scan.exit_code, 2);
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
