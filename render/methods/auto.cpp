// The default: `sweep-lod` that spends only what shows. Of five ways to render a frame
// (auto_ways.cpp) it takes the cheapest whose error stays within the tolerance: as found beforehand
// over scenes and blurs, or where that asks for parts of the lens, as found on a few squares of the
// frame itself; `auto:N` is always the N-th. Known failure: what small squares do not meet is not
// known, nor what is harder at a blur of a few pixels, where none are rendered, than the scenes
// that the ways were measured on.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "render/methods/auto_ways.h"
#include "render/methods/blur_pyramid.h"
#include "render/methods/lod_splats.h"
#include "render/methods/method.h"
#include "render/methods/spot_check.h"
#include "render/methods/time_budget.h"

namespace foci {
namespace {

/// Where no way stays within the tolerance, it is this much above what the best one can.
constexpr float kAsGood = 1.15f;  // times kMargin, some way still is

/// To come back to a cheaper way its error must be this much below the tolerance: what is rendered
/// does not flicker between two ways.
constexpr float kMargin = 0.9f;

/// Squares are rendered anew after so many frames, or where the blur has become this much more or
/// less.
constexpr int kCheckAgain = 60;
constexpr float kOtherBlur = 1.5f;

/// Where neither fits the budget, the better of two is rendered unless it takes so much longer.
constexpr float kAsQuick = 2.0f;

/// What a sharp image hangs on.
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

/// The sharp image of what an eye sees that stands still.
struct StandingView {
  Sight sight;
  BlurPyramid pyramid;
  RenderStats stats;
};

/// Those of both eyes, that a method and its twins share: one renders them while another uses them.
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

  std::unique_ptr<Method> cloneSharingScene() const override {
    return std::make_unique<AutoMethod>(*this, nullptr);
  }
  AutoMethod(const AutoMethod& other, std::nullptr_t)
      : scene_(other.scene_.sharedTree()), standing_(other.standing_), number_(other.number_) {}

  void prepare(const View& view, const RenderSettings& settings) override {
    standingOf(sightOf(view, settings));
  }

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    const Quality& quality = settings.quality;
    const float blur_px = largestBlur_px(view, settings.defocus);
    const Sight sight = sightOf(view, settings);
    const bool moved = sight != sight_;
    if (!quality.as_before) sight_ = sight;
    const int number = number_ > 0 ? number_ : quality.way;
    const std::size_t chosen = number > 0          ? static_cast<std::size_t>(number - 1)
                               : quality.as_before ? rendered_
                                                   : choose(sight, settings, blur_px);
    rendered_ = chosen;
    const auto start = std::chrono::steady_clock::now();
    RenderStats stats;
    if (chosen == kStanding) {
      const auto standing = standingOf(sight);
      standing->pyramid.blur(settings.defocus, frame);
      stats = standing->stats;
    } else {
      stats = renderSplats(wayNumbered(chosen), view, settings, frame);
    }
    if (!quality.as_before && number == 0) {
      const std::chrono::duration<float, std::milli> took =
          std::chrono::steady_clock::now() - start;
      time_.took(chosen, took.count(), moved);
    }
    stats.tolerance_error = number == 0 ? expectedError(chosen, blur_px)  //
                                        : wayNumbered(chosen).error(blur_px);
    stats.in_full = number > 0 || chosen == *way_;
    if (quality.frame_ms) stats.rendered_as = "auto:" + std::to_string(chosen + 1);
    return stats;
  }

 private:
  static LodSettings lodOf(const Way& way, const Quality& quality) {
    LodSettings lod = way.lod;
    if (way.lod.cut.acuity == Acuity{}) {
      lod.cut.acuity = quality.acuity;
    } else {  // the softer of both
      lod.cut.acuity.gaze_px = quality.acuity.gaze_px;
      lod.cut.acuity.per_px = quality.acuity.per_px;
    }
    return lod;
  }

  RenderStats renderSplats(const Way& way, const View& view, const RenderSettings& settings,
                           Frame& frame) {
    RenderSettings rendered = settings;
    if (way.sharp) rendered.defocus.radius_px_per_D = glm::vec2(0.0f);
    return scene_.render(view, rendered, lodOf(way, settings.quality), frame);
  }

  /// Drawn where it is not there yet.
  std::shared_ptr<const StandingView> standingOf(const Sight& sight) {
    if (auto there = standing_->of(sight)) return there;
    auto standing = std::make_shared<StandingView>();
    Frame sharp;
    sharp.resize(sight.view.size_px, true);
    standing->stats = scene_.render(sight.view,
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
    const float most_D = std::max(maxDefocus_D(defocus, 1.0f / distances->first),
                                  maxDefocus_D(defocus, 1.0f / distances->second));
    return most_D * std::max(defocus.radius_px_per_D.x, defocus.radius_px_per_D.y);
  }

  /// The way to render a frame of this blur.
  std::size_t choose(const Sight& sight, const RenderSettings& settings, float blur_px) {
    const Quality& quality = settings.quality;
    const bool unhurried = !quality.frame_ms || std::isinf(*quality.frame_ms);
    if (unhurried) {
      check(sight, settings, blur_px);
    } else {
      checked_.reset();
    }
    const float allowed = allowedError(quality, blur_px);
    const auto cheapest = [&](float error) {
      std::size_t way = 0;
      while (expectedError(way, blur_px) > error) ++way;
      return way;
    };
    const std::size_t least = cheapest(allowed);
    way_ = way_ ? std::clamp(*way_, least, cheapest(kMargin * allowed)) : least;
    if (unhurried) return *way_;

    // Without blur where none would show, but not for want of time.
    const float budget_ms = *quality.frame_ms;
    const std::size_t last = std::min(*way_, kCoarse);
    for (std::size_t way = *way_ + 1; way-- > last;) {
      if (time_.fits(way, budget_ms)) return way;
    }
    // Where it is there, the sharp image blurred is as quick as the softest, or nearly.
    if (standing_->of(sight) &&
        (time_.fits(kStanding, budget_ms) ||
         time_.expected_ms(kStanding) <= kAsQuick * time_.expected_ms(kSofter))) {
      return kStanding;
    }
    return time_.fits(kSoft, budget_ms) ? kSoft : kSofter;
  }

  /// Of one of the ways, or of what time leaves: by the blur, and where squares of the frame were
  /// looked at, by what they show.
  float expectedError(std::size_t way, float blur_px) const {
    const float tabled = wayNumbered(way).error(blur_px);
    if (!checked_ || way >= kWays) return tabled;
    if (way < kWhole) return std::max(tabled, expectedError(kWhole, blur_px));
    const std::optional<float>& apart = checked_->apart[way];
    return apart ? std::hypot(finestWay().error(blur_px), *apart) : tabled;
  }

  float allowedError(const Quality& quality, float blur_px) const {
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t way = 0; way < kWays; ++way) {
      least = std::min(least, expectedError(way, blur_px));
    }
    return std::max(quality.tolerance, kAsGood * least);
  }

  /// Where the table asks for parts of the lens, a few squares tell whether the frame does, and how
  /// many nodes: surfaces that overlap in much of the view.
  void check(const Sight& sight, const RenderSettings& settings, float blur_px) {
    const Quality& quality = settings.quality;
    const float best = wayNumbered(kWays - 1).error(blur_px);
    if (wayNumbered(kWhole).error(blur_px) <=
        kMargin * std::max(quality.tolerance, kAsGood * best)) {
      checked_.reset();
      return;
    }
    if (checked_) {
      const bool same = checked_->sight == sight && checked_->defocus == settings.defocus;
      const float times = blur_px / checked_->blur_px;
      if (same ||
          (++checked_->renders < kCheckAgain && times < kOtherBlur && times > 1.0f / kOtherBlur)) {
        return;
      }
    }
    SpotCheck squares(squares_, sight.view, settings, lodOf(finestWay(), quality));
    checked_ = {.sight = sight, .defocus = settings.defocus, .blur_px = blur_px, .apart = {}};
    for (std::size_t way = kWhole; way < kWays; ++way) {
      const float allowed = allowedError(quality, blur_px);
      const float finest = std::min(finestWay().error(blur_px), allowed);
      const float limit = std::sqrt(allowed * allowed - finest * finest);
      checked_->apart[way] = squares.error(lodOf(wayNumbered(way), quality), limit);
      if (expectedError(way, blur_px) <= allowedError(quality, blur_px)) break;
    }
  }

  /// What was found out on squares of a frame.
  struct Checked {
    Sight sight;
    Defocus defocus;
    float blur_px = 0.0f;
    int renders = 0;                                // since then
    std::array<std::optional<float>, kWays> apart;  // from the finest, of the ways that were tried
  };

  LodSplats scene_;
  LodSplats squares_{scene_.sharedTree()};  // buffers of their size
  std::shared_ptr<StandingViews> standing_;
  int number_;
  std::size_t rendered_ = 0;        // the way of the render before
  std::optional<std::size_t> way_;  // for the tolerance's sake
  std::optional<Checked> checked_;
  TimeBudget time_{kLikely};
  Sight sight_;  // of the render before
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
