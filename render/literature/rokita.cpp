// A repeated small convolution (Rokita, Fast Generation of Depth of Field Effects in Computer
// Graphics, Computers & Graphics 17(5), 1993; Generating Depth-of-Field Effects in Virtual Reality
// Applications, IEEE Computer Graphics and Applications 16(2), 1996). Each pixel of the finished
// pinhole image passes through a 3 x 3 filter, more often the larger its circle of confusion is.
// The variances of the passes add up to the disc's, C^2/4; the last pass is a weaker one. Known
// failure: a pixel gathers light by its own blur, not by the blur of its neighbours. So a blurred
// surface keeps a sharp outline, and a sharp surface leaks into the blur around it. Time grows with
// C^2.
#include <algorithm>

#include "render/literature/filter_method.h"

namespace foci {
namespace {

/// Variance of the filter (1 2 1) / 4, the widest of a pass, px^2.
constexpr float kPass_px2 = 0.5f;

/// Consecutive pixels of a row that are skipped together once all of them are done. Chosen by hand.
constexpr int kRun_px = 32;

class RokitaMethod final : public FilterMethod {
  using FilterMethod::FilterMethod;

  void filter(const View&, const Defocus& defocus, Frame& frame) override {
    const float max_px2 = plan(frame, defocus);
    other_ = frame.rgba;
    for (int pass = 0; static_cast<float>(pass) * kPass_px2 < max_px2; ++pass) {
      parallelFor(static_cast<std::size_t>(frame.size_px.y),
                  [&](std::size_t y) { filterRow(frame, static_cast<int>(y), pass); });
      std::swap(frame.rgba, other_);
    }
  }

  /// Finds the variance that each pixel needs, and the largest in each run. Returns the largest of
  /// all.
  float plan(const Frame& frame, const Defocus& defocus) {
    const glm::ivec2 size = frame.size_px;
    const std::vector<float> point_D = vergences_D(frame, defocus);
    variance_px2_.resize(point_D.size());
    runs_ = (size.x + kRun_px - 1) / kRun_px;
    run_max_px2_.assign(static_cast<std::size_t>(runs_) * size.y, 0.0f);
    for (std::size_t p = 0; p < point_D.size(); ++p) {
      const glm::vec2 radius_px = cappedRadius_px(defocus, point_D[p]);
      variance_px2_[p] = 0.25f * radius_px * radius_px;
      float& run = run_max_px2_[p / size.x * runs_ + p % size.x / kRun_px];
      run = std::max({run, variance_px2_[p].x, variance_px2_[p].y});
    }
    return run_max_px2_.empty() ? 0.0f : *std::ranges::max_element(run_max_px2_);
  }

  /// Filters a row once, from frame.rgba to other_.
  void filterRow(const Frame& frame, int y, int pass) {
    const glm::ivec2 size = frame.size_px;
    const auto row = [&](int at) {
      return frame.rgba.data() + static_cast<std::size_t>(std::clamp(at, 0, size.y - 1)) * size.x;
    };
    const glm::vec4 *above = row(y - 1), *here = row(y), *below = row(y + 1);
    glm::vec4* out = other_.data() + static_cast<std::size_t>(y) * size.x;
    const glm::vec2* variance = variance_px2_.data() + static_cast<std::size_t>(y) * size.x;
    const float done_px2 = static_cast<float>(pass) * kPass_px2;
    for (int run = 0; run < runs_; ++run) {
      // After its last pass a run is copied once, so that both images hold it.
      const float max_px2 = run_max_px2_[static_cast<std::size_t>(y) * runs_ + run];
      if (max_px2 <= done_px2 - kPass_px2) continue;
      const int end = std::min(size.x, (run + 1) * kRun_px);
      for (int x = run * kRun_px; x < end; ++x) {
        const glm::vec2 left = variance[x] - done_px2;
        if (left.x <= 0.0f && left.y <= 0.0f) {
          out[x] = here[x];
          continue;
        }
        // The filter (s/2, 1 - s, s/2) has the variance s.
        const glm::vec2 side = 0.5f * glm::clamp(left, 0.0f, kPass_px2);
        const glm::vec2 middle = 1.0f - 2.0f * side;
        const int before = std::max(x - 1, 0), after = std::min(x + 1, size.x - 1);
        const auto across = [&](const glm::vec4* from) {
          return side.x * (from[before] + from[after]) + middle.x * from[x];
        };
        out[x] = side.y * (across(above) + across(below)) + middle.y * across(here);
      }
    }
  }

  std::vector<glm::vec4> other_;
  std::vector<glm::vec2> variance_px2_;
  std::vector<float> run_max_px2_;
  int runs_ = 0;
};

}  // namespace

MethodEntry rokitaMethod() {
  return filterEntry<RokitaMethod>(
      {.name = "rokita",
       .summary = "3 x 3 convolutions of the pinhole image, repeated as the blur asks for",
       .source = "Rokita 1993",
       .family = MethodFamily::post_filter});
}

}  // namespace foci
