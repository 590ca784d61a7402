#include "app/evaluation/reproduce/reproduce.h"

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>

#include "app/evaluation/reproduce/page.h"
#include "app/evaluation/timed_runs.h"
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

}  // namespace

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

ReproduceSummary reproduce(const ReproduceRequest& request) {
  const auto start = std::chrono::steady_clock::now();
  const ReproduceEffort effort = request.quick ? kQuick : ReproduceEffort{};
  const std::vector<unsigned> threads = threadCounts();
  ReproduceScene lion = request.scan ? scanScene(*request.scan) : statueScene();
  OutputFolder output(request.out,
                      request.guard);  // before the work, so that a bad folder is reported at once

  findApertures(lion);
  const ReproduceScene plane = planeScene();
  const SurfelCloud gallery = makeGallery();

  Progress progress("rendering", "frames",
                    framesToRender(plane, lion, effort, threads, request.quick));
  std::size_t done = 0;
  const auto onFrames = [&](std::size_t frames) { progress.advance(done += frames); };

  ReproduceFacts facts{.effort = effort, .threads = threads, .quick = request.quick};
  ReproduceSummary summary{.out = request.out, .quick = request.quick};
  const SceneResult plane_result = measureScene(plane, effort, threads, onFrames);
  const SceneResult lion_result = measureScene(lion, effort, threads, onFrames);
  for (const auto& [scene, result] : {std::pair{&plane, &plane_result}, {&lion, &lion_result}}) {
    facts.scenes.push_back({*scene, *result, figure6(*scene, *result)});
    summary.rows.insert(summary.rows.end(), result->rows.begin(), result->rows.end());
    const auto ratios = ratiosOf(result->rows, scene == &plane);
    facts.ratios.insert(facts.ratios.end(), ratios.begin(), ratios.end());
    output.write(
        kFigure6 + scene->name + ".png",
        pngOf(gridOf(imagesOf(facts.scenes.back().figure6),
                     {kOurs, "reference", "difference x " + decimal(kDifferenceGain, 0)})));
  }
  facts.figure1 = figure1(gallery, effort.figure1_views, onFrames);
  output.write(kFigure1, pngOf(gridOf(imagesOf({facts.figure1}),
                                      {"mask in focus", "between the two", "bust in focus"})));
  if (!request.quick) {
    facts.growth = measureGrowth(kManySurfels, [&] { onFrames(1); });
    const auto ratios = ratiosOf(*facts.growth);
    facts.ratios.insert(facts.ratios.end(), ratios.begin(), ratios.end());
  }

  output.write(kTable, csvOf(summary.rows));
  summary.ratios = facts.ratios;
  summary.growth = facts.growth;
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  facts.seconds = summary.seconds;
  output.write(kPage, reproducePage(facts));
  output.commit();
  return summary;
}

}  // namespace foci
