#include "render/gl/gaussian_jobs.h"

#include <algorithm>
#include <utility>

#include "render/gl/frame_stages.h"

namespace foci {
namespace {

/// Work groups of a dispatch that OpenGL allows everywhere.
constexpr std::size_t kMostGroups = 65535;

/// The jobs of a tile, front to back. Places of planes and followed samples begin at 0.
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
  }

  std::span<const GpuJob> jobs() const { return {jobs_.data(), layers_.count}; }
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
    before.behind_side = job.side;
    before.behind_step = before.step_px / job.step_px;
    // Those of the first layer lie in the middle of its pixels.
    before.behind_first = second ? 0.5f * before.behind_step : 0.0f;
  }

  const GpuTile& tile_;
  const TileLayers& layers_;
  const TileLens& lens_;
  bool follows_;
  std::array<GpuJob, TileLayers::kMost> jobs_;
  std::size_t planes_ = 0, followed_ = 0;
};

bool fits(const GpuJobBatch& batch, const TileJobs& tile, std::size_t room) {
  if (batch.planes + tile.planes() > room) return false;
  if ((batch.followed + tile.followed()) * GpuJobs::kFollowVectors > room) return false;
  for (std::size_t k = 0; k < tile.jobs().size(); ++k) {
    if (batch.work.at(k).size() + TileJobs::squaresOf(tile.jobs()[k]) > kMostGroups) return false;
  }
  return true;
}

void add(const TileJobs& tile, GpuJobBatch& batch) {
  for (std::size_t k = 0; k < tile.jobs().size(); ++k) {
    GpuJob job = tile.jobs()[k];
    if (k > 0) job.to += static_cast<std::uint32_t>(batch.planes);
    if (job.behind != GpuJob::kNone) job.behind += static_cast<std::uint32_t>(batch.planes);
    job.followed += batch.followed;
    const auto index = static_cast<std::uint32_t>(batch.jobs.size());
    for (std::uint32_t part = 0; part < TileJobs::squaresOf(job); ++part) {
      batch.work.at(k).push_back(index << 6 | part);
    }
    batch.discs.at(k) = std::max(batch.discs.at(k), job.discs[1]);
    batch.jobs.push_back(job);
  }
  batch.planes += tile.planes();
  batch.followed += static_cast<std::uint32_t>(tile.followed());
}

}  // namespace

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
    for (std::size_t k = 0; follows && k < tile.jobs().size(); ++k) {
      const GpuJob& job = tile.jobs()[k];
      jobs.followed.push_back({.tile = t,
                               .layer = k,
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
