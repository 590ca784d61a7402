// The default: `sweep-lod` that spends only what shows. Of four ways to draw a frame it takes the
// cheapest whose error, as found beforehand over scenes and blurs, stays within the tolerance;
// `auto:N` is always the N-th.
// Known failure: the error is one of whole pictures by the largest blur in view, so a small part
// that is harder than the rest (foliage) may err by more.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "render/methods/blur_pyramid.h"
#include "render/methods/lod_splats.h"
#include "render/methods/method.h"
#include "render/methods/time_budget.h"

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

CutSettings softer(float times, float pixel_px) {
  CutSettings cut = looser(times);
  cut.acuity.base_px = pixel_px;
  return cut;
}

/// From the cheapest on.
const std::array<Way, 4> kWays{Way{{looser(10.0f), 1}, {3.1f, 3.1f, 3.2f, 4.6f, 4.6f}},
                               Way{{looser(3.0f), 1}, {0.6f, 1.5f, 1.5f, 2.6f, 4.3f}},
                               Way{{looser(1.0f), 1}, {0.4f, 1.5f, 1.5f, 1.5f, 2.8f}},
                               Way{{looser(1.0f), 7}, {0.3f, 1.5f, 1.5f, 1.5f, 2.5f}}};

/// Where no way stays within the tolerance, it is this much above what the best one can.
constexpr float kAsGood = 1.15f;  // times kMargin, some way still is

/// To come back to a cheaper way its error must be this much below the tolerance: what is drawn
/// does not flicker between two ways.
constexpr float kMargin = 0.9f;

/// What time leaves where it does not suffice for the ways above, from the best on: of an eye that
/// stands still the sharp picture, blurred afterwards; everything through a Gaussian of so many
/// pixels. Numbered behind the ways.
constexpr std::size_t kStanding = kWays.size(), kSoft = kStanding + 1, kSofter = kSoft + 1;
constexpr std::size_t kNumbers = kSofter + 1;
const Way kSoftWay{{softer(30.0f, 6.0f), 1}, {14.7f, 13.2f, 12.8f, 12.7f, 12.7f}};
const Way kSofterWay{{softer(30.0f, 12.0f), 1}, {16.2f, 15.0f, 13.6f, 13.1f, 13.0f}};
const Way kStandingWay{{looser(1.0f), 1}, {0.5f, 4.0f, 5.7f, 5.8f, 6.2f}};

/// Relative times of all of them, of the gallery at 1280 x 720, to begin with.
constexpr std::array<float, kNumbers> kLikely{16.0f, 16.0f, 16.0f, 25.0f, 1.1f, 3.0f, 1.0f};

/// Where neither fits the budget, the better of two is drawn unless it takes so much longer.
constexpr float kAsQuick = 2.0f;

const Way& wayNumbered(std::size_t i) {
  if (i == kStanding) return kStandingWay;
  if (i == kSoft) return kSoftWay;
  return i == kSofter ? kSofterWay : kWays[i];
}

/// What a sharp picture hangs on.
struct Sight {
  View view;
  glm::vec3 background{0.0f};
  float shading = 0.0f;
  DistanceAlong along = DistanceAlong::sight;
  bool operator==(const Sight&) const = default;
};

Sight sightOf(const View& view, const RenderSettings& settings) {
  return {view, settings.background, settings.shading, settings.defocus.along};
}

/// The sharp picture of what an eye sees that stands still.
struct StandingView {
  Sight sight;
  BlurPyramid pyramid;
  RenderStats stats;
};

/// Those of both eyes, that a method and its twins share: one draws them while another uses them.
class StandingViews {
 public:
  std::shared_ptr<const StandingView> of(const Sight& sight) const {
    const std::lock_guard lock(mutex_);
    const auto found =
        std::ranges::find_if(views_, [&](const auto& each) { return each->sight == sight; });
    return found == views_.end() ? nullptr : *found;
  }

  void add(std::shared_ptr<const StandingView> view) {
    constexpr std::size_t kMost = 2;
    const std::lock_guard lock(mutex_);
    if (views_.size() == kMost) views_.erase(views_.begin());  // the oldest
    views_.push_back(std::move(view));
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<const StandingView>> views_;
};

class AutoMethod final : public Method {
 public:
  /// @param number  of the way, from 1; 0: chosen by frame
  AutoMethod(const SurfelCloud& cloud, int number)
      : scene_(cloud), standing_(std::make_shared<StandingViews>()), number_(number) {}

  std::unique_ptr<Method> twin() const override {
    return std::make_unique<AutoMethod>(*this, nullptr);
  }
  AutoMethod(const AutoMethod& other, std::nullptr_t)
      : scene_(other.scene_.sharedTree()), standing_(other.standing_), number_(other.number_) {}

  void prepare(const View& view, const RenderSettings& settings) override {
    standingOf(sightOf(view, settings));
  }

  RenderStats draw(const View& view, const RenderSettings& settings, Frame& frame) override {
    const Quality& quality = settings.quality;
    const float blur_px = largestBlur_px(view, settings.defocus);
    const Sight sight = sightOf(view, settings);
    const bool moved = sight != sight_;
    if (!quality.as_before) sight_ = sight;
    const int number = number_ > 0 ? number_ : quality.way;
    const std::size_t chosen = number > 0          ? static_cast<std::size_t>(number - 1)
                               : quality.as_before ? drawn_
                                                   : choose(sight, quality, blur_px);
    drawn_ = chosen;
    const auto start = std::chrono::steady_clock::now();
    RenderStats stats;
    if (chosen == kStanding) {
      const auto standing = standingOf(sight);
      standing->pyramid.blur(settings.defocus, frame);
      stats = standing->stats;
    } else {
      stats = drawSplats(wayNumbered(chosen), view, settings, frame);
    }
    if (!quality.as_before && number == 0) {
      const std::chrono::duration<float, std::milli> took =
          std::chrono::steady_clock::now() - start;
      time_.took(chosen, took.count(), moved);
    }
    stats.tolerance_error = wayNumbered(chosen).error(blur_px);
    stats.in_full = number > 0 || chosen == *way_;
    if (quality.frame_ms) stats.drawn_as = "auto:" + std::to_string(chosen + 1);
    return stats;
  }

 private:
  RenderStats drawSplats(const Way& way, const View& view, const RenderSettings& settings,
                         Frame& frame) {
    LodSettings lod = way.lod;
    if (way.lod.cut.acuity == Acuity{}) {
      lod.cut.acuity = settings.quality.acuity;
    } else {  // the softer of both
      lod.cut.acuity.gaze_px = settings.quality.acuity.gaze_px;
      lod.cut.acuity.per_px = settings.quality.acuity.per_px;
    }
    return scene_.draw(view, settings, lod, frame);
  }

  /// Drawn where it is not there yet.
  std::shared_ptr<const StandingView> standingOf(const Sight& sight) {
    if (auto there = standing_->of(sight)) return there;
    auto standing = std::make_shared<StandingView>();
    Frame sharp{.size_px = sight.view.size_px, .rgba = {}, .depth_m = {}};
    sharp.rgba.resize(static_cast<std::size_t>(sharp.size_px.x) * sharp.size_px.y);
    sharp.depth_m.resize(sharp.rgba.size());
    standing->stats = scene_.draw(sight.view,
                                  {.defocus = {.along = sight.along},
                                   .background = sight.background,
                                   .shading = sight.shading,
                                   .depth = true},
                                  {.cut = kFaithfulCut}, sharp);
    standing->pyramid.set(std::move(sharp), sight.view.focal_px);
    standing->sight = sight;
    standing_->add(standing);
    return standing;
  }

  float largestBlur_px(const View& view, const Defocus& defocus) const {
    const auto distances = distancesInView(scene_.tree(), view, defocus);
    if (!distances) return 0.0f;
    const float most_D = std::max(mostDefocus_D(defocus, 1.0f / distances->first),
                                  mostDefocus_D(defocus, 1.0f / distances->second));
    return most_D * std::max(defocus.radius_px_per_D.x, defocus.radius_px_per_D.y);
  }

  /// The way to draw a frame of this blur.
  std::size_t choose(const Sight& sight, const Quality& quality, float blur_px) {
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
    if (!quality.frame_ms || std::isinf(*quality.frame_ms)) return *way_;

    const float budget_ms = *quality.frame_ms;
    for (std::size_t way = *way_ + 1; way-- > 0;) {
      if (time_.fits(way, budget_ms)) return way;
    }
    // Where it is there, the sharp picture blurred is as quick as the softest, or nearly.
    if (standing_->of(sight) &&
        (time_.fits(kStanding, budget_ms) ||
         time_.expected_ms(kStanding) <= kAsQuick * time_.expected_ms(kSofter))) {
      return kStanding;
    }
    return time_.fits(kSoft, budget_ms) ? kSoft : kSofter;
  }

  LodSplats scene_;
  std::shared_ptr<StandingViews> standing_;
  int number_;
  std::size_t drawn_ = 0;           // the way of the draw before
  std::optional<std::size_t> way_;  // for the tolerance's sake
  TimeBudget time_{kLikely};
  Sight sight_;  // of the draw before
};

}  // namespace

MethodEntry autoMethod() {
  return {
      .info = {.name = "auto",
               .summary = "sweep-lod that spends only what shows: as coarse as the tolerance, or "
                          "the time, allows",
               .source = "our own",
               .most = static_cast<int>(kNumbers)},
      .make = makeAs<AutoMethod>};
}

}  // namespace foci
