// Jobs of tiles for the GPU, without a GPU.
#include "render/gl/gaussian_layers.h"

#include <gtest/gtest.h>

#include "render/methods/gaussian_methods.h"

namespace foci {
namespace FOCI_FILE {

/// A row of tiles of three layers, with samples 1, 2 and 8 px apart, of 10, 20 and 30 Gaussians.
class Row {
 public:
  explicit Row(std::size_t count, bool follows = false, std::size_t room = std::size_t{1} << 22) {
    const TileLens lens{.discs = &front_, .pairs = {&middle_, &back_}};
    for (std::size_t t = 0; t < count; ++t) {
      tiles_.push_back({.tile = {.x_px = 32 * static_cast<int>(t), .y_px = 64},
                        .cell = static_cast<std::uint32_t>(2 * t),
                        .begin = static_cast<std::uint32_t>(100 * t),
                        .end = static_cast<std::uint32_t>(100 * t + 60)});
      layers_.push_back({.layers = {TileLayer{.size = 10, .step_px = 1, .samples = 32},
                                    TileLayer{.size = 20, .step_px = 2, .samples = 17},
                                    TileLayer{.size = 30, .step_px = 8, .samples = 5}},
                         .count = 3});
      lenses_.push_back(lens);
    }
    lenses_[0].discs = nullptr;  // the image keeps it
    jobs = jobsOf(tiles_, layers_, lenses_, follows, room);
  }

  GpuJobs jobs;

 private:
  std::vector<LensDisc> front_ = subApertureDiscs(3);
  LensPairs middle_ = pairLensDiscs(front_, subApertureDiscs(7));
  LensPairs back_ = pairLensDiscs(middle_.behind, subApertureDiscs(19));
  std::vector<GpuTile> tiles_;
  std::vector<TileLayers> layers_;
  std::vector<TileLens> lenses_;
};

TEST(GpuJobs, FollowTheLayersOfATile) {
  const Row row(3);
  ASSERT_EQ(row.jobs.batches.size(), 1u);
  const GpuJobBatch& batch = row.jobs.batches[0];
  ASSERT_EQ(batch.jobs.size(), 6u);
  const GpuJob &first = batch.jobs[3], &second = batch.jobs[4], &third = batch.jobs[5];
  EXPECT_EQ(first.first_px, glm::vec2(64.5f, 64.5f));
  EXPECT_EQ(second.first_px, glm::vec2(64.0f, 64.0f));
  EXPECT_EQ(first.entries[0], 200u);
  EXPECT_EQ(second.entries[0], first.entries[1]);
  EXPECT_EQ(third.entries[1], 260u);
  EXPECT_EQ(first.behind, second.to);
  EXPECT_EQ(second.behind, third.to);
  EXPECT_EQ(third.behind, GpuJob::kNone);
  EXPECT_EQ(second.fronts, 3u);
  EXPECT_EQ(third.fronts, 7u);
  // A pixel's middle lies between samples at the edges of pixels.
  EXPECT_EQ(first.behind_first, 0.25f);
  EXPECT_EQ(first.behind_step, 0.5f);
  EXPECT_EQ(second.behind_first, 0.0f);
  EXPECT_EQ(second.behind_step, 0.25f);
  EXPECT_EQ(batch.work[0].size(), 2u * 16);
  EXPECT_EQ(batch.work[1].size(), 2u * 9);
  EXPECT_EQ(batch.work[2].size(), 2u * 1);
  EXPECT_EQ(row.jobs.lenses.discs().size(), 3u + 7 + 19);
  EXPECT_EQ(row.jobs.lenses.weights().size(), 3u * 7 + 7 * 19);
}

// Planes of one batch do not overlap, and stay within the room that a batch has.
TEST(GpuJobs, AreDividedIntoBatches) {
  constexpr std::size_t kTile = 2 * (4 * 17 * 17 + 8 * 5 * 5), kRoom = 3 * kTile + 5;
  const Row row(9, false, kRoom);
  ASSERT_EQ(row.jobs.batches.size(), 3u);
  std::size_t jobs = 0;
  for (const GpuJobBatch& batch : row.jobs.batches) {
    EXPECT_LE(batch.planes, kRoom);
    std::uint32_t end = 0;
    for (const GpuJob& job : batch.jobs) {
      if (job.fronts == 0) continue;
      EXPECT_EQ(job.to, end);
      end += 2 * (job.fronts + 1) * static_cast<std::uint32_t>(job.side * job.side);
    }
    EXPECT_EQ(end, batch.planes);
    jobs += batch.jobs.size();
  }
  EXPECT_EQ(jobs, 8u * 3);
}

TEST(GpuJobs, FollowEachSampleOnce) {
  constexpr std::size_t kSamplesATile = 3 * 8 * 8;
  const Row row(9, true, 3 * kSamplesATile * GpuJobs::kFollowVectors);
  EXPECT_GT(row.jobs.batches.size(), 1u);
  ASSERT_EQ(row.jobs.followed.size(), 8u * 3);
  std::uint32_t end = 0;
  for (std::size_t i = 0; i < row.jobs.followed.size(); ++i) {
    const FollowedJob& job = row.jobs.followed[i];
    EXPECT_EQ(job.tile, 1 + i / 3);
    EXPECT_EQ(job.pass, i % 3);
    EXPECT_EQ(job.first, end);
    EXPECT_EQ(job.count, 64u);
    end += job.count;
  }
}

// A single disc of the first layer is judged at the samples that are followed, over the mean of the
// views behind.
TEST(GpuJobs, JudgeTheFollowedSamples) {
  const std::vector<LensDisc> one = subApertureDiscs(1), judges = subApertureDiscs(3);
  const LensPairs pairs = pairLensDiscs(one, subApertureDiscs(7));
  const GpuTile tile{.tile = {.x_px = 64, .y_px = 32}, .cell = 5, .begin = 100, .end = 130};
  const TileLayers layers{.layers = {TileLayer{.size = 10, .step_px = 1, .samples = 32},
                                     TileLayer{.size = 20, .step_px = 4, .samples = 9}},
                          .count = 2};
  const TileLens lens{.discs = &one, .pairs = {&pairs, nullptr}, .judges = &judges};
  const GpuJobs jobs = jobsOf({&tile, 1}, {&layers, 1}, {&lens, 1}, true, std::size_t{1} << 22);
  const GpuJobBatch& batch = jobs.batches.at(0);
  ASSERT_EQ(batch.jobs.size(), 3u);
  const GpuJob &first = batch.jobs[0], &second = batch.jobs[1], &judge = batch.jobs[2];
  EXPECT_EQ(judge.first_px, glm::vec2(66.5f, 34.5f));  // the third sample
  EXPECT_EQ(judge.step_px, 4.0f);
  EXPECT_EQ(judge.side, 8);
  EXPECT_EQ(judge.entries[1], 110u);
  EXPECT_EQ(judge.discs[1], 3u);
  EXPECT_EQ(judge.judged, first.followed);
  EXPECT_EQ(judge.followed, 2u * 64);
  EXPECT_EQ(judge.mean, first.mean);
  EXPECT_EQ(judge.mean, second.to + 2 * 9 * 9);
  EXPECT_EQ(judge.behind_first, 0.625f);
  EXPECT_EQ(judge.behind_step, 1.0f);
  EXPECT_EQ(batch.work[GpuJobBatch::kJudges].size(), 1u);
  EXPECT_EQ(jobs.followed.back().pass, GpuJobBatch::kJudges);
  EXPECT_EQ(jobsOf({&tile, 1}, {&layers, 1}, {&lens, 1}, false, std::size_t{1} << 22)
                .batches.at(0)
                .jobs.size(),
            2u);
}

}  // namespace FOCI_FILE
}  // namespace foci
