#include "app/webcam/watch.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "app/graphics/image.h"
#include "app/platform/interrupt.h"
#include "app/platform/json_text.h"
#include "app/platform/output_files.h"
#include "app/platform/progress.h"
#include "base/file.h"
#include "base/input_error.h"
#include "base/quantile.h"
#include "base/text.h"
#include "calibration/webcam/webcam_calibration.h"
#include "gaze/webcam/webcam_source.h"

namespace foci {
namespace {

/// A camera's number, a file or a pattern, with or without `webcam:` before it.
WebcamPlace placeOf(const std::string& source) {
  if (const auto place = webcamPlaceOf(source)) return *place;
  return *webcamPlaceOf("webcam:" + source);
}

const char* const kColumns =
    "frame\ttime_s\tface\tfaces\tblink\tconfidence\tms\tface_x_px\tface_y_px\tipd_px\t"
    "left_x_px\tleft_y_px\tleft_radius_px\tright_x_px\tright_y_px\tright_radius_px\t"
    "yaw_deg\tpitch_deg\troll_deg\thead_x_m\thead_y_m\thead_z_m\n";

std::string rowOf(std::size_t frame, double time_s, double ms, const WebcamRecord& record) {
  const auto cells = [](bool known, std::initializer_list<double> values, int digits) {
    std::string text;
    for (const double value : values) text += '\t' + (known ? decimal(value, digits) : "n/a");
    return text;
  };
  std::string row = std::to_string(frame) + '\t' + decimal(time_s, 6) + '\t' +
                    (record.face ? "1\t" : "0\t") + std::to_string(record.faces) + '\t' +
                    (record.blink ? "1" : "0") + cells(true, {record.confidence}, 3) +
                    cells(true, {ms}, 2) +
                    cells(record.face, {record.eyes_px.x, record.eyes_px.y, record.ipd_px}, 2);
  for (const std::optional<Iris>& iris : record.irises) {
    const Iris at = iris.value_or(Iris{});
    row += cells(iris.has_value(), {at.centre_px.x, at.centre_px.y, at.radius_px}, 3);
  }
  const WebcamView view = record.head ? webcamView(*record.head, glm::dvec2(0.0)) : WebcamView{};
  row += cells(record.face,
               {glm::degrees(view.head_rad.x), glm::degrees(view.head_rad.y),
                glm::degrees(view.roll_rad)},
               3) +
         cells(record.face, {view.head_m.x, view.head_m.y, view.head_m.z}, 4);
  return row + '\n';
}

// OpenCV draws in coordinates whose pixel centres are whole numbers, here in sixteenths.
constexpr int kShift = 4;
cv::Point fine(const glm::dvec2& px) {
  return {static_cast<int>(std::lround((px.x - 0.5) * (1 << kShift))),
          static_cast<int>(std::lround((px.y - 0.5) * (1 << kShift)))};
}

/// Draws the face's box, lids, irises and the axes of the head.
void drawRecord(cv::Mat& image, const WebcamRecord& record, const Pinhole& camera) {
  const int width = std::max(1, image.cols / 640);
  const auto line = [&](const glm::dvec2& a, const glm::dvec2& b, const cv::Scalar& bgr) {
    cv::line(image, fine(a), fine(b), bgr, width, cv::LINE_AA, kShift);
  };
  const cv::Scalar yellow(0, 220, 255), green(90, 230, 60), white(255, 255, 255);
  if (record.head) {
    const double half = 1.1 * record.ipd_px;
    const glm::dvec2 low = record.eyes_px - glm::dvec2(half, 0.9 * half), high = low + 2.0 * half;
    cv::rectangle(image, fine(low), fine(high), white, width, cv::LINE_AA, kShift);
    const glm::dvec2 origin = project(camera, *record.head, glm::dvec3(0.0));
    const std::array<cv::Scalar, 3> colours{cv::Scalar(60, 60, 240), green,
                                            cv::Scalar(240, 140, 40)};
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 end(0.0);
      end[axis] = axis == 0 ? 60.0 : -60.0;  // right, up, out of the face
      line(origin, project(camera, *record.head, end), colours[static_cast<std::size_t>(axis)]);
    }
  }
  for (const std::vector<glm::dvec2>& lids : record.lids_px) {
    for (std::size_t i = 0; i < lids.size(); ++i) {
      line(lids[i], lids[(i + 1) % lids.size()], record.blink ? white : yellow);
    }
  }
  for (const std::optional<Iris>& iris : record.irises) {
    if (!iris) continue;
    cv::circle(image, fine(iris->centre_px), static_cast<int>(iris->radius_px * (1 << kShift)),
               green, width, cv::LINE_AA, kShift);
    cv::circle(image, fine(iris->centre_px), width << kShift, green, cv::FILLED, cv::LINE_AA,
               kShift);
  }
  const std::string words = record.blink ? "blink" : textOf(record.problem, record.ipd_px);
  const double size = 0.5 * width;
  const cv::Point at(6 * width, image.rows - 8 * width);
  cv::putText(image, words, at, cv::FONT_HERSHEY_SIMPLEX, size, {0, 0, 0}, 3 * width, cv::LINE_AA);
  cv::putText(image, words, at, cv::FONT_HERSHEY_SIMPLEX, size, white, width, cv::LINE_AA);
}

/// The overlay of one picture is a picture, that of several frames a video.
class Overlay {
 public:
  Overlay(OutputFiles& files, const std::string& file, bool one, double rate_Hz)
      : rate_Hz_(rate_Hz) {
    if (file.empty()) return;
    const std::string wanted = one ? ".png" : ".mp4";
    if (std::filesystem::path(file).extension() != wanted) {
      throw InputError("--overlay " + file,
                       "expected a name that ends in " + wanted + ", as " +
                           (one ? "the source is one picture" : "the source has many frames"));
    }
    staged_ = files.stage(file);
    one_ = one;
  }
  void add(cv::Mat image, const WebcamRecord& record, const Pinhole& camera) {
    if (staged_.empty()) return;
    if (image.channels() == 1) cv::cvtColor(image, image, cv::COLOR_GRAY2BGR);
    drawRecord(image, record, camera);
    const int unit = one_ ? 1 : 2;  // a video's sides are even
    const cv::Rect shown(0, 0, image.cols / unit * unit, image.rows / unit * unit);
    cv::Mat rgb;
    cv::cvtColor(image(shown), rgb, cv::COLOR_BGR2RGB);
    Image frame{{rgb.cols, rgb.rows}, {}};
    frame.rgb.assign(rgb.datastart, rgb.dataend);
    if (one_) {
      replaceFile(staged_, pngOf(frame));
      return;
    }
    if (!video_) video_ = std::make_unique<VideoWriter>(staged_, frame.size_px, rate_Hz_);
    video_->push(std::move(frame));
  }
  void finish() {
    if (video_) video_->finish();
  }

 private:
  std::filesystem::path staged_;
  double rate_Hz_;
  bool one_ = false;
  std::unique_ptr<VideoWriter> video_;
};

struct Totals {
  std::size_t frames = 0, faces = 0, blinks = 0, irises = 0;
  std::vector<double> ms;
  WebcamProblems problems;

  void add(const WebcamRecord& record, double took_ms) {
    ++frames;
    faces += record.face;
    blinks += record.blink;
    for (const auto& iris : record.irises) irises += iris.has_value();
    ms.push_back(took_ms);
    problems.add(record);
  }
};

void printSummary(const WatchOptions& options, Totals totals, bool by_networks) {
  const auto share = [&](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(totals.frames);
  };
  nlohmann::ordered_json json = {{"tracker", by_networks ? "networks" : "cascades"},
                                 {"frames", totals.frames},
                                 {"face", share(totals.faces)},
                                 {"blink", share(totals.blinks)},
                                 {"irises_a_frame", share(totals.irises)},
                                 {"ms_median", quantile(totals.ms, 0.5)},
                                 {"ms_95", quantile(totals.ms, 0.95)},
                                 {"problems", nlohmann::ordered_json::array()}};
  for (const auto& [count, text] : totals.problems.list()) {
    json["problems"].push_back({{"problem", text}, {"frames", count}});
  }
  if (options.json) {
    std::puts(jsonText(json).c_str());
    return;
  }
  // A table without a file has standard output.
  std::FILE* const to = options.table && options.out.empty() ? stderr : stdout;
  std::fprintf(to,
               "%s by %s: a face in %.1f %%, a blink in %.1f %%, %.2f irises a frame; %.1f "
               "ms a frame, 95 %% below %.1f ms\n",
               counted(totals.frames, "frame").c_str(), by_networks ? "networks" : "cascades",
               100.0 * share(totals.faces), 100.0 * share(totals.blinks), share(totals.irises),
               quantile(totals.ms, 0.5), quantile(totals.ms, 0.95));
  for (const auto& [count, text] : totals.problems.list()) {
    std::fprintf(to, "%s: %s\n", counted(count, "frame").c_str(), text.c_str());
  }
}

}  // namespace

void watchWebcam(const WatchOptions& options) {
  const WebcamPlace place = placeOf(options.source);
  OutputFiles files(
      OutputGuard({options.out, options.overlay}, {place.file, options.camera}, options.overwrite));
  std::optional<Lens> camera;
  if (!options.camera.empty()) camera = lensOf(readCamera(options.camera));
  WebcamTracker tracker(camera);
  WebcamFrames frames(place);
  if (const std::string remark = tracker.remark(); !remark.empty()) {
    std::fprintf(stderr, "foci: %s\n", remark.c_str());
  }
  Overlay overlay(files, options.overlay, frames.isPicture(), frames.rate_Hz());
  std::string table = kColumns;
  Totals totals;
  if (frames.isCamera()) noteInterrupts();
  const auto print = [&](const std::string& row) {
    if (!options.table) return;
    if (!options.out.empty()) {
      table += row;
    } else if (!options.json) {
      std::fputs(row.c_str(), stdout);
    }
  };
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  cv::Mat image;
  while (!isInterrupted()) {
    const auto due_s = frames.isCamera() ? std::nullopt : frames.nextTime_s();
    if (!frames.next(image)) {
      if (!frames.isCamera()) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      continue;
    }
    const auto now = Clock::now();
    const WebcamRecord record = tracker.push(image);
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - now).count();
    const double time_s = due_s.value_or(std::chrono::duration<double>(now - begin).count());
    if (totals.frames == 0 && options.out.empty()) print(kColumns);
    print(rowOf(totals.frames, time_s, ms, record));
    totals.add(record, ms);
    overlay.add(image, record, *tracker.camera());
  }
  if (const std::string remark = frames.remark(); !remark.empty()) {
    std::fprintf(stderr, "foci: %s: %s\n", nameOf(place).c_str(), remark.c_str());
  }
  if (totals.frames == 0) throw InputError(nameOf(place), "has no frame that can be read");
  overlay.finish();
  if (!options.out.empty()) files.write(options.out, table);
  files.commit();
  printSummary(options, totals, tracker.byNetworks());
}

}  // namespace foci
