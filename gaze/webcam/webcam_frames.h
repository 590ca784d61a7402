// Frames from a camera, a video file, a picture or numbered images.
#pragma once

#include <cstddef>
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
  std::optional<int> device{};  ///< a camera's number
  /// Else a video, a picture, or a pattern of images such as "eye%04d.png".
  std::filesystem::path file{};
};

/// Parses `webcam[:N|FILE|PATTERN]`. Nothing if the source is not a webcam.
/// @throws InputError if the colon is the last character, or if there can be no camera N
std::optional<WebcamPlace> webcamPlaceOf(std::string_view source);

/// "webcam 0", "webcam eyes.mp4".
std::string nameOf(const WebcamPlace& place);

/// Refuses a video, or an image of a pattern, that is a folder, a pipe or a device: OpenCV would
/// wait for it for ever.
/// @throws InputError
void refuseOtherThanFiles(const std::filesystem::path& video);

class WebcamFrames {
 public:
  /// @throws InputError if there is no such camera, or if the file is no video and no image
  explicit WebcamFrames(const WebcamPlace& place);
  ~WebcamFrames();
  WebcamFrames(const WebcamFrames&) = delete;
  WebcamFrames& operator=(const WebcamFrames&) = delete;

  /// The next frame, 8 bits, one channel or BGR. Never waits for a camera.
  /// @return false if the camera has no new frame, or at the end of a file
  /// @throws InputError if a frame is too small, or differs in size from the previous ones
  bool next(cv::Mat& frame);

  /// Of a file: when its next frame is due, seconds from its first one. A video whose rate varies
  /// has the times of its own stamps; a frame of any other file follows the one before by 1 / rate.
  /// Nothing at the end.
  std::optional<double> nextTime_s();

  /// Nominal frame rate, > 0; 30 for images.
  double rate_Hz() const { return rate_Hz_; }
  bool isCamera() const { return place_.device.has_value(); }
  bool isPicture() const { return picture_; }

 private:
  struct Capture;
  bool grab();

  WebcamPlace place_;
  std::unique_ptr<Capture> capture_;
  double rate_Hz_ = 30.0;
  bool picture_ = false;   // a single one
  bool grabbed_ = false;   // the next frame
  bool varies_ = false;    // the rate
  std::size_t count_ = 0;  // frames grabbed
  std::optional<double> first_stamp_s_{}, last_s_{};
};

}  // namespace foci
