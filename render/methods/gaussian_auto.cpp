// Method `auto` on scenes of Gaussians. It renders a LOD cut that the blur allows under the
// tolerance, and each tile through as few discs of the lens. Source: our own. Known failure:
// thin blurred parts before a bright background exceed the predicted error, and so does fine detail
// that fills an image of few pixels.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "render/gaussians/gaussian_view.h"
#include "render/methods/discs_of_tiles.h"
#include "render/methods/gaussian_methods.h"
#include "render/methods/lens_gaussians.h"
#include "render/methods/mean_of_parts.h"
#include "render/methods/quality_level.h"
#include "render/methods/quality_level_table.h"
#include "render/scene/gaussian_tree.h"

namespace foci {
namespace {

/// Variance that merging Gaussians may add: a share of C^2, and a largest one for each unit of
/// tolerance. It adds an error of at most `kLodError_per_px` C and of `kMaxLodError`, for each unit
/// of tolerance. Measured on two captures and on the garden (builtin/garden.cpp).
constexpr float kPerBlur2 = 0.015f, kMaxSpread_px2 = 0.3f;
constexpr float kLodError_per_px = 0.03f, kMaxLodError = 0.3f;

/// Several layers leave an error of up to 0.6 JND on small Gaussians, with any number of discs
/// (tests of TileLayers). A tolerance below this has one layer.
constexpr float kLayersFrom_JND = 1.0f;

/// @param tolerance  of the LOD cut
float mergingError(const TileBlur& blur, float tolerance) {
  return std::min(kLodError_per_px * blur.radius_px, kMaxLodError) * tolerance;
}

/// By the blur radius, with merging.
float errorOf(int discs, const TileBlur& blur, float tolerance) {
  return std::hypot(errorByBlur(discs, blur), mergingError(blur, tolerance));
}

/// Discs of a quality level that the whole frame shares; 0: a pinhole.
int discsOf(QualityLevel level) {
  switch (level) {
    case QualityLevel::coarse:
    case QualityLevel::whole_aperture:
      return 1;
    case QualityLevel::sub_apertures:
      return 7;
    case QualityLevel::fine:
      return 19;
    case QualityLevel::thorough:
      return 61;
    default:
      return 0;
  }
}

constexpr int kFewestParts = 7;

/// The discs that tell the error of a single one, in kDiscs: three.
constexpr std::size_t kJudges = 1;

constexpr std::array kBudgetLevels{QualityLevel::fine, QualityLevel::sub_apertures,
                                   QualityLevel::whole_aperture, QualityLevel::sharp};

/// By the discs in front and behind, in kDiscs.
using PairTable = std::array<std::array<LensPairs, kDiscs.size()>, kDiscs.size()>;

/// Made once for all, since it depends on `kDiscs` alone; not before a tile has several layers.
const PairTable& pairTable() {
  static const PairTable table = [] {
    PairTable made;
    for (std::size_t front = 0; front < kDiscs.size(); ++front) {
      const std::vector<LensDisc> discs = subApertureDiscs(kDiscs[front]);
      for (std::size_t behind = 0; behind < kDiscs.size(); ++behind) {
        made[front][behind] = pairLensDiscs(discs, subApertureDiscs(kDiscs[behind]));
      }
    }
    return made;
  }();
  return table;
}

class GaussianAuto final : public GaussianEyeMethod {
 public:
  /// @param cloud  with its tree
  GaussianAuto(std::shared_ptr<const GaussianCloud> cloud, std::optional<QualityLevel> forced,
               const SharedGpu& gpu)
      : GaussianAuto(LensGaussians(std::move(cloud), gpu), forced) {}

  GaussianAuto(LensGaussians scene, std::optional<QualityLevel> forced)
      : scene_(std::move(scene)), forced_(forced) {
    for (const int count : kDiscs) sets_.push_back(subApertureDiscs(count));
    // Together they bound what any set shows.
    for (const std::vector<LensDisc>& set : sets_) all_.insert(all_.end(), set.begin(), set.end());
  }

  std::unique_ptr<Method> cloneSharingScene() const override {
    return std::make_unique<GaussianAuto>(scene_.sharingScene(), forced_);
  }

  RenderStats renderGeometry(const View& view, const RenderSettings& settings,
                             Frame& frame) override {
    const Quality& quality = settings.quality;
    const bool budget = quality.frame_ms && !std::isinf(*quality.frame_ms);
    const bool moved = !(view == last_view_);
    last_view_ = view;
    if (settings.defocus.radius_px_per_D == glm::vec2(0.0f)) {
      return renderThrough(pinhole_, view, settings, frame);
    }
    if (settings.pupil.hasParts()) return renderByParts(view, settings, frame);
    if (const auto forced = forced_ ? forced_ : quality.quality_level) {
      return renderAt(*forced, view, settings, frame);
    }
    if (!budget) return renderByTiles(view, settings, frame);
    const QualityLevel level = quality.keep_level ? last_level_ : levelWithin(*quality.frame_ms);
    last_level_ = level;
    const auto start = std::chrono::steady_clock::now();
    RenderStats stats = renderAt(level, view, settings, frame);
    const std::chrono::duration<float, std::milli> took = std::chrono::steady_clock::now() - start;
    if (!quality.keep_level) time_.took(level, took.count(), moved);
    stats.full_quality = *stats.tolerance_error <= quality.tolerance || level == kBudgetLevels[0];
    return stats;
  }

 private:
  RenderStats renderThrough(const std::vector<LensDisc>& discs, const View& view,
                            const RenderSettings& settings, Frame& frame) {
    RenderStats stats = project(discs, view, settings);
    stats.add(scene_.render(discs, settings.lighting.background, frame));
    return stats;
  }

  RenderStats project(const std::vector<LensDisc>& discs, const View& view,
                      const RenderSettings& settings) {
    const GaussianCutSettings lod = lodOf(settings);
    return scene_.project(view, settings.defocus, discs, &lod);
  }

  static GaussianCutSettings lodOf(const RenderSettings& settings) {
    return {.per_blur2 = kPerBlur2 * settings.quality.tolerance,
            .max_px2 = kMaxSpread_px2 * settings.quality.tolerance,
            .acuity = settings.quality.acuity};
  }

  RenderStats renderAt(QualityLevel level, const View& view, const RenderSettings& settings,
                       Frame& frame) {
    const int n = discsOf(level);
    RenderStats stats =
        renderThrough(n == 0 ? pinhole_ : subApertureDiscs(n), view, settings, frame);
    stats.quality_level = level;
    stats.tolerance_error = largestError([&](const TileBlur& blur) {
      return errorOf(std::max(n, 1), blur, settings.quality.tolerance);
    });
    return stats;
  }

  /// At full quality, whatever the budget.
  RenderStats renderByParts(const View& view, const RenderSettings& settings, Frame& frame) {
    const GaussianCutSettings lod = lodOf(settings);
    const std::vector<LensPart> parts =
        partsFor(settings.defocus, withoutDiffraction(settings.pupil), kFewestParts);
    RenderStats stats = parts_.render(scene_, parts, view, settings, &lod, frame);
    stats.tolerance_error = largestError([&](const TileBlur& blur) {
      return errorOf(static_cast<int>(parts.size()), blur, settings.quality.tolerance);
    });
    return stats;
  }

  RenderStats renderByTiles(const View& view, const RenderSettings& settings, Frame& frame) {
    RenderStats stats = project(all_, view, settings);
    const float tolerance = settings.quality.tolerance;
    const std::vector<TileLayers>& layers = scene_.divide(tolerance >= kLayersFrom_JND);
    std::vector<float> merging;
    merging.reserve(layers.size());
    for (const TileLayers& tile : layers) {
      float most = 0.0f;
      for (const TileLayer& layer : tile.all()) {
        most = std::max(most, mergingError(layer.blur, tolerance));
      }
      merging.push_back(most);
    }
    tiles_.choose(scene_.tiles(), view.size_px, layers, merging, tolerance);
    do {
      stats.add(scene_.render(
          [&](std::size_t tile) {
            TileLens lens;
            if (!tiles_.isNext(tile)) return lens;
            lens.discs = &sets_[tiles_.indexOf(tile, 0)];
            lens.weight = tiles_.weightOf(tile);
            if (tiles_.isJudged(tile)) lens.judges = &sets_[kJudges];
            for (std::size_t k = 1; k < layers[tile].count; ++k) {
              lens.pairs[k - 1] =
                  &pairTable()[tiles_.indexOf(tile, k - 1)][tiles_.indexOf(tile, k)];
            }
            return lens;
          },
          settings.lighting.background, frame, &errors_));
    } while (tiles_.refine(errors_));
    stats.tolerance_error = tiles_.error();
    return stats;
  }

  /// The largest of the tiles' errors.
  template <typename ErrorOf>
  double largestError(const ErrorOf& errorOfBlur) {
    double largest = 0.0;
    for (const TileLayers& tile : scene_.divide(false)) {
      largest = std::max(largest, double{errorOfBlur(tile.layers[0].blur)});
    }
    return largest;
  }

  QualityLevel levelWithin(float budget_ms) const {
    for (const QualityLevel level : kBudgetLevels) {
      if (time_.fits(level, budget_ms)) return level;
    }
    return kBudgetLevels.back();
  }

  LensGaussians scene_;
  GaussianParts parts_;
  std::optional<QualityLevel> forced_;
  std::vector<std::vector<LensDisc>> sets_;  // by kDiscs
  DiscsOfTiles tiles_;
  std::vector<SampledErrors> errors_;
  std::vector<LensDisc> all_, pinhole_ = {LensDisc{}};
  QualityLevel last_level_ = QualityLevel::sharp;  // of the previous render
  View last_view_;
  TimeBudget time_{relativeTimes(), scene_.isOnGpu()};
};

}  // namespace

std::unique_ptr<Method> gaussianAuto(const GaussianCloud& cloud, int n, const SharedGpu& gpu) {
  return std::make_unique<GaussianAuto>(sharedWithTree(cloud), qualityLevelNumbered(n), gpu);
}

}  // namespace foci
