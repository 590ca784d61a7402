// The gallery, and the garden of Gaussians, on a GPU: the time of each stage of a frame. One
// program without OpenCV, windows and scene files, so that it can be carried to a machine with a
// GPU:
//     foci_gpu_bench [WIDTHxHEIGHT [SURFEL_STEP_PX [FRAMES]]]
// Focus moves from 0.3 to 2 m and back, through a pupil of 4 mm; full quality (`sweep-lod:7`, of
// Gaussians `sweep:7`). The garden is rendered without blur, too. The CPU renders the first frame
// of each scene, and the line `same` says how far both pictures lie apart.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <vector>

#include "render/gaussians/gaussian_view.h"
#include "render/gl/gaussians.h"
#include "render/gl/splats.h"
#include "render/lod/cut.h"
#include "render/methods/lens_samples.h"
#include "render/scene/builtin/procedural.h"
#include "render/splat/bin.h"
#include "render/splat/project.h"
#include "render/splat/sweep.h"

namespace foci {
namespace {

double at(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void printTimes(const char* what, const std::vector<double>& ms) {
  std::printf("%-10s median %8.3f  min %8.3f  95 %% %8.3f ms\n", what, at(ms, 0.5), at(ms, 0.0),
              at(ms, 0.95));
}

double psnrOf(const Frame& a, const Frame& b) {
  double sum = 0.0;
  for (std::size_t p = 0; p < a.rgba.size(); ++p) {
    const glm::vec3 apart = glm::vec3(a.rgba[p]) - glm::vec3(b.rgba[p]);
    sum += static_cast<double>(glm::dot(apart, apart));
  }
  return -10.0 * std::log10(sum / (3.0 * static_cast<double>(a.rgba.size())) + 1e-30);
}

/// Near and far focus, D.
constexpr double kNear_D = 1.0 / 0.3, kFar_D = 0.5;

/// The eye before its screen.
View viewFrom(const EyePose& pose, const glm::ivec2& size_px) {
  return viewThroughScreen(eyeFromWorld(pose.position_m, pose.target_m, pose.up), size_px,
                           {0.508, 0.28575}, 0.6);
}

Defocus focusAt(const View& view, double focus_D) {
  return defocusOfLens(0.004, view.focal_px, focus_D, DistanceAlong::sight);
}

/// Renders frames while focus moves from near to far and back, and prints their times.
/// @param render  a frame with this focus, D
void time(int frames, const std::function<GpuStats(double focus_D)>& render, Frame& frame) {
  const auto since = [](std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
        .count();
  };
  std::vector<double> all, rendered, device, stages[kGpuStages.size()];
  for (int i = 0; i < frames; ++i) {
    std::fprintf(stderr, "\rframe %d of %d", i + 1, frames);
    const double t = 0.5 - 0.5 * std::cos(6.2831853 * i / frames);
    const auto start = std::chrono::steady_clock::now();
    const GpuStats stats = render(kNear_D + t * (kFar_D - kNear_D));
    rendered.push_back(since(start));
    readFromGpu(frame);
    all.push_back(since(start));
    double sum = 0.0;
    for (std::size_t stage = 0; stage < kGpuStages.size(); ++stage) {
      stages[stage].push_back(stats.times.stage_ms.at(stage));
      sum += stats.times.stage_ms.at(stage);
    }
    device.push_back(sum);
  }
  std::fputc('\n', stderr);
  for (std::size_t stage = 0; stage < kGpuStages.size(); ++stage) {
    printTimes(kGpuStages.at(stage).data(), stages[stage]);
  }
  printTimes("device", device);
  printTimes("with host", rendered);
  printTimes("with read", all);
}

/// As `LodSplats` does it.
void renderOnCpu(const MomentTree& tree, const GpuRequest& request, Frame& frame) {
  constexpr int kMargin_px = kApron * kMaxStep_px;
  CutSettings settings = *request.cut;
  settings.margin_px = kMargin_px;
  Cut cut;
  SplatChunks chunks;
  TileLists lists;
  selectCut(tree, request.view, request.defocus, settings, cut);
  const auto number = static_cast<float>(request.sub_aperture_centres.size());
  projectCut(tree, cut, request.view, request.defocus,
             {.sub_aperture = 1.0f / std::sqrt(number), .margin_px = kMargin_px}, chunks);
  lists.build(chunks, request.view.size_px, true);
  const SubApertures sub_apertures{.splats = chunks.sub_aperture_splats.get(),
                                   .out_of_focus_D = chunks.out_of_focus_D.get(),
                                   .out_across_D = nullptr,
                                   .lens_px = nullptr,
                                   .centres = request.sub_aperture_centres};
  sweep(chunks, lists,
        {.background = request.lighting.background,
         .defocus = request.defocus,
         .sub_apertures = &sub_apertures},
        frame);
}

void timeGallery(const std::shared_ptr<GpuDevice>& gpu, const glm::ivec2& size_px, float step_px,
                 int frames) {
  const SurfelCloud cloud = makeGallery(step_px);
  std::printf("\nscene      gallery, %zu surfels; %d x %d px; %d frames\n", cloud.size(), size_px.x,
              size_px.y, frames);
  const View view = viewFrom(galleryEyePose(), size_px);
  const MomentTree tree(cloud);
  GpuSplats splats(std::make_shared<GpuScene>(gpu, tree));
  const auto requestAt = [&](double focus_D) {
    return GpuRequest{.view = view,
                      .defocus = focusAt(view, focus_D),
                      .cut = kFaithfulCut,
                      .sub_aperture_centres = subApertureCentres(7)};
  };
  Frame frame, by_cpu;
  frame.resize(size_px);
  by_cpu.resize(size_px);
  for (int i = 0; i < 3; ++i) splats.render(requestAt(kNear_D), frame.gpu);  // compiles shaders
  readFromGpu(frame);
  renderOnCpu(tree, requestAt(kNear_D), by_cpu);
  std::printf("same       %.1f dB\n", psnrOf(frame, by_cpu));
  time(
      frames, [&](double focus_D) { return splats.render(requestAt(focus_D), frame.gpu); }, frame);
}

void timeGarden(const std::shared_ptr<GpuDevice>& gpu, const glm::ivec2& size_px, int discs_count,
                int frames) {
  const GaussianCloud gaussians = makeGarden();
  std::printf("\nscene      garden, %zu Gaussians; %d sub-apertures; %d x %d px; %d frames\n",
              gaussians.size(), discs_count, size_px.x, size_px.y, frames);
  const View view = viewFrom(gardenEyePose(), size_px);
  std::vector<LensDisc> discs;
  for (const glm::vec2& centre : subApertureCentres(discs_count)) discs.push_back({centre, 0.0f});
  const auto sizes = subApertureSizes(discs);
  GpuGaussians on_gpu(std::make_shared<GpuGaussianScene>(gpu, gaussians));
  Frame frame, by_cpu;
  frame.resize(size_px);
  by_cpu.resize(size_px);
  const auto render = [&](double focus_D) {
    GpuStats stats = on_gpu.project(view, focusAt(view, focus_D), sizes, nullptr);
    const GpuStats composited = on_gpu.render(discs, {}, frame.gpu);
    for (std::size_t stage = 0; stage < kGpuStages.size(); ++stage) {
      stats.times.stage_ms.at(stage) += composited.times.stage_ms.at(stage);
    }
    return stats;
  };
  for (int i = 0; i < 3; ++i) render(kNear_D);
  readFromGpu(frame);
  GaussianView on_cpu(gaussians);
  on_cpu.project(view, focusAt(view, kNear_D), discs);
  on_cpu.render(discs, glm::vec3(0.0f), by_cpu);
  std::printf("same       %.1f dB\n", psnrOf(frame, by_cpu));
  time(frames, render, frame);
}

int run(int argc, char** argv) {
  glm::ivec2 size_px{1920, 1080};
  if (argc > 1 && std::sscanf(argv[1], "%dx%d", &size_px.x, &size_px.y) != 2) return 2;
  const float step_px = argc > 2 ? std::strtof(argv[2], nullptr) : 0.9f;
  const int frames = argc > 3 ? std::max(std::atoi(argv[3]), 1) : 100;
  const auto gpu = GpuDevice::open(GpuDevice::Kind::any);
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // a line is seen at once, in a file, too
  std::printf("device     %s%s\n", gpu->text().c_str(), gpu->isSoftware() ? " (software)" : "");
  timeGallery(gpu, size_px, step_px, frames);
  for (const int discs : {1, 7}) timeGarden(gpu, size_px, discs, frames);
  return 0;
}

}  // namespace
}  // namespace foci

int main(int argc, char** argv) {
  try {
    return foci::run(argc, argv);
  } catch (const foci::GpuError& error) {
    std::fprintf(stderr, "foci_gpu_bench: %s\n", error.what());
    return 2;
  }
}
