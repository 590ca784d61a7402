#include "render/gl/gaussian_layers.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <algorithm>
#include <span>
#include <utility>

#include "render/image/srgb.h"

namespace foci {
namespace {

/// Of planes, and of followed samples, in a batch.
constexpr std::size_t kMostRoom_bytes = std::size_t{64} << 20;

/// What shaders/gaussian_errors.glsl writes.
struct FollowedSample {
  SpreadSquares squares;
  float transmittance = 0.0f;
  float judged_jnd = 0.0f;  ///< of a judge: from the mean of its views to the view that it judges
};
static_assert(sizeof(FollowedSample) == kVector_bytes);

template <typename T>
void writeAll(GpuDevice& device, GpuBuffer& buffer, const std::vector<T>& values,
              const char* what) {
  buffer.reserve(device, std::max<std::size_t>(values.size(), 1) * sizeof(T), what);
  if (!values.empty()) buffer.write(0, values.size() * sizeof(T), values.data());
}

}  // namespace

std::size_t GpuGaussianLayers::room() const {
  return std::min(device_->maxBlock_bytes(), kMostRoom_bytes) / kVector_bytes;
}

void GpuGaussianLayers::takeLenses(const GpuLenses& lenses, std::span<const FollowedJob> followed) {
  // Two vectors a disc: gaussian_composite.glsl.
  std::vector<float> all;
  for (const LensDisc& each : lenses.discs()) {
    all.insert(all.end(),
               {each.centre.x, each.centre.y, each.radius, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f});
  }
  polynomials_.clear();
  for (const FollowedJob& job : followed) {
    if (job.discs < 3 || polynomials_.contains(job.first_disc)) continue;
    const auto polynomials =
        polynomialsOver(std::span(lenses.discs()).subspan(job.first_disc, job.discs));
    polynomials_[job.first_disc] = polynomials.size();
    for (std::size_t k = 0; k < polynomials.size(); ++k) {
      for (std::size_t i = 0; i < job.discs; ++i) {
        all[8 * (job.first_disc + i) + 3 + k] = polynomials[k][i];
      }
    }
  }
  writeAll(*device_, own_.discs, all, "the sub-apertures");
  writeAll(*device_, own_.weights, lenses.weights(), "the sub-apertures");
}

unsigned GpuGaussianLayers::bind(GpuFrameStages& stages, const GpuProjected& projected,
                                 const GpuBuffer& work, const std::string& defines,
                                 const GpuCompositing& how) {
  const GpuFrameStages::Buffers& common = stages.buffers();
  const GLuint program =
      stages.bind("gaussian_composite", (how.depth ? "#define DEPTH\n" : "") + defines,
                  {&work, &common.tiles, &own_.jobs, &common.ranges, &common.lists, &projected.a,
                   &projected.b, nullptr, &common.samples, how.depth ? &common.depths : nullptr,
                   &own_.discs, &own_.followed, &own_.planes, &own_.weights});
  glProgramUniform3f(program, 1, srgbFromLinear(how.background.r), srgbFromLinear(how.background.g),
                     srgbFromLinear(how.background.b));
  return program;
}

void GpuGaussianLayers::composite(GpuFrameStages& stages, const GpuProjected& projected,
                                  const std::vector<LensDisc>& discs, const GpuCompositing& how) {
  GpuLenses lenses;
  lenses.firstOf(discs);
  takeLenses(lenses, {});
  const GLuint program = bind(stages, projected, stages.buffers().work, "", how);
  glProgramUniform1ui(program, 2, static_cast<GLuint>(discs.size()));
  // One dispatch a disc, so that none takes long: drivers end those that do.
  for (std::size_t i = 0; i < discs.size(); ++i) {
    glProgramUniform1ui(program, 0, static_cast<GLuint>(i));
    stages.dispatchIndirect(offsetof(GpuTotals, sweep_groups));
  }
}

void GpuGaussianLayers::composite(GpuFrameStages& stages, const GpuProjected& projected,
                                  const GpuJobs& jobs, const GpuCompositing& how, bool follows) {
  takeLenses(jobs.lenses, jobs.followed);
  std::size_t planes = 1, followed = 1, all_followed = 1;
  for (const GpuJobBatch& batch : jobs.batches) {
    planes = std::max(planes, batch.planes);
    followed = std::max<std::size_t>(followed, batch.followed);
    all_followed += batch.followed;
  }
  own_.planes.reserve(*device_, planes * kVector_bytes, "the layers of tiles");
  own_.followed.reserve(*device_, followed * GpuJobs::kFollowVectors * kVector_bytes,
                        "the samples that are followed");
  own_.squares.reserve(*device_, all_followed * sizeof(FollowedSample), "the samples' errors");
  for (const GpuJobBatch& batch : jobs.batches) {
    compositeBatch(stages, projected, batch, how, follows);
    if (follows) measureSpread(stages, batch);
  }
}

void GpuGaussianLayers::compositeBatch(GpuFrameStages& stages, const GpuProjected& projected,
                                       const GpuJobBatch& batch, const GpuCompositing& how,
                                       bool follows) {
  std::vector<std::uint32_t> work;
  std::array<std::size_t, GpuJobBatch::kPasses> first{};
  for (std::size_t k = 0; k < batch.work.size(); ++k) {
    first.at(k) = work.size();
    work.insert(work.end(), batch.work.at(k).begin(), batch.work.at(k).end());
  }
  writeAll(*device_, own_.jobs, batch.jobs, "the layers of tiles");
  writeAll(*device_, own_.work, work, "the layers of tiles");
  const std::string defines = std::string("#define JOBS\n") + (follows ? "#define FOLLOW\n" : "");
  const auto run = [&](std::size_t pass, const char* variant) {
    if (batch.work.at(pass).empty()) return;
    const GLuint program = bind(stages, projected, own_.work, defines + variant, how);
    glProgramUniform2ui(program, 2, static_cast<GLuint>(first.at(pass)),
                        static_cast<GLuint>(batch.work.at(pass).size()));
    for (std::uint32_t i = 0; i < batch.discs.at(pass); ++i) {
      glProgramUniform1ui(program, 0, i);
      GpuFrameStages::dispatch(batch.work.at(pass).size());
    }
  };
  for (std::size_t k = TileLayers::kMost; k-- > 1;) run(k, "#define BEHIND\n");
  run(0, "");
  run(GpuJobBatch::kJudges, "#define JUDGE\n");
}

void GpuGaussianLayers::measureSpread(GpuFrameStages& stages, const GpuJobBatch& batch) {
  const GLuint program = stages.bind("gaussian_errors", {}, {&own_.followed, &own_.squares});
  glProgramUniform1ui(program, 0, batch.followed);
  glProgramUniform1ui(program, 1, batch.first_followed);
  GpuFrameStages::dispatch(groupsOf(batch.followed, 64));
}

void GpuGaussianLayers::readErrors(const GpuJobs& jobs, std::span<const TileLayers> layers,
                                   std::vector<SampledErrors>& errors) {
  std::vector<FollowedSample> samples;
  for (const FollowedJob& job : jobs.followed) {
    samples.resize(std::max<std::size_t>(samples.size(), job.first + job.count));
  }
  own_.squares.read(0, samples.size() * sizeof samples[0], samples.data());
  device_->check();
  errors.resize(layers.size());
  std::array<float, SampledErrors::kMost> through;
  for (const FollowedJob& job : jobs.followed) {
    if (job.pass == 0) {
      through.fill(1.0f);
      errors[job.tile] = {.layers_jnd = {}, .count = job.count};
    }
    const auto seen = std::span(samples).subspan(job.first, job.count);
    if (job.pass == GpuJobBatch::kJudges) {
      std::ranges::transform(
          seen, errors[job.tile].layers_jnd[0].begin(),
          [](const FollowedSample& each) { return errorOfOne(each.judged_jnd); });
      continue;
    }
    auto& own = errors[job.tile].layers_jnd.at(job.pass);
    if (job.discs > 1) {
      std::array<SpreadSquares, SampledErrors::kMost> squares;
      std::ranges::transform(seen, squares.begin(), &FollowedSample::squares);
      own = errorsOfMean(std::span(squares).first(job.count), job.discs,
                         polynomials_.at(job.first_disc),
                         layers[job.tile].layers.at(job.pass).blur.radius_px);
    }
    for (std::size_t i = 0; i < seen.size(); ++i) {
      own.at(i) *= through.at(i);
      through.at(i) *= seen[i].transmittance;
    }
  }
}

}  // namespace foci
