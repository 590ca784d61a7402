#include "app/replay/compared_run.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/gtc/constants.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <sstream>

#include "base/input_error.h"
#include "gaze/sources/line_reader.h"

namespace foci {
namespace {

constexpr double kArcminPerRad = 60.0 * 180.0 / glm::pi<double>();

/// A table with a header, by rows of fields.
class Table {
 public:
  /// @param columns  that it must have
  Table(const std::filesystem::path& file, const std::vector<std::string>& columns) : file_(file) {
    requireRegularFile(file);
    std::ifstream in(file, std::ios::binary);
    std::string line;
    if (!in || !std::getline(in, line)) {
      throw InputError(file.string(), "cannot be read; expected the folder of a foci replay");
    }
    const std::vector<std::string> header = fieldsOf(line);
    for (const std::string& column : columns) {
      const auto found = std::find(header.begin(), header.end(), column);
      if (found == header.end()) {
        throw InputError(file.string(),
                         "has no column " + column + "; expected one of this version of foci");
      }
      at_.push_back(static_cast<std::size_t>(found - header.begin()));
    }
    while (std::getline(in, line)) {
      rows_.push_back(fieldsOf(line));
      if (rows_.back().size() != header.size()) {
        throw InputError(place(rows_.size() - 1),
                         "expected " + std::to_string(header.size()) + " fields");
      }
    }
  }

  std::size_t size() const { return rows_.size(); }
  const std::string& text(std::size_t row, std::size_t column) const {
    return rows_[row][at_[column]];
  }
  std::optional<double> number(std::size_t row, std::size_t column) const {
    const std::string& field = text(row, column);
    if (field == "n/a") return std::nullopt;
    const auto number = parseNumber(field);
    if (!number) throw InputError(place(row), field + ": expected a number");
    return number;
  }
  double needed(std::size_t row, std::size_t column) const {
    const auto value = number(row, column);
    if (!value) throw InputError(place(row), "n/a: expected a number");
    return *value;
  }

 private:
  static std::vector<std::string> fieldsOf(const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream stream(line);
    for (std::string field; std::getline(stream, field, '\t');) fields.push_back(field);
    return fields;
  }
  std::string place(std::size_t row) const {
    return file_.string() + ":" + std::to_string(row + 2);
  }

  std::filesystem::path file_;
  std::vector<std::size_t> at_;
  std::vector<std::vector<std::string>> rows_;
};

std::vector<Image> picturesOf(const std::filesystem::path& video, std::size_t frames) {
  std::vector<Image> pictures;
  requireRegularFile(video);
  cv::VideoCapture capture(video.string());
  cv::Mat bgr;
  std::size_t next = 0;
  for (int k = 0; k < kPictures; ++k) {
    const std::size_t wanted = (2 * static_cast<std::size_t>(k) + 1) * frames / (2 * kPictures);
    for (; next <= wanted; ++next) {
      if (!capture.read(bgr)) throw InputError(video.string(), "ends before the tables do");
    }
    Image image{.size_px = {bgr.cols, bgr.rows}, .rgb = {}};
    cv::Mat rgb;
    cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
    image.rgb.assign(rgb.datastart, rgb.dataend);
    pictures.push_back(std::move(image));
  }
  return pictures;
}

template <class Get>
double meanOf(const std::vector<ComparedFrame>& frames, const Get& get) {
  double sum = 0.0;
  for (const ComparedFrame& frame : frames) sum += get(frame);
  return sum / static_cast<double>(frames.size());
}

}  // namespace

double ComparedRun::duration_s() const {
  const auto count = static_cast<double>(frames.size());
  return frames.size() < 2 ? 0.0 : frames.back().time_s * count / (count - 1.0);
}

double ComparedRun::meanFocus_D() const {
  return meanOf(frames, [](const ComparedFrame& frame) { return frame.focus_D; });
}

double ComparedRun::meanPupil_mm() const {
  return meanOf(frames, [](const ComparedFrame& frame) { return frame.pupil_mm; });
}

std::optional<double> ComparedRun::meanBlur_arcmin() const {
  double sum = 0.0;
  std::size_t count = 0;
  for (const ComparedFrame& frame : frames) {
    if (!frame.off_focus_D) continue;
    sum += 1e-3 * frame.pupil_mm * *frame.off_focus_D * kArcminPerRad;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / static_cast<double>(count);
}

ComparedRun readRun(const std::filesystem::path& folder) {
  ComparedRun run{.folder = folder, .name = folder.lexically_normal().filename().string()};
  if (run.name.empty()) run.name = folder.lexically_normal().parent_path().filename().string();
  const Table frames(folder / "frames.tsv",
                     {"time_s", "focus_D", "pupil_mm", "surface_distance_m"});
  if (frames.size() == 0) throw InputError((folder / "frames.tsv").string(), "has no frames");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ComparedFrame frame{.time_s = frames.needed(i, 0) - frames.needed(0, 0),
                        .focus_D = frames.needed(i, 1),
                        .pupil_mm = frames.needed(i, 2)};
    if (const auto surface_m = frames.number(i, 3)) {
      frame.off_focus_D = std::abs(1.0 / *surface_m - frame.focus_D);
    }
    run.frames.push_back(frame);
  }
  const Table events(folder / "events.tsv", {"event"});
  for (std::size_t i = 0; i < events.size(); ++i) run.fixations += events.text(i, 0) == "fixation";
  const Table objects(folder / "objects.tsv", {"object", "dwell_s"});
  for (std::size_t i = 0; i < objects.size(); ++i) {
    run.dwell_s[objects.text(i, 0)] = objects.needed(i, 1);
  }
  run.pictures = picturesOf(folder / "video.mp4", run.frames.size());
  return run;
}

}  // namespace foci
