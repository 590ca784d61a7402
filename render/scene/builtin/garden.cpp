// A garden of 3D Gaussians, with what makes captured scenes hard to blur: opaque surfaces of
// overlapping flat Gaussians, blades thinner than a pixel, a veil that lets light through,
// floaters, and boards one behind the other.
#include <cmath>
#include <numbers>

#include "render/scene/builtin/pattern.h"
#include "render/scene/builtin/procedural.h"
#include "render/scene/gaussian_cloud.h"
#include "render/scene/harmonics.h"

namespace foci {
namespace {

constexpr float kSurfaceStep_m = 0.014f;  // between Gaussians of the wall and the ground
constexpr float kThickness_m = 5e-4f;
constexpr float kBallRadius_m = 0.16f;
constexpr int kBallGaussians = 5000, kBlades = 420, kPartsOfABlade = 7, kFloaters = 40;
const glm::vec3 kBallCentre_m(-0.22f, kBallRadius_m, -1.25f), kTuft_m(0.16f, 0.0f, -0.95f);

/// Numbers from 0 to 1 that belong to item `i`.
struct Dice {
  std::int32_t i, seed;
  float operator()(std::int32_t which) const { return hash01(i, which, seed); }
  float between(float low, float high, std::int32_t which) const {
    return low + (high - low) * (*this)(which);
  }
};

/// Appends a Gaussian with its axes, each a standard deviation long, perpendicular to each other.
/// @param display  colour, display values
void appendGaussian(GaussianCloud& cloud, const glm::vec3& position_m, const glm::mat3& axes_m,
                    float opacity, const glm::vec3& display) {
  cloud.position_m.push_back(position_m);
  cloud.covariance_m2.push_back(covarianceOf(axes_m));
  cloud.opacity.push_back(opacity);
  cloud.color.push_back(display);
  cloud.harmonics.resize(cloud.size() * cloud.harmonicsPerGaussian());
}

/// A flat Gaussian, `spacing_m` from its neighbours, of the shapes that training leaves: wider
/// along one direction, and turned.
void appendFlat(GaussianCloud& cloud, const glm::vec3& position_m, const glm::vec3& normal,
                float spacing_m, const glm::vec3& display, const Dice& dice) {
  const float turn = dice(0) * std::numbers::pi_v<float>;
  const float stretch = std::exp2(dice.between(-0.5f, 0.5f, 1));
  const glm::vec3 u = tangentTo(normal), v = glm::cross(normal, u);
  const float sigma_m = kSigmaPerSpacing * spacing_m;
  const glm::vec3 along = std::cos(turn) * u + std::sin(turn) * v,
                  across = glm::cross(normal, along);
  appendGaussian(cloud, position_m,
                 {sigma_m * stretch * along, sigma_m / stretch * across, kThickness_m * normal},
                 dice.between(0.85f, 0.99f, 2), display);
}

/// A board of `size_m` about `centre_m` that spans `u` and `v`: two layers, so that it is opaque.
template <typename ColorOf>
void addBoard(GaussianCloud& cloud, const glm::vec3& centre_m, const glm::vec3& u,
              const glm::vec3& v, const glm::vec2& size_m, float step_m, std::int32_t seed,
              const ColorOf& colorOf) {
  const glm::ivec2 count(glm::ceil(size_m / step_m));
  const glm::vec3 normal = glm::cross(u, v);
  for (int layer = 0; layer < 2; ++layer) {
    for (int y = 0; y < count.y; ++y) {
      for (int x = 0; x < count.x; ++x) {
        const Dice dice{(layer * count.y + y) * count.x + x, seed};
        const glm::vec2 jitter(dice(10), dice(11));
        const glm::vec2 at_m = ((glm::vec2(x, y) + jitter) / glm::vec2(count) - 0.5f) * size_m;
        const glm::vec3 p_m =
            centre_m + at_m.x * u + at_m.y * v - static_cast<float>(layer) * 2e-3f * normal;
        appendFlat(cloud, p_m, normal, step_m, colorOf(at_m), dice);
      }
    }
  }
}

const glm::vec3 kRight(1.0f, 0.0f, 0.0f), kUpward(0.0f, 1.0f, 0.0f), kTowards(0.0f, 0.0f, 1.0f);

void addWallAndGround(GaussianCloud& cloud) {
  addBoard(cloud, {0.0f, 0.55f, -3.0f}, kRight, kUpward, {3.0f, 1.5f}, kSurfaceStep_m, 1,
           [](const glm::vec2& p) {
             const float bricks = lines(8.0f * p.y, 0.06f) + lines(3.0f * p.x, 0.03f);
             return glm::mix(glm::vec3(0.62f, 0.38f, 0.3f), glm::vec3(0.85f, 0.82f, 0.75f),
                             std::min(bricks, 1.0f)) *
                    (0.75f + 0.4f * fractalNoise(12.0f * p, 4, 2));
           });
  addBoard(cloud, {0.0f, 0.0f, -1.8f}, kRight, -kTowards, {3.0f, 2.4f}, kSurfaceStep_m, 3,
           [](const glm::vec2& p) {
             const float tiles = checker(9.0f * p);
             return glm::mix(glm::vec3(0.35f, 0.33f, 0.3f), glm::vec3(0.7f, 0.68f, 0.6f), tiles) *
                    (0.8f + 0.3f * fractalNoise(20.0f * p, 3, 4));
           });
}

/// Striped boards from 0.8 to 2.4 m away, each partly behind the one before.
void addBoards(GaussianCloud& cloud) {
  constexpr int kBoards = 4;
  for (int i = 0; i < kBoards; ++i) {
    const auto f = static_cast<float>(i);
    const float depth_m = 0.8f * std::pow(3.0f, f / (kBoards - 1));
    const glm::vec3 centre_m((0.05f + 0.1f * f) * depth_m, 0.42f - 0.02f * f, -depth_m);
    addBoard(cloud, centre_m, kRight, kUpward, glm::vec2(0.14f, 0.18f) * depth_m, 0.004f * depth_m,
             10 + i, [&](const glm::vec2& p) {
               const glm::vec3 stripes =
                   0.5f + 0.35f * glm::vec3(std::sin(140.0f / depth_m * p.x + f),
                                            std::sin(90.0f / depth_m * p.y + 2.0f * f),
                                            std::sin(60.0f / depth_m * (p.x + p.y) + f));
               return stripes * glm::vec3(1.0f, 0.9f - 0.1f * f, 0.6f + 0.12f * f);
             });
  }
}

/// A ball whose colour depends on the side that it is seen from.
void addBall(GaussianCloud& cloud) {
  constexpr float kGolden = 2.39996323f;  // of an even spiral, radians
  const float spacing_m = kBallRadius_m * std::sqrt(4.0f * std::numbers::pi_v<float> /
                                                    static_cast<float>(kBallGaussians));
  for (int i = 0; i < kBallGaussians; ++i) {
    const float y =
        1.0f - (2.0f * static_cast<float>(i) + 1.0f) / static_cast<float>(kBallGaussians);
    const float r = std::sqrt(1.0f - y * y), turn = kGolden * static_cast<float>(i);
    const glm::vec3 normal(r * std::cos(turn), y, r * std::sin(turn));
    const float band = lines(5.0f * y + 0.6f * normal.x, 0.2f);
    const glm::vec3 display =
        glm::mix(glm::vec3(0.2f, 0.35f, 0.65f), glm::vec3(0.95f, 0.85f, 0.4f), band);
    appendFlat(cloud, kBallCentre_m + kBallRadius_m * normal, normal, spacing_m,
               display * (0.75f + 0.25f * y), {i, 20});
    // Brighter where it is seen along the normal: coefficients of degree 1 against Y_1 to Y_3.
    const glm::vec3 along = 0.15f * glm::vec3(normal.y, -normal.z, normal.x) / kHarmonicsStep;
    std::int16_t* const all = &cloud.harmonics[(cloud.size() - 1) * cloud.harmonicsPerGaussian()];
    for (int k = 0; k < 9; ++k) all[k] = static_cast<std::int16_t>(std::lround(along[k / 3]));
  }
}

/// Bent blades of thin Gaussians, end to end.
void addTuft(GaussianCloud& cloud) {
  for (int i = 0; i < kBlades; ++i) {
    const Dice dice{i, 30};
    const float turn = 2.0f * std::numbers::pi_v<float> * dice(0);
    const glm::vec3 out(std::cos(turn), 0.0f, std::sin(turn));
    const float reach_m = 0.09f * std::sqrt(dice(1)), height_m = dice.between(0.1f, 0.3f, 2);
    const float bend_m = dice.between(0.0f, 0.12f, 3), width_m = dice.between(3e-4f, 1.2e-3f, 4);
    const glm::vec3 root_m = kTuft_m + reach_m * out;
    const glm::vec3 display(dice.between(0.2f, 0.5f, 5), dice.between(0.45f, 0.8f, 6), 0.2f);
    const auto at = [&](float t) { return root_m + height_m * t * kUpward + bend_m * t * t * out; };
    for (int part = 0; part < kPartsOfABlade; ++part) {
      const float t0 = static_cast<float>(part) / kPartsOfABlade, t1 = t0 + 1.0f / kPartsOfABlade;
      const glm::vec3 span_m = at(t1) - at(t0), along = glm::normalize(span_m);
      const glm::vec3 u = tangentTo(along);
      appendGaussian(
          cloud, 0.5f * (at(t0) + at(t1)),
          {kSigmaPerSpacing * span_m, width_m * u, 0.5f * width_m * glm::cross(along, u)}, 0.9f,
          display * (0.6f + 0.4f * t1));
    }
  }
}

/// A veil 0.65 m away, and floaters between it and the ball.
void addVeil(GaussianCloud& cloud) {
  addBoard(cloud, {-0.15f, 0.42f, -0.65f}, kRight, kUpward, {0.22f, 0.2f}, 0.02f, 40,
           [](const glm::vec2& p) {
             return glm::vec3(0.85f, 0.85f, 0.95f) * (0.7f + 0.3f * noise(30.0f * p, 41));
           });
  for (std::size_t i = cloud.size(); i-- > 0 && cloud.position_m[i].z > -0.7f;) {
    cloud.opacity[i] *= 0.1f;
  }
  for (int i = 0; i < kFloaters; ++i) {
    const Dice dice{i, 50};
    const float size_m = dice.between(0.004f, 0.03f, 0);
    appendGaussian(
        cloud,
        {dice.between(-0.4f, 0.4f, 1), dice.between(0.05f, 0.6f, 2), dice.between(-1.2f, -0.7f, 3)},
        glm::mat3(size_m), dice.between(0.02f, 0.12f, 4), glm::vec3(dice.between(0.4f, 0.9f, 5)));
  }
}

}  // namespace

GaussianCloud makeGarden() {
  GaussianCloud cloud;
  cloud.degree = 1;
  addWallAndGround(cloud);
  addBoards(cloud);
  addBall(cloud);
  addTuft(cloud);
  addVeil(cloud);
  return cloud;
}

EyePose gardenEyePose() { return {{0.0f, 0.42f, 0.0f}, {0.0f, 0.3f, -1.2f}}; }

}  // namespace foci
