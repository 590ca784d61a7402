#include "app/cli/reproduce_command.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/evaluation/reproduce/figures.h"
#include "app/evaluation/reproduce/page.h"
#include "app/evaluation/scan_options.h"
#include "app/evaluation/timed_runs.h"
#include "app/platform/interrupt.h"
#include "app/platform/json_number.h"
#include "app/platform/output_folder.h"
#include "app/platform/progress.h"
#include "app/record/tables.h"
#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr ReproduceEffort kQuick{
    .runs = 3, .accumulate_runs = 1, .min_views = 64, .max_views = 64, .figure1_views = 32};
constexpr std::size_t kSearchFrames = 10;  // that finding the apertures takes, about
constexpr std::size_t kManySurfels = 10'000'000;

void writeBytes(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes) {
  writeText(file, std::string(bytes.begin(), bytes.end()));
}

std::vector<std::vector<Image>> imagesOf(const std::vector<std::vector<FigurePanel>>& rows) {
  std::vector<std::vector<Image>> images;
  for (const auto& row : rows) {
    auto& next = images.emplace_back();
    for (const FigurePanel& panel : row) next.push_back(panel.image);
  }
  return images;
}

}  // namespace

ReproduceSummary reproduce(const ReproduceRequest& request) {
  const auto start = std::chrono::steady_clock::now();
  noteInterrupts();
  const ReproduceEffort effort = request.quick ? kQuick : ReproduceEffort{};
  const std::vector<unsigned> threads = threadCounts();
  ReproduceScene lion = request.scan ? scanScene(*request.scan) : statueScene();
  OutputFolder output(request.out);  // before the work, should it be impossible

  Progress search("finding apertures", "frames", kSearchFrames);
  std::size_t searched = 0;
  chooseApertures(lion, [&] {
    throwIfInterrupted();
    if (++searched < kSearchFrames) search.advance(searched);
  });
  search.advance(kSearchFrames);
  const ReproduceScene plane = planeScene();
  const SurfelCloud gallery = makeGallery();

  const std::size_t figure1_frames = 3 * (1 + static_cast<std::size_t>(effort.figure1_views));
  const std::size_t growth_frames = request.quick ? 0 : 2 * kApertures * (1 + kGrowthRuns);
  Progress progress("drawing", "frames",
                    framesToMeasure(plane, effort, threads) +
                        framesToMeasure(lion, effort, threads) + figure1_frames + growth_frames);
  std::size_t done = 0;
  const auto onFrames = [&](std::size_t frames) {
    throwIfInterrupted();
    progress.advance(done += frames);
  };

  ReproduceFacts facts{.effort = effort, .threads = threads};
  ReproduceSummary summary{.out = request.out};
  const SceneResult plane_result = measureScene(plane, effort, threads, onFrames);
  const SceneResult lion_result = measureScene(lion, effort, threads, onFrames);
  for (const auto& [scene, result] : {std::pair{&plane, &plane_result}, {&lion, &lion_result}}) {
    facts.scenes.push_back({*scene, *result, figure6(*scene, *result)});
    summary.rows.insert(summary.rows.end(), result->rows.begin(), result->rows.end());
    const auto ratios = ratiosOf(result->rows, scene == &plane);
    facts.ratios.insert(facts.ratios.end(), ratios.begin(), ratios.end());
    writeBytes(output.stage("figure6_" + scene->name + ".png"),
               pngOf(gridOf(imagesOf(facts.scenes.back().figure6),
                            {kOurs, "reference", "difference x " + decimal(kDifferenceGain, 0)})));
  }
  facts.figure1 = drawFigure1(gallery, effort.figure1_views, onFrames);
  writeBytes(
      output.stage("figure1.png"),
      pngOf(gridOf(imagesOf({facts.figure1}), {"mask in focus", "in between", "bust in focus"})));
  if (!request.quick) {
    facts.growth = measureGrowth(kManySurfels, [&] { onFrames(1); });
    const auto ratios = ratiosOf(*facts.growth);
    facts.ratios.insert(facts.ratios.end(), ratios.begin(), ratios.end());
  }

  writeText(output.stage("table1.csv"), csvOf(summary.rows));
  summary.ratios = facts.ratios;
  summary.growth = facts.growth;
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  facts.seconds = summary.seconds;
  writeReproducePage(output.stage("reproduce.html"), facts);
  output.commit();
  return summary;
}

namespace {

using Json = nlohmann::ordered_json;

std::string json(const ReproduceSummary& summary) {
  Json ratios = Json::array();
  for (const ReproduceRatio& one : summary.ratios) {
    ratios.push_back({{"figure", one.key},
                      {"scene", one.scene},
                      {"value", jsonNumber(one.value)},
                      {one.at_most ? "at_most" : "at_least", one.wanted},
                      {"reached", one.reached()}});
  }
  Json rows = Json::array();
  for (const ReproduceRow& row : summary.rows) {
    Json one = {{"scene", row.scene},
                {"aperture", row.aperture_m},
                {"method", row.method},
                {"threads", row.threads},
                {"kfragments", row.kfragments},
                {"ms_median", row.ms_median},
                {"psnr_dB", jsonNumber(row.psnr_dB)}};
    rows.push_back(std::move(one));
  }
  Json all = {{"out", summary.out.string()},
              {"seconds", summary.seconds},
              {"ratios", ratios},
              {"rows", rows}};
  if (summary.growth) {
    for (const Growth::Size& size : {summary.growth->before, summary.growth->after}) {
      all["growth"].push_back({{"surfels", size.surfels},
                               {"build_s", size.build_s},
                               {"bytes_per_surfel", size.bytes_per_surfel},
                               {"ms_median", size.ms_median}});
    }
  }
  return all.dump(-1, ' ', false, Json::error_handler_t::replace);
}

struct Options {
  std::string out;
  ScanOptions scan;
  bool quick = false, json = false;
};

void run(const Options& options) {
  if (options.out.empty()) throw InputError("--out", "expected a value that is not empty");
  const auto limit = threadLimit(options.scan);
  const ReproduceRequest request{
      .out = options.out, .scan = scanViewOf(options.scan), .quick = options.quick};
  const ReproduceSummary summary = reproduce(request);
  if (options.json) {
    std::puts(json(summary).c_str());
    return;
  }
  for (const ReproduceRatio& one : summary.ratios) {
    std::printf("%-7s %s: %s, wanted %s %g%s\n", one.scene.c_str(), one.what.c_str(),
                std::isfinite(one.value) ? decimal(one.value, one.digits).c_str() : "exact",
                one.at_most ? "at most" : "at least", one.wanted,
                one.reached() ? "" : ": not reached");
  }
  std::printf("%.0f s; page: %s\n", summary.seconds, (summary.out / "reproduce.html").c_str());
}

}  // namespace

void addReproduceCommand(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  CLI::App* reproduce = app.add_subcommand(
      "reproduce",
      "Measure the paper again: its Table 1, Figure 1 and Figure 6, in under ten minutes and with\n"
      "2 GB of memory.\n"
      "Example: foci reproduce --out out/paper");
  reproduce->add_option("--out", options->out, "folder of the results")
      ->type_name("DIR")
      ->required();
  reproduce->add_flag("--quick", options->quick,
                      "fewer repetitions, a coarse reference, no 10 million surfels: in a minute");
  addScanOptions(*reproduce, options->scan);
  reproduce->add_flag("--json", options->json, "print the ratios as JSON");
  reproduce->callback([options] { run(*options); });
}

}  // namespace foci
