#include "app/prepare_command.h"

#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "app/base/input_error.h"
#include "app/output_folder.h"
#include "app/prepare_report.h"
#include "app/progress.h"
#include "render/scene/estimate.h"
#include "render/scene/foci_file.h"
#include "render/scene/kernel_sums.h"
#include "render/scene/open_scene.h"

namespace foci {
namespace {

constexpr std::size_t kProbes = 50'000;
constexpr float kPixels[] = {1.0f, 0.5f};
constexpr int kMostThreads = 1024;

Normalisation normalisationOf(const std::vector<KernelSum>& sums, float pixel_spacings) {
  Normalisation n{.pixel_spacings = pixel_spacings,
                  .within_2 = shareWithin(sums, 0.02f, false),
                  .within_5 = shareWithin(sums, 0.05f, false),
                  .within_10 = shareWithin(sums, 0.1f, false),
                  .smooth_within_2 = shareWithin(sums, 0.02f, true),
                  .smooth_within_5 = shareWithin(sums, 0.05f, true),
                  .smooth_within_10 = shareWithin(sums, 0.1f, true),
                  .mean = 0.0,
                  .histogram = std::vector<std::size_t>(kHistogramBins, 0)};
  for (const KernelSum& sum : sums) {
    n.mean += sum.sum / static_cast<double>(sums.size());
    const float bin = std::floor((sum.sum - 0.5f) * static_cast<float>(kHistogramBins));
    ++n.histogram[static_cast<std::size_t>(
        std::clamp(bin, 0.0f, static_cast<float>(kHistogramBins - 1)))];
  }
  return n;
}

double medianSpacing_m(const SurfelCloud& cloud) {
  std::vector<float> area_m2 = cloud.area_m2;
  const auto middle = area_m2.begin() + static_cast<std::ptrdiff_t>(area_m2.size() / 2);
  std::nth_element(area_m2.begin(), middle, area_m2.end());
  return std::sqrt(static_cast<double>(*middle));
}

std::string json(const PrepareSummary& summary) {
  auto normalisation = nlohmann::ordered_json::array();
  for (const Normalisation& n : summary.normalisation) {
    normalisation.push_back({{"pixel_spacings", n.pixel_spacings},
                             {"mean", n.mean},
                             {"within_0.02", n.within_2},
                             {"within_0.05", n.within_5},
                             {"within_0.1", n.within_10},
                             {"smooth_within_0.02", n.smooth_within_2},
                             {"smooth_within_0.05", n.smooth_within_5},
                             {"smooth_within_0.1", n.smooth_within_10}});
  }
  const nlohmann::ordered_json all = {{"out", summary.out.string()},
                                      {"report", summary.report.string()},
                                      {"surfels", summary.surfels},
                                      {"dropped", summary.dropped},
                                      {"oriented", summary.oriented},
                                      {"area_m2", summary.area_m2},
                                      {"spacing_mm", 1000.0 * summary.spacing_m},
                                      {"smooth_share", summary.smooth_share},
                                      {"seconds", summary.seconds},
                                      {"normalisation", normalisation}};
  return all.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

struct Options {
  std::string input, out;
  double scale_m = 1.0;
  double points = 500'000.0;
  std::optional<int> threads;
  bool json = false;
};

void run(const Options& options) {
  if (options.input.empty()) throw InputError("INPUT", "expected a value that is not empty");
  if (!(options.scale_m >= 1e-6 && options.scale_m <= 1e6)) {
    throw InputError("--scale " + std::to_string(options.scale_m),
                     "expected metres a unit of the input, 1e-6 to 1e6");
  }
  if (!(options.points >= 1.0 && options.points <= 1e8)) {
    throw InputError("--points " + std::to_string(options.points), "expected 1 to 1e8");
  }
  if (options.threads && (*options.threads < 1 || *options.threads > kMostThreads)) {
    throw InputError("--threads " + std::to_string(*options.threads),
                     "expected an integer, 1 to " + std::to_string(kMostThreads));
  }
  std::optional<tbb::global_control> limit;
  if (options.threads) {
    limit.emplace(tbb::global_control::max_allowed_parallelism,
                  static_cast<std::size_t>(*options.threads));
  }
  const PrepareSummary summary = prepareScene({.input = options.input,
                                               .out = options.out,
                                               .scale_m = options.scale_m,
                                               .points = static_cast<std::size_t>(options.points)});
  if (summary.dropped > 0) {
    std::fprintf(stderr, "%s: %zu points left out: their position is not finite\n",
                 options.input.c_str(), summary.dropped);
  }
  if (options.json) {
    std::puts(json(summary).c_str());
    return;
  }
  const Normalisation& n = summary.normalisation.front();
  std::printf(
      "%zu surfels, %.4g m2, one every %.3g mm; %.1f s\n"
      "kernels sum to 1 +- 0.02 over %.1f %% of the surface, to 1 +- 0.1 over %.1f %% (smooth "
      "parts: "
      "%.1f %%)\nscene: %s\nreport: %s\n",
      summary.surfels, summary.area_m2, 1000.0 * summary.spacing_m, summary.seconds,
      100.0 * n.within_2, 100.0 * n.within_10, 100.0 * n.smooth_within_10, summary.out.c_str(),
      summary.report.c_str());
}

}  // namespace

PrepareSummary prepareScene(const PrepareRequest& request) {
  if (request.out.extension() != ".foci") {
    throw InputError("--out " + request.out.string(), "expected a file name that ends in .foci");
  }
  std::error_code ignored;
  if (std::filesystem::is_directory(request.out, ignored)) {
    throw InputError("--out " + request.out.string(), "is a folder");
  }
  if (isSceneFile(request.input)) {
    throw InputError(request.input.string(), "is prepared already");
  }
  const auto start = std::chrono::steady_clock::now();
  std::filesystem::path folder = request.out.parent_path();
  if (folder.empty()) folder = ".";
  OutputFolder output(folder);  // before the work, should it be impossible
  const std::filesystem::path scene_file = output.stage(request.out.filename().string());
  PointCloud points =
      openPoints(request.input, request.scale_m, MeshSampling{.points = request.points});
  PrepareSummary summary{.out = request.out, .report = request.out, .dropped = points.dropped};
  summary.report.replace_extension(".html");

  std::optional<Progress> progress;
  const SurfelCloud cloud = surfelsFromPoints(
      std::move(points), {.thorough = true, .progress = [&](std::size_t done, std::size_t total) {
                            if (!progress)
                              progress.emplace("solving weights and sizes", "passes", total);
                            progress->advance(done);
                          }});
  summary.surfels = cloud.size();
  summary.oriented = cloud.oriented;
  summary.spacing_m = medianSpacing_m(cloud);
  for (const float area_m2 : cloud.area_m2) summary.area_m2 += area_m2;
  for (const float pixel : kPixels) {
    const std::vector<KernelSum> sums = kernelSums(cloud, kProbes, {pixel});
    summary.normalisation.push_back(normalisationOf(sums, pixel));
    summary.smooth_share =
        static_cast<double>(std::count_if(sums.begin(), sums.end(),
                                          [](const KernelSum& sum) { return sum.smooth; })) /
        static_cast<double>(std::max<std::size_t>(sums.size(), 1));
  }

  writeSceneFile(scene_file, cloud);
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  writeText(output.stage(summary.report.filename().string()), prepareReport(request, summary));
  output.commit();
  return summary;
}

void addPrepareCommand(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  CLI::App* prepare = app.add_subcommand("prepare",
                                         "Turn points or a mesh into a scene file: sizes and "
                                         "weights solved so that surfaces are whole.\n"
                                         "Example: foci prepare lion.ply --out lion.foci");
  prepare->add_option("INPUT", options->input, "points (PLY) or mesh (OBJ, glTF, STL, PLY)")
      ->type_name("FILE")
      ->required();
  prepare->add_option("--out", options->out, "scene; the report goes beside it, .html")
      ->type_name("FILE.foci")
      ->required();
  prepare->add_option("--scale", options->scale_m, "a unit of the input, metres; default: 1")
      ->type_name("METRES");
  prepare->add_option("--points", options->points, "about, of a mesh; default: 500000")
      ->type_name("N");
  prepare->add_option("--threads", options->threads, "at most; the result is the same for any")
      ->type_name("N");
  prepare->add_flag("--json", options->json, "print the summary as JSON");
  prepare->callback([options] { run(*options); });
}

}  // namespace foci
