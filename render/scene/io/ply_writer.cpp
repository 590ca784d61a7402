#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>

#include "render/image/srgb.h"
#include "render/scene/io/ply.h"

namespace foci {
namespace {

constexpr std::size_t kWriteBlock = 1 << 20;  // bytes written together

}  // namespace

void writePly(const std::filesystem::path& path, const PointCloud& points,
              const PlyProperty& further) {
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "wb"));
  std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                    std::to_string(points.size()) +
                    "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!points.normal.empty()) out += "property float nx\nproperty float ny\nproperty float nz\n";
  out += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (!points.radius_m.empty()) out += "property float radius\n";
  if (!points.opacity.empty()) out += "property float opacity\n";
  if (!further.values.empty()) out += "property float " + further.name + "\n";
  out += "end_header\n";

  const auto put = [&out](float value) {
    auto raw = std::bit_cast<std::array<char, 4>>(value);
    if (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
    out.append(raw.data(), raw.size());
  };
  const auto put3 = [&put](const glm::vec3& v) { put(v.x), put(v.y), put(v.z); };
  bool good = file != nullptr;
  for (std::size_t i = 0; good && i < points.size(); ++i) {
    put3(points.position_m[i]);
    if (!points.normal.empty()) put3(points.normal[i]);
    for (int c = 0; c < 3; ++c) {
      const float linear = std::clamp(points.color[i][c], 0.0f, 1.0f);
      out += static_cast<char>(std::lround(255.0f * srgbFromLinear(linear)));
    }
    if (!points.radius_m.empty()) put(points.radius_m[i]);
    if (!points.opacity.empty()) put(points.opacity[i]);
    if (!further.values.empty()) put(further.values[i]);
    if (out.size() >= kWriteBlock) {
      good = std::fwrite(out.data(), 1, out.size(), file.get()) == out.size();
      out.clear();
    }
  }
  good = good && std::fwrite(out.data(), 1, out.size(), file.get()) == out.size() &&
         std::fflush(file.get()) == 0;
  if (!good) throw std::runtime_error(path.string() + ": cannot be written");
}

}  // namespace foci
