#include <tbb/global_control.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <type_traits>

#include "app/cli/commands.h"
#include "app/cli/option_values.h"
#include "app/cli/scan_options.h"
#include "app/evaluation/chart/export.h"
#include "app/evaluation/chart/import.h"
#include "app/evaluation/chart/measure.h"
#include "app/evaluation/chart/motion.h"
#include "app/evaluation/chart/motion_page.h"
#include "app/evaluation/chart/page.h"
#include "app/evaluation/chart/panel.h"
#include "app/evaluation/growth/growth.h"
#include "app/evaluation/growth/page.h"
#include "app/evaluation/stability/measure.h"
#include "app/evaluation/stability/page.h"
#include "app/evaluation/timed_runs.h"
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

/// The rows of JSON: curves or points.
template <class Result>
const auto& rowsOf(const Result& result) {
  if constexpr (std::is_same_v<Result, GrowthResult>) {
    return result.curves;
  } else {
    return result.points;
  }
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

template <class Result>
std::string chartJson(const std::filesystem::path& out, double seconds, const Result& result) {
  auto points = nlohmann::ordered_json::array();
  for (const auto& row : rowsOf(result)) points.push_back(pointJson(row));
  return jsonText({{"out", out.string()},
                   {"seconds", seconds},
                   {"computed", result.computed},
                   {"kept", result.kept},
                   {std::is_same_v<Result, GrowthResult> ? "curves" : "points", points}});
}

/// Reports the steps of a run.
std::function<void(std::size_t)> progressOf(std::size_t steps) {
  return [progress = std::make_shared<Progress>("charting", "steps", steps),
          done = std::size_t{0}](std::size_t more) mutable { progress->advance(done += more); };
}

/// @return why there is no image of all panels; empty: there is one
std::string writeOverview(const std::string& name, const Drawing& panels, OutputFolder& output) {
  const GnuplotChart png = pngOf(panels);
  if (png.image) {
    output.write(name, *png.image);
    return "";
  }
  std::string notice = "No new " + name + ": " + png.problem;
  say(notice);
  return notice;
}

using Imported = std::vector<ImportedPoint>;

/// Measures and writes the table, the page and the image of all panels.
ChartResult chart(const ChartPlan& plan, const Imported& imported, const std::filesystem::path& out,
                  const OutputGuard& guard) {
  OutputFolder output(out, guard);
  ChartResult result = measureChart(plan, out, guard, progressOf(stepsOf(plan)));
  writeImages(imported, output);
  for (const ImportedPoint& one : imported) result.points.push_back(one.point);
  markFrontiers(result.points);
  output.write("chart.csv", csvOf(result.points));
  const double blur_px = plan.blurs_px[plan.blurs_px.size() / 2];
  const std::string notice = writeOverview(
      "chart.png", overviewOf(plan, result.points, blur_px, describeMachine()), output);
  if (!notice.empty()) result.warnings.push_back(notice);
  output.write("chart.html", chartPage(plan, result.points, result.warnings));
  output.commit();
  return result;
}

StabilityResult chart(const StabilityPlan& plan, const Imported& /*none*/,
                      const std::filesystem::path& out, const OutputGuard& guard) {
  OutputFolder output(out, guard);
  StabilityResult result = measureStability(plan, out, guard, progressOf(stepsOf(plan)));
  output.write("stability.csv", csvOf(plan, result.points));
  const std::string notice =
      writeOverview("stability.png", stabilityOverview(plan, result.points), output);
  output.write("stability.html", stabilityPage(plan, result.points, notice));
  output.commit();
  return result;
}

/// No cells: a run takes minutes.
std::vector<std::filesystem::path> measuredFiles(const GrowthPlan& /*none*/,
                                                 const std::filesystem::path& /*none*/) {
  return {};
}

GrowthResult chart(const GrowthPlan& plan, const Imported& /*none*/,
                   const std::filesystem::path& out, const OutputGuard& guard) {
  OutputFolder output(out, guard);
  GrowthResult result = measureGrowth(plan, progressOf(stepsOf(plan)));
  output.write("growth.csv", csvOf(result.curves));
  const std::string notice = writeOverview("growth.png", growthOverview(result.curves), output);
  output.write("growth.html", growthPage(plan.quick, result.curves, notice));
  output.commit();
  return result;
}

MotionResult chart(const MotionPlan& plan, const Imported& /*none*/,
                   const std::filesystem::path& out, const OutputGuard& guard) {
  OutputFolder output(out, guard);
  MotionResult result = measureMotion(plan, out, guard, progressOf(stepsOf(plan)));
  output.write("motion.csv", csvOf(result.points));
  output.write("motion.html", motionPage(plan, result.points, result.warnings));
  output.commit();
  return result;
}

template <class Plan>
void chartAndReport(const ChartOptions& options, const Plan& plan, const std::string& name,
                    const Imported& imported = {}) {
  const auto start = std::chrono::steady_clock::now();
  const std::filesystem::path out = options.out;
  std::vector<std::filesystem::path> outputs = measuredFiles(plan, out);
  for (const char* extension : {".csv", ".html"}) outputs.push_back(out / (name + extension));
  if (!std::is_same_v<Plan, MotionPlan>) outputs.push_back(out / (name + ".png"));
  for (const auto& file : importedFiles(imported, out)) outputs.push_back(file);
  auto inputs = scanFiles(options.scan);
  for (const ImportedPoint& one : imported) {
    inputs.insert(inputs.end(), one.read.begin(), one.read.end());
  }
  const auto result = chart(plan, imported, out, OutputGuard(outputs, inputs, options.overwrite));
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (options.json) {
    std::puts(chartJson(out, seconds, result).c_str());
  } else {
    if constexpr (std::is_same_v<Plan, GrowthPlan>) {
      for (const GrowthCurve& curve : result.curves) {
        std::printf("%s: exponent %s\n", nameOf(curve).c_str(),
                    growthText(curve.time, 1.0).c_str());
      }
    }
    std::printf("%zu cells measured, %zu already complete; %.0f s; page: %s\n", result.computed,
                result.kept, seconds, visible((out / (name + ".html")).string()).c_str());
  }
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
    chartAndReport(
        options,
        planGrowth(options.choice.quick, size_px.value_or(640), memory_GB, threadCounts().back()),
        "growth");
    return;
  }
  options.choice.scan = scanViewOf(options.scan);
  if (options.stability) {
    chartAndReport(options, planStability(options.choice), "stability");
    return;
  }
  if (options.motion) {
    chartAndReport(options, planMotion(options.choice), "motion");
    return;
  }
  const ChartPlan plan = planChart(options.choice);
  if (!options.export_to.empty()) {
    exportPlan(options, plan);
  } else {
    chartAndReport(
        options, plan, "chart",
        options.import_from.empty() ? Imported() : importPoints(plan, options.import_from));
  }
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
