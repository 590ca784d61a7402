#include "render/methods/auto_ways.h"

#include <algorithm>
#include <cassert>

namespace foci {
namespace {

/// Beyond this nodes beside the gaze no longer close surfaces.
constexpr float kLoosestAcuity = 2.0f;

CutSettings looser(float times) {
  return {.per_blur2 = times * kFaithfulCut.per_blur2,
          .per_pixel2 = times * kFaithfulCut.per_pixel2,
          .per_acuity2 = std::min(times, kLoosestAcuity) * kFaithfulCut.per_acuity2};
}

CutSettings softer(float times, float pixel_px) {
  CutSettings cut = looser(times);
  cut.per_acuity2 = cut.per_pixel2;
  cut.acuity.base_px = pixel_px;
  return cut;
}

/// Errors are the largest against the accumulated reference on the scenes of the chart,
/// `visible_error` of
///     foci chart --method auto:1 --method auto:2 ... --method auto:8 --out DIR
/// with 512 px and with `--size 256`, with `--quick` for 16 px, and of a scan of a lion; up to 4 px
/// with reserve, as images of 96 px err by half as much again, parts of the lens of a fence by
/// more. Beyond 40 px, and where the blur is wider than a fifth of the image, they may err by
/// more.
const std::array<Way, kNumbers> kAll{
    Way{{looser(2.0f), 1}, {0.4f, 0.8f, 6.0f, 12.0f, 13.0f, 16.0f}, true},
    Way{{looser(10.0f), 1}, {1.9f, 2.3f, 1.9f, 1.9f, 2.2f, 3.2f}},
    Way{{looser(3.0f), 1}, {0.8f, 0.8f, 0.8f, 1.8f, 2.1f, 2.6f}},
    Way{{looser(3.0f), 7}, {0.8f, 0.8f, 0.7f, 0.7f, 0.8f, 1.1f}},
    Way{{looser(1.0f), 7}, {0.2f, 0.3f, 0.5f, 0.6f, 0.6f, 0.9f}},
    Way{{looser(1.0f), 1}, {0.5f, 0.5f, 4.0f, 5.7f, 5.8f, 6.2f}},
    Way{{softer(30.0f, 6.0f), 1}, {14.7f, 14.7f, 13.2f, 12.8f, 12.7f, 12.7f}},
    Way{{softer(30.0f, 12.0f), 1}, {16.2f, 16.2f, 15.0f, 13.6f, 13.1f, 13.0f}}};

/// Its errors are such that with what ways are apart from it by, each squared, they bound those of
/// the ways on the same scenes: from 4 px on, where squares are rendered.
const Way kFinest{{looser(0.25f), 19}, {0.2f, 0.3f, 0.45f, 0.45f, 0.75f, 0.8f}};

}  // namespace

float Way::error(float blur_px) const {
  assert(blur_px >= 0.0f);
  const auto above = std::upper_bound(kBlurs_px.begin(), kBlurs_px.end(), blur_px);
  if (above == kBlurs_px.end()) return error_at.back() * blur_px / kBlurs_px.back();
  const auto i = static_cast<std::size_t>(above - kBlurs_px.begin());
  const float t = (blur_px - kBlurs_px[i - 1]) / (kBlurs_px[i] - kBlurs_px[i - 1]);
  return error_at[i - 1] + t * (error_at[i] - error_at[i - 1]);
}

const Way& wayNumbered(std::size_t i) { return kAll[i]; }

const Way& finestWay() { return kFinest; }

}  // namespace foci
