#include "render/methods/gaussian_methods.h"

#include <array>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "base/transformed.h"
#include "render/gl/image.h"
#include "render/image/metrics.h"
#include "render/methods/lens_gaussians.h"
#include "render/methods/lens_samples.h"
#include "render/methods/mean_of_parts.h"
#include "render/scene/gaussian_tree.h"

namespace foci {
namespace {

/// Share of a sub-aperture's area that its disc covers. Discs blur each Gaussian by itself, and so
/// let light through surfaces; gaps between discs show as ghosts. With 7 sub-apertures and blur of
/// 10 and 20 px, PSNR against 100 pinholes, dB:
///            1     0.6   0.35  0.2
///   guitar   44.0  46.3  48.1  49.3     at 20 px: 41.0, -, 43.9, 44.9
///   biker    50.2  -     51.7  51.3     at 20 px: 46.9, -, 47.9, 47.4
constexpr float kDiscShare = 0.15f;

/// Variance that merging may add in `sweep-lod`: a share of C^2, of which a lens's disc has 1/4,
/// and a largest one. With 7 sub-apertures and blur of 20 px everywhere, 384 px wide, the PSNR
/// against 64 pinholes by the largest variance, and without merging, dB:
///            none   2     4     without
///   guitar   43.2   45.6  45.0  41.6
///   biker    39.0   44.2  42.8  42.8
constexpr float kSweepLodPerBlur2 = 0.1f, kSweepLodMost_px2 = 3.0f;

/// A pointer that does not own the scene.
std::shared_ptr<const GaussianCloud> borrowed(const GaussianCloud& cloud) {
  return {std::shared_ptr<void>(), &cloud};
}

bool isBlurred(const Defocus& defocus) { return defocus.radius_px_per_D != glm::vec2(0.0f); }

/// The mean of the frames through the given discs of the lens, without aberrations.
class DiscsMethod final : public Method {
 public:
  DiscsMethod(const GaussianCloud& cloud, std::vector<LensDisc> discs, const SharedGpu& gpu)
      : scene_(borrowed(cloud), gpu), discs_(std::move(discs)) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    const std::vector<LensDisc>& discs = isBlurred(settings.defocus) ? discs_ : pinhole_;
    RenderStats stats = scene_.project(view, settings.defocus, discs);
    stats.add(scene_.render(discs, settings.lighting.background, frame));
    return stats;
  }

 private:
  LensGaussians scene_;
  std::vector<LensDisc> discs_, pinhole_ = {LensDisc{}};
};

/// The mean of sub-apertures.
class SubAperturesMethod final : public GaussianEyeMethod {
 public:
  /// @param lod  renders nodes of the scene's tree, coarser where blurred; null: all Gaussians
  SubAperturesMethod(std::shared_ptr<const GaussianCloud> cloud, int n,
                     const GaussianCutSettings* lod, const SharedGpu& gpu)
      : scene_(std::move(cloud), gpu),
        discs_(subApertureDiscs(n)),
        itself_(eachWithItself(discs_)),
        lod_(lod) {}

  RenderStats renderGeometry(const View& view, const RenderSettings& settings,
                             Frame& frame) override {
    if (isBlurred(settings.defocus) && settings.pupil.hasParts()) {
      const int n = static_cast<int>(discs_.size());
      const Pupil pupil = withoutDiffraction(settings.pupil);
      return parts_.render(
          scene_,
          lod_ ? partsFor(settings.defocus, pupil, n) : lensParts(settings.defocus, pupil, n), view,
          settings, lod_, frame);
    }
    const bool blurred = isBlurred(settings.defocus);
    const std::vector<LensDisc>& discs = blurred ? discs_ : pinhole_;
    RenderStats stats = scene_.project(view, settings.defocus, discs, lod_);
    if (lod_ && blurred) {
      scene_.divide(true);
      const TileLens lens{.discs = &discs, .pairs = {&itself_, &itself_}};
      stats.add(
          scene_.render([&](std::size_t) { return lens; }, settings.lighting.background, frame));
    } else {
      stats.add(scene_.render(discs, settings.lighting.background, frame));
    }
    return stats;
  }

 private:
  LensGaussians scene_;
  GaussianParts parts_;
  std::vector<LensDisc> discs_, pinhole_ = {LensDisc{}};
  LensPairs itself_;  // what lies behind a view is seen through the same disc
  const GaussianCutSettings* lod_;
};

constexpr GaussianCutSettings kSweepLod{.per_blur2 = kSweepLodPerBlur2,
                                        .max_px2 = kSweepLodMost_px2};

/// The mean of pinhole views, with the error of its two halves.
class AccumulatedPoints final : public GaussianEyeMethod {
 public:
  AccumulatedPoints(const GaussianCloud& cloud, int n, const SharedGpu& gpu)
      : scene_(borrowed(cloud), gpu) {
    for (int i = 0; i < n; ++i) halves_[i % 2].push_back({lensSample(i, n), 0.0f});
    all_ = halves_[0];
    all_.insert(all_.end(), halves_[1].begin(), halves_[1].end());
  }

  RenderStats renderGeometry(const View& view, const RenderSettings& settings,
                             Frame& frame) override {
    if (isBlurred(settings.defocus) && settings.pupil.hasParts()) {
      const auto points = transformed(all_, &LensDisc::centre);
      return parts_.render(scene_, lensPoints(settings.defocus, settings.pupil, points), view,
                           settings, nullptr, frame);
    }
    RenderStats stats = scene_.project(view, settings.defocus, all_);
    stats.add(scene_.render(halves_[0], settings.lighting.background, frame));
    if (halves_[1].empty()) return stats;
    readFromGpu(frame);
    odd_.resize(view.size_px, settings.depth);
    stats.add(scene_.render(halves_[1], settings.lighting.background, odd_));
    readFromGpu(odd_);
    stats.split_half_psnr_dB = psnr_dB(frame, odd_);
    addOdd(frame);
    return stats;
  }

 private:
  void addOdd(Frame& frame) const {
    const auto even = static_cast<float>(halves_[0].size()) / static_cast<float>(all_.size());
    const float odd = 1.0f - even;
    parallelFor(frame.rgba.size(), [&](std::size_t p) {
      const float coverage = even * frame.rgba[p].a + odd * odd_.rgba[p].a;
      if (!frame.depth_m.empty() && coverage > 0.0f) {
        frame.depth_m[p] =
            (even * frame.depth_m[p] * frame.rgba[p].a + odd * odd_.depth_m[p] * odd_.rgba[p].a) /
            coverage;
      }
      frame.rgba[p] = even * frame.rgba[p] + odd * odd_.rgba[p];
    });
  }

  LensGaussians scene_;
  GaussianParts parts_;
  std::vector<LensDisc> halves_[2], all_;
  Frame odd_;
};

}  // namespace

std::vector<LensDisc> subApertureDiscs(int n) {
  if (n <= 1) return {{glm::vec2(0.0f), 1.0f}};
  // The centres have the variance 1/4 of the lens (lens_samples.h), the discs a share of this.
  const float share = kDiscShare / static_cast<float>(n);
  return transformed(subApertureCentres(n), [&](const glm::vec2& centre) {
    return LensDisc{std::sqrt(1.0f - share) * centre, std::sqrt(share)};
  });
}

float partDiscRadius(std::size_t n) { return n == 1 ? 1.0f : std::sqrt(kDiscShare); }

float inflateWidening(int variant) {
  // The square root of the variance over C^2.
  const std::array sigma{std::sqrt(0.5f / std::log(4.0f)), 1.0f, 2.0f};
  return sigma[static_cast<std::size_t>(variant)] / sigma[0];
}

std::unique_ptr<Method> gaussianInflate(const GaussianCloud& cloud, int n, const SharedGpu& gpu) {
  // A disc of radius r has the variance r^2 / 4, so this one has 1 / (2 ln 4) times the widening.
  const float radius = std::sqrt(2.0f / std::log(4.0f)) * inflateWidening(n);
  return std::make_unique<DiscsMethod>(cloud, std::vector{LensDisc{glm::vec2(0.0f), radius}}, gpu);
}

std::unique_ptr<Method> gaussianPinhole(const GaussianCloud& cloud, int /*n*/,
                                        const SharedGpu& gpu) {
  return std::make_unique<DiscsMethod>(cloud, std::vector<LensDisc>{LensDisc{}}, gpu);
}

std::unique_ptr<Method> gaussianSweep(const GaussianCloud& cloud, int n, const SharedGpu& gpu) {
  return std::make_unique<SubAperturesMethod>(borrowed(cloud), n, nullptr, gpu);
}

std::unique_ptr<Method> gaussianSweepLod(const GaussianCloud& cloud, int n, const SharedGpu& gpu) {
  return std::make_unique<SubAperturesMethod>(sharedWithTree(cloud), n, &kSweepLod, gpu);
}

std::unique_ptr<Method> gaussianAccumulate(const GaussianCloud& cloud, int n,
                                           const SharedGpu& gpu) {
  return std::make_unique<AccumulatedPoints>(cloud, n, gpu);
}

}  // namespace foci
