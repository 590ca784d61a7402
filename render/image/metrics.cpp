#include "render/image/metrics.h"

#include <cassert>
#include <cmath>

namespace foci {

double psnr_dB(const Frame& a, const Frame& b) {
  assert(a.size_px == b.size_px);
  double sum = 0.0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    const glm::dvec3 difference = glm::dvec3(a.rgba[i]) - glm::dvec3(b.rgba[i]);
    sum += glm::dot(difference, difference);
  }
  return -10.0 * std::log10(sum / (3.0 * static_cast<double>(a.rgba.size())));
}

}  // namespace foci
