#include "render/gl/gaussians.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <limits>
#include <string>

#include "base/parallel.h"
#include "base/transformed.h"
#include "render/gl/frame_stages.h"

namespace foci {
namespace {

template <typename T>
std::vector<T> readArray(const GpuBuffer& buffer, std::size_t count) {
  std::vector<T> values(count);
  buffer.read(0, count * sizeof(T), values.data());
  return values;
}

/// What shaders/gaussian_blurs.glsl lists.
std::vector<ListedGaussian> gaussiansOf(std::span<const glm::uvec2> listed) {
  constexpr std::uint32_t kStepBits = 3;
  return transformed(listed, [](const glm::uvec2& each) {
    return ListedGaussian{.blur_px = std::bit_cast<float>(each.x),
                          .opacity = std::bit_cast<float>(each.y & ~kStepBits),
                          .step_px = 1 << (each.y & kStepBits)};
  });
}

}  // namespace

GpuFrameBlock GpuGaussians::blockOf(const View& view, const Defocus& defocus,
                                    const GaussianCutSettings* lod) const {
  GpuFrameBlock block = viewBlockOf(view, defocus, lod ? lod->acuity : Acuity{});
  if (lod) block.cut = {lod->per_blur2, lod->per_pixel2, lod->per_acuity2, view.near_m};
  block.size.w = lod != nullptr;
  block.scene = {static_cast<int>(scene_->size()), scene_->levels(), block.scene.z,
                 scene_->preservesLight()};
  return block;
}

void GpuGaussians::start(const GpuFrameBlock& block, bool cut,
                         const std::vector<SubApertureSize>& sizes) {
  stages_.start(block, cut);
  const std::size_t entries = stages_.entryRoom();
  own_.projected.a.reserve(*device_, entries * 2 * kVector_bytes, "the projected Gaussians");
  own_.projected.b.reserve(*device_, entries * 2 * kVector_bytes, "the projected Gaussians");
  static_assert(sizeof(SubApertureSize) == sizeof(glm::vec2));
  own_.sizes.reserve(*device_, sizes.size() * sizeof(SubApertureSize), "the sub-apertures");
  own_.sizes.write(0, sizes.size() * sizeof(SubApertureSize), sizes.data());
}

void GpuGaussians::selectCut(float max_px2) {
  const GpuGaussianScene::Buffers& scene = scene_->buffers();
  const GpuFrameStages::Buffers& common = stages_.buffers();
  for (int level = 0; level < scene_->levels(); ++level) {
    const GLuint program = stages_.bind(
        "gaussian_cut", {}, {&scene.node_places, &scene.node_spreads, &common.own, &common.passed});
    glProgramUniform1i(program, 0, level);
    glProgramUniform1f(program, 1, std::min(max_px2, std::numeric_limits<float>::max()));
    GpuFrameStages::dispatch(groupsOf(std::size_t{1} << level, 64));
  }
  stages_.gatherCut();
}

void GpuGaussians::projectEntries(bool cut, std::size_t sizes) {
  const GpuGaussianScene::Buffers& scene = scene_->buffers();
  const GpuFrameStages::Buffers& common = stages_.buffers();
  const bool harmonics = scene_->degree() > 0;
  const GLuint program = stages_.bind(
      "gaussian_project",
      "#define DEGREE " + std::to_string(scene_->degree()) + (cut ? "\n#define CUT\n" : "\n"),
      {cut ? &common.entries : nullptr, nullptr, nullptr, nullptr, &own_.projected.a, &common.keys,
       nullptr, nullptr, &own_.projected.b, &own_.sizes});
  glProgramUniform1i(program, 1, static_cast<GLint>(sizes));
  const auto bindArray = [&](GLuint gaussians, GLuint its_harmonics,
                             const GpuGaussianScene::Array& array, const GpuWindow& window) {
    GpuFrameStages::bindWindow(gaussians, array.gaussians, window,
                               GpuGaussianScene::kGaussian_bytes);
    if (!harmonics) return;
    GpuFrameStages::bindWindow(its_harmonics, array.harmonics, window, scene_->harmonics_bytes());
  };
  // Of large arrays a shader sees a window at a time: one pass for each.
  for (std::size_t pass = 0; pass < scene_->windows(); ++pass) {
    const GpuWindow nodes = scene_->nodeWindow(pass), gaussians = scene_->gaussianWindow(pass);
    bindArray(1, 2, scene.gaussians, gaussians);
    if (cut) bindArray(3, 6, scene.nodes, nodes);
    stages_.projectWindows(program, nodes, gaussians);
  }
}

GpuStats GpuGaussians::project(const View& view, const Defocus& defocus,
                               const std::vector<SubApertureSize>& sizes,
                               const GaussianCutSettings* lod) {
  assert(!lod || scene_->levels() > 0);
  const GpuDevice::Use use(*device_);
  tiles_.clear();
  divided_.clear();
  const bool cut = lod != nullptr;
  const GpuFrameBlock block = blockOf(view, defocus, lod);
  stages_.setField(defocus);
  GpuTotals totals;
  do {
    start(block, cut, sizes);
    stages_.beginTimes();
    if (cut) selectCut(lod->max_px2);
    stages_.note(GpuStage::cut);
    projectEntries(cut, sizes.size());
    stages_.note(GpuStage::project);
    stages_.sortIntoTiles();
    totals = stages_.totals();
  } while (stages_.grew(totals));
  stages_.checkLoops(totals);
  return {.splats = totals.splats, .times = stages_.times()};
}

void GpuGaussians::readTiles() {
  if (!tiles_.empty()) return;
  const GpuDevice::Use use(*device_);
  const GpuFrameStages::Buffers& common = stages_.buffers();
  const std::size_t count = stages_.tileCount();
  const auto squares = readArray<glm::ivec4>(common.tiles, count);
  const auto largest = readArray<float>(common.blurs, count);
  const auto ranges = readArray<glm::uvec2>(common.ranges, count);
  device_->check();
  on_gpu_.clear();
  for (std::size_t cell = 0; cell < count; ++cell) {
    const glm::ivec4& square = squares[cell];
    if (square.z == 0) continue;
    tiles_.push_back({square.x, square.y, square.z, square.w, largest[cell]});
    on_gpu_.push_back(
        {tiles_.back(), static_cast<std::uint32_t>(cell), ranges[cell].x, ranges[cell].y});
  }
}

const std::vector<Tile>& GpuGaussians::tiles() {
  readTiles();
  return tiles_;
}

const std::vector<TileLayers>& GpuGaussians::divide(bool several) {
  readTiles();
  const GpuDevice::Use use(*device_);
  const GpuFrameStages::Buffers& common = stages_.buffers();
  const std::size_t count = stages_.tileCount();
  own_.radii.reserve(*device_, count * sizeof(float), "the tiles");
  stages_.bind("gaussian_blurs", several ? "#define LISTED\n" : "",
               {&common.lists, &common.ranges, &common.keys, &own_.projected.b, &own_.radii,
                several ? &common.scratch : nullptr});  // its room is free after the sort
  GpuFrameStages::dispatch(count);
  const auto radii = readArray<float>(own_.radii, count);
  std::size_t entries = 0;
  if (several) {
    for (const GpuTile& tile : on_gpu_) entries = std::max<std::size_t>(entries, tile.end);
  }
  const auto listed = readArray<glm::uvec2>(common.scratch, entries);
  device_->check();
  divided_.resize(on_gpu_.size());
  parallelFor(on_gpu_.size(), [&](std::size_t t) {
    const auto& [tile, cell, begin, end] = on_gpu_[t];
    if (several && tile.step_px == 1) {
      divided_[t] = layersOf(tile, gaussiansOf(std::span(listed).subspan(begin, end - begin)),
                             glm::ivec2(stages_.block().size));
    } else {
      divided_[t] = oneLayer(tile, end - begin);
      divided_[t].layers[0].blur = {.radius_px = radii[cell], .everywhere = tile.step_px > 1};
    }
  });
  return divided_;
}

GpuStats GpuGaussians::show(const GpuImage& image, const GpuBuffer* weights) {
  stages_.note(GpuStage::composite);
  stages_.interpolate(image, weights);
  stages_.note(GpuStage::present);
  const GpuTotals totals = stages_.totals();
  stages_.checkLoops(totals);
  return {.fragments = fragmentsOf(totals), .times = stages_.times()};
}

GpuStats GpuGaussians::render(const std::vector<LensDisc>& discs, const GpuCompositing& how,
                              std::shared_ptr<GpuImage>& image) {
  const GpuDevice::Use use(*device_);
  image = nullptr;  // its buffers can be used again
  image = std::make_shared<GpuImage>(device_, glm::ivec2(stages_.block().size), how.depth);
  if (how.depth) stages_.makeDepthRoom();
  stages_.clearFragments();
  stages_.beginTimes();
  layers_.composite(stages_, own_.projected, discs, how);
  return show(*image, nullptr);
}

GpuStats GpuGaussians::render(std::span<const TileLens> lenses, const GpuCompositing& how,
                              std::shared_ptr<GpuImage>& image,
                              std::vector<SampledErrors>* errors) {
  assert(lenses.size() == divided_.size());
  const GpuDevice::Use use(*device_);
  if (!image) {
    image = std::make_shared<GpuImage>(device_, glm::ivec2(stages_.block().size), how.depth);
  }
  if (how.depth) stages_.makeDepthRoom();
  const bool follows = errors != nullptr;
  const GpuJobs jobs = jobsOf(on_gpu_, divided_, lenses, follows, layers_.room());
  std::vector<float> weights(stages_.tileCount(), 0.0f);
  for (std::size_t t = 0; t < lenses.size(); ++t) {
    if (lenses[t].discs) weights[on_gpu_[t].cell] = lenses[t].weight;
  }
  own_.weights.reserve(*device_, weights.size() * sizeof(float), "the tiles");
  own_.weights.write(0, weights.size() * sizeof(float), weights.data());
  stages_.clearFragments();
  stages_.beginTimes();
  layers_.composite(stages_, own_.projected, jobs, how, follows);
  const GpuStats stats = show(*image, &own_.weights);
  if (errors) layers_.readErrors(jobs, divided_, *errors);
  return stats;
}

GpuGaussianScene::GpuGaussianScene(std::shared_ptr<GpuDevice> device, const GaussianCloud& cloud)
    : device_(std::move(device)),
      size_(cloud.size()),
      degree_(cloud.degree),
      preserves_light_(cloud.preserves_light) {
  const GpuDevice::Use use(*device_);
  upload(cloud, nullptr, "the Gaussians", buffers_.gaussians);
  if (!cloud.tree) return;
  const GaussianTree& tree = *cloud.tree;
  levels_ = tree.levels;
  nodes_ = tree.nodes.size();
  upload(tree.nodes, tree.growth_per_m2.data(), "the nodes", buffers_.nodes);
  foci::upload(*device_, buffers_.node_places, nodes_, 1, "the nodes", false,
               [&](std::size_t i, glm::vec4* to) {
                 to[0] = {tree.nodes.position_m[i], tree.radius_m[i]};
               });
  foci::upload<float>(*device_, buffers_.node_spreads, nodes_, 1, "the nodes", false,
                      [&](std::size_t i, float* to) { to[0] = tree.spread_m2[i]; });
}

std::size_t GpuGaussianScene::harmonics_bytes() const {
  const auto numbers = 3 * static_cast<std::size_t>(harmonicsOf(degree_));
  return (numbers + 1) / 2 * sizeof(std::uint32_t);
}

std::size_t GpuGaussianScene::widest_bytes() const {
  return std::max(kGaussian_bytes, harmonics_bytes());
}

std::size_t GpuGaussianScene::windows() const {
  return std::max({windowsOver(*device_, widest_bytes(), nodes_),
                   windowsOver(*device_, widest_bytes(), size_), std::size_t{1}});
}

GpuWindow GpuGaussianScene::window(std::size_t i, std::size_t all) const {
  return windowOf(*device_, i, widest_bytes(), all);
}

void GpuGaussianScene::upload(const GaussianCloud& cloud, const float* growth_per_m2,
                              const char* what, Array& to) {
  foci::upload(*device_, to.gaussians, cloud.size(), 4, what, true,
               [&](std::size_t i, glm::vec4* vectors) {
                 const Covariance3& v = cloud.covariance_m2[i];
                 vectors[0] = {cloud.position_m[i], cloud.opacity[i]};
                 vectors[1] = {v.xx, v.xy, v.xz, v.yy};
                 vectors[2] = {v.yz, v.zz, growth_per_m2 ? growth_per_m2[i] : 0.0f, 0.0f};
                 vectors[3] = {cloud.color[i], 0.0f};
               });
  if (cloud.degree == 0) return;
  const std::size_t numbers = cloud.harmonicsPerGaussian();
  foci::upload<std::uint32_t>(
      *device_, to.harmonics, cloud.size(), (numbers + 1) / 2, what, true,
      [&](std::size_t i, std::uint32_t* words) {
        const auto number = [&](std::size_t k) {
          return k < numbers ? static_cast<std::uint16_t>(cloud.harmonics[i * numbers + k])
                             : std::uint16_t{0};
        };
        for (std::size_t k = 0; k < numbers; k += 2)
          words[k / 2] = packed(number(k), number(k + 1));
      });
}

}  // namespace foci
