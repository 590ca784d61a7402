#include "app/evaluation/reproduce/figures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/text.h"
#include "render/image/metrics.h"
#include "render/methods/method.h"
#include "render/optics/view.h"
#include "render/scene/builtin/procedural.h"

namespace foci {
namespace {

constexpr int kFigure_px = 512;
constexpr double kLens_m = 0.03;  // chosen by eye: blurs by about a tenth of a face

std::string figureDb(double value) {
  return std::isfinite(value) ? decimal(value, 1) + " dB" : "exact";
}

}  // namespace

std::vector<FigurePanel> figure1(const SurfelCloud& gallery, int views,
                                 const std::function<void(std::size_t)>& on_frames) {
  const View view = maskView(kFigure_px);
  const auto ours = makeMethod(kOurs, gallery);
  const auto reference = makeMethod("accumulate:" + std::to_string(views), gallery);
  const double mask_m = galleryDepth_m(view, "mask"), bust_m = galleryDepth_m(view, "bust");
  // Between the two in dioptres, where both have the same blur.
  const std::array<double, 3> focus_D = {1.0 / mask_m, 0.5 / mask_m + 0.5 / bust_m, 1.0 / bust_m};
  const std::array<const char*, 3> names = {"the mask in focus", "between the two",
                                            "the bust in focus"};
  std::vector<FigurePanel> panels;
  for (std::size_t i = 0; i < focus_D.size(); ++i) {
    RenderSettings settings;
    settings.defocus = defocusOfLens(kLens_m, view.focal_px, focus_D[i], DistanceAlong::axis);
    Frame frame, exact;
    ours->render(view, settings, frame);
    reference->render(view, settings, exact);
    on_frames(1 + static_cast<std::size_t>(views));
    panels.push_back({imageOf(frame), std::string(names[i]) + ", " + decimal(1.0 / focus_D[i], 2) +
                                          " m; " + figureDb(psnr_dB(frame, exact)) +
                                          " against the reference"});
  }
  return panels;
}

std::vector<std::vector<FigurePanel>> figure6(const ReproduceScene& scene,
                                              const SceneResult& result) {
  std::vector<std::vector<FigurePanel>> rows;
  for (std::size_t aperture = 0; aperture < kApertures; ++aperture) {
    const Frame& ours = result.frames.at(kOurs)[aperture];
    const ReproduceReference& reference = result.reference[aperture];
    const auto row = std::find_if(
        result.rows.begin(), result.rows.end(),
        [&](const ReproduceRow& one) { return one.method == kOurs && one.aperture == aperture; });
    const std::string blur = "aperture " + decimal(scene.apertures_m[aperture], 3) +
                             " m, blur radius up to " + decimal(row->blur_px_max, 1) + " px";
    const std::string views =
        aperture == 0 ? std::string("one view")
                      : std::to_string(reference.views) + " views, one half against the other " +
                            figureDb(reference.split_half_psnr_dB.value_or(INFINITY));
    rows.push_back(
        {{imageOf(ours), std::string(kOurs) + ": " + blur},
         {imageOf(reference.frame), "reference: " + views},
         {differenceOf(ours, reference.frame, kDifferenceGain),
          "difference times " + decimal(kDifferenceGain, 0) + ": PSNR " + figureDb(row->psnr_dB)}});
  }
  return rows;
}

}  // namespace foci
