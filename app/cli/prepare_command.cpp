#include <tbb/global_control.h>

#include <cstdio>
#include <memory>
#include <optional>

#include "app/cli/commands.h"
#include "app/platform/json_text.h"
#include "app/prepare/prepare.h"
#include "app/study/framing.h"
#include "app/study/study.h"
#include "base/input_error.h"
#include "base/text.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {
namespace {

nlohmann::ordered_json normalisationJson(const Normalisation& n) {
  const auto ofSmooth = [&](double value) {
    return n.smooth_share > 0.0 ? std::optional(value) : std::nullopt;
  };
  return {{"pixel_spacings", n.pixel_spacings},
          {"blur_spacings", n.blur_spacings},
          {"mean", n.whole.mean},
          {"within_0.02", n.whole.within_2},
          {"within_0.05", n.whole.within_5},
          {"within_0.1", n.whole.within_10},
          {"smooth_share", n.smooth_share},
          {"smooth_mean", ofSmooth(n.smooth.mean)},
          {"smooth_within_0.02", ofSmooth(n.smooth.within_2)},
          {"smooth_within_0.05", ofSmooth(n.smooth.within_5)},
          {"smooth_within_0.1", ofSmooth(n.smooth.within_10)},
          {"histogram", n.whole.histogram},
          {"smooth_histogram", n.smooth.histogram}};
}

nlohmann::ordered_json fidelityJson(const FidelityReport& report) {
  const Fidelity& all = report.all;
  return {{"views", report.views.size()},
          {"pixel_spacings", report.pixelSpacings()},
          {"interior_px", all.interior},
          {"leak_share", all.leakShare()},
          {"largest_leak", all.largest_leak},
          {"color_error_mean", all.color_mean},
          {"color_error_99", all.color_99},
          {"outline_error_px", all.outline_px},
          {"outline_shift_px", all.outline_shift_px},
          {"transparent_share", report.transparent_share}};
}

std::string prepareJson(const PrepareSummary& summary, const nlohmann::ordered_json& input) {
  const auto list = [](const std::vector<Normalisation>& from) {
    auto all = nlohmann::ordered_json::array();
    for (const Normalisation& n : from) all.push_back(normalisationJson(n));
    return all;
  };
  auto levels = nlohmann::ordered_json::array();
  for (const LevelNormalisation& level : summary.levels) {
    levels.push_back({{"nodes", level.nodes},
                      {"sharp", normalisationJson(level.sharp)},
                      {"blurred", normalisationJson(level.blurred)}});
  }
  const nlohmann::ordered_json all = {
      {"out", summary.out.string()},
      {"report", summary.report.string()},
      {"input", input},
      {"surfels", summary.surfels},
      {"gaussians", summary.gaussians},
      {"nodes", summary.nodes},
      {"dropped", summary.dropped},
      {"oriented", summary.oriented},
      {"area_m2", summary.area_m2},
      {"spacing_mm", 1000.0 * summary.spacing_m},
      {"seconds", summary.seconds},
      {"triangles", summary.fidelity ? fidelityJson(*summary.fidelity) : nlohmann::ordered_json()},
      {"warnings", summary.warnings},
      {"normalisation", list(summary.normalisation)},
      {"normalisation_before", list(summary.before)},
      {"normalisation_of_levels", levels}};
  return jsonText(all);
}

struct PrepareOptions {
  std::string input{}, out{};
  double scale_m = 1.0;
  std::optional<double> points{};
  std::string threads{};
  bool json = false, overwrite = false;
};

void runPrepare(const PrepareOptions& options) {
  if (!(options.scale_m >= kMinScale_m && options.scale_m <= kMaxScale_m)) {
    throw InputError("--scale " + exactText(options.scale_m),
                     "expected metres per unit of the input, 1e-6 to 1e6");
  }
  std::optional<std::size_t> points;
  if (options.points) {
    if (!(*options.points >= 1.0 && *options.points <= 1e8)) {
      throw InputError("--points " + exactText(*options.points), "expected 1 to 1e8");
    }
    points = static_cast<std::size_t>(*options.points);
  }
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  threadsOf(options.threads));
  const PrepareSummary summary = prepareScene(
      {.input = options.input,
       .out = options.out,
       .scale_m = options.scale_m,
       .points = points,
       .up_axis = [](const SceneFacts& facts) { return upAxisOf(facts, boxOf(facts)).axis; },
       .overwrite = options.overwrite});
  const SceneFacts& facts = summary.facts;
  const Framing framing = framingOf(facts, {.screen = defaultScreen(), .scale_m = options.scale_m});
  if (options.json) {
    std::puts(prepareJson(summary, sceneJson(facts, framing)).c_str());
    return;
  }
  std::fputs(sceneText(facts, framing).c_str(), stdout);
  if (summary.gaussians > 0) {
    std::printf("%s, a tree of %s; %.1f s\nscene: %s\nreport: %s\n",
                counted(summary.gaussians, "Gaussian").c_str(),
                counted(summary.nodes, "node").c_str(), summary.seconds,
                visible(summary.out.string()).c_str(), visible(summary.report.string()).c_str());
    return;
  }
  const Normalisation& n = summary.normalisation.front();
  std::printf(
      "%zu surfels, %.4g m2, one every %.3g mm; %.1f s\n"
      "kernels sum to 1 +- 0.02 over %.1f %% of the surface, to 1 +- 0.1 over %.1f %% (%.1f %% of "
      "the smooth parts)\n%s\nscene: %s\nreport: %s\n",
      summary.surfels, summary.area_m2, 1000.0 * summary.spacing_m, summary.seconds,
      100.0 * n.whole.within_2, 100.0 * n.whole.within_10, 100.0 * n.smooth.within_10,
      fidelityText(summary).c_str(), visible(summary.out.string()).c_str(),
      visible(summary.report.string()).c_str());
}

}  // namespace

void addPrepareCommand(CLI::App& app) {
  const auto options = std::make_shared<PrepareOptions>();
  CLI::App* prepare =
      app.add_subcommand("prepare",
                         "Convert points, a mesh or Gaussians to a prepared scene.\n"
                         "foci solves for the sizes and weights of surfels, so that surfaces have "
                         "neither holes nor seams.\n"
                         "For Gaussians, it builds levels of detail. For a mesh, the report "
                         "compares the surfels with the triangles.\n"
                         "Example: foci prepare lion.ply --out lion.foci");
  addOption(*prepare, "INPUT", options->input, "FILE",
            "points (PLY, LAS, PCD, XYZ, PTS, COLMAP), mesh (OBJ, glTF, STL, FBX, PLY, OFF) or "
            "Gaussians (PLY, SPZ, SPLAT, KSPLAT, SOG, glTF)")
      ->required();
  addOption(*prepare, "--out", options->out, "FILE.foci",
            "scene; the report gets the same name with .html")
      ->required();
  addOption(*prepare, "--scale", options->scale_m, "METRES",
            "length of a unit of the input, metres; default: 1");
  addOption(*prepare, "--points", options->points, "N",
            "approximate number of samples of a mesh; default: from its detail, 500000 or more");
  addOption(*prepare, "--threads", options->threads, "N",
            "max number of threads; the scene does not depend on it");
  addOverwriteFlag(*prepare, options->overwrite);
  prepare->add_flag("--json", options->json, "print the summary as JSON");
  onceParsed(*prepare, [options] { runPrepare(*options); });
}

}  // namespace foci
