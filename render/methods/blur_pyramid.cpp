#include "render/methods/blur_pyramid.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "base/parallel.h"
#include "render/methods/post_filter.h"
#include "render/optics/lens_field.h"

namespace foci {
namespace {

constexpr int kSide_px = 32;  // of a tile; chosen by hand

/// Outlines are found for this pupil, whatever the lens is: a typical diameter in indoor light.
constexpr float kUsualPupil_m = 0.004f;

/// Variance along an axis of copy j > 0 after interpolation, px^2: 2^j / 2 - 1/3.
///   Even j = 2 k, at 2^-k of the size: the filters (1 4 6 4 1) / 16 before each halving add
///   (4^k - 1) / 3, and the linear interpolation between samples adds 4^k / 6.
///   Odd j: the filter (1 2 1) / 4 on top adds 4^k / 2.
///   j = 1, of the size of the image: the mean of three pixels has 2/3.
constexpr float varianceOf_px2(int j) { return 0.5f * static_cast<float>(1 << j) - 1.0f / 3.0f; }

using Kernel = std::array<float, 3>;  // a symmetric filter, from its middle to one side
constexpr Kernel kThree{1.0f / 3.0f, 1.0f / 3.0f, 0.0f}, kSmooth{0.5f, 0.25f, 0.0f},
    kHalve{0.375f, 0.25f, 0.0625f};

/// Filters an image along x and y, and keeps every `step`-th sample.
void filter(const std::vector<glm::vec4>& from, const glm::ivec2& size, const Kernel& kernel,
            int step, std::vector<glm::vec4>& to, const glm::ivec2& to_size) {
  std::vector<glm::vec4> rows(static_cast<std::size_t>(to_size.x) * size.y);
  parallelFor(static_cast<std::size_t>(size.y), [&](std::size_t y) {
    const glm::vec4* in = from.data() + y * size.x;
    const auto at = [&](int x) { return in[std::clamp(x, 0, size.x - 1)]; };
    for (int i = 0; i < to_size.x; ++i) {
      const int x = step * i;
      rows[y * to_size.x + i] = kernel[0] * at(x) + kernel[1] * (at(x - 1) + at(x + 1)) +
                                kernel[2] * (at(x - 2) + at(x + 2));
    }
  });
  to.resize(static_cast<std::size_t>(to_size.x) * to_size.y);
  parallelFor(static_cast<std::size_t>(to_size.y), [&](std::size_t row) {
    const auto at = [&](int dy) {
      const int y = std::clamp(step * static_cast<int>(row) + dy, 0, size.y - 1);
      return rows.data() + static_cast<std::size_t>(y) * to_size.x;
    };
    const glm::vec4 *a = at(-2), *b = at(-1), *c = at(0), *d = at(1), *e = at(2);
    glm::vec4* out = to.data() + row * to_size.x;
    for (int x = 0; x < to_size.x; ++x) {
      out[x] = kernel[0] * c[x] + kernel[1] * (b[x] + d[x]) + kernel[2] * (a[x] + e[x]);
    }
  });
}

/// The blur's variance along an axis, mean over all axes, px^2: a + b d + c d^2 for a point that is
/// d dioptres beyond the focus.
glm::vec3 meanVariance_px2(const LocalLens& lens, const Defocus& defocus) {
  const glm::mat2 in_focus = lens.blur_px(defocus, defocus.focus_D);
  const glm::mat2 per_D = lens.imagePerAngle() * lens.pupil();
  const auto dot = [](const glm::mat2& a, const glm::mat2& b) {
    return kDiscVariancePerRadius2 * (glm::dot(a[0], b[0]) + glm::dot(a[1], b[1]));
  };
  const float coma = lens[LocalLens::kCxx] + lens[LocalLens::kCyy];
  return 0.5f *
         glm::vec3(dot(in_focus, in_focus) + coma, 2.0f * dot(in_focus, per_D), dot(per_D, per_D));
}

/// Gives each empty pixel the mean vergence of the smallest square around it that is not empty. So
/// an outline in front of nothing is blurred equally on both sides.
void continueOver(std::vector<float>& point_D, const Frame& sharp) {
  struct Means {
    glm::ivec2 size;
    std::vector<glm::vec2> sum_count;
  };
  std::vector<Means> levels(1);
  levels[0].size = sharp.size_px;
  levels[0].sum_count.resize(point_D.size());
  bool any_empty = false;
  for (std::size_t p = 0; p < point_D.size(); ++p) {
    const bool shows = sharp.depth_m[p] > 0.0f;
    levels[0].sum_count[p] = shows ? glm::vec2(point_D[p], 1.0f) : glm::vec2(0.0f);
    any_empty = any_empty || !shows;
  }
  if (!any_empty) return;
  while (levels.back().size != glm::ivec2(1)) {
    Means half{.size = (levels.back().size + 1) / 2, .sum_count = {}};
    half.sum_count.resize(static_cast<std::size_t>(half.size.x) * half.size.y);
    const Means& all = levels.back();
    for (std::size_t p = 0; p < all.sum_count.size(); ++p) {
      half.sum_count[p / all.size.x / 2 * half.size.x + p % all.size.x / 2] += all.sum_count[p];
    }
    levels.push_back(std::move(half));
  }
  for (std::size_t p = 0; p < point_D.size(); ++p) {
    glm::ivec2 at(static_cast<int>(p % sharp.size_px.x), static_cast<int>(p / sharp.size_px.x));
    for (const Means& level : levels) {
      const glm::vec2& mean = level.sum_count[static_cast<std::size_t>(at.y) * level.size.x + at.x];
      if (mean.y > 0.0f) {
        point_D[p] = mean.x / mean.y;
        break;
      }
      at /= 2;
    }
  }
}

}  // namespace

void BlurPyramid::set(Frame sharp, const View& view) {
  sharp_ = std::move(sharp);
  principal_px_ = view.principal_px;
  point_D_ = vergences_D(sharp_, {.radius_px_per_D = 0.5f * kUsualPupil_m * view.focal_px});
  continueOver(point_D_, sharp_);
  Copy& first = copies_[1];
  first.size = sharp_.size_px;
  filter(sharp_.rgba, sharp_.size_px, kThree, 1, first.rgba, first.size);
  for (std::size_t j = 2; j <= kCopies; j += 2) {
    const glm::ivec2 size = j == 2 ? sharp_.size_px : copies_[j - 2].size;
    Copy& half = copies_[j];
    half.size = size / 2 + 1;
    filter(j == 2 ? sharp_.rgba : copies_[j - 2].rgba, size, kHalve, 2, half.rgba, half.size);
    if (j == kCopies) break;
    copies_[j + 1].size = half.size;
    filter(half.rgba, half.size, kSmooth, 1, copies_[j + 1].rgba, half.size);
  }
}

/// Blurs one tile of the image.
class BlurPyramid::Tile {
 public:
  Tile(const BlurPyramid& pyramid, const Defocus& defocus, const glm::ivec2& corner)
      : pyramid_(pyramid),
        defocus_(defocus),
        corner_(corner),
        size_(glm::min(pyramid.sharp_.size_px - corner, kSide_px)) {
    const LensField* field = shownField(defocus);
    if (!field) return;
    for (int i = 0; i < 4; ++i) {
      const glm::vec2 at_px(corner + kSide_px * glm::ivec2(i % 2, i / 2));
      variance_px2_[i] = meanVariance_px2(field->at(at_px - pyramid.principal_px_), defocus);
    }
  }

  void renderRow(int y, Frame& frame) const {
    float level[kSide_px];               // by pixel
    int finer[kSide_px];                 // of the two copies that a pixel interpolates
    Colour rows[kCopies + 1][kSide_px];  // by copy
    findLevels(y, level);
    int first = kCopies, last = 0;
    for (int x = 0; x < size_.x; ++x) {
      finer[x] = std::min(static_cast<int>(level[x]), kCopies - 1);
      first = std::min(first, finer[x]);
      last = std::max(last, finer[x]);
    }
    for (int j = first; j <= last + 1; ++j) interpolateRow(j, y, rows[j]);
    glm::vec4* out = frame.rgba.data() + indexOf(y);
    for (int x = 0; x < size_.x; ++x) {
      const int j = finer[x];
      const Colour from = rows[j][x];
      put(from + (level[x] - static_cast<float>(j)) * (rows[j + 1][x] - from), out[x]);
    }
  }

 private:
  using Colour = float __attribute__((vector_size(16)));

  static Colour colour(const glm::vec4& from) {
    Colour result;
    std::memcpy(&result, &from, sizeof result);
    return result;
  }

  static void put(const Colour& from, glm::vec4& to) { std::memcpy(&to, &from, sizeof to); }

  std::size_t indexOf(int y) const {
    return static_cast<std::size_t>(corner_.y + y) * pyramid_.sharp_.size_px.x + corner_.x;
  }

  /// j + t where the variance lies between those of copies j and j + 1, at the fraction t.
  static float levelOf(float variance_px2) {
    const float first_px2 = varianceOf_px2(1);
    // From copy 1 on, 2 (variance + 1/3) is 2^j, and between two copies 2^j (1 + t).
    const float power = 2.0f * variance_px2 + 2.0f / 3.0f;
    const int j = (std::bit_cast<int>(power) >> 23) - 127;
    const float rest = power * std::bit_cast<float>((127 - j) << 23);
    const float beyond = static_cast<float>(j) + (rest - 1.0f);
    const float level = variance_px2 <= first_px2 ? variance_px2 * (1.0f / first_px2) : beyond;
    return std::min(level, static_cast<float>(kCopies));
  }

  /// Finds the level of each pixel in a row of the tile.
  void findLevels(int y, float* level) const {
    const float* point_D = pyramid_.point_D_.data() + indexOf(y);
    const glm::vec2 finite = glm::min(defocus_.radius_px_per_D, glm::vec2(1e6f));
    const float radius_px_per_D = std::sqrt(finite.x * finite.y);
    const auto find = [&](auto&& defocus_D) {
      for (int x = 0; x < size_.x; ++x) {
        const float radius_px = std::min(radius_px_per_D * defocus_D(point_D[x]), kMaxRadius_px);
        level[x] = levelOf(kDiscVariancePerRadius2 * radius_px * radius_px);
      }
    };
    if (shownField(defocus_)) {
      const auto share = [](int pixel) { return (static_cast<float>(pixel) + 0.5f) / kSide_px; };
      const glm::vec3 left = glm::mix(variance_px2_[0], variance_px2_[2], share(y));
      const glm::vec3 right = glm::mix(variance_px2_[1], variance_px2_[3], share(y));
      for (int x = 0; x < size_.x; ++x) {
        const float off_D = defocus_.focus_D - point_D[x];
        level[x] = levelOf(
            glm::dot(glm::mix(left, right, share(x)), glm::vec3(1.0f, off_D, off_D * off_D)));
      }
    } else if (isAstigmatic(defocus_)) {
      find([&](float each_D) { return std::abs(roundDefocus_D(defocus_, each_D)); });
    } else {
      find([focus_D = defocus_.focus_D](float each_D) { return std::abs(each_D - focus_D); });
    }
  }

  /// Row y of the tile in copy j, which has a sample every 2^(j/2) pixels; copy 0 is the image.
  void interpolateRow(int j, int y, Colour* to) const {
    const int k = j / 2, step = 1 << k;
    const std::size_t copy_j = static_cast<std::size_t>(j);
    if (k == 0) {
      const auto& rgba = j == 0 ? pyramid_.sharp_.rgba : pyramid_.copies_[copy_j].rgba;
      std::memcpy(to, rgba.data() + indexOf(y), size_.x * sizeof(Colour));
      return;
    }
    const Copy& copy = pyramid_.copies_[copy_j];
    const int at_y = corner_.y + y, coarse_y = at_y >> k;
    const float inverse = 1.0f / static_cast<float>(step);
    const float ty = static_cast<float>(at_y & (step - 1)) * inverse;
    const glm::vec4* above = copy.rgba.data() + static_cast<std::size_t>(coarse_y) * copy.size.x;
    const glm::vec4* below = coarse_y + 1 < copy.size.y ? above + copy.size.x : above;
    const auto between = [&](int x) {
      const int from = std::min(x, copy.size.x - 1);
      const Colour upper = colour(above[from]);
      return upper + ty * (colour(below[from]) - upper);
    };
    int coarse_x = corner_.x >> k, rest = corner_.x & (step - 1);
    Colour before = between(coarse_x);
    for (int x = 0; x < size_.x; rest = 0) {
      const Colour after = between(++coarse_x), change = after - before;
      for (; rest < step && x < size_.x; ++rest, ++x) {
        to[x] = before + static_cast<float>(rest) * inverse * change;
      }
      before = after;
    }
  }

  const BlurPyramid& pyramid_;
  const Defocus& defocus_;
  glm::ivec2 corner_, size_;
  glm::vec3 variance_px2_[4]{};  // at the tile's corners; with a field only
};

void BlurPyramid::blur(const Defocus& defocus, Frame& frame) const {
  // Row by row through all tiles: memory is read in its order.
  constexpr int kRows = kSide_px / 2;
  const glm::ivec2 size_px = sharp_.size_px;
  parallelFor((size_px.y + kRows - 1) / kRows, [&](std::size_t i) {
    const int first = kRows * static_cast<int>(i), top = first / kSide_px * kSide_px;
    std::vector<Tile> tiles;
    for (int x = 0; x < size_px.x; x += kSide_px) {
      tiles.emplace_back(*this, defocus, glm::ivec2(x, top));
    }
    for (int y = first; y < std::min(first + kRows, size_px.y); ++y) {
      for (const Tile& tile : tiles) tile.renderRow(y - top, frame);
    }
  });
  if (!frame.depth_m.empty()) frame.depth_m = sharp_.depth_m;
}

}  // namespace foci
