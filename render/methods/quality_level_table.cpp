#include "render/methods/quality_level_table.h"

#include <algorithm>
#include <cassert>

namespace foci {
namespace {

/// Beyond this factor the nodes away from the gaze no longer close surfaces. Bounded by
/// AutoTest.FoveatedIsTheSameAtTheGazeAndCheaperElsewhere.
constexpr float kMaxAcuityFactor = 2.0f;

/// Beyond this factor sharp folds open between nodes; bounded by `ClosedSurfaces`.
constexpr float kMaxPixelFactor = 6.0f;

/// The LOD cut of `sweep-lod`, with `factor` times the variance that merging may add.
CutSettings coarserBy(float factor) {
  return {.per_blur2 = factor * kFaithfulCut.per_blur2,
          .per_pixel2 = std::min(factor, kMaxPixelFactor) * kFaithfulCut.per_pixel2,
          .per_acuity2 = std::min(factor, kMaxAcuityFactor) * kFaithfulCut.per_acuity2};
}

/// The finest levels have the reserve for it; others would let light through at outlines
/// (`ClosedSurfaces`).
CutSettings foreshortened(CutSettings cut) {
  cut.foreshortened = true;
  return cut;
}

/// The same under a low-pass of standard deviation `low_pass_px`, in a whole-aperture pass.
LodSettings softerBy(float factor, float low_pass_px) {
  CutSettings cut = coarserBy(factor);
  cut.per_acuity2 = factor * kFaithfulCut.per_pixel2;
  cut.acuity.base_px = low_pass_px;
  return {cut, 1, low_pass_px};
}

/// Each error is the largest `visible_error` against the accumulated reference, on the scenes of
/// the chart and on a scan of a lion.
///     foci chart --method auto:1 --method auto:2 ... --method auto:8 --out DIR
/// measured them, with 512 px and with `--size 256`. The column of 16 px is from `--quick`. Errors
/// up to 4 px have a reserve, because images of 96 px err by half as much again. Sub-apertures err
/// by more on a fence, and beyond 4 px on a lumpy ball. The soft levels up to 4 px err most on the
/// tilted plane of AutoTest, whose outline grows in a large share of its image. Blur beyond 40 px,
/// and blur wider than a fifth of the image, may exceed the bound.
const std::array<LevelSettings, kQualityLevels> kLevels{
    LevelSettings{{.cut = foreshortened(coarserBy(2.0f)), .sharp = true},
                  {0.4f, 0.8f, 6.0f, 12.0f, 13.0f, 16.0f}},
    LevelSettings{{coarserBy(10.0f), 1}, {1.9f, 2.3f, 1.9f, 1.9f, 2.2f, 3.2f}},
    LevelSettings{{coarserBy(3.0f), 1}, {0.8f, 0.8f, 0.8f, 1.8f, 2.1f, 2.6f}},
    LevelSettings{{coarserBy(3.0f), 7}, {0.8f, 0.8f, 0.7f, 0.75f, 1.0f, 1.5f}},
    LevelSettings{{foreshortened(coarserBy(1.0f)), 7}, {0.2f, 0.4f, 0.55f, 0.8f, 0.9f, 1.2f}},
    LevelSettings{{coarserBy(1.0f), 1}, {0.5f, 0.5f, 4.0f, 5.7f, 5.8f, 6.2f}},
    LevelSettings{softerBy(30.0f, 6.0f), {19.0f, 19.0f, 13.2f, 12.8f, 12.7f, 12.7f}},
    LevelSettings{softerBy(30.0f, 12.0f), {26.0f, 26.0f, 21.5f, 14.5f, 13.1f, 13.0f}},
    LevelSettings{{.cut = kPixelCut}, {0.1f, 0.1f, 0.15f, 0.25f, 0.25f, 0.25f}}};

constexpr std::array<float, kQualityLevels> kRelativeTimes{13.0f, 14.0f, 16.0f, 32.0f, 35.0f,
                                                           1.1f,  3.0f,  1.0f,  420.0f};

}  // namespace

float LevelSettings::error(float blur_px) const {
  assert(blur_px >= 0.0f);
  const auto above = std::upper_bound(kBlurs_px.begin(), kBlurs_px.end(), blur_px);
  if (above == kBlurs_px.end()) return error_at.back() * blur_px / kBlurs_px.back();
  const auto i = static_cast<std::size_t>(above - kBlurs_px.begin());
  const float t = (blur_px - kBlurs_px[i - 1]) / (kBlurs_px[i] - kBlurs_px[i - 1]);
  return error_at[i - 1] + t * (error_at[i] - error_at[i - 1]);
}

const LevelSettings& settingsOf(QualityLevel level) {
  return kLevels[static_cast<std::size_t>(level)];
}

std::span<const float> relativeTimes() { return kRelativeTimes; }

}  // namespace foci
