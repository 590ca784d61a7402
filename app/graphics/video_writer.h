// H.264 video, encoded while foci renders.
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

/// Keeps the order of the frames. The encoder has a thread of its own, unless foci may use one
/// thread only (`maxThreads`). At most a few frames wait for it: then `push` blocks. The file
/// depends on the frames alone, not on the machine's cores.
class VideoWriter {
 public:
  /// @param file  ends in .mp4; `size_px` even
  /// @throws std::runtime_error if OpenCV has no H.264 encoder or the file cannot be written
  VideoWriter(const std::filesystem::path& file, const glm::ivec2& size_px, double fps);
  ~VideoWriter();

  /// @throws std::runtime_error if encoding has failed
  void push(Image&& image);

  /// Waits for the last frame and closes the file.
  /// @throws std::runtime_error if encoding has failed or the file is not complete
  void finish();

 private:
  struct Worker;
  std::unique_ptr<Worker> worker_;
};

/// True if a file consists of boxes of ISO/IEC 14496-12 from its first byte to its last, with an
/// index among them. The encoder does not report a file that a full disk truncates.
bool isWholeMp4(const std::filesystem::path& file);

}  // namespace foci
