// Linear images that foci writes (PFM), for tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

namespace foci::e2e {

/// A linear image (PFM), top row first.
struct LinearImage {
  int width = 0, height = 0, channels = 0;
  std::vector<float> values;

  explicit LinearImage(const std::string& pfm) {
    std::istringstream header(pfm);
    std::string magic, scale;
    header >> magic >> width >> height >> scale;
    channels = magic == "PF" ? 3 : 1;
    values.resize(static_cast<std::size_t>(width) * height * channels);
    const std::size_t bytes = values.size() * sizeof(float);
    if (pfm.size() < bytes) return;
    std::memcpy(values.data(), pfm.data() + pfm.size() - bytes, bytes);
  }

  float at(int x, int y, int channel = 0) const {
    return values[(static_cast<std::size_t>(height - 1 - y) * width + x) * channels + channel];
  }

  /// The largest step between neighbours in a row, among the columns `x0` to `x1`.
  float steepestIn(int row, int x0, int x1) const {
    float most = 0.0f;
    for (int x = x0 + 1; x < x1; ++x) {
      most = std::max(most, std::abs(at(x, row) - at(x - 1, row)));
    }
    return most;
  }
};

}  // namespace foci::e2e
