#include "app/replay/figures.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/constants.hpp>
#include <set>

#include "app/graphics/image.h"
#include "app/platform/output_files.h"
#include "app/platform/warnings.h"
#include "app/replay/gaze_in_scene.h"
#include "app/replay/heatmap.h"
#include "app/study/load_scene.h"
#include "base/input_error.h"
#include "base/quantile.h"
#include "base/text.h"
#include "gaze/geometry/line_of_sight.h"

namespace foci {
namespace {

constexpr int kMapWidth = 640;
constexpr float kMapDim = 0.5f;              // of the frame under the gaze map
const glm::vec3 kLuma(0.30f, 0.59f, 0.11f);  // of sRGB codes (ITU-R BT.601)

/// The finished run, or one trial of it.
struct FigureRun {
  std::filesystem::path folder;
  Study study;
  Screen screen;
  std::vector<RunFrame> frames;
  std::vector<RunFixation> fixations;

  FigureRun(const std::filesystem::path& from, const std::optional<std::string>& trial)
      : folder(from),
        study(studyOfRun(from)),
        screen(study.screenInForce()),
        frames(framesOfRun(from)),
        fixations(fixationsOfRun(from)) {
    if (!trial) return;
    std::set<std::string> names;
    for (const RunFrame& frame : frames) names.insert(frame.trial);
    if (!names.contains(*trial)) {
      throw InputError("--trial " + *trial,
                       "expected a trial of the run: " + listed(names, ", ", visible));
    }
    const auto other = [&](const auto& one) { return one.trial != *trial; };
    std::erase_if(frames, other);
    std::erase_if(fixations, other);
  }

  bool eyeMoves() const {
    return std::ranges::any_of(frames, [&](const RunFrame& frame) {
      return glm::distance(frame.eye_m, frames[0].eye_m) > 1e-3 ||
             std::abs(glm::dot(frame.world_from_eye, frames[0].world_from_eye)) < 1.0 - 1e-6;
    });
  }
};

/// The median of the images, value by value: without the marker of gaze, which moves.
Image medianOf(std::vector<Image> images) {
  Image median = std::move(images.back());
  images.pop_back();
  std::vector<std::uint8_t> values(images.size() + 1);
  for (std::size_t i = 0; i < median.rgb.size(); ++i) {
    for (std::size_t k = 0; k < images.size(); ++k) values[k] = images[k].rgb[i];
    values.back() = median.rgb[i];
    median.rgb[i] = quantile(values, 0.5);
  }
  return median;
}

/// The ground of scanpath and gaze map, and where the fixations lie on it.
struct Ground {
  std::optional<Image> frame{};
  std::vector<PathPoint> path{};
  std::string remark{};
};

/// The frame in the middle of the longest fixation: where the eye moves, the fixations lie where
/// their points of the scene are in it.
Ground groundOf(const FigureRun& run) {
  const std::vector<RunFrame>& frames = run.frames;
  const bool moves = run.eyeMoves(), mono = run.study.output.view == StereoView::mono;
  Ground ground;
  std::size_t chosen = frames.size() / 2;
  if (!run.fixations.empty()) {
    const auto longest = std::ranges::max_element(run.fixations, {}, &RunFixation::duration_s);
    const double time_s = longest->onset_s + 0.5 * longest->duration_s;
    const auto at = std::ranges::lower_bound(frames, time_s, {}, &ChartRow::time_s);
    chosen = std::min(static_cast<std::size_t>(at - frames.begin()), frames.size() - 1);
  }
  for (const RunFixation& fixation : run.fixations) {
    auto at_px = fixation.gaze_px;
    if (moves) {
      at_px.reset();
      const RunFrame& frame = frames[chosen];
      if (fixation.point_m) {
        at_px = pointOnScreen_px(
            run.screen, glm::inverse(frame.world_from_eye) * (*fixation.point_m - frame.eye_m));
      }
    }
    const bool inside = at_px && glm::all(glm::greaterThanEqual(*at_px, glm::dvec2(0.0))) &&
                        glm::all(glm::lessThan(*at_px, glm::dvec2(run.screen.size_px)));
    if (inside) ground.path.push_back({*at_px, fixation.duration_s, fixation.number});
  }
  const std::size_t outside = run.fixations.size() - ground.path.size();
  if (outside > 0) {
    ground.remark = std::to_string(outside) + " of " + std::to_string(run.fixations.size()) +
                    " fixations lie outside the frame and are left out";
  }
  if (!mono) {
    ground.remark += (ground.remark.empty() ? "" : "; ") +
                     std::string("without the frame: output.view is not mono");
    return ground;
  }
  std::vector<std::size_t> wanted{frames[chosen].number};
  if (run.study.output.marker && !moves) {
    wanted.clear();
    for (std::size_t k = 0; k < 7; ++k) {
      wanted.push_back(frames[(2 * k + 1) * frames.size() / 14].number);
    }
  }
  ground.frame = medianOf(videoFrames(run.folder, wanted));
  return ground;
}

Image fitted(const FigureStyle& style, const Image& image) {
  const int most = static_cast<int>(style.width_mm / 25.4 * style.dpi);
  return image.size_px.x > most ? thumbnail(image, most) : image;
}

/// The length in pixels of a round angle about the faced point of the screen, and its name.
void addBar(const Screen& screen, FigurePicture& picture) {
  const double px_per_m = screen.size_px.x / screen.size_m.x;
  for (const double degrees : {50.0, 20.0, 10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1}) {
    const double half_m = screen.distance_m * std::tan(glm::radians(0.5 * degrees));
    picture.bar = 2.0 * half_m * px_per_m;
    picture.bar_label = significant(degrees, 2) + " deg";
    if (*picture.bar < 0.2 * screen.size_px.x) return;
  }
}

/// The place of a number at a fixation, or beside it where other numbers are near.
glm::dvec2 freePlace(const glm::dvec2& at_px, double step_px, std::vector<glm::dvec2>& taken) {
  constexpr int kPlaces = 25, kTurn = 8;
  glm::dvec2 place = at_px;
  for (int i = 0; i < kPlaces; ++i) {
    const double angle_rad = glm::two_pi<double>() * i / kTurn;
    const double away_px = i == 0 ? 0.0 : step_px * (1 + (i - 1) / kTurn);
    place = at_px + away_px * glm::dvec2(std::cos(angle_rad), std::sin(angle_rad));
    if (std::ranges::none_of(taken, [&](const glm::dvec2& other) {
          return glm::distance(place, other) < 0.9 * step_px;
        })) {
      break;
    }
  }
  taken.push_back(place);
  return place;
}

}  // namespace

GnuplotChart scanpathFigure(const FigureStyle& wanted, const Screen& screen,
                            const std::optional<Image>& frame, const std::vector<PathPoint>& path) {
  const Image white{.size_px = {1, 1}, .rgb = {255, 255, 255}};
  const FigureStyle style = styleFor(wanted, screen.size_px);
  const double px_per_pt = screen.size_px.x / style.size_pt().x;
  // A circle of 1 s; a short fixation still has room for its number.
  const double second_px = 2.2 * style.font_pt * px_per_pt;
  FigurePicture picture{.image = frame ? fitted(style, *frame) : white,
                        .size = screen.size_px,
                        .scale = {.from = 1.0,
                                  .to = static_cast<double>(std::max<std::size_t>(path.size(), 2)),
                                  .label = "fixation, in order",
                                  .heat = false}};
  addBar(screen, picture);
  picture.bar_label += "; area: duration";
  const double letter_px = style.font_pt * px_per_pt, least_px = 0.8 * letter_px;
  std::string line, circles;
  std::vector<glm::dvec2> numbers;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const PathPoint& point = path[i];
    const glm::dvec2 number_px = freePlace(point.at_px, 1.5 * letter_px, numbers);
    const auto circle = [&](const glm::dvec2& at_px, double radius_px) {
      circles += decimal(at_px.x, 2) + " " + decimal(at_px.y, 2) + " " + decimal(radius_px, 2) +
                 " " + std::to_string(i + 1) + "\n";
    };
    line += decimal(point.at_px.x, 2) + " " + decimal(point.at_px.y, 2) + "\n";
    circle(point.at_px, std::max(second_px * std::sqrt(point.duration_s), least_px));
    if (number_px != point.at_px) circle(number_px, least_px);
    const double order =
        path.size() < 2 ? 0.0 : static_cast<double>(i) / static_cast<double>(path.size() - 1);
    const glm::vec3 color = colorAt(style.colors, static_cast<float>(order));
    const bool bright = glm::dot(color, kLuma) > 0.5f;
    picture.settings += "set label '" + std::to_string(point.number) + "' at " +
                        decimal(number_px.x, 2) + "," + decimal(number_px.y, 2) +
                        " center front textcolor rgb '" + (bright ? "#000000" : "#ffffff") + "'\n";
  }
  if (!path.empty()) {
    picture.settings += "$line << END\n" + line + "END\n$circles << END\n" + circles + "END\n";
    for (const auto& [width, color] : {std::pair(2.2, "#000000"), {1.2, "#ffffff"}}) {
      picture.plots += ", $line using 1:2 with lines notitle linewidth " + style.line(width) +
                       " linecolor rgb '" + color + "'";
    }
    picture.plots +=
        ", $circles using 1:2:3:4 with circles notitle linecolor palette fillstyle transparent "
        "solid 0.85 noborder";
  }
  return drawFigure(style, figureHead(style) + pictureScript(style, picture),
                    "Scanpath of " + counted(path.size(), "fixation"),
                    "Circles at the fixations on a frame of the run, numbered as in "
                    "fixations.tsv, joined in order. " +
                        picture.bar_label + ".");
}

std::vector<float> gazeMap(const Screen& screen, const glm::ivec2& size,
                           const std::vector<PathPoint>& path) {
  constexpr double kReach = 5.0;  // in sigmas
  const double sigma = glm::radians(kGazeMapSigma_deg);
  std::vector<glm::dvec3> sights;
  sights.reserve(path.size());
  for (const PathPoint& point : path) sights.push_back(lineOfSight(screen, point.at_px));
  std::vector<float> map;
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const glm::dvec2 at_px =
          (glm::dvec2(x, y) + 0.5) / glm::dvec2(size) * glm::dvec2(screen.size_px);
      const glm::dvec3 sight = lineOfSight(screen, at_px);
      double sum = 0.0;
      for (std::size_t i = 0; i < sights.size(); ++i) {
        const double chord = glm::distance(sight, sights[i]);
        if (chord > kReach * sigma) continue;
        const double angle = 2.0 * std::asin(0.5 * chord);
        sum += path[i].duration_s * std::exp(-0.5 * angle * angle / (sigma * sigma));
      }
      map.push_back(static_cast<float>(
          sum / (glm::two_pi<double>() * kGazeMapSigma_deg * kGazeMapSigma_deg)));
    }
  }
  return map;
}

namespace {

GnuplotChart gazeMapFigure(const FigureStyle& wanted, const Screen& screen, const Ground& ground) {
  const FigureStyle style = styleFor(wanted, screen.size_px);
  Image image{.size_px = {kMapWidth, kMapWidth * screen.size_px.y / screen.size_px.x}, .rgb = {}};
  if (ground.frame) image = thumbnail(*ground.frame, std::min(kMapWidth, ground.frame->size_px.x));
  const std::vector<float> map = gazeMap(screen, image.size_px, ground.path);
  const float most = std::max(*std::ranges::max_element(map), 1e-9f);
  image.rgb.resize(3 * map.size(), 0);
  for (std::size_t i = 0; i < map.size(); ++i) {
    std::uint8_t* const rgb = &image.rgb[3 * i];
    const float grey = kMapDim / 255.0f * glm::dot(kLuma, glm::vec3(rgb[0], rgb[1], rgb[2]));
    const float share = map[i] / most;
    const glm::vec3 color = heatAt(style.colors, share < 0.01f ? 0.0f : share, grey);
    for (int c = 0; c < 3; ++c) rgb[c] = static_cast<std::uint8_t>(std::lround(255 * color[c]));
  }
  FigurePicture picture{.image = std::move(image),
                        .size = screen.size_px,
                        .scale = {.to = double{most}, .label = "time of fixation, s/deg²"}};
  addBar(screen, picture);
  picture.bar_label += "; smoothing: " + significant(kGazeMapSigma_deg, 2) + " deg";
  return drawFigure(style, figureHead(style) + pictureScript(style, picture), "Map of gaze",
                    "Time of fixation per solid angle, up to " + significant(double{most}, 3) +
                        " s/deg2, smoothed by a Gaussian of " + significant(kGazeMapSigma_deg, 2) +
                        " deg. Bar: " + picture.bar_label);
}

/// Heat on the surfaces, from where the observer was on average.
GnuplotChart heatMapFigure(const FigureStyle& wanted, const FigureRun& run,
                           const std::optional<std::string>& trial) {
  requireSameInputs(run.folder);
  Warnings warnings;
  ReplayedGaze gaze = readReplayedGaze(run.study, warnings);
  const Scene scene = loadScene(gaze.study, warnings);
  if (trial) {
    std::erase_if(gaze.trace.samples, [&](const GazeSample& sample) {
      return sample.time_s < run.frames.front().time_s || sample.time_s > run.frames.back().time_s;
    });
  }
  RunEvents judged =
      eventsOfRun(gaze.study, gaze.trace, run.frames.front().time_s, run.frames.back().time_s);
  const GazeInScene seen = lookIntoScene(gaze.study, gaze, scene, judged, true);
  const HeatMap heat = heatMapOf(scene, seen, wanted.colors);
  const int width = static_cast<int>(wanted.width_mm / 25.4 * std::min(wanted.dpi, 300.0));
  const auto pictures = heatPictures(heat.scene, seen, {width, 2 * width / 3});
  if (pictures.empty()) throw InputError("no gaze met the scene");
  const FigureStyle style = styleFor(wanted, pictures[0].image.size_px);
  const FigurePicture picture{
      .image = pictures[0].image,
      .size = pictures[0].image.size_px,
      .scale = {.to = heat.most_s_per_m2, .label = "gaze on the surface, s/m²", .beyond = "≥ "}};
  return drawFigure(style, figureHead(style) + pictureScript(style, picture),
                    "Heat map of gaze on the scene",
                    "Seconds of gaze per square metre of the surface, " + pictures[0].caption +
                        "; the scale ends at " + significant(heat.most_s_per_m2, 3) + " s/m2");
}

GnuplotChart timeSeriesFigure(const FigureStyle& style, const FigureRun& run) {
  ChartSeries series;
  for (const RunFrame& frame : run.frames) series.add([&] { return frame; });
  return timeFigure(style, series.kept(), run.screen.size_px, {}, false);
}

/// A round whole number, so that the axis has at most a dozen numbers of fixations.
std::size_t numberStep(const std::vector<RunFixation>& fixations) {
  constexpr std::size_t kMostTicks = 12;
  const std::size_t span = fixations.back().number - fixations.front().number + 1;
  std::size_t step = 1;
  for (std::size_t i = 0; step * kMostTicks < span; ++i) {
    step = i % 3 == 1 ? step / 2 * 5 : 2 * step;  // 1, 2, 5, 10, ...
  }
  return step;
}

/// Focus against surface, and the blur between them, at each fixation.
GnuplotChart focusFigure(const FigureStyle& style, const FigureRun& run) {
  std::string rows;
  for (const RunFixation& fixation : run.fixations) {
    rows += std::to_string(fixation.number);
    for (const double value : {fixation.surface_D, fixation.focus_D, fixation.blur_arcmin}) {
      rows += std::isfinite(value) ? " " + decimal(value, 4) : " NaN";
    }
    rows += '\n';
  }
  if (rows.empty()) throw InputError("the run has no fixations");
  const std::string first = std::to_string(run.fixations.front().number);
  const std::string script =
      figureHead(style) + "$fixations << END\n" + rows + "END\nset xrange [" + first +
      " - 0.7:" + std::to_string(run.fixations.back().number) + " + 0.7]\nset xtics " +
      std::to_string(numberStep(run.fixations)) + "\n";
  const auto points = [&](int column, int type, const char* color, const char* title) {
    return ", $fixations using 1:" + std::to_string(column) + " with points pointtype " +
           std::to_string(type) + " linewidth " + style.line(0.8) + " pointsize " +
           style.point(2.0) + " linecolor rgb '" + color + "' title '" + title + "'";
  };
  const std::vector<FigurePanel> panels = {
      {.label = "vergence, D",
       .settings = "set yrange [0:*]\n",
       .plots = "$fixations using 1:2:(0):($3-$2) with vectors nohead linewidth " +
                style.line(0.8) + " linecolor rgb '#7a8190' notitle" +
                points(2, 4, "#3a9d6e", "surface") + points(3, 7, "#c2417c", "focus of the eye")},
      {.label = "blur radius, arcmin",
       .settings = "set yrange [0:*]\n",
       .plots = "$fixations using 1:4 with impulses linewidth " + style.line(2.0) +
                " linecolor rgb '#3b82c4' notitle"}};
  return drawFigure(style, script + stackedPanels(style, "fixation", panels),
                    "Focus and blur at each fixation",
                    counted(run.fixations.size(), "fixation") +
                        ": distance of the surface and focus of the eye in dioptres, and the "
                        "radius of the circle of confusion in minutes of arc");
}

std::string fileOf(const char* kind, const FigureStyle& style) {
  return std::string(kind) + "." + kFigureFormats.at(static_cast<std::size_t>(style.format));
}

bool isWanted(const FigureChoice& choice, const char* kind) {
  return choice.kinds.empty() || std::ranges::find(choice.kinds, kind) != choice.kinds.end();
}

}  // namespace

std::vector<std::filesystem::path> figureFiles(const FigureChoice& choice,
                                               const std::filesystem::path& out) {
  std::vector<std::filesystem::path> files;
  for (const char* kind : kFigures) {
    if (isWanted(choice, kind)) files.push_back(out / fileOf(kind, choice.style));
  }
  return files;
}

FiguresMade writeFigures(const std::filesystem::path& folder, const FigureChoice& choice,
                         const std::filesystem::path& out, const OutputGuard& guard) {
  const FigureRun run(folder, choice.trial);
  const FigureStyle& style = choice.style;
  Ground ground;
  if (isWanted(choice, kFigures[0]) || isWanted(choice, kFigures[1])) ground = groundOf(run);
  const std::array<std::function<GnuplotChart()>, kFigures.size()> draw = {
      [&] { return scanpathFigure(style, run.screen, ground.frame, ground.path); },
      [&] { return gazeMapFigure(style, run.screen, ground); },
      [&] { return heatMapFigure(style, run, choice.trial); },
      [&] { return timeSeriesFigure(style, run); }, [&] { return focusFigure(style, run); }};
  OutputFolder files(out, guard);
  FiguresMade made;
  if (!ground.remark.empty()) made.remarks.push_back("scanpath, gaze-map: " + ground.remark);
  for (std::size_t i = 0; i < kFigures.size(); ++i) {
    if (!isWanted(choice, kFigures[i])) continue;
    std::string problem;
    try {
      const GnuplotChart chart = draw[i]();
      if (chart.image) {
        files.write(fileOf(kFigures[i], style), *chart.image);
        made.files.push_back(out / fileOf(kFigures[i], style));
        continue;
      }
      problem = chart.problem;
    } catch (const InputError& error) {
      problem = error.what();
    }
    if (!choice.kinds.empty()) throw InputError("--only " + std::string(kFigures[i]), problem);
    made.remarks.push_back("no " + std::string(kFigures[i]) + ": " + problem);
  }
  if (made.files.empty()) throw InputError(folder.string(), made.remarks.back());
  files.commit();
  return made;
}

}  // namespace foci
