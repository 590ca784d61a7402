// The error of a quality level on a frame, measured on small squares of the frame: it depends on
// the scene in view, which no table of blur radii can know.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <memory>
#include <mutex>
#include <vector>

#include "render/methods/lod_splats.h"
#include "render/methods/method.h"

namespace foci {

/// Squares of one frame: 48 tiles, spread evenly over the view. A view of fewer than twice as many
/// tiles is one square. On the CPU, the reference's squares are rendered side by side, and all
/// others as parts of the full frame, which keeps them (`LodSplats::renderWindows`). 48 tiles
/// estimate the error of 95 % of the pixels within 20 %
/// (SpotCheckTest.EstimatesTheErrorFromSomeSquares), the first 16 of them within a factor of two.
class SpotCheck {
 public:
  /// @param scene  stays alive while this exists. It may then render `frame`, which keeps the tiles
  ///               that are rendered.
  /// @param reference  the settings that all others are compared with
  /// @param frame  of the view's size; its pixels are overwritten while this exists
  SpotCheck(LodSplats& scene, const View& view, const RenderSettings& settings,
            const LodSettings& reference, Frame& frame);
  ~SpotCheck() { scene_.forgetWindows(); }

  /// The difference from the reference that 95 % of the squares' pixels stay below, in
  /// just-noticeable differences at 40 pixels a degree (visible_difference.h).
  /// @param limit  the caller compares the difference with this. If the first 16 squares are
  ///               clearly above or below, the other squares are not rendered; below, the result
  ///               is then an upper bound.
  float error(const LodSettings& lod, float limit);

 private:
  Frame render(const Window& square, const LodSettings& lod);
  /// The squares [begin, end).
  std::vector<Frame> render(std::size_t begin, std::size_t end, const LodSettings& lod);
  /// The differences from the reference of the squares [begin, end), pixel by pixel.
  std::vector<float> differences(std::size_t begin, std::size_t end, const LodSettings& lod);
  std::unique_ptr<LodSplats> idleSplats();

  LodSplats& scene_;
  View view_;
  RenderSettings settings_;
  LodSettings reference_;
  std::vector<Window> squares_;
  std::vector<Frame> references_;  // of the first squares, as far as they were needed
  Frame& frame_;                   // whose tiles at squares are rendered
  std::mutex mutex_;
  std::vector<std::unique_ptr<LodSplats>> idle_;  // buffers of squares rendered side by side
};

}  // namespace foci
