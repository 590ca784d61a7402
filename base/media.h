// Cameras, videos, and images of other formats than foci reads itself, by OpenCV. Its codecs bring
// over 200 shared libraries, so that they stand in a library of their own, libfoci_media, opened
// when it is first asked for.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "base/image_codec.h"

namespace cv {
class Mat;
}

namespace foci {

class VideoReader {
 public:
  virtual ~VideoReader() = default;
  virtual bool openCamera(int number) = 0;
  virtual bool open(const std::string& file) = 0;
  /// @return false at the end
  virtual bool grab() = 0;
  /// The grabbed frame, BGR. @return false if it cannot be decoded
  virtual bool retrieve(cv::Mat& frame) = 0;
  /// @return true if a camera has a frame now
  virtual bool hasFrame() = 0;
  /// As the file or the camera states them; 0: not known.
  virtual double rate_Hz() const = 0;
  virtual double frames() const = 0;
  /// Of the grabbed frame, from the file's beginning.
  virtual double time_s() const = 0;
};

/// Encodes H.264.
class VideoEncoder {
 public:
  virtual ~VideoEncoder() = default;
  virtual bool open(const std::string& file, int columns, int rows, double fps) = 0;
  /// @param rgb  8-bit sRGB, row-major, top row first
  /// @return false if encoding fails
  virtual bool write(std::span<std::uint8_t> rgb) = 0;
  virtual void close() = 0;
};

/// A change of it needs another number in the symbol `foci_media_1`.
struct Media {
  std::unique_ptr<VideoReader> (*newReader)();
  std::unique_ptr<VideoEncoder> (*newEncoder)();
  /// True if a file's first bytes are those of an image.
  bool (*isImage)(const std::string& file);
  /// BGR, its bits as in the file, turned as its EXIF data say; empty if it cannot be read.
  cv::Mat (*readImage)(const std::string& file);
  /// The values, bits and channels of the file; empty if it cannot be read.
  cv::Mat (*readStored)(const std::string& file);
  /// 16 bits are rounded to 8. Nothing if it cannot be read.
  std::optional<DecodedImage> (*decodeImage)(std::span<const unsigned char> bytes);
};

/// Null where the library cannot be opened.
const Media* media();

/// What a message adds then: why not.
std::string withoutMedia();

}  // namespace foci
