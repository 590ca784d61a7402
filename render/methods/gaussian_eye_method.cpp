#include "render/methods/gaussian_eye_method.h"

#include <cassert>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "render/gl/image.h"

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
  kernel.reserve(2 * static_cast<std::size_t>(reach) + 1);
  for (int i = -reach; i <= reach; ++i) {
    kernel.push_back(
        static_cast<float>(std::exp(-variance_px2) * std::cyl_bessel_i(std::abs(i), variance_px2)));
  }
  cv::Mat light(frame.size_px.y, frame.size_px.x, CV_32FC4, frame.rgba.data());
  cv::sepFilter2D(light, light, -1, kernel, kernel, {-1, -1}, 0.0, cv::BORDER_REPLICATE);
}

}  // namespace foci
