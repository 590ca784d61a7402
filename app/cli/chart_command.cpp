#include <tbb/global_control.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <type_traits>

#include "app/cli/commands.h"
#include "app/evaluation/chart/cases.h"
#include "app/evaluation/chart/chart.h"
#include "app/evaluation/chart/motion.h"
#include "app/evaluation/evaluated_methods.h"
#include "app/evaluation/growth/growth.h"
#include "app/evaluation/stability/measure.h"
#include "app/platform/json_text.h"
#include "app/platform/machine.h"
#include "app/platform/output_files.h"
#include "app/platform/progress.h"
#include "app/platform/shell.h"
#include "app/platform/warnings.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr int kMinSize_px = 16, kMaxSize_px = 4096;

struct ChartOptions {
  std::string out{}, export_to{}, import_from{};
  ScanOptions scan{};
  EvaluationChoice choice{};
  bool stability = false, motion = false, growth = false, json = false, overwrite = false;
};

nlohmann::ordered_json pointJson(const ChartPoint& point) {
  return {{"scene", point.scene},
          {"blur_px", point.blur_px},
          {"method", point.method.spec()},
          {"threads", point.threads},
          {"ms_median", point.ms_median},
          {"psnr_dB", jsonNumber(point.psnr_dB)},
          {"on_frontier", point.on_frontier}};
}

nlohmann::ordered_json pointJson(const StabilityPoint& point) {
  return {{"scene", point.scene},
          {"value", point.value},
          {"method", point.by},
          {"score", jsonNumber(point.score)}};
}

nlohmann::ordered_json pointJson(const GrowthCurve& curve) {
  nlohmann::ordered_json json = {{"curve", nameOf(curve)},
                                 {"exponent", curve.time.exponent},
                                 {"bend", nullptr},
                                 {"memory_exponent", curve.memory.exponent}};
  if (const auto& bend = curve.time.bend) {
    json["bend"] = {{"at", bend->at}, {"before", bend->before}, {"after", bend->after}};
  }
  for (const GrowthPoint& point : curve.points) {
    json["points"].push_back({{"size", point.size},
                              {"method", point.method},
                              {"ms_median", point.ms},
                              {"cpu_ms_median", point.cpu_ms},
                              {"memory_GB", point.memory_GB}});
  }
  return json;
}

nlohmann::ordered_json pointJson(const MotionPoint& point) {
  return {{"scene", point.scene},
          {"path", point.path},
          {"method", point.method.spec()},
          {"budget_ms", point.budget_ms},
          {"light_worst", point.light_worst},
          {"jnd_worst", point.jnd_worst},
          {"ms_median", point.ms_median}};
}

/// Reports the steps of a run.
std::function<void(std::size_t)> progressOf(std::size_t steps) {
  return [progress = std::make_shared<Progress>("charting", "steps", steps),
          done = std::size_t{0}](std::size_t more) mutable { progress->advance(done += more); };
}

using Paths = std::vector<std::filesystem::path>;
using Imported = std::vector<ImportedPoint>;

/// The folder of a chart.
struct ChartOutput {
  std::string name;
  std::filesystem::path out;
  OutputGuard guard;
  OutputFolder folder{out, guard};

  ChartCells cells() const { return {out, programKey(), guard}; }

  /// @return why there is no image of all panels; empty: there is one
  std::string writeOverview(const Drawing& panels) {
    const GnuplotChart png = pngOf(panels);
    if (png.image) folder.write(name + ".png", *png.image);
    if (png.image) return "";
    std::string notice = "No new " + name + ".png: " + png.problem;
    say(notice);
    return notice;
  }
  void write(const std::string& csv, const std::string& page) {
    folder.write(name + ".csv", csv);
    folder.write(name + ".html", page);
    folder.commit();
  }
};

// Each measures and writes the table, the page and the image of all panels.

Measured<ChartPoint> chart(const ChartPlan& plan, const Imported& imported, ChartOutput& to) {
  auto measured = measureChart(plan, to.cells(), progressOf(stepsOf(plan)));
  writeImages(imported, to.folder);
  for (const ImportedPoint& one : imported) measured.rows.push_back(one.point);
  markFrontiers(measured.rows);
  const double blur_px = plan.blurs_px[plan.blurs_px.size() / 2];
  const std::string notice = to.writeOverview(overviewOf(plan, measured.rows, blur_px));
  if (!notice.empty()) measured.warnings.push_back(notice);
  to.write(csvOf(measured.rows), chartPage(plan, measured));
  return measured;
}

Measured<StabilityPoint> chart(const StabilityPlan& plan, ChartOutput& to) {
  auto measured = measureStability(plan, to.cells(), progressOf(stepsOf(plan)));
  const std::string notice = to.writeOverview(stabilityOverview(plan, measured.rows));
  to.write(csvOf(plan, measured.rows), stabilityPage(plan, measured.rows, notice));
  return measured;
}

Measured<GrowthCurve> chart(const GrowthPlan& plan, ChartOutput& to) {
  auto measured = measureGrowth(plan, progressOf(stepsOf(plan)));
  const std::string notice = to.writeOverview(growthOverview(measured.rows));
  to.write(csvOf(measured.rows), growthPage(plan.quick, measured.rows, notice));
  return measured;
}

Measured<MotionPoint> chart(const MotionPlan& plan, ChartOutput& to) {
  auto measured = measureMotion(plan, to.cells(), progressOf(stepsOf(plan)));
  to.write(csvOf(measured.rows), motionPage(plan, measured));
  return measured;
}

/// @param outputs  besides table, page and image of all panels
/// @param inputs   besides the scan
/// @param measure  into a `ChartOutput`
template <class Measure>
void chartAndReport(const ChartOptions& options, const std::string& name, Paths outputs,
                    Paths inputs, const Measure& measure) {
  const auto start = std::chrono::steady_clock::now();
  const std::filesystem::path out = options.out;
  for (const char* extension : {".csv", ".html"}) outputs.push_back(out / (name + extension));
  if (name != "motion") outputs.push_back(out / (name + ".png"));
  for (const auto& file : scanFiles(options.scan)) inputs.push_back(file);
  ChartOutput to{name, out, OutputGuard(outputs, inputs, options.overwrite)};
  const auto measured = measure(to);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (options.json) {
    auto rows = nlohmann::ordered_json::array();
    for (const auto& row : measured.rows) rows.push_back(pointJson(row));
    std::puts(jsonText({{"out", out.string()},
                        {"seconds", seconds},
                        {"computed", measured.computed},
                        {"kept", measured.kept},
                        {name == "growth" ? "curves" : "points", rows}})
                  .c_str());
    return;
  }
  if constexpr (std::is_same_v<decltype(measured), const Measured<GrowthCurve>>) {
    for (const GrowthCurve& one : measured.rows) {
      std::printf("%s: exponent %s\n", nameOf(one).c_str(), growthText(one.time, 1.0).c_str());
    }
  }
  std::printf("%s measured, %zu already complete; %.0f s; page: %s\n",
              counted(measured.computed, "cell").c_str(), measured.kept, seconds,
              visible((out / (name + ".html")).string()).c_str());
}

/// The options that choose the scenes, as they are given again.
std::string sceneOptions(const ChartOptions& options) {
  std::string text = options.choice.quick ? " --quick" : "";
  if (options.choice.size_px) text += " --size " + std::to_string(*options.choice.size_px);
  for (const std::string& scene : options.choice.scenes) text += " --scene " + scene;
  if (options.choice.scan) {
    text += " --scan " + shellWord(std::filesystem::absolute(options.scan.scan).string());
    for (const auto& [name, place] : {std::pair(" --eye ", &options.scan.eye),
                                      {" --look-at ", &options.scan.look_at},
                                      {" --up ", &options.scan.up}}) {
      for (const double& each : *place) {
        text += (&each == place->data() ? name : ",") + exactText(each);
      }
    }
  }
  return text;
}

void exportPlan(const ChartOptions& options, const ChartPlan& plan) {
  const std::filesystem::path out = options.export_to;
  OutputFolder output(
      out, OutputGuard(exportedFiles(plan, out), scanFiles(options.scan), options.overwrite));
  const std::size_t cases = plan.scenes.size() * plan.blurs_px.size();
  Progress progress("exporting", "cases", cases);
  exportCases(plan, sceneOptions(options), output,
              [&, done = std::size_t{0}]() mutable { progress.advance(++done); });
  output.commit();
  if (options.json) {
    std::puts(jsonText({{"out", out.string()}, {"cases", cases}}).c_str());
  } else {
    std::printf("%s, explained in %s\n", counted(cases, "case").c_str(),
                visible((out / "README.md").string()).c_str());
  }
}

void runChart(ChartOptions options) {
  if (options.out.empty() && options.export_to.empty()) {
    throw InputError("--out is required: the folder of the results");
  }
  const auto& size_px = options.choice.size_px;
  if (size_px && (*size_px < kMinSize_px || *size_px > kMaxSize_px)) {
    throw InputError(
        "--size " + std::to_string(*size_px),
        "expected pixels, " + std::to_string(kMinSize_px) + " to " + std::to_string(kMaxSize_px));
  }
  if (size_px && options.stability) {
    throw InputError("--size", "the scenes of --stability have a fixed size");
  }
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  threadsOf(options.scan.threads));
  if (options.growth) {
    const double memory_GB = 0.5 * freeMemory_GB();  // half stays for other programs
    const GrowthPlan plan =
        planGrowth(options.choice.quick, size_px.value_or(640), memory_GB, threadCounts().back());
    return chartAndReport(options, "growth", {}, {},
                          [&](ChartOutput& to) { return chart(plan, to); });
  }
  options.choice.scan = scanViewOf(options.scan);
  if (options.stability) {
    const StabilityPlan plan = planStability(options.choice);
    return chartAndReport(options, "stability", measuredFiles(plan, options.out), {},
                          [&](ChartOutput& to) { return chart(plan, to); });
  }
  if (options.motion) {
    const MotionPlan plan = planMotion(options.choice);
    return chartAndReport(options, "motion", measuredFiles(plan, options.out), {},
                          [&](ChartOutput& to) { return chart(plan, to); });
  }
  const ChartPlan plan = planChart(options.choice);
  if (!options.export_to.empty()) return exportPlan(options, plan);
  Imported imported;
  if (!options.import_from.empty()) imported = importPoints(plan, options.import_from);
  Paths outputs = measuredFiles(plan, options.out), inputs;
  for (const auto& file : importedFiles(imported, options.out)) outputs.push_back(file);
  for (const ImportedPoint& one : imported) {
    inputs.insert(inputs.end(), one.read.begin(), one.read.end());
  }
  chartAndReport(options, "chart", outputs, inputs,
                 [&](ChartOutput& to) { return chart(plan, imported, to); });
}

}  // namespace

void addChartCommand(CLI::App& app) {
  const auto options = std::make_shared<ChartOptions>();
  CLI::App* chart = app.add_subcommand("chart",
                                       "Chart the frame time of every method against its accuracy. "
                                       "The run takes under half an hour;\n"
                                       "interrupted, it continues where it stopped, except "
                                       "--growth.\n"
                                       "Example: foci chart --out out/chart\n"
                                       "         foci chart --stability --out out/stability\n"
                                       "         foci chart --growth --out out/growth\n"
                                       "         foci chart --motion --out out/motion\n"
                                       "         foci chart --quick --scene ball --export cases");
  CLI::Option* out = addOption(*chart, "--out", options->out, "DIR", "folder of the results");
  chart->add_flag("--quick", options->choice.quick,
                  "minutes: fewer blurs, settings, frames and runs, times with all threads only");
  CLI::Option* stability =
      chart->add_flag("--stability", options->stability,
                      "score the methods on scenes made to break them, each with a dial from "
                      "harmless to extreme");
  CLI::Option* motion =
      chart
          ->add_flag("--motion", options->motion,
                     "score the change from frame to frame beyond the reference's: head, focus, "
                     "pupil, saccade, stereo")
          ->excludes(stability);
  addOption(*chart, "--size", options->choice.size_px, "PX",
            "width of the images; default 640, with --motion 160");
  CLI::Option* scene = addOption(*chart, "--scene", options->choice.scenes, "NAME",
                                 "only this scene; may be repeated");
  CLI::Option* method = addOption(*chart, "--method", options->choice.methods, "NAME",
                                  "only this method, NAME or NAME:N; may be repeated");
  CLI::Option* growth =
      chart
          ->add_flag("--growth", options->growth,
                     "measure how time and memory grow with splats, pixels, blur, views and "
                     "threads; ten minutes, --quick one")
          ->excludes(stability, motion, scene, method);
  CLI::Option* exported =
      addOption(*chart, "--export", options->export_to, "DIR",
                "write scenes, cameras, lenses and references for other renderers")
          ->excludes(out, stability, growth, motion, method);
  addOption(*chart, "--import", options->import_from, "DIR",
            "also chart the images of other renderers that DIR/times.json lists")
      ->excludes(exported, growth, motion, stability);
  addScanOptions(*chart, options->scan);
  growth->excludes(chart->get_option("--scan"));
  addOverwriteFlag(*chart, options->overwrite);
  chart->add_flag("--json", options->json, "print the figures as JSON");
  onceParsed(*chart, [options] { runChart(*options); });
}

}  // namespace foci
