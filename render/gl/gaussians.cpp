#include "render/gl/gaussians.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "render/gl/frame_stages.h"
#include "render/image/srgb.h"

namespace foci {
namespace {

template <typename T>
std::vector<T> readArray(const GpuBuffer& buffer, std::size_t count) {
  std::vector<T> values(count);
  buffer.read(0, count * sizeof(T), values.data());
  return values;
}

}  // namespace

class GpuGaussians::Pipeline {
 public:
  explicit Pipeline(std::shared_ptr<const GpuGaussianScene> scene)
      : scene_(std::move(scene)), device_(scene_->device()), stages_(device_) {}

  GpuStats project(const View& view, const Defocus& defocus,
                   const std::vector<SubApertureSize>& sizes, const GaussianCutSettings* lod);
  GpuStats render(std::span<const LensDisc> discs, const glm::vec3& background, bool depth,
                  std::shared_ptr<GpuImage>& image);
  const Tiles& tiles();
  GpuStats render(std::span<const LensDisc> discs, std::span<const TileDiscs> tiles,
                  const glm::vec3& background, bool depth, std::shared_ptr<GpuImage>& image,
                  std::vector<SampledErrors>* errors);
  const std::shared_ptr<const GpuGaussianScene>& scene() const { return scene_; }

 private:
  struct Buffers {
    GpuBuffer sizes;
    GpuBuffer projected_a, projected_b;  // by entry
    GpuBuffer discs;
    GpuBuffer lenses, weights, radii;  // by tile
    GpuBuffer followed, squares;       // by sample that is followed
  };

  GpuFrameBlock blockOf(const View& view, const Defocus& defocus,
                        const GaussianCutSettings* lod) const;
  void start(const GpuFrameBlock& block, bool cut, const std::vector<SubApertureSize>& sizes);
  void selectCut(float max_px2);
  void projectEntries(bool cut, std::size_t sizes);
  void takeLenses(std::span<const LensDisc> discs, std::span<const TileDiscs> sets,
                  std::span<const glm::uvec4> of_cells);
  void composite(std::size_t discs, const glm::vec3& background, bool depth, bool follow);
  GpuStats show(const GpuImage& image, const GpuBuffer* weights);
  void measureSpread();
  void readErrors(std::span<const TileDiscs> tiles, std::vector<SampledErrors>& errors);

  std::shared_ptr<const GpuGaussianScene> scene_;
  std::shared_ptr<GpuDevice> device_;
  GpuFrameStages stages_;
  Buffers own_;
  std::optional<Tiles> tiles_;      // read since the last projection
  std::vector<std::size_t> cells_;  // by tile, its first cell: its place in the GPU's arrays
  std::map<std::uint32_t, std::size_t> polynomials_;  // their number, by the first disc of a set
  std::vector<std::uint32_t> first_followed_;         // by tile, and their number
};

GpuFrameBlock GpuGaussians::Pipeline::blockOf(const View& view, const Defocus& defocus,
                                              const GaussianCutSettings* lod) const {
  GpuFrameBlock block = viewBlockOf(view, defocus, lod ? lod->acuity : Acuity{});
  if (lod) block.cut = {lod->per_blur2, lod->per_pixel2, lod->per_acuity2, view.near_m};
  block.size.w = lod != nullptr;
  block.scene = {static_cast<int>(scene_->size()), scene_->levels(), block.scene.z,
                 scene_->preservesLight()};
  return block;
}

void GpuGaussians::Pipeline::start(const GpuFrameBlock& block, bool cut,
                                   const std::vector<SubApertureSize>& sizes) {
  stages_.start(block, cut);
  const std::size_t entries = stages_.entryRoom();
  own_.projected_a.reserve(*device_, entries * 2 * kVector_bytes, "the projected Gaussians");
  own_.projected_b.reserve(*device_, entries * 2 * kVector_bytes, "the projected Gaussians");
  static_assert(sizeof(SubApertureSize) == sizeof(glm::vec2));
  own_.sizes.reserve(*device_, sizes.size() * sizeof(SubApertureSize), "the sub-apertures");
  own_.sizes.write(0, sizes.size() * sizeof(SubApertureSize), sizes.data());
}

void GpuGaussians::Pipeline::selectCut(float max_px2) {
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

void GpuGaussians::Pipeline::projectEntries(bool cut, std::size_t sizes) {
  const GpuGaussianScene::Buffers& scene = scene_->buffers();
  const GpuFrameStages::Buffers& common = stages_.buffers();
  const bool harmonics = scene_->degree() > 0;
  const GLuint program = stages_.bind(
      "gaussian_project",
      "#define DEGREE " + std::to_string(scene_->degree()) + (cut ? "\n#define CUT\n" : "\n"),
      {cut ? &common.entries : nullptr, nullptr, nullptr, nullptr, &own_.projected_a, &common.keys,
       nullptr, nullptr, &own_.projected_b, &own_.sizes});
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

GpuStats GpuGaussians::Pipeline::project(const View& view, const Defocus& defocus,
                                         const std::vector<SubApertureSize>& sizes,
                                         const GaussianCutSettings* lod) {
  assert(!lod || scene_->levels() > 0);
  const GpuDevice::Use use(*device_);
  tiles_.reset();
  const bool cut = lod != nullptr;
  const GpuFrameBlock block = blockOf(view, defocus, lod);
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

const GpuGaussians::Tiles& GpuGaussians::Pipeline::tiles() {
  if (tiles_) return *tiles_;
  const GpuDevice::Use use(*device_);
  const GpuFrameStages::Buffers& common = stages_.buffers();
  const std::size_t count = stages_.tileCount();
  own_.radii.reserve(*device_, count * sizeof(float), "the tiles");
  stages_.bind("gaussian_blurs", {},
               {&common.lists, &common.ranges, &common.keys, &own_.projected_b, &own_.radii});
  GpuFrameStages::dispatch(count);
  const auto squares = readArray<glm::ivec4>(common.tiles, count);
  const auto largest = readArray<float>(common.blurs, count);
  const auto radii = readArray<float>(own_.radii, count);
  const auto ranges = readArray<glm::uvec2>(common.ranges, count);
  device_->check();
  tiles_.emplace();
  cells_.clear();
  first_followed_.assign(1, 0);
  ViewSpread spread;
  for (std::size_t cell = 0; cell < count; ++cell) {
    const glm::ivec4& square = squares[cell];
    if (square.z == 0) continue;
    const Tile tile{square.x, square.y, square.z, square.w, largest[cell]};
    TileLayers layers = oneLayer(tile, ranges[cell].y - ranges[cell].x);
    layers.layers[0].blur = {.radius_px = radii[cell], .everywhere = tile.step_px > 1};
    tiles_->tiles.push_back(tile);
    tiles_->layers.push_back(layers);
    cells_.push_back(cell);
    spread.begin(tile.samplesWithApron(), tile.apron());
    first_followed_.push_back(first_followed_.back() +
                              static_cast<std::uint32_t>(spread.places().size()));
  }
  return *tiles_;
}

void GpuGaussians::Pipeline::takeLenses(std::span<const LensDisc> discs,
                                        std::span<const TileDiscs> sets,
                                        std::span<const glm::uvec4> of_cells) {
  // Two vectors a disc: gaussian_composite.glsl.
  std::vector<float> all;
  for (const LensDisc& each : discs) {
    all.insert(all.end(),
               {each.centre.x, each.centre.y, each.radius, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f});
  }
  polynomials_.clear();
  for (const TileDiscs& set : sets) {
    if (set.count < 3 || polynomials_.contains(set.first)) continue;
    const auto polynomials = polynomialsOver(discs.subspan(set.first, set.count));
    polynomials_[set.first] = polynomials.size();
    for (std::size_t k = 0; k < polynomials.size(); ++k) {
      for (std::size_t i = 0; i < set.count; ++i) {
        all[8 * (set.first + i) + 3 + k] = polynomials[k][i];
      }
    }
  }
  own_.discs.reserve(*device_, all.size() * sizeof all[0], "the sub-apertures");
  own_.discs.write(0, all.size() * sizeof all[0], all.data());
  own_.lenses.reserve(*device_, of_cells.size_bytes(), "the tiles");
  own_.lenses.write(0, of_cells.size_bytes(), of_cells.data());
}

void GpuGaussians::Pipeline::composite(std::size_t discs, const glm::vec3& background, bool depth,
                                       bool follow) {
  const GpuFrameStages::Buffers& common = stages_.buffers();
  const GLuint program = stages_.bind(
      "gaussian_composite",
      std::string(depth ? "#define DEPTH\n" : "") + (follow ? "#define FOLLOW\n" : ""),
      {&common.work, &common.tiles, &own_.lenses, &common.ranges, &common.lists, &own_.projected_a,
       &own_.projected_b, nullptr, &common.samples, depth ? &common.depths : nullptr, &own_.discs,
       follow ? &own_.followed : nullptr});
  glProgramUniform3f(program, 1, srgbFromLinear(background.r), srgbFromLinear(background.g),
                     srgbFromLinear(background.b));
  // One dispatch a disc, so that none takes long: drivers end those that do.
  for (std::size_t i = 0; i < discs; ++i) {
    glProgramUniform1ui(program, 0, static_cast<GLuint>(i));
    stages_.dispatchIndirect(offsetof(GpuTotals, sweep_groups));
  }
}

GpuStats GpuGaussians::Pipeline::show(const GpuImage& image, const GpuBuffer* weights) {
  stages_.note(GpuStage::composite);
  stages_.interpolate(image, weights);
  stages_.note(GpuStage::present);
  const GpuTotals totals = stages_.totals();
  stages_.checkLoops(totals);
  return {.fragments = fragmentsOf(totals), .times = stages_.times()};
}

GpuStats GpuGaussians::Pipeline::render(std::span<const LensDisc> discs,
                                        const glm::vec3& background, bool depth,
                                        std::shared_ptr<GpuImage>& image) {
  const GpuDevice::Use use(*device_);
  image = nullptr;  // its buffers can be used again
  image = std::make_shared<GpuImage>(device_, glm::ivec2(stages_.block().size), depth);
  if (depth) stages_.makeDepthRoom();
  takeLenses(discs, {}, std::vector(stages_.tileCount(), glm::uvec4(0, discs.size(), 0, 0)));
  stages_.clearFragments();
  stages_.beginTimes();
  composite(discs.size(), background, depth, false);
  return show(*image, nullptr);
}

GpuStats GpuGaussians::Pipeline::render(std::span<const LensDisc> discs,
                                        std::span<const TileDiscs> tiles,
                                        const glm::vec3& background, bool depth,
                                        std::shared_ptr<GpuImage>& image,
                                        std::vector<SampledErrors>* errors) {
  assert(tiles_ && tiles.size() == tiles_->tiles.size());
  const GpuDevice::Use use(*device_);
  if (!image) image = std::make_shared<GpuImage>(device_, glm::ivec2(stages_.block().size), depth);
  if (depth) stages_.makeDepthRoom();
  const std::size_t cells = stages_.tileCount();
  std::vector<glm::uvec4> lenses(cells, glm::uvec4(0));
  std::vector<float> weights(cells, 0.0f);
  std::uint32_t most = 0;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    if (tiles[t].count == 0) continue;
    lenses[cells_[t]] = {tiles[t].first, tiles[t].count, first_followed_[t], 0};
    weights[cells_[t]] = tiles[t].weight;
    most = std::max(most, tiles[t].count);
  }
  takeLenses(discs, errors ? tiles : std::span<const TileDiscs>(), lenses);
  own_.weights.reserve(*device_, cells * sizeof(float), "the tiles");
  own_.weights.write(0, cells * sizeof(float), weights.data());
  if (errors) {
    constexpr std::size_t kVectorsASample = 7;  // of gaussian_composite.glsl
    own_.followed.reserve(*device_, first_followed_.back() * kVectorsASample * kVector_bytes,
                          "the samples that are followed");
  }
  stages_.clearFragments();
  stages_.beginTimes();
  composite(most, background, depth, errors != nullptr);
  if (errors) measureSpread();
  const GpuStats stats = show(*image, &own_.weights);
  if (errors) readErrors(tiles, *errors);
  return stats;
}

void GpuGaussians::Pipeline::measureSpread() {
  const std::uint32_t samples = first_followed_.back();
  own_.squares.reserve(*device_, samples * sizeof(SpreadSquares), "the samples' errors");
  const GLuint program = stages_.bind("gaussian_errors", {}, {&own_.followed, &own_.squares});
  glProgramUniform1ui(program, 0, samples);
  GpuFrameStages::dispatch(groupsOf(samples, 64));
}

void GpuGaussians::Pipeline::readErrors(std::span<const TileDiscs> tiles,
                                        std::vector<SampledErrors>& errors) {
  static_assert(sizeof(SpreadSquares) == sizeof(glm::vec2));
  const auto squares = readArray<SpreadSquares>(own_.squares, first_followed_.back());
  device_->check();
  errors.resize(tiles.size());
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    const auto& [first, count, weight] = tiles[t];
    if (count == 0) continue;
    const auto samples =
        std::span(squares).subspan(first_followed_[t], first_followed_[t + 1] - first_followed_[t]);
    errors[t] = {.layers_jnd = {}, .count = samples.size()};
    if (count == 1) continue;
    errors[t].layers_jnd[0] = errorsOfMean(samples, count, polynomials_.at(first),
                                           tiles_->layers[t].layers[0].blur.radius_px);
  }
}

GpuGaussians::GpuGaussians(std::shared_ptr<const GpuGaussianScene> scene)
    : pipeline_(std::make_unique<Pipeline>(std::move(scene))) {}
GpuGaussians::~GpuGaussians() = default;
GpuGaussians::GpuGaussians(GpuGaussians&&) noexcept = default;
GpuGaussians& GpuGaussians::operator=(GpuGaussians&&) noexcept = default;

GpuStats GpuGaussians::project(const View& view, const Defocus& defocus,
                               const std::vector<SubApertureSize>& sizes,
                               const GaussianCutSettings* lod) {
  return pipeline_->project(view, defocus, sizes, lod);
}

GpuStats GpuGaussians::render(std::span<const LensDisc> discs, const glm::vec3& background,
                              bool depth, std::shared_ptr<GpuImage>& image) {
  return pipeline_->render(discs, background, depth, image);
}

const GpuGaussians::Tiles& GpuGaussians::tiles() { return pipeline_->tiles(); }

GpuStats GpuGaussians::render(std::span<const LensDisc> discs, std::span<const TileDiscs> tiles,
                              const glm::vec3& background, bool depth,
                              std::shared_ptr<GpuImage>& image,
                              std::vector<SampledErrors>* errors) {
  return pipeline_->render(discs, tiles, background, depth, image, errors);
}

const std::shared_ptr<const GpuGaussianScene>& GpuGaussians::scene() const {
  return pipeline_->scene();
}

}  // namespace foci
