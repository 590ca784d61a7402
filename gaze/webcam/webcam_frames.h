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
  /// Else a video, a picture, or a pattern of images such as "eye%04d.png": from number 0 or 1 to
  /// the first gap.
  std::filesystem::path file{};
};

/// Parses `webcam[:N|FILE|PATTERN]`. Nothing if the source is not a webcam.
/// @throws InputError if the colon is the last character, or if there can be no camera N
std::optional<WebcamPlace> webcamPlaceOf(std::string_view source);

/// "webcam 0", "webcam eyes.mp4".
std::string nameOf(const WebcamPlace& place);

/// A photograph of 8 or 16 bits a channel, as 8 bits, grey or BGR; transparency is left out.
/// @throws InputError if it is none, is not whole, or cannot be read
cv::Mat readPhotograph(const std::filesystem::path& file);

class WebcamFrames {
 public:
  /// @throws InputError if there is no such camera, or if the file is no video and no image
  explicit WebcamFrames(const WebcamPlace& place);
  ~WebcamFrames();
  WebcamFrames(const WebcamFrames&) = delete;
  WebcamFrames& operator=(const WebcamFrames&) = delete;

  /// The next frame, 8 bits, one channel or BGR. Never waits for a camera.
  /// @return false if the camera has no new frame, or at the end of a file
  /// @throws InputError if a frame is too small, or differs in size from the previous ones, or if
  ///   an image cannot be read to its end
  bool next(cv::Mat& frame);

  /// Of a file: when its next frame is due, seconds from its first one. A video whose rate varies
  /// has the times of its own stamps; a frame of any other file follows the one before by 1 / rate.
  /// Nothing at the end.
  std::optional<double> nextTime_s();

  /// Nominal frame rate, > 0; 30 for images.
  double rate_Hz() const { return rate_Hz_; }
  bool isCamera() const { return place_.device.has_value(); }
  bool isPicture() const { return images_ && !isPattern(); }

  /// After the last frame: a sentence about the frames that a video states and does not hold.
  std::string remark() const;

 private:
  struct Capture;
  bool isPattern() const { return !after_number_.empty(); }
  std::filesystem::path image(std::size_t index) const;
  bool grab();

  WebcamPlace place_;
  std::unique_ptr<Capture> capture_;
  double rate_Hz_ = 30.0;
  bool images_ = false;                           // a pattern of them, or a single picture
  std::string before_number_{}, after_number_{};  // a pattern's
  int digits_ = 0;
  std::size_t first_ = 0;  // number of a pattern
  bool grabbed_ = false;   // the next frame
  bool varies_ = false;    // the rate
  std::size_t count_ = 0;  // frames grabbed
  double stated_ = 0.0;    // frames of a video; 0: not known
  std::optional<double> first_stamp_s_{}, last_s_{};
};

}  // namespace foci
