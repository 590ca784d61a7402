// H.264 video, encoded in a thread of its own beside the rendering.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

namespace foci {

/// 8-bit sRGB, row-major, top row first, 3 bytes a pixel: R, G, B.
struct Image {
  glm::ivec2 size_px{0, 0};
  std::vector<std::uint8_t> rgb;
};

/// Frames come out in the order they went in. At most a few wait: `push` blocks until there is
/// room.
class VideoWriter {
 public:
  /// @param file  ends in .mp4; `size_px` even
  /// @throws std::runtime_error where OpenCV offers no H.264 encoder or the file cannot be written
  VideoWriter(const std::filesystem::path& file, const glm::ivec2& size_px, double fps);
  ~VideoWriter();

  /// @throws std::runtime_error where encoding has failed meanwhile
  void push(Image&& image);

  /// Waits for the last frame and closes the file.
  /// @throws std::runtime_error where encoding has failed, or the file is not whole
  void finish();

 private:
  struct Worker;
  std::unique_ptr<Worker> worker_;
};

/// Whether a file is boxes of ISO/IEC 14496-12 from its first byte to its last, their index among
/// them. One that a full disk has cut short is not, though the encoder says nothing.
bool isWholeMp4(const std::filesystem::path& file);

}  // namespace foci
