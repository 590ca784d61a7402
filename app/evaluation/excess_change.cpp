#include "app/evaluation/excess_change.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "base/quantile.h"
#include "render/image/metrics.h"

namespace foci {
namespace {

constexpr double kShareOfPixels = 0.999;  // whose change a score bounds; chosen by eye

}  // namespace

FrameInLab::FrameInLab(Frame rendered)
    : frame(std::move(rendered)), lab(labOf(frame, kUsualPx_per_deg)) {}

ExcessChange excessChange(const FrameInLab& from, const FrameInLab& to,
                          const FrameInLab& exact_from, const FrameInLab& exact_to) {
  const std::size_t pixels = to.frame.rgba.size();
  assert(from.lab.size() == pixels && exact_from.lab.size() == pixels &&
         exact_to.lab.size() == pixels);
  std::vector<float> light(pixels), jnd(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const glm::vec4 beyond = glm::abs((to.frame.rgba[i] - from.frame.rgba[i]) -
                                      (exact_to.frame.rgba[i] - exact_from.frame.rgba[i]));
    light[i] = std::max({beyond.r, beyond.g, beyond.b});
    jnd[i] = glm::distance(to.lab[i] - from.lab[i], exact_to.lab[i] - exact_from.lab[i]) /
             kJustNoticeable;
  }
  return {.light = quantile(light, kShareOfPixels), .jnd = quantile(jnd, kShareOfPixels)};
}

Frame minus(Frame frame, const Frame& without) {
  assert(frame.rgba.size() == without.rgba.size());
  for (std::size_t i = 0; i < frame.rgba.size(); ++i) frame.rgba[i] -= without.rgba[i];
  return frame;
}

}  // namespace foci
