#include "app/evaluation/chart/scores.h"

#include <array>
#include <functional>
#include <numeric>

#include "base/parallel.h"
#include "base/quantile.h"
#include "render/image/flip.h"
#include "render/image/metrics.h"

namespace foci {

Compared comparedWith(const Frame& reference, const Frame& pinhole, const Defocus& lens) {
  return {.reference = &reference,
          .lab = labOf(reference, kUsualPx_per_deg),
          .band = silhouetteBand(pinhole, lens)};
}

ChartErrors scoresOf(const Frame& frame, const Compared& with) {
  constexpr double kShareOfPixels = 0.95;  // as `Quality::tolerance` counts errors
  const Frame& reference = *with.reference;
  ChartErrors errors;
  const std::array<std::function<void()>, 4> tasks{
      [&] {
        auto visible = visibleDifference(frame, with.lab, kUsualPx_per_deg);
        errors.visible_error = quantile(visible, kShareOfPixels);
      },
      [&] { errors.ssim = ssim(frame, reference); },
      [&] {
        errors.psnr_dB = psnr_dB(frame, reference);
        errors.silhouette_psnr_dB = silhouettePsnr_dB(frame, reference, with.band);
        errors.coverage_error = coverageError(frame, reference);
      },
      [&] {
        const std::vector<float> flip = flipOf(frame, reference, kUsualPx_per_deg);
        errors.flip =
            std::accumulate(flip.begin(), flip.end(), 0.0) / static_cast<double>(flip.size());
      }};
  parallelFor(tasks.size(), [&](std::size_t i) { tasks.at(i)(); });
  return errors;
}

}  // namespace foci
