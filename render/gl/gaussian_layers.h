// Composites the layers of tiles on the GPU, as LayerStack does on the CPU.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "render/gaussians/view_spread.h"
#include "render/gl/frame_stages.h"
#include "render/gl/gaussian_jobs.h"

namespace foci {

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
