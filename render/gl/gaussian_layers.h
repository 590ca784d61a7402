// Composites the layers of tiles on the GPU, as LayerStack does on the CPU: a job for each layer of
// each tile, in batches that fit its memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/gaussians/layer_stack.h"
#include "render/gaussians/tile_layers.h"
#include "render/gaussians/view_spread.h"
#include "render/gl/frame_stages.h"

namespace foci {

/// As shaders/gaussian_layers.glsl lays it out (std430).
struct GpuJob {
  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;
  glm::vec2 first_px{0.0f};
  float step_px = 1.0f;
  std::int32_t side = 0;          ///< samples
  std::uint32_t entries[2] = {};  ///< in the lists: begin, end
  std::uint32_t discs[2] = {};    ///< first, number
  std::uint32_t to = 0;           ///< of its first sample; of a layer behind, of its planes
  std::uint32_t fronts = 0;       ///< views of the layer before it; 0: the first layer
  std::uint32_t weights = 0;      ///< of its views in those, the first
  std::uint32_t behind = kNone;   ///< planes of the next layer
  std::uint32_t mean = kNone;     ///< the same, of the mean of its views
  std::int32_t behind_side = 0;   ///< samples of the next layer
  float behind_first = 0.0f, behind_step = 0.0f;
  std::uint32_t followed = 0;    ///< the first of its samples that are followed
  std::uint32_t judged = kNone;  ///< of a judge: the first of the followed samples that it judges
  std::int32_t along = 0, follow_first = 0, follow_apart = 1, follow_ratio = 0;
};
static_assert(sizeof(GpuJob) == 88);

/// A tile on the GPU.
struct GpuTile {
  Tile tile;
  std::uint32_t cell = 0;            ///< its place in the GPU's arrays
  std::uint32_t begin = 0, end = 0;  ///< its entries in the lists
};

/// The discs and weights that jobs use, each set once.
class GpuLenses {
 public:
  /// @return the place of the first of them
  std::uint32_t firstOf(const std::vector<LensDisc>& discs);
  std::uint32_t weightsOf(const LensPairs& pairs);

  const std::vector<LensDisc>& discs() const { return discs_; }
  const std::vector<float>& weights() const { return weights_; }

 private:
  std::map<const void*, std::uint32_t> discs_of_, weights_of_;
  std::vector<LensDisc> discs_;
  std::vector<float> weights_;
};

/// Samples of a job that are followed.
struct FollowedJob {
  std::size_t tile = 0, pass = 0;
  std::uint32_t first = 0, count = 0;  ///< of all of the frame
  std::uint32_t first_disc = 0, discs = 0;
};

/// Jobs that are composited together, in passes: layer by layer from the last one, then the judges
/// of first layers.
struct GpuJobBatch {
  static constexpr std::size_t kJudges = TileLayers::kMost, kPasses = kJudges + 1;
  std::vector<GpuJob> jobs;
  /// By pass: a work group each, job << 6 | square of the samples.
  std::array<std::vector<std::uint32_t>, kPasses> work;
  std::array<std::uint32_t, kPasses> discs{};      ///< by pass, the most of a job
  std::size_t planes = 0;                          ///< vectors
  std::uint32_t first_followed = 0, followed = 0;  ///< samples, of all of the frame
};

struct GpuJobs {
  static constexpr std::size_t kPlaneVectors = 2;   ///< a sample
  static constexpr std::size_t kFollowVectors = 8;  ///< a sample that is followed

  GpuLenses lenses;
  std::vector<GpuJobBatch> batches;
  std::vector<FollowedJob> followed;  ///< by tile, front to back
};

/// @param layers     by tile
/// @param lenses     by tile; without discs: no job
/// @param follows    whether samples are followed
/// @param room       vectors of planes, and of followed samples, that a batch may have; a tile may
///                   exceed it
GpuJobs jobsOf(std::span<const GpuTile> tiles, std::span<const TileLayers> layers,
               std::span<const TileLens> lenses, bool follows, std::size_t room);

/// What Gaussians become on the image: two vectors each, by entry (shaders/gaussian_project.glsl).
struct GpuProjected {
  GpuBuffer a, b;
};

/// How Gaussians are composited.
struct GpuCompositing {
  glm::vec3 background{0.0f};  ///< linear RGB
  bool depth = false;
};

/// Keeps its buffers between frames. Needs a `GpuDevice::Use`, but for its destructor.
class GpuGaussianLayers {
 public:
  explicit GpuGaussianLayers(std::shared_ptr<GpuDevice> device) : device_(std::move(device)) {}

  /// Composites all tiles through the same discs.
  void composite(GpuFrameStages& stages, const GpuProjected& projected,
                 const std::vector<LensDisc>& discs, const GpuCompositing& how);

  /// Composites tiles through discs of their own (`jobsOf`), and follows samples if `follows`.
  void composite(GpuFrameStages& stages, const GpuProjected& projected, const GpuJobs& jobs,
                 const GpuCompositing& how, bool follows);

  /// The errors of the layers of the jobs that were composited last. Waits for the GPU.
  /// @param layers  by tile
  /// @param errors  by tile; of tiles without jobs they stay
  void readErrors(const GpuJobs& jobs, std::span<const TileLayers> layers,
                  std::vector<SampledErrors>& errors);

  /// Vectors of planes, and of followed samples, in a batch.
  std::size_t room() const;

 private:
  struct Buffers {
    GpuBuffer discs, weights;
    GpuBuffer jobs, work;  // of a batch
    GpuBuffer planes, followed;
    GpuBuffer squares;  // by sample that is followed, of the frame
  };

  void takeLenses(const GpuLenses& lenses, std::span<const FollowedJob> followed);
  unsigned bind(GpuFrameStages& stages, const GpuProjected& projected, const GpuBuffer& work,
                const std::string& defines, const GpuCompositing& how);
  void compositeBatch(GpuFrameStages& stages, const GpuProjected& projected,
                      const GpuJobBatch& batch, const GpuCompositing& how, bool follows);
  void measureSpread(GpuFrameStages& stages, const GpuJobBatch& batch);

  std::shared_ptr<GpuDevice> device_;
  Buffers own_;
  std::map<std::uint32_t, std::size_t> polynomials_;  // their number, by the first disc of a set
};

}  // namespace foci
