#include "render/image/frame.h"

#include <algorithm>
#include <cstddef>

#include "base/parallel.h"

namespace foci {

namespace {

int inside(int at, int count, ImageBorder border) {
  if (border == ImageBorder::replicate || count == 1) return std::clamp(at, 0, count - 1);
  while (at < 0 || at >= count) at = at < 0 ? -at : 2 * (count - 1) - at;
  return at;
}

}  // namespace

void filterSeparably(std::vector<glm::vec4>& pixels, const glm::ivec2& size_px,
                     const std::vector<float>& kernel, ImageBorder border) {
  const int reach = static_cast<int>(kernel.size()) - 1;
  const auto columns = static_cast<std::size_t>(size_px.x);
  std::vector<glm::vec4> across(pixels.size());
  parallelFor(static_cast<std::size_t>(size_px.y), [&](std::size_t y) {
    std::vector<glm::vec4> row(columns + 2 * static_cast<std::size_t>(reach));
    for (std::size_t i = 0; i < row.size(); ++i) {
      const int x = inside(static_cast<int>(i) - reach, size_px.x, border);
      row[i] = pixels[y * columns + static_cast<std::size_t>(x)];
    }
    for (std::size_t x = 0; x < columns; ++x) {
      const glm::vec4* at = &row[x + static_cast<std::size_t>(reach)];
      glm::vec4 sum = kernel[0] * at[0];
      for (int k = 1; k <= reach; ++k)
        sum += kernel[static_cast<std::size_t>(k)] * (at[-k] + at[k]);
      across[y * columns + x] = sum;
    }
  });
  parallelFor(static_cast<std::size_t>(size_px.y), [&](std::size_t y) {
    const auto rowAt = [&](int k) {
      const int row = inside(static_cast<int>(y) + k, size_px.y, border);
      return &across[static_cast<std::size_t>(row) * columns];
    };
    glm::vec4* to = &pixels[y * columns];
    for (std::size_t x = 0; x < columns; ++x) to[x] = kernel[0] * rowAt(0)[x];
    for (int k = 1; k <= reach; ++k) {
      const glm::vec4 *above = rowAt(-k), *below = rowAt(k);
      for (std::size_t x = 0; x < columns; ++x) {
        to[x] += kernel[static_cast<std::size_t>(k)] * (above[x] + below[x]);
      }
    }
  });
}

}  // namespace foci
