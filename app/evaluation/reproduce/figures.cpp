#include "app/evaluation/reproduce/figures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "app/record/tables.h"
#include "base/text.h"
#include "render/image/metrics.h"
#include "render/methods/method.h"
#include "render/optics/view.h"
#include "render/scene/builtin/procedural.h"

namespace foci {
namespace {

constexpr int kSize_px = 512;
constexpr double kLens_m = 0.03;  // what is out of focus blurs to about a tenth of a face

std::string dB(double value) { return std::isfinite(value) ? decimal(value, 1) + " dB" : "exact"; }

}  // namespace

std::vector<FigurePanel> drawFigure1(const SurfelCloud& gallery, int views,
                                     const std::function<void(std::size_t)>& on_frames) {
  const View view = maskView(kSize_px);
  const auto ours = makeMethod(kOurs, gallery);
  const auto reference = makeMethod("accumulate:" + std::to_string(views), gallery);
  const double mask_m = galleryDepth_m(view, "mask"), bust_m = galleryDepth_m(view, "bust");
  // In between in dioptres, where both are blurred alike.
  const std::array<double, 3> focus_D = {1.0 / mask_m, 0.5 / mask_m + 0.5 / bust_m, 1.0 / bust_m};
  const std::array<const char*, 3> what = {"the mask in focus", "in between", "the bust in focus"};
  std::vector<FigurePanel> panels;
  for (std::size_t i = 0; i < focus_D.size(); ++i) {
    RenderSettings settings;
    settings.defocus = defocusOfLens(kLens_m, view.focal_px, focus_D[i], DistanceAlong::axis);
    Frame frame, exact;
    ours->render(view, settings, frame);
    reference->render(view, settings, exact);
    on_frames(1 + static_cast<std::size_t>(views));
    panels.push_back({imageOf(frame), std::string(what[i]) + ", " + decimal(1.0 / focus_D[i], 2) +
                                          " m; " + dB(psnr_dB(frame, exact)) +
                                          " from the reference"});
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
                             " m, blur up to " + decimal(row->blur_px_max, 1) + " px";
    const std::string views =
        aperture == 0 ? std::string("one view")
                      : std::to_string(reference.views) + " views, their halves " +
                            dB(reference.split_half_psnr_dB.value_or(INFINITY)) + " apart";
    rows.push_back(
        {{imageOf(ours), std::string(kOurs) + ": " + blur},
         {imageOf(reference.frame), "reference: " + views},
         {differenceOf(ours, reference.frame, kDifferenceGain),
          "difference, " + decimal(kDifferenceGain, 0) + " times: " + dB(row->psnr_dB)}});
  }
  return rows;
}

}  // namespace foci
