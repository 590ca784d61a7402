// The default: `sweep-lod` that spends only what shows. Of four ways to draw a frame it takes the
// cheapest whose error, as found beforehand over scenes and blurs, stays within the tolerance;
// `auto:N` is always the N-th.
// Known failure: the error is one of whole pictures by the largest blur in view, so a small part
// that is harder than the rest (foliage) may err by more.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>

#include "render/methods/lod_splats.h"
#include "render/methods/method.h"

namespace foci {
namespace {

/// Largest radii of blur in view, px, at which the errors of the ways were measured.
constexpr std::array<float, 5> kBlurs_px{1.0f, 4.0f, 8.0f, 16.0f, 40.0f};

/// A way to draw. Its error is that of 95 % of the pixels, in just noticeable differences at 40
/// pixels a degree: the largest that was measured against the accumulated reference on the scenes
/// of `foci chart` (256 x 256 pixels) and on a scan. Between the blurs it is interpolated; beyond
/// the last, where nothing was measured, it counts as growing with the blur.
struct Way {
  LodSettings lod;
  std::array<float, kBlurs_px.size()> error_at;

  float error(float blur_px) const {
    const auto above = std::upper_bound(kBlurs_px.begin(), kBlurs_px.end(), blur_px);
    if (above == kBlurs_px.begin()) return error_at.front();
    if (above == kBlurs_px.end()) return error_at.back() * blur_px / kBlurs_px.back();
    const auto i = static_cast<std::size_t>(above - kBlurs_px.begin());
    const float t = (blur_px - kBlurs_px[i - 1]) / (kBlurs_px[i] - kBlurs_px[i - 1]);
    return error_at[i - 1] + t * (error_at[i] - error_at[i - 1]);
  }
};

CutSettings looser(float times) {
  return {.per_blur2 = times * kFaithfulCut.per_blur2,
          .per_pixel2 = times * kFaithfulCut.per_pixel2};
}

/// From the cheapest on.
const std::array<Way, 4> kWays{Way{{looser(10.0f), 1}, {3.1f, 3.1f, 3.2f, 4.6f, 4.6f}},
                               Way{{looser(3.0f), 1}, {0.6f, 1.5f, 1.5f, 2.6f, 4.3f}},
                               Way{{looser(1.0f), 1}, {0.4f, 1.5f, 1.5f, 1.5f, 2.8f}},
                               Way{{looser(1.0f), 7}, {0.3f, 1.5f, 1.5f, 1.5f, 2.5f}}};

/// Where no way stays within the tolerance, it is this much above what the best one can.
constexpr float kAsGood = 1.15f;  // times kMargin, some way still is

/// To come back to a cheaper way its error must be this much below the tolerance, or its time below
/// the budget, for so many frames: what is drawn does not flicker between two ways.
constexpr float kMargin = 0.9f, kTimeMargin = 0.6f;
constexpr int kFramesBelow = 10;

class AutoMethod final : public Method {
 public:
  /// @param number  of the way, from 1; 0: chosen by frame
  AutoMethod(const SurfelCloud& cloud, int number) : scene_(cloud), number_(number) {}

  RenderStats draw(const View& view, const RenderSettings& settings, Frame& frame) override {
    const float blur_px = largestBlur_px(view, settings.defocus);
    const std::size_t chosen = number_ > 0                  ? static_cast<std::size_t>(number_ - 1)
                               : settings.quality.as_before ? drawn_
                                                            : choose(blur_px, settings.quality);
    drawn_ = chosen;
    const Way& way = kWays[chosen];
    LodSettings lod = way.lod;
    lod.cut.acuity = settings.quality.acuity;
    const auto start = std::chrono::steady_clock::now();
    RenderStats stats = scene_.draw(view, settings, lod, frame);
    if (!settings.quality.as_before) {
      last_ms_ = std::chrono::duration<float, std::milli>(std::chrono::steady_clock::now() - start)
                     .count();
    }
    stats.tolerance_error = way.error(blur_px);
    if (settings.quality.frame_ms) stats.drawn_as = "auto:" + std::to_string(chosen + 1);
    return stats;
  }

 private:
  float largestBlur_px(const View& view, const Defocus& defocus) const {
    const auto distances = distancesInView(scene_.tree(), view, defocus);
    if (!distances) return 0.0f;
    const float most_D = std::max(mostDefocus_D(defocus, 1.0f / distances->first),
                                  mostDefocus_D(defocus, 1.0f / distances->second));
    return most_D * std::max(defocus.radius_px_per_D.x, defocus.radius_px_per_D.y);
  }

  /// The way to draw a frame of this blur.
  std::size_t choose(float blur_px, const Quality& quality) {
    const float as_good = kAsGood * kWays.back().error(blur_px);
    const float allowed = std::max(quality.tolerance, as_good);
    const auto cheapest = [&](float error) {
      std::size_t way = 0;
      while (kWays[way].error(blur_px) > error) ++way;
      return way;
    };
    const std::size_t least = cheapest(allowed);
    const std::size_t safe = cheapest(kMargin * allowed);
    way_ = way_ ? std::clamp(*way_, least, safe) : least;

    if (quality.frame_ms) {
      below_ = last_ms_ < kTimeMargin * *quality.frame_ms ? below_ + 1 : 0;
      if (last_ms_ > *quality.frame_ms && cheaper_ + 1 < kWays.size()) ++cheaper_;
      if (below_ >= kFramesBelow && cheaper_ > 0) {
        --cheaper_;
        below_ = 0;
      }
    } else {
      cheaper_ = 0;
    }
    return *way_ - std::min(*way_, cheaper_);
  }

  LodSplats scene_;
  int number_;
  std::size_t drawn_ = 0;           // the way of the draw before
  std::optional<std::size_t> way_;  // for the tolerance's sake
  std::size_t cheaper_ = 0;         // ways less, for the time's sake
  int below_ = 0;                   // frames well within the time
  float last_ms_ = 0.0f;
};

}  // namespace

MethodEntry autoMethod() {
  return {
      .info = {.name = "auto",
               .summary = "sweep-lod that spends only what shows: as coarse as the tolerance, or "
                          "the time, allows",
               .source = "our own",
               .most = static_cast<int>(kWays.size())},
      .make = makeAs<AutoMethod>};
}

}  // namespace foci
