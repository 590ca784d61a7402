// Writes a landscape of any number of surfels, tile by tile: the scenes larger than memory of
// docs/scenes.md.
//
//     foci_large_scene OUT.foci MILLIONS
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/glm.hpp>

#include "render/lod/moment_tree.h"
#include "render/scene/io/foci_file.h"

namespace foci {
namespace {

constexpr int kPartLevel = 8;  // 16 x 16 tiles
constexpr std::size_t kTiles = 16;
constexpr double kSpacing_m = 0.02;

/// Hills of 3 m to ripples of a hand's breadth.
struct Ground {
  double height_m, slope_x, slope_z;
};

Ground groundAt(double x_m, double z_m) {
  Ground ground{};
  double wave_per_m = 0.05, height_m = 3.0, turn_rad = 0.3;
  for (int octave = 0; octave < 9; ++octave) {
    const double along_x = wave_per_m * std::cos(turn_rad),
                 along_z = wave_per_m * std::sin(turn_rad);
    const double phase = along_x * x_m + along_z * z_m + octave;
    ground.height_m += height_m * std::sin(phase);
    ground.slope_x += height_m * along_x * std::cos(phase);
    ground.slope_z += height_m * along_z * std::cos(phase);
    wave_per_m *= 1.9;
    height_m *= 0.45;
    turn_rad += 2.4;
  }
  return ground;
}

/// A number from 0 to 1 by the place on the grid.
double hashed(std::size_t i, std::size_t j, std::uint64_t what) {
  std::uint64_t h = (i * 0x9e3779b97f4a7c15u) ^ (j * 0xc2b2ae3d27d4eb4fu) ^ (what << 60);
  h = (h ^ (h >> 31)) * 0xbf58476d1ce4e5b9u;
  h = (h ^ (h >> 29)) * 0x94d049bb133111ebu;
  return static_cast<double>(h >> 11) / 9007199254740992.0;
}

/// @param side  surfels along each side of a tile
SurfelCloud tile(std::size_t tile_x, std::size_t tile_z, std::size_t side) {
  SurfelCloud cloud;
  cloud.oriented = true;
  const double middle = 0.5 * static_cast<double>(kTiles * side);
  for (std::size_t z = tile_z * side; z < (tile_z + 1) * side; ++z) {
    for (std::size_t x = tile_x * side; x < (tile_x + 1) * side; ++x) {
      const double x_m = kSpacing_m * (static_cast<double>(x) + hashed(x, z, 1) - middle);
      const double z_m = kSpacing_m * (static_cast<double>(z) + hashed(x, z, 2) - middle);
      const Ground ground = groundAt(x_m, z_m);
      const glm::vec3 up(glm::normalize(glm::dvec3(-ground.slope_x, 1.0, -ground.slope_z)));
      const auto area_m2 = static_cast<float>(kSpacing_m * kSpacing_m) / up.y;
      const auto dry = static_cast<float>(0.5 + 0.5 * std::tanh(0.7 * ground.height_m));
      const auto grain = static_cast<float>(0.7 + 0.6 * hashed(x / 3, z / 3, 3));
      appendSurfel(
          cloud, {x_m, ground.height_m, z_m}, up, kSigmaPerSpacing * std::sqrt(area_m2), area_m2,
          grain * glm::mix(glm::vec3(0.05f, 0.14f, 0.03f), glm::vec3(0.36f, 0.27f, 0.16f), dry));
    }
  }
  return cloud;
}

/// Every other bit of a number, from the last one or the one before.
std::size_t everyOtherBit(std::size_t number, int first) {
  std::size_t bits = 0;
  for (int bit = 0; bit < kPartLevel / 2; ++bit) {
    bits |= (number >> (2 * bit + first) & 1) << bit;
  }
  return bits;
}

int run(const char* out, double millions) {
  const auto side = static_cast<std::size_t>(std::sqrt(millions * 1e6) / kTiles);
  const std::uint64_t count = std::uint64_t{side} * side << kPartLevel;
  std::printf("%.1f million surfels, %.0f m wide\n", static_cast<double>(count) / 1e6,
              kSpacing_m * static_cast<double>(kTiles * side));
  SurfelCloud like;
  like.oriented = true;
  SurfelFileWriter writer(out, count, kPartLevel, like, {.up_axis = 1});
  for (std::size_t part = 0; part < kTiles * kTiles; ++part) {
    writer.add(part, MomentTree(tile(everyOtherBit(part, 1), everyOtherBit(part, 0), side)));
    std::fprintf(stderr, "\rtile %zu of %zu", part + 1, kTiles * kTiles);
  }
  std::fputs("\nchecksums\n", stderr);
  writer.finish();
  return 0;
}

}  // namespace
}  // namespace foci

int main(int argc, char** argv) {
  const double millions = argc == 3 ? std::atof(argv[2]) : 0.0;
  if (!(millions >= 0.1 && millions <= 2000.0)) {
    std::fputs("foci_large_scene OUT.foci MILLIONS (0.1 to 2000)\n", stderr);
    return 2;
  }
  return foci::run(argv[1], millions);
}
