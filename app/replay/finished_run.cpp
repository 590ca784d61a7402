#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "app/platform/sha256.h"
#include "app/replay/figures.h"
#include "app/study/study_text.h"
#include "base/file.h"
#include "base/input_error.h"
#include "base/media.h"

namespace foci {
namespace {

using Json = nlohmann::ordered_json;
constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

Json manifestOf(const std::filesystem::path& folder) {
  constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 26;
  const std::filesystem::path file = folder / "manifest.json";
  Json json = Json::parse(bytesOfFile(file, kMaxBytes), nullptr, false);
  if (json.is_object() && json.contains("configuration") && json.contains("inputs")) return json;
  throw InputError(file.string(), "expected the manifest of a replay by this version of foci");
}

/// Reads columns of a table by their names.
struct Columns {
  NamedTable& table;
  double operator()(const char* name) const {
    return table.number(table.column(name)).value_or(kNoValue);
  }
  std::string text(const char* name) const { return std::string(table.text(table.column(name))); }
};

}  // namespace

NamedTable tableOfRun(const std::filesystem::path& folder, const char* name) {
  return NamedTable(folder / name, "the folder of a replay by this version of foci");
}

std::vector<RunFrame> framesOfRun(const std::filesystem::path& folder) {
  NamedTable table = tableOfRun(folder, "frames.tsv");
  const Columns at{table};
  std::vector<RunFrame> frames;
  while (table.next()) {
    const auto needed = [&](const char* name) { return table.needed(table.column(name)); };
    frames.push_back({{.time_s = needed("time_s"),
                       .gaze_x_px = at("gaze_x_px"),
                       .gaze_y_px = at("gaze_y_px"),
                       .surface_D = 1.0 / at("surface_distance_m"),
                       .target_D = at("target_D"),
                       .focus_D = needed("focus_D"),
                       .pupil_mm = needed("pupil_mm"),
                       .render_ms = needed("render_ms"),
                       .state = stateNamed(at.text("gaze_state")).value_or(GazeState::lost),
                       .world_from_eye = {at("eye_qw"), at("eye_qx"), at("eye_qy"), at("eye_qz")}},
                      {at("eye_x_m"), at("eye_y_m"), at("eye_z_m")},
                      at.text("trial"),
                      frames.size()});
  }
  if (frames.empty()) throw InputError(table.fileName(), "has no frames");
  return frames;
}

std::vector<RunFixation> fixationsOfRun(const std::filesystem::path& folder) {
  NamedTable table = tableOfRun(folder, "fixations.tsv");
  table.withoutComments();  // a recording may be named #1
  const Columns at{table};
  std::vector<RunFixation> fixations;
  while (table.next()) {
    const glm::dvec2 gaze_px(at("x_px"), at("y_px"));
    const glm::dvec3 point_m(at("point_x_m"), at("point_y_m"), at("point_z_m"));
    fixations.push_back({.number = static_cast<std::size_t>(table.needed(table.column("fixation"))),
                         .onset_s = table.needed(table.column("onset_s")),
                         .duration_s = table.needed(table.column("duration_s")),
                         .surface_D = at("surface_D"),
                         .focus_D = at("focus_D"),
                         .blur_arcmin = at("blur_radius_arcmin"),
                         .trial = at.text("trial")});
    if (std::isfinite(gaze_px.x)) fixations.back().gaze_px = gaze_px;
    if (std::isfinite(point_m.x)) fixations.back().point_m = point_m;
  }
  return fixations;
}

Study studyOfRun(const std::filesystem::path& folder) {
  const Json manifest = manifestOf(folder), &all = manifest["configuration"];
  const std::string file = (folder / "manifest.json").string();
  Study study;
  for (const ResolvedKey& key : resolvedKeys(Study{})) {
    const std::string name(key.name), section(sectionOf(name));
    const Json& stated = section.empty() ? all : all.value(section, Json::object());
    const Json value = stated.value(std::string(leafOf(name)), Json());
    // The numbers of a monitor stand beside its file.
    if (value.is_null() || value == Json::array() || value == "" || name == "screen.monitor") {
      continue;
    }
    setKey(study, name, tomlOfJson(value.dump()), file);
  }
  study.file = file;
  study.screen.is_default = manifest.value("screen_is_default", false);
  return study;
}

void requireSameInputs(const std::filesystem::path& folder) {
  const Json manifest = manifestOf(folder);
  for (const Json& input : manifest["inputs"]) {
    const std::string path = input.value("path", ""), sha256 = input.value("sha256", "");
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) {
      throw InputError(path, "is not there: run this in the folder where the run was made");
    }
    if (sha256OfFile(path) != sha256) throw InputError(path, "has changed since the run");
  }
}

std::vector<Image> videoFrames(const std::filesystem::path& folder,
                               const std::vector<std::size_t>& wanted) {
  const std::filesystem::path video = folder / "video.mp4";
  requireRegularFile(video);
  const auto reader = media() ? media()->newReader() : nullptr;
  if (!reader || !reader->open(video.string())) {
    throw InputError(video.string(), "not a video that can be read" + withoutMedia());
  }
  std::vector<Image> frames;
  cv::Mat bgr;
  std::size_t next = 0;
  for (const std::size_t number : wanted) {
    for (; next <= number; ++next) {
      if (!reader->grab() || !reader->retrieve(bgr))
        throw InputError(video.string(), "ends before the tables do");
    }
    Image image{.size_px = {bgr.cols, bgr.rows}, .rgb = {}};
    cv::Mat rgb;
    cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
    image.rgb.assign(rgb.datastart, rgb.dataend);
    frames.push_back(std::move(image));
  }
  return frames;
}

}  // namespace foci
