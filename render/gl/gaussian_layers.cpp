#include "render/gl/gaussian_layers.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <algorithm>
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

/// The jobs of a tile, front to back, then its judge. Places of planes and followed samples begin
/// at 0.
class TileJobs {
 public:
  TileJobs(const GpuTile& tile, const TileLayers& layers, const TileLens& lens, bool follows,
           GpuLenses& lenses)
      : tile_(tile), layers_(layers), lens_(lens), follows_(follows) {
    std::uint32_t begin = tile.begin;
    for (std::size_t k = 0; k < layers.count; ++k) {
      jobs_.at(k) = jobOf(k, lenses);
      jobs_.at(k).entries[0] = begin;
      begin += static_cast<std::uint32_t>(layers.layers.at(k).size);
      jobs_.at(k).entries[1] = begin;
    }
    for (std::size_t k = 1; k < layers.count; ++k) layBehind(jobs_.at(k - 1), jobs_.at(k), k == 1);
    count_ = layers.count;
    if (follows && lens.judges && lens.discs->size() == 1) jobs_.at(count_++) = judge(lenses);
  }

  std::span<const GpuJob> jobs() const { return {jobs_.data(), count_}; }
  std::size_t passOf(std::size_t i) const { return i < layers_.count ? i : GpuJobBatch::kJudges; }
  std::size_t planes() const { return planes_; }
  std::size_t followed() const { return followed_; }

  static std::size_t squaresOf(const GpuJob& job) {
    const std::size_t along = groupsOf(static_cast<std::size_t>(job.side), kGroupSide);
    return along * along;
  }

 private:
  GpuJob jobOf(std::size_t k, GpuLenses& lenses) {
    const Tile& tile = tile_.tile;
    const TileLayer& layer = layers_.layers.at(k);
    const std::vector<LensDisc>& discs = k == 0 ? *lens_.discs : lens_.pairs.at(k - 1)->behind;
    GpuJob job;
    job.step_px = static_cast<float>(layer.step_px);
    job.side = layer.samples;
    job.discs[0] = lenses.firstOf(discs);
    job.discs[1] = static_cast<std::uint32_t>(discs.size());
    job.first_px = glm::vec2(tile.x_px, tile.y_px);
    if (k == 0) {
      job.first_px += job.step_px * (0.5f - static_cast<float>(tile.apron()));
      job.to = tile_.cell * static_cast<std::uint32_t>(kSamplesATile);
    } else {
      job.weights = lenses.weightsOf(*lens_.pairs.at(k - 1));
    }
    if (follows_) follow(k, job);
    return job;
  }

  void follow(std::size_t k, GpuJob& job) {
    const Tile& tile = tile_.tile;
    const auto [first, apart, count] = followedAlong(tile.samplesWithApron(), tile.apron());
    job.follow_first = first;
    job.follow_apart = apart;
    job.along = count;
    job.follow_ratio = k == 0 ? 0 : layers_.layers.at(k).step_px / tile.step_px;
    job.followed = static_cast<std::uint32_t>(followed_);
    followed_ += static_cast<std::size_t>(count) * static_cast<std::size_t>(count);
  }

  void layBehind(GpuJob& before, GpuJob& job, bool second) {
    job.fronts = before.discs[1];
    job.to = static_cast<std::uint32_t>(planes_);
    const auto side = static_cast<std::size_t>(job.side);
    planes_ += (std::size_t{job.fronts} + 1) * side * side * GpuJobs::kPlaneVectors;
    before.behind = job.to;
    before.mean = static_cast<std::uint32_t>(planes_ - side * side * GpuJobs::kPlaneVectors);
    before.behind_side = job.side;
    before.behind_step = before.step_px / job.step_px;
    // Those of the first layer lie in the middle of its pixels.
    before.behind_first = second ? 0.5f * before.behind_step : 0.0f;
  }

  /// Views of the first layer's followed samples alone (`LayerStack::judge`).
  GpuJob judge(GpuLenses& lenses) {
    GpuJob job = jobs_[0];
    const auto from = static_cast<float>(job.follow_first);
    const auto apart = static_cast<float>(job.follow_apart);
    job.first_px += from * job.step_px;
    job.step_px *= apart;
    job.side = job.along;
    job.behind_first += from * job.behind_step;
    job.behind_step *= apart;
    job.behind = GpuJob::kNone;
    job.discs[0] = lenses.firstOf(*lens_.judges);
    job.discs[1] = static_cast<std::uint32_t>(lens_.judges->size());
    job.judged = std::exchange(job.followed, static_cast<std::uint32_t>(followed_));
    job.follow_first = 0;
    job.follow_apart = 1;
    followed_ += static_cast<std::size_t>(job.along) * static_cast<std::size_t>(job.along);
    return job;
  }

  const GpuTile& tile_;
  const TileLayers& layers_;
  const TileLens& lens_;
  bool follows_;
  std::array<GpuJob, GpuJobBatch::kPasses> jobs_;
  std::size_t count_ = 0, planes_ = 0, followed_ = 0;
};

bool fits(const GpuJobBatch& batch, const TileJobs& tile, std::size_t room) {
  return batch.planes + tile.planes() <= room &&
         (batch.followed + tile.followed()) * GpuJobs::kFollowVectors <= room;
}

void add(const TileJobs& tile, GpuJobBatch& batch) {
  const auto moveBy = [](std::uint32_t& place, std::size_t by) {
    if (place != GpuJob::kNone) place += static_cast<std::uint32_t>(by);
  };
  for (std::size_t i = 0; i < tile.jobs().size(); ++i) {
    GpuJob job = tile.jobs()[i];
    const std::size_t pass = tile.passOf(i);
    if (job.fronts > 0) moveBy(job.to, batch.planes);
    moveBy(job.behind, batch.planes);
    moveBy(job.mean, batch.planes);
    moveBy(job.followed, batch.followed);
    moveBy(job.judged, batch.followed);
    const auto index = static_cast<std::uint32_t>(batch.jobs.size());
    for (std::uint32_t part = 0; part < TileJobs::squaresOf(job); ++part) {
      batch.work.at(pass).push_back(index << 6 | part);
    }
    batch.discs.at(pass) = std::max(batch.discs.at(pass), job.discs[1]);
    batch.jobs.push_back(job);
  }
  batch.planes += tile.planes();
  batch.followed += static_cast<std::uint32_t>(tile.followed());
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

std::uint32_t GpuLenses::firstOf(const std::vector<LensDisc>& discs) {
  const auto [at, is_new] =
      discs_of_.try_emplace(&discs, static_cast<std::uint32_t>(discs_.size()));
  if (is_new) discs_.insert(discs_.end(), discs.begin(), discs.end());
  return at->second;
}

std::uint32_t GpuLenses::weightsOf(const LensPairs& pairs) {
  const auto [at, is_new] =
      weights_of_.try_emplace(&pairs, static_cast<std::uint32_t>(weights_.size()));
  if (is_new) weights_.insert(weights_.end(), pairs.weights.begin(), pairs.weights.end());
  return at->second;
}

GpuJobs jobsOf(std::span<const GpuTile> tiles, std::span<const TileLayers> layers,
               std::span<const TileLens> lenses, bool follows, std::size_t room) {
  GpuJobs jobs;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    if (!lenses[t].discs) continue;
    const TileJobs tile(tiles[t], layers[t], lenses[t], follows, jobs.lenses);
    if (jobs.batches.empty() || !fits(jobs.batches.back(), tile, room)) {
      const std::uint32_t before =
          jobs.batches.empty() ? 0
                               : jobs.batches.back().first_followed + jobs.batches.back().followed;
      jobs.batches.emplace_back().first_followed = before;
    }
    GpuJobBatch& batch = jobs.batches.back();
    for (std::size_t i = 0; follows && i < tile.jobs().size(); ++i) {
      const GpuJob& job = tile.jobs()[i];
      jobs.followed.push_back({.tile = t,
                               .pass = tile.passOf(i),
                               .first = batch.first_followed + batch.followed + job.followed,
                               .count = static_cast<std::uint32_t>(job.along * job.along),
                               .first_disc = job.discs[0],
                               .discs = job.discs[1]});
    }
    add(tile, batch);
  }
  return jobs;
}

}  // namespace foci
