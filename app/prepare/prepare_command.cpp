#include "app/prepare/prepare_command.h"

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

#include "app/platform/output_folder.h"
#include "app/platform/progress.h"
#include "app/prepare/prepare_report.h"
#include "base/file.h"
#include "base/input_error.h"
#include "render/lod/level_kernels.h"
#include "render/lod/moment_tree.h"
#include "render/normalisation/kernel_sums.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/io/foci_file.h"
#include "render/scene/io/open_scene.h"

namespace foci {
namespace {

constexpr std::size_t kMaxProbes = 20'000, kProbesASurfel = 10;
constexpr int kMinNodes = 1000;
constexpr float kPixels[] = {1.0f, 0.5f};
constexpr int kMaxThreads = 1024;

std::vector<std::size_t> histogramOf(const std::vector<KernelSum>& sums, bool smooth_only) {
  std::vector<std::size_t> histogram(kHistogramBins, 0);
  for (const KernelSum& sum : sums) {
    if (smooth_only && !sum.smooth) continue;
    const float bin = std::floor((sum.sum - 0.5f) * static_cast<float>(kHistogramBins));
    ++histogram[static_cast<std::size_t>(
        std::clamp(bin, 0.0f, static_cast<float>(kHistogramBins - 1)))];
  }
  return histogram;
}

Normalisation normalisationOf(const std::vector<KernelSum>& sums, const SeenAs& seen) {
  double sum = 0.0, smooth_sum = 0.0, smooth = 0.0;
  for (const KernelSum& at : sums) {
    sum += at.sum;
    smooth += at.smooth ? 1.0 : 0.0;
    smooth_sum += at.smooth ? at.sum : 0.0;
  }
  const auto all = static_cast<double>(std::max<std::size_t>(sums.size(), 1));
  return {.pixel_spacings = seen.pixel_spacings,
          .blur_spacings = seen.blur_spacings,
          .smooth_share = smooth / all,
          .within_2 = shareWithin(sums, 0.02f, false),
          .within_5 = shareWithin(sums, 0.05f, false),
          .within_10 = shareWithin(sums, 0.1f, false),
          .smooth_within_2 = shareWithin(sums, 0.02f, true),
          .smooth_within_5 = shareWithin(sums, 0.05f, true),
          .smooth_within_10 = shareWithin(sums, 0.1f, true),
          .mean = sum / all,
          .smooth_mean = smooth_sum / std::max(smooth, 1.0),
          .histogram = histogramOf(sums, false),
          .smooth_histogram = histogramOf(sums, true)};
}

std::size_t probesOf(const SurfelCloud& cloud) {
  return std::min(kMaxProbes, kProbesASurfel * cloud.size());
}

std::vector<Normalisation> normalisationOf(const SurfelCloud& cloud) {
  std::vector<Normalisation> all;
  for (const float pixel : kPixels) {
    all.push_back(normalisationOf(kernelSums(cloud, probesOf(cloud), {pixel}), {pixel}));
  }
  return all;
}

/// Of the levels that have at least kMinNodes nodes: coarser ones are border everywhere.
std::vector<LevelNormalisation> normalisationOfLevels(const SurfelCloud& cloud) {
  std::vector<LevelNormalisation> levels;
  const MomentTree tree(cloud);
  for (int level = tree.levels() - 1; level >= 0 && 1 << level >= kMinNodes; --level) {
    const LevelKernels kernels = levelKernels(tree, level);
    const auto as = [&](const SeenAs& seen) {
      return normalisationOf(
          kernelSums(kernels.surfels, probesOf(kernels.surfels), seen, kernels.added_m2), seen);
    };
    levels.push_back({.nodes = kernels.surfels.size(),
                      .sharp = as(kCoarsestSharp),
                      .blurred = as(kCoarsestBlurred)});
  }
  return levels;
}

double medianSpacing_m(const SurfelCloud& cloud) {
  std::vector<float> area_m2 = cloud.area_m2;
  const auto middle = area_m2.begin() + static_cast<std::ptrdiff_t>(area_m2.size() / 2);
  std::nth_element(area_m2.begin(), middle, area_m2.end());
  return std::sqrt(static_cast<double>(*middle));
}

nlohmann::ordered_json json(const Normalisation& n) {
  const auto ofSmooth = [&](double value) {
    return n.smooth_share > 0.0 ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
  };
  return {{"pixel_spacings", n.pixel_spacings},
          {"blur_spacings", n.blur_spacings},
          {"mean", n.mean},
          {"within_0.02", n.within_2},
          {"within_0.05", n.within_5},
          {"within_0.1", n.within_10},
          {"smooth_share", n.smooth_share},
          {"smooth_mean", ofSmooth(n.smooth_mean)},
          {"smooth_within_0.02", ofSmooth(n.smooth_within_2)},
          {"smooth_within_0.05", ofSmooth(n.smooth_within_5)},
          {"smooth_within_0.1", ofSmooth(n.smooth_within_10)},
          {"histogram", n.histogram},
          {"smooth_histogram", n.smooth_histogram}};
}

std::string json(const PrepareSummary& summary) {
  const auto list = [](const std::vector<Normalisation>& from) {
    auto all = nlohmann::ordered_json::array();
    for (const Normalisation& n : from) all.push_back(json(n));
    return all;
  };
  auto levels = nlohmann::ordered_json::array();
  for (const LevelNormalisation& level : summary.levels) {
    levels.push_back(
        {{"nodes", level.nodes}, {"sharp", json(level.sharp)}, {"blurred", json(level.blurred)}});
  }
  const nlohmann::ordered_json all = {{"out", summary.out.string()},
                                      {"report", summary.report.string()},
                                      {"surfels", summary.surfels},
                                      {"dropped", summary.dropped},
                                      {"oriented", summary.oriented},
                                      {"area_m2", summary.area_m2},
                                      {"spacing_mm", 1000.0 * summary.spacing_m},
                                      {"seconds", summary.seconds},
                                      {"normalisation", list(summary.normalisation)},
                                      {"normalisation_before", list(summary.before)},
                                      {"normalisation_of_levels", levels}};
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
  if (options.threads && (*options.threads < 1 || *options.threads > kMaxThreads)) {
    throw InputError("--threads " + std::to_string(*options.threads),
                     "expected an integer, 1 to " + std::to_string(kMaxThreads));
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

  summary.before =
      normalisationOf(surfelsFromPoints(PointCloud(points), {.solve = KernelSolve::none}));
  std::optional<Progress> progress;
  const SurfelCloud cloud = surfelsFromPoints(
      std::move(points),
      {.solve = KernelSolve::thorough, .progress = [&](std::size_t done, std::size_t total) {
         if (!progress) {
           progress.emplace("solving weights and sizes", "passes", total);
         }
         progress->advance(done);
       }});
  summary.surfels = cloud.size();
  summary.oriented = cloud.oriented;
  summary.spacing_m = medianSpacing_m(cloud);
  for (const float area_m2 : cloud.area_m2) summary.area_m2 += area_m2;
  summary.normalisation = normalisationOf(cloud);
  summary.levels = normalisationOfLevels(cloud);

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
