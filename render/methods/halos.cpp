#include "render/methods/halos.h"

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "render/gl/image.h"

namespace foci {
namespace {

/// Gaussians are applied at a scale where they are at least this wide, in samples.
constexpr double kLeastSigma = 2.5;

/// The image, spread by a Gaussian. Wide ones at a fraction of the resolution.
cv::Mat spread(const cv::Mat& image, double sigma_px) {
  int step = 1;
  while (sigma_px >= 2.0 * step * kLeastSigma) step *= 2;
  cv::Mat wide;
  if (step == 1) {
    cv::GaussianBlur(image, wide, {}, sigma_px, sigma_px, cv::BORDER_REPLICATE);
    return wide;
  }
  const cv::Size blocks((image.cols + step - 1) / step, (image.rows + step - 1) / step);
  cv::copyMakeBorder(image, wide, 0, blocks.height * step - image.rows, 0,
                     blocks.width * step - image.cols, cv::BORDER_REPLICATE);
  const cv::Size whole = wide.size();
  cv::resize(wide, wide, blocks, 0.0, 0.0, cv::INTER_AREA);
  // The means of blocks and the linear steps between them have the variances (step^2 - 1) / 12 and
  // step^2 / 6.
  const double sampling_px2 = (step * step - 1) / 12.0 + step * step / 6.0;
  const double sigma = std::sqrt(sigma_px * sigma_px - sampling_px2) / step;
  cv::GaussianBlur(wide, wide, {}, sigma, sigma, cv::BORDER_REPLICATE);
  cv::resize(wide, wide, whole, 0.0, 0.0, cv::INTER_LINEAR);
  return wide(cv::Rect(0, 0, image.cols, image.rows));
}

}  // namespace

void spreadIntoHalos(float diffraction_px, Frame& frame) {
  const DiffractionHalo halo = diffractionHalo(diffraction_px);
  if (halo.inHalos() == 0.0f) return;
  readFromGpu(frame);
  cv::Mat light(frame.size_px.y, frame.size_px.x, CV_32FC4, frame.rgba.data());
  const cv::Mat core = light.clone();
  light *= 1.0f - halo.inHalos();
  for (std::size_t i = 0; i < halo.halo_px.size(); ++i) {
    // The core is blurred already.
    const double sigma_px =
        std::sqrt(halo.halo_px[i] * halo.halo_px[i] - halo.core_px * halo.core_px);
    cv::scaleAdd(spread(core, sigma_px), halo.halo_share[i], light, light);
  }
}

}  // namespace foci
