#include "app/reproduce_command.h"

#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/base/input_error.h"
#include "app/interrupt.h"
#include "app/output_folder.h"
#include "app/progress.h"
#include "app/reproduce_figures.h"
#include "app/reproduce_page.h"
#include "app/tables.h"

namespace foci {
namespace {

constexpr ReproduceEffort kQuick{
    .runs = 3, .accumulate_runs = 1, .least_views = 64, .most_views = 64, .figure1_views = 32};
constexpr std::size_t kSearchFrames = 10;  // that finding the apertures takes, about
constexpr int kMostThreads = 1024;
constexpr std::size_t kManySurfels = 10'000'000;

std::vector<unsigned> threadCounts() {
  const auto all = static_cast<unsigned>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
  return all > 1 ? std::vector<unsigned>{1, all} : std::vector<unsigned>{1};
}

void writeBytes(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes) {
  writeText(file, std::string(bytes.begin(), bytes.end()));
}

std::vector<std::vector<Picture>> picturesOf(const std::vector<std::vector<FigurePanel>>& rows) {
  std::vector<std::vector<Picture>> pictures;
  for (const auto& row : rows) {
    auto& next = pictures.emplace_back();
    for (const FigurePanel& panel : row) next.push_back(panel.picture);
  }
  return pictures;
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
               pngOf(gridOf(picturesOf(facts.scenes.back().figure6),
                            {kOurs, "reference", "difference x " + decimal(kDifferenceGain, 0)})));
  }
  facts.figure1 = drawFigure1(gallery, effort.figure1_views, onFrames);
  writeBytes(
      output.stage("figure1.png"),
      pngOf(gridOf(picturesOf({facts.figure1}), {"mask in focus", "in between", "bust in focus"})));
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

/// JSON has no infinity.
Json numberOf(double value) { return std::isfinite(value) ? Json(value) : Json("inf"); }

std::string json(const ReproduceSummary& summary) {
  Json ratios = Json::array();
  for (const ReproduceRatio& one : summary.ratios) {
    ratios.push_back({{"figure", one.key},
                      {"scene", one.scene},
                      {"value", numberOf(one.value)},
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
                {"psnr_dB", numberOf(row.psnr_dB)}};
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
  std::string out, scan;
  std::vector<double> eye{-4.4, -1.1, 1.3}, look_at{-2.9, 3.9, -1.2}, up{0.0, 0.0, 1.0};
  std::optional<int> threads;
  bool quick = false, json = false;
};

glm::vec3 vectorOf(const std::vector<double>& xyz) {
  return {static_cast<float>(xyz[0]), static_cast<float>(xyz[1]), static_cast<float>(xyz[2])};
}

ReproduceRequest requestOf(const Options& options) {
  ReproduceRequest request{.out = options.out, .quick = options.quick};
  if (options.out.empty()) throw InputError("--out", "expected a value that is not empty");
  if (options.threads && (*options.threads < 1 || *options.threads > kMostThreads)) {
    throw InputError("--threads " + std::to_string(*options.threads),
                     "expected an integer, 1 to " + std::to_string(kMostThreads));
  }
  if (!options.scan.empty()) {
    const EyePose pose{vectorOf(options.eye), vectorOf(options.look_at), vectorOf(options.up)};
    const glm::vec3 side = glm::cross(pose.target_m - pose.position_m, pose.up);
    if (!(glm::length(side) > 0.0f && std::isfinite(glm::length(side)))) {
      throw InputError("--eye, --look-at, --up", "the line of sight is none, or along up");
    }
    request.scan = ScanView{options.scan, pose};
  }
  return request;
}

void run(const Options& options) {
  const ReproduceRequest request = requestOf(options);
  std::optional<tbb::global_control> limit;
  if (options.threads) {
    limit.emplace(tbb::global_control::max_allowed_parallelism,
                  static_cast<std::size_t>(*options.threads));
  }
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
  reproduce->add_option("--scan", options->scan, "points, mesh or scene instead of the statue")
      ->type_name("FILE");
  const auto pose = [&](const char* name, std::vector<double>& xyz, const char* help) {
    reproduce->add_option(name, xyz, help)->type_name("X,Y,Z")->delimiter(',')->expected(3);
  };
  pose("--eye", options->eye, "from where the scan is seen, metres; default: as configs/lion.toml");
  pose("--look-at", options->look_at, "what of it is in the middle and in focus, metres");
  pose("--up", options->up, "which way is up");
  reproduce->add_flag("--quick", options->quick,
                      "fewer repetitions, a coarse reference, no 10 million surfels: in a minute");
  reproduce->add_option("--threads", options->threads, "at most; measured at 1 and at this")
      ->type_name("N");
  reproduce->add_flag("--json", options->json, "print the ratios as JSON");
  reproduce->callback([options] { run(*options); });
}

}  // namespace foci
