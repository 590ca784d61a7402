#include <tbb/global_control.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/cli/commands.h"
#include "app/evaluation/evaluated_methods.h"
#include "app/evaluation/reproduce/reproduce.h"
#include "app/platform/json_text.h"
#include "app/platform/output_files.h"
#include "app/platform/progress.h"
#include "base/text.h"
#include "render/scene/builtin/procedural.h"

namespace foci {
namespace {

/// Chosen by eye, for a minute's run.
constexpr ReproduceEffort kQuick{
    .runs = 1, .accumulate_runs = 1, .min_views = 32, .max_views = 32, .figure1_views = 16};
constexpr std::size_t kSearchFrames = 10;  // about the frames that the search for apertures renders
constexpr std::size_t kManySurfels = 10'000'000;
constexpr const char *kTable = "table1.csv", *kPage = "reproduce.html", *kFigure1 = "figure1.png";
constexpr const char* kFigure6 = "figure6_";  // and the name of its scene

std::vector<std::vector<Image>> imagesOf(const std::vector<std::vector<PaperFigure>>& rows) {
  std::vector<std::vector<Image>> images;
  for (const auto& row : rows) {
    auto& next = images.emplace_back();
    for (const PaperFigure& panel : row) next.push_back(panel.image);
  }
  return images;
}

/// The frames that `reproduce` renders after it has found the apertures.
std::size_t framesToRender(const ReproduceScene& plane, const ReproduceScene& lion,
                           const ReproduceEffort& effort, const std::vector<unsigned>& threads,
                           bool quick) {
  const std::size_t figure1_frames = 3 * (1 + static_cast<std::size_t>(effort.figure1_views));
  const std::size_t growth_frames = quick ? 0 : 2 * kApertures * (1 + kGrowthRuns);
  return framesToMeasure(plane, effort, threads) + framesToMeasure(lion, effort, threads) +
         figure1_frames + growth_frames;
}

void findApertures(ReproduceScene& scene) {
  Progress progress("finding apertures", "frames", kSearchFrames);
  std::size_t done = 0;
  chooseApertures(scene, [&] {
    if (++done < kSearchFrames) progress.advance(done);
  });
  progress.advance(kSearchFrames);
}

struct ReproduceOptions {
  std::string out{};
  ScanOptions scan{};
  bool quick = false, json = false, overwrite = false;
};

/// The files in `out` that `reproduce` writes. The figures 6 are named for their scenes: these are
/// the figures that are there already.
std::vector<std::filesystem::path> reproduceFiles(const std::filesystem::path& out) {
  std::vector<std::filesystem::path> files;
  for (const char* name : {kTable, kPage, kFigure1}) files.push_back(out / name);
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(out, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(kFigure6) && name.ends_with(".png")) files.push_back(entry.path());
  }
  return files;
}

/// Measures and writes table1.csv, reproduce.html, figure1.png and figure6_SCENE.png of both
/// scenes. If it throws, it leaves nothing there. Progress goes to standard error.
/// @throws InputError, std::runtime_error
ReproduceFacts reproduce(const ReproduceOptions& options) {
  const OutputGuard guard(reproduceFiles(options.out), scanFiles(options.scan), options.overwrite);
  const std::optional<ScanView> scan = scanViewOf(options.scan);
  const auto start = std::chrono::steady_clock::now();
  const ReproduceEffort effort = options.quick ? kQuick : ReproduceEffort{};
  const std::vector<unsigned> threads = threadCounts();
  ReproduceScene lion = scan ? scanScene(*scan) : statueScene();
  OutputFolder output(options.out, guard);  // before the work, so that a bad folder is reported

  findApertures(lion);
  ReproduceScene plane = planeScene();
  const SurfelCloud gallery = makeGallery();

  Progress progress("rendering", "frames",
                    framesToRender(plane, lion, effort, threads, options.quick));
  std::size_t done = 0;
  const auto onFrames = [&](std::size_t frames) { progress.advance(done += frames); };

  ReproduceFacts facts{.effort = effort, .threads = threads, .quick = options.quick};
  const auto judge = [&](const std::vector<ReproduceRatio>& ratios) {
    facts.ratios.insert(facts.ratios.end(), ratios.begin(), ratios.end());
  };
  std::vector<ReproduceRow> rows;
  for (ReproduceScene* scene : {&plane, &lion}) {
    SceneResult result = measureScene(*scene, effort, threads, onFrames);
    rows.insert(rows.end(), result.rows.begin(), result.rows.end());
    judge(ratiosOf(result.rows, scene == &plane));
    auto figures = figure6(*scene, result);
    output.write(kFigure6 + scene->name + ".png",
                 pngOf(gridOf(imagesOf(figures), {kOurs, "reference",
                                                  "difference x " + decimal(kDifferenceGain, 0)})));
    facts.scenes.push_back({std::move(*scene), std::move(result), std::move(figures)});
  }
  facts.figure1 = figure1(gallery, effort.figure1_views, onFrames);
  output.write(kFigure1, pngOf(gridOf(imagesOf({facts.figure1}),
                                      {"mask in focus", "between the two", "bust in focus"})));
  if (!options.quick) {
    facts.growth = measureGrowth(kManySurfels, [&] { onFrames(1); });
    judge(ratiosOf(*facts.growth));
  }

  output.write(kTable, csvOf(rows));
  facts.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  output.write(kPage, reproducePage(facts));
  output.commit();
  return facts;
}

std::string reproduceJson(const std::filesystem::path& out, const ReproduceFacts& facts) {
  nlohmann::ordered_json ratios = nlohmann::ordered_json::array();
  for (const ReproduceRatio& one : facts.ratios) {
    nlohmann::ordered_json ratio = {{"figure", one.key},
                                    {"scene", one.scene},
                                    {"value", jsonNumber(one.value)},
                                    {one.at_most ? "at_most" : "at_least", one.wanted}};
    if (!facts.quick) ratio["reached"] = one.reached();
    ratios.push_back(std::move(ratio));
  }
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const ReproducedScene& one : facts.scenes) {
    for (const ReproduceRow& row : one.result.rows) {
      rows.push_back({{"scene", row.scene},
                      {"aperture", row.aperture_m},
                      {"method", row.method},
                      {"threads", row.threads},
                      {"kfragments", row.kfragments},
                      {"ms_median", row.ms_median},
                      {"psnr_dB", jsonNumber(row.psnr_dB)}});
    }
  }
  nlohmann::ordered_json all = {{"out", out.string()},
                                {"seconds", facts.seconds},
                                {"quick", facts.quick},
                                {"ratios", ratios},
                                {"rows", rows}};
  if (facts.growth) {
    for (const Growth::Size& size : {facts.growth->before, facts.growth->after}) {
      all["growth"].push_back({{"surfels", size.surfels},
                               {"build_s", size.build_s},
                               {"bytes_per_surfel", size.bytes_per_surfel},
                               {"ms_median", size.ms_median}});
    }
  }
  return jsonText(all);
}

void runReproduce(const ReproduceOptions& options) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  threadsOf(options.scan.threads));
  const ReproduceFacts facts = reproduce(options);
  const std::filesystem::path out = options.out;
  if (options.json) {
    std::puts(reproduceJson(out, facts).c_str());
    return;
  }
  for (const ReproduceRatio& one : facts.ratios) {
    std::printf("%-7s %s: %s, wanted %s %g%s\n", one.scene.c_str(), one.what.c_str(),
                std::isfinite(one.value) ? decimal(one.value, one.digits).c_str() : "exact",
                one.at_most ? "at most" : "at least", one.wanted,
                facts.quick || one.reached() ? "" : ": not reached");
  }
  if (facts.quick) std::puts("A quick run: its figures scatter too much to be judged.");
  std::printf("%.0f s; page: %s\n", facts.seconds, visible((out / kPage).string()).c_str());
}

}  // namespace

void addReproduceCommand(CLI::App& app) {
  const auto options = std::make_shared<ReproduceOptions>();
  CLI::App* command = app.add_subcommand("reproduce",
                                         "Measure Table 1, Figure 1 and Figure 6 of the 2003 paper "
                                         "on this machine. The run takes under\n"
                                         "ten minutes and 2 GB of memory.\n"
                                         "Example: foci reproduce --out out/paper");
  addOption(*command, "--out", options->out, "DIR", "folder of the results")->required();
  command->add_flag(
      "--quick", options->quick,
      "one minute: fewer repetitions, a coarse reference, no scene of 10 million surfels; shows "
      "the figures without judging them");
  addScanOptions(*command, options->scan);
  addOverwriteFlag(*command, options->overwrite);
  command->add_flag("--json", options->json, "print the figures as JSON");
  onceParsed(*command, [options] { runReproduce(*options); });
}

}  // namespace foci
