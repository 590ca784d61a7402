// Grey frames of a camera, a video file or numbered images, with their times.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace cv {
class Mat;
}

namespace foci {

struct WebcamPlace {
  std::optional<int> device{};   ///< number of a camera
  std::filesystem::path file{};  ///< else a video, or a pattern of images as "eye%04d.png"
};

/// What `webcam[:N|FILE|PATTERN]` names; nothing where the source is no webcam.
/// @throws InputError where nothing stands behind the colon
std::optional<WebcamPlace> webcamPlaceOf(std::string_view source);

/// "webcam 0", "webcam eyes.mp4".
std::string nameOf(const WebcamPlace& place);

class WebcamFrames {
 public:
  /// @throws InputError where there is no such camera, or the file is no video
  explicit WebcamFrames(const WebcamPlace& place);
  ~WebcamFrames();
  WebcamFrames(const WebcamFrames&) = delete;
  WebcamFrames& operator=(const WebcamFrames&) = delete;

  /// The next frame, 8 bits, one channel. Of a camera only what has come already: this never waits
  /// for it.
  /// @return false where there is none now; in a file, where it ends
  /// @throws InputError on frames that are too small or of a size of their own
  bool next(cv::Mat& grey);

  /// Nominal, > 0; images come at 30 a second.
  double rate_Hz() const { return rate_Hz_; }
  bool isCamera() const { return place_.device.has_value(); }

 private:
  struct Capture;
  WebcamPlace place_;
  std::unique_ptr<Capture> capture_;
  double rate_Hz_ = 30.0;
};

}  // namespace foci
