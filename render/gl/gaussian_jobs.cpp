#include "render/gl/gaussian_jobs.h"

#include <algorithm>
#include <utility>

#include "render/gl/frame_stages.h"

namespace foci {
namespace {

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
