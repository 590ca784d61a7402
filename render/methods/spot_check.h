// The errors of quality levels on a frame, measured on small squares of the frame: they depend on
// the scene in view, which no table of blur radii can know.
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "render/methods/lod_splats.h"
#include "render/methods/method.h"

namespace foci {

/// What small parts of the lens see is, in the mean, the truth that levels are compared with, and
/// what level `thorough` renders. As many points of the lens err by two to five times as much; but
/// where the wavefront differs over the lens, they share no fault with the levels.
/// @param blur_px  the largest blur radius in view, >= 0
std::vector<LensPart> partsOfTruth(const RenderSettings& settings, float blur_px);

/// Compares squares of one frame with the truth. Up to 144 squares of 16 px are spread evenly over
/// the view. They are rendered bit by bit, in a fixed order, so that the work can be spread over
/// many frames. The CPU renders, whatever renders the frames: both then choose the same level.
class SpotCheck {
 public:
  /// @param blur_px  the largest blur radius in view
  /// @param levels   what is compared: the first one square by square with the truth, then the
  ///                 others. All have one acuity.
  SpotCheck(std::shared_ptr<const MomentTree> tree, const View& view,
            const RenderSettings& settings, float blur_px, std::vector<LodSettings> levels);

  /// Renders the next part: about as much as the share `kShareOfFrame` of a frame.
  void step();
  /// Whether the first level, or every level, is compared in all squares.
  bool isFirstDone() const { return done_ >= squares_.size() * firstJobs(); }
  bool isDone() const { return done_ == squares_.size() * (firstJobs() + levels_.size() - 1); }

  /// The difference of a level from the truth that 95 % of the squares' pixels stay below, as far
  /// as rendered, in just-noticeable differences at 40 pixels a degree (metrics.h); away from the
  /// gaze, as the eye sees them there.
  /// Absent before a level was compared in a quarter of the squares.
  std::optional<float> error(std::size_t level) const;

  /// The same for the truth itself, from the difference of its halves.
  std::optional<float> errorOfTruth() const;

 private:
  struct Square {
    glm::ivec2 corner_px;
    View view;
    Acuity acuity;                          // around the gaze on the square
    double px_per_deg;                      // at which an eye in focus sees as much
    Cut cut;                                // of its views; empty before and after them
    std::array<Frame, 2> halves;            // sums of views
    std::vector<glm::vec3> first, truth;    // as the eye sees them
    std::vector<float> halves_apart;        // of the truth
    std::vector<std::vector<float>> apart;  // from the truth, by level
  };
  /// The level or the view that a job renders.
  struct Job {
    std::size_t square;
    std::optional<std::size_t> level, view;
  };
  /// Of a square: the first level, then the views.
  std::size_t firstJobs() const { return 1 + parts_.size(); }
  Job job(std::size_t number) const;
  Cut cutOf(const Square& square) const;
  Frame render(const Job& job);
  void compareViews(Square& square) const;
  template <typename ValuesOf>
  std::optional<float> quantileOf(const ValuesOf& valuesOf) const;
  struct Buffers {
    explicit Buffers(std::shared_ptr<const MomentTree> tree) : levels(std::move(tree)) {}
    LodSplats levels;
    SplatChunks chunks;
    TileLists lists;
  };
  std::unique_ptr<Buffers> idleBuffers();

  std::shared_ptr<const MomentTree> tree_;
  RenderSettings settings_;
  float blur_px_;
  std::vector<LodSettings> levels_;
  std::vector<LensPart> parts_;
  std::vector<Square> squares_;
  std::size_t done_ = 0, views_a_step_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Buffers>> idle_;  // of squares rendered side by side
};

}  // namespace foci
