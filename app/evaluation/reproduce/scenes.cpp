#include "app/evaluation/reproduce/reproduce.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr int kTable_px = 512;
constexpr std::array<double, kApertures> kPlaneApertures_m{0.0, 0.5, 2.0};

/// Root mean square of the blur radius that the paper's counts imply (formulas.md, 7).
constexpr double kFirstBlur_px = 3.5;
constexpr double kFragmentsWithin = 0.005;  // chosen by eye
constexpr int kMaxSteps = 12;               // chosen by eye

constexpr std::array<PaperRow, 5> kPaperPlane{{{0, "0", false, 5685, 262144, 0.76},
                                               {1, "0.5", true, 8521, 178696, 0.97},
                                               {2, "2", true, 7246, 54385, 0.75},
                                               {1, "0.5", false, 17630, 262144, 1.79},
                                               {2, "2", false, 196752, 262144, 20.2}}};
constexpr std::array<PaperRow, 5> kPaperLion{{{0, "0", false, 2266, 81458, 0.43},
                                              {1, "0.01", true, 4036, 53629, 0.56},
                                              {2, "0.04", true, 5318, 17271, 0.56},
                                              {1, "0.01", false, 7771, 81458, 0.91},
                                              {2, "0.04", false, 90219, 81458, 8.93}}};

ReproduceScene lionScene(SceneInView seen) { return {{std::move(seen)}, {}, kPaperLion, 83.0}; }

/// The aperture that blurs the image as the paper's small aperture did.
double firstAperture_m(const ReproduceScene& scene) {
  double sum_D2 = 0.0;
  const std::vector<float> depths_m = scene.depthsInView_m();
  for (const float depth_m : depths_m) {
    const double defocus_D = 1.0 / depth_m - scene.settings.defocus.focus_D;
    sum_D2 += defocus_D * defocus_D / static_cast<double>(depths_m.size());
  }
  return 2.0 * kFirstBlur_px / (scene.view.focal_px.x * std::sqrt(sum_D2));
}

}  // namespace

ReproduceScene planeScene(int samples) {
  return {{planeInView(samples, kTable_px)}, kPlaneApertures_m, kPaperPlane, 147.0};
}

ReproduceScene statueScene() { return lionScene(statueInView(kTable_px)); }

ReproduceScene scanScene(const ScanView& scan) {
  return lionScene(surfacesInView(scan, kTable_px));
}

void chooseApertures(ReproduceScene& scene, const std::function<void()>& on_frame) {
  const auto paper = makeMethod("paper", scene.scene);
  Frame frame;
  const auto fragmentsAt = [&](std::size_t aperture) {
    const auto stats = paper->render(scene.view, scene.settingsAt(aperture), frame);
    on_frame();
    return static_cast<double>(stats.fragments);
  };
  const auto counted = [&](std::size_t aperture) {
    const auto row = std::ranges::find_if(
        scene.paper, [&](const PaperRow& one) { return one.aperture == aperture && !one.lod; });
    return row->kfragments;
  };

  double aperture_m = firstAperture_m(scene);
  scene.apertures_m = {};
  const double sharp = fragmentsAt(0);
  for (const std::size_t aperture : {std::size_t{1}, std::size_t{2}}) {
    const double wanted = sharp * counted(aperture) / counted(0);
    for (int step = 0;; ++step) {
      scene.apertures_m[aperture] = aperture_m;
      const double fragments = std::isfinite(aperture_m) ? fragmentsAt(aperture) : 0.0;
      if (std::abs(fragments / wanted - 1.0) < kFragmentsWithin) break;
      if (step == kMaxSteps || !(fragments > sharp)) {
        throw InputError(scene.name, "no aperture blurs it so that fragments grow " +
                                         decimal(counted(aperture) / counted(0), 1) + " times");
      }
      aperture_m *= std::sqrt((wanted - sharp) / (fragments - sharp));
    }
    aperture_m *= 4.0;  // the ratio of the paper's two apertures
  }
}

}  // namespace foci
