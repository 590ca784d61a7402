#include "render/methods/gaussian_eye_method.h"

#include <cassert>
#include <cmath>
#include <vector>

#include "render/gl/image.h"
#include "render/image/filter.h"

namespace foci {

RenderStats GaussianEyeMethod::renderFrame(const View& view, const RenderSettings& settings,
                                           Frame& frame) {
  const RenderStats stats = renderGeometry(view, settings, frame);
  const double sigma_px = diffractionThroughPixel_px(settings.pupil.diffraction_px);
  if (sigma_px > 0.0) {
    readFromGpu(frame);
    spreadLight(frame, sigma_px * sigma_px);
  }
  return stats;
}

void spreadLight(Frame& frame, double variance_px2) {
  assert(variance_px2 > 0.0);
  const int reach = 1 + static_cast<int>(std::ceil(5.0 * std::sqrt(variance_px2)));
  std::vector<float> kernel;
  for (int i = 0; i <= reach; ++i) {
    kernel.push_back(
        static_cast<float>(std::exp(-variance_px2) * std::cyl_bessel_i(i, variance_px2)));
  }
  filterSeparably(frame.rgba, frame.size_px, kernel, ImageBorder::replicate);
}

}  // namespace foci
