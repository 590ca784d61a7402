#include "app/replay/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/gtc/constants.hpp>
#include <set>
#include <sstream>

#include "app/graphics/html.h"
#include "app/graphics/image.h"
#include "app/graphics/plot.h"
#include "app/platform/output_files.h"
#include "app/replay/fixation_tables.h"
#include "base/quantile.h"
#include "base/text.h"
#include "base/transformed.h"
#include "gaze/sources/rows.h"

namespace foci {
namespace {

constexpr const char *kCompareTable = "compare.tsv", *kComparePage = "compare.html";
constexpr int kComparePicture_px = 300;

/// Colours of the runs (Okabe and Ito 2008), readable on light and dark pages.
constexpr std::array<const char*, 7> kColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                "#e69f00", "#56b4e9", "#999999"};

const char* colorOf(std::size_t run) { return kColors.at(run % kColors.size()); }

/// The mean of what `get` takes of each; nothing for none.
template <class Rows, class Get>
std::optional<double> meanOf(const Rows& rows, const Get& get) {
  double sum = 0.0;
  for (const auto& row : rows) sum += std::invoke(get, row);
  return rows.empty() ? std::nullopt : std::optional(sum / static_cast<double>(rows.size()));
}

/// Diameter of the blur disc of what is looked at: mean of pupil times defocus. Absent if no
/// surface was looked at.
std::optional<double> meanBlur_arcmin(const ComparedRun& run) {
  std::vector<double> blurs_arcmin;
  for (const RunFrame& frame : run.frames) {
    if (!std::isfinite(frame.surface_D)) continue;
    blurs_arcmin.push_back(1e-3 * frame.pupil_mm * std::abs(frame.surface_D - frame.focus_D) *
                           kArcminPerRad);
  }
  return meanOf(blurs_arcmin, std::identity{});
}

/// A figure of a run: a column of the table and of the page.
struct RunFigure {
  const char *column, *title;
  int digits;
  std::optional<double> (*of)(const ComparedRun&);
};

using Some = std::optional<double>;
constexpr std::array<RunFigure, 9> kRunFigures{{
    {"frames", "frames", 0, [](const ComparedRun& run) { return Some(run.frames.size()); }},
    {"duration_s", "duration, s", 3, [](const ComparedRun& run) { return Some(run.duration_s()); }},
    {"fixations", "fixations", 0,
     [](const ComparedRun& run) { return Some(run.fixations.size()); }},
    {"fixations_per_s", "fixations per s", 3,
     [](const ComparedRun& run) {
       const double lasts_s = run.duration_s();
       return lasts_s > 0.0 ? Some(static_cast<double>(run.fixations.size()) / lasts_s) : Some();
     }},
    {"mean_fixation_s", "mean fixation, s", 3,
     [](const ComparedRun& run) { return meanOf(run.fixations, &RunFixation::duration_s); }},
    {"median_saccade_deg", "median saccade, deg", 2,
     [](const ComparedRun& run) { return run.median_saccade_deg; }},
    {"mean_focus_D", "mean focus, D", 4,
     [](const ComparedRun& run) { return meanOf(run.frames, &RunFrame::focus_D); }},
    {"mean_pupil_mm", "mean pupil, mm", 3,
     [](const ComparedRun& run) { return meanOf(run.frames, &RunFrame::pupil_mm); }},
    {"mean_blur_arcmin", "mean blur, arcmin", 3, &meanBlur_arcmin},
}};

std::string textOf(const Some& value, int digits, const char* absent) {
  return value ? decimal(*value, digits) : absent;
}

/// A table of the page: a row for each run.
/// @param heads  of the columns, as HTML @param value  of a run and a column, as HTML
void writeTable(std::ostream& out, const std::vector<ComparedRun>& runs,
                const std::vector<std::string>& heads,
                const std::function<std::string(std::size_t, std::size_t)>& value) {
  out << "<div class=\"scroll\"><table><tr><th>run</th>";
  for (const std::string& head : heads) out << "<th>" << head << "</th>";
  out << "</tr>\n";
  for (std::size_t i = 0; i < runs.size(); ++i) {
    out << "<tr>"
        << cell(std::string("<b style=\"color:") + colorOf(i) + "\">&#9632;</b> " +
                escaped(runs[i].name));
    for (std::size_t k = 0; k < heads.size(); ++k) out << cell(value(i, k), "value");
    out << "</tr>\n";
  }
  out << "</table></div>\n";
}

std::vector<std::string> objectsOf(const std::vector<ComparedRun>& runs, double above_s) {
  std::set<std::string> objects;
  for (const ComparedRun& run : runs) {
    for (const auto& [object, dwell_s] : run.dwell_s) {
      if (dwell_s > above_s) objects.insert(object);
    }
  }
  return {objects.begin(), objects.end()};
}

std::string dwellText(const ComparedRun& run, const std::string& object, int digits,
                      const char* absent) {
  const auto found = run.dwell_s.find(object);
  return found == run.dwell_s.end() ? absent : decimal(found->second, digits);
}

void writeTables(std::ostream& out, const std::vector<ComparedRun>& runs,
                 const GazeOverlaps& overlaps) {
  std::vector<std::string> heads(kRunFigures.size());
  std::ranges::transform(kRunFigures, heads.begin(), &RunFigure::title);
  writeTable(out, runs, heads, [&](std::size_t i, std::size_t k) {
    return textOf(kRunFigures[k].of(runs[i]), kRunFigures[k].digits, "&ndash;");
  });
  out << "<p class=\"quiet\">Blur: diameter of the blur disc of the surface that is looked at, "
         "pupil times |1 / distance - focus|.</p>\n";

  const std::vector<std::string> objects = objectsOf(runs, 0.0);
  if (!objects.empty()) {
    out << "<h2>Dwell time, s</h2>\n";
    heads.clear();
    for (const std::string& object : objects) heads.push_back(escaped(object));
    writeTable(out, runs, heads, [&](std::size_t i, std::size_t k) {
      return dwellText(runs[i], objects[k], 2, "&ndash;");
    });
  }

  out << "<h2>Overlap of gaze in the scene</h2>\n";
  heads.clear();
  for (const ComparedRun& run : runs) heads.push_back(escaped(run.name));
  writeTable(out, runs, heads,
             [&](std::size_t i, std::size_t k) { return textOf(overlaps[i][k], 2, "&ndash;"); });
  out << "<p class=\"quiet\">From 0, no common place, to 1, the same places for the same shares of "
         "the time: kernel correlation (Tsin and Kanade 2004) of the points of the scene that were "
         "fixated, weighted by duration, each spread by a Gaussian of "
      << significant(kGazeMapSigma_deg, 2) << " deg.</p>\n";
}

void embed(std::ostream& out, const Image& image, const std::string& caption) {
  const int width_px = std::min(kComparePicture_px, image.size_px.x);
  out << "<figure><img alt=\"" << escaped(caption) << "\" src=\""
      << imageUri(jpegOf(thumbnail(image, width_px))) << "\"><figcaption>" << escaped(caption)
      << "</figcaption></figure>\n";
}

void writeFocus(std::ostream& out, const std::vector<ComparedRun>& runs) {
  Plot plot{.name = "focus of each run over time", .size_px = {900.0, 240.0}};
  std::vector<double> times_s, focus_D;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    PlotSeries series{.name = runs[i].name, .color = colorOf(i), .discs = false};
    for (const RunFrame& frame : runs[i].frames) {
      series.points.push_back({.x = frame.time_s, .y = frame.focus_D});
      times_s.push_back(frame.time_s);
      focus_D.push_back(frame.focus_D);
    }
    plot.series.push_back(std::move(series));
  }
  plot.x = linearAxis("time, s", times_s);
  plot.y = linearAxis("", focus_D);
  out << "<h2>Focus over time, D</h2>\n" << svgOf(layOut(plot));
}

void writePictures(std::ostream& out, const std::vector<ComparedRun>& runs) {
  out << "<h2>Images</h2>\n<p class=\"quiet\">At " << kPictures
      << " equal steps of each run, from its video. A difference is that from the first run, times "
      << decimal(kDifferenceGain, 0) << ", without the rings that mark gaze.</p>\n";
  for (std::size_t k = 0; k < kPictures; ++k) {
    out << "<div class=\"sheet\">\n";
    for (const ComparedRun& run : runs) embed(out, run.pictures[k], run.name);
    for (std::size_t i = 1; i < runs.size(); ++i) {
      if (runs[i].pictures[k].size_px != runs[0].pictures[k].size_px) continue;
      embed(out, pictureDifference(runs[0], runs[i], k),
            "difference of " + runs[i].name + " from " + runs[0].name);
    }
    out << "</div>\n";
  }
}

/// Names the runs by the last parts of their folders, as many as tell all of them apart.
void nameRuns(std::vector<ComparedRun>& runs) {
  std::vector<std::filesystem::path> rests;
  for (ComparedRun& run : runs) {
    rests.push_back(std::filesystem::absolute(run.folder / "").lexically_normal().parent_path());
    run.name.clear();
  }
  std::set<std::string> names;
  for (bool more = true; names.size() < runs.size() && more;) {
    more = false;
    names.clear();
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const std::string part = rests[i].filename().string();
      if (!part.empty()) {
        runs[i].name = part + (runs[i].name.empty() ? "" : "/") + runs[i].name;
        more = true;
      }
      rests[i] = rests[i].parent_path();
      names.insert(runs[i].name);
    }
  }
}

Some medianSaccade_deg(const std::filesystem::path& folder) {
  NamedTable table = tableOfRun(folder, "saccades.tsv");
  table.withoutComments();  // a recording may be named #1
  const std::size_t amplitude = table.column("amplitude_deg");
  std::vector<double> all_deg;
  while (table.next()) {
    if (const auto value_deg = table.number(amplitude)) all_deg.push_back(*value_deg);
  }
  return all_deg.empty() ? std::nullopt : Some(quantile(all_deg, 0.5));
}

void readPictures(const Study& study, ComparedRun& run) {
  std::vector<std::size_t> wanted;
  for (std::size_t k = 0; k < kPictures; ++k) {
    wanted.push_back((2 * k + 1) * run.frames.size() / (2 * kPictures));
  }
  run.pictures = videoFrames(run.folder, wanted);
  run.markers_px.resize(kPictures);
  if (!study.output.marker || study.output.view != StereoView::mono) return;
  const glm::dvec2 screen_px(study.screenInForce().size_px);
  for (std::size_t k = 0; k < kPictures; ++k) {
    const RunFrame& frame = run.frames[wanted[k]];
    const glm::dvec2 gaze_px(frame.gaze_x_px, frame.gaze_y_px);
    if (std::isfinite(gaze_px.x) && std::isfinite(gaze_px.y)) {
      run.markers_px[k] = gaze_px * glm::dvec2(run.pictures[k].size_px) / screen_px;
    }
  }
}

/// @throws InputError if the folder is not that of a replay
ComparedRun readRun(const std::filesystem::path& folder) {
  const Study study = studyOfRun(folder);
  ComparedRun run{.folder = folder, .name = {}, .scene = study.scene.builtin};
  if (study.scene.file) run.scene = study.scene.file->string();
  run.frames = framesOfRun(folder);
  const double first_s = run.frames.front().time_s;
  for (RunFrame& frame : run.frames) frame.time_s -= first_s;
  run.fixations = fixationsOfRun(folder);
  run.median_saccade_deg = medianSaccade_deg(folder);
  NamedTable objects = tableOfRun(folder, "objects.tsv");
  const std::size_t object = objects.column("object"), dwell = objects.column("dwell_s");
  objects.withoutComments();  // an object may be named #1
  while (objects.next()) {
    run.dwell_s[std::string(objects.text(object))] += objects.needed(dwell);
  }
  readPictures(study, run);
  return run;
}

/// The sum over all pairs of the integral of the product of their Gaussians.
double kernelSum(const std::vector<RunFixation>& first, const std::vector<RunFixation>& second) {
  const auto variance_m2 = [](const RunFixation& fixation) {
    const double sigma_m = std::tan(glm::radians(kGazeMapSigma_deg)) / fixation.surface_D;
    return sigma_m * sigma_m;
  };
  double sum = 0.0;
  for (const RunFixation& a : first) {
    if (!a.point_m) continue;
    for (const RunFixation& b : second) {
      if (!b.point_m) continue;
      const double both_m2 = variance_m2(a) + variance_m2(b);
      const glm::dvec3 apart_m = *a.point_m - *b.point_m;
      sum += a.duration_s * b.duration_s / (glm::two_pi<double>() * both_m2) *
             std::exp(-0.5 * glm::dot(apart_m, apart_m) / both_m2);
    }
  }
  return sum;
}

}  // namespace

double ComparedRun::duration_s() const {
  const auto count = static_cast<double>(frames.size());
  return frames.size() < 2 ? 0.0 : frames.back().time_s * count / (count - 1.0);
}

std::vector<std::filesystem::path> runFolders(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (std::filesystem::exists(folder / "frames.tsv", ignored)) return {folder};
  std::vector<std::filesystem::path> runs;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    if (std::filesystem::exists(entry.path() / "frames.tsv", ignored)) runs.push_back(entry.path());
  }
  std::ranges::sort(runs);
  return runs.empty() ? std::vector{folder} : runs;
}

GazeOverlaps gazeOverlaps(const std::vector<ComparedRun>& runs) {
  GazeOverlaps overlaps(runs.size(), std::vector<std::optional<double>>(runs.size()));
  std::vector<double> within;
  within.reserve(runs.size());
  for (const ComparedRun& run : runs) within.push_back(kernelSum(run.fixations, run.fixations));
  for (std::size_t a = 0; a < runs.size(); ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      if (runs[a].scene != runs[b].scene || !(within[a] * within[b] > 0.0)) continue;
      const double between = a == b ? within[a] : kernelSum(runs[a].fixations, runs[b].fixations);
      overlaps[a][b] = overlaps[b][a] = between / std::sqrt(within[a] * within[b]);
    }
  }
  return overlaps;
}

Image pictureDifference(const ComparedRun& a, const ComparedRun& b, std::size_t picture) {
  const Image &one = a.pictures[picture], &other = b.pictures[picture];
  Image difference = one;
  for (std::size_t i = 0; i < one.rgb.size(); ++i) {
    const int apart = std::abs(int{one.rgb[i]} - int{other.rgb[i]});
    difference.rgb[i] =
        static_cast<std::uint8_t>(std::min(255, static_cast<int>(kDifferenceGain) * apart));
  }
  for (const ComparedRun* run : {&a, &b}) {
    if (run->markers_px[picture]) eraseMarker(difference, *run->markers_px[picture]);
  }
  return difference;
}

std::string compareTable(const std::vector<ComparedRun>& runs, const GazeOverlaps& overlaps) {
  const std::vector<std::string> objects = objectsOf(runs, -1.0);
  std::string table = "run";
  for (const RunFigure& figure : kRunFigures) table += std::string("\t") + figure.column;
  for (const std::string& object : objects) table += "\tdwell_s " + visible(object);
  for (const ComparedRun& run : runs) table += "\toverlap " + visible(run.name);
  table += '\n';
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const ComparedRun& run = runs[i];
    table += visible(run.folder.string());
    for (const RunFigure& figure : kRunFigures) {
      table += '\t' + textOf(figure.of(run), figure.digits, "n/a");
    }
    for (const std::string& object : objects) table += '\t' + dwellText(run, object, 4, "n/a");
    for (const auto& overlap : overlaps[i]) table += '\t' + textOf(overlap, 4, "n/a");
    table += '\n';
  }
  return table;
}

std::string comparePage(const std::vector<ComparedRun>& runs, const GazeOverlaps& overlaps) {
  std::ostringstream out;
  out << pageStart(std::to_string(runs.size()) + " runs - foci compare",
                   ".scroll { overflow-x: auto; } th, td { padding-right: 1rem; }")
      << "<h1>" << runs.size() << " runs side by side</h1>\n";
  writeTables(out, runs, overlaps);
  writeFocus(out, runs);
  writePictures(out, runs);
  out << kPageEnd;
  return out.str();
}

std::vector<std::filesystem::path> compareFiles(const std::filesystem::path& out) {
  return {out / kCompareTable, out / kComparePage};
}

void compareRuns(const std::vector<std::filesystem::path>& folders,
                 const std::filesystem::path& out, const OutputGuard& guard) {
  std::vector<ComparedRun> runs = transformed(folders, readRun);
  nameRuns(runs);
  const GazeOverlaps overlaps = gazeOverlaps(runs);
  OutputFolder files(out, guard);
  files.write(kCompareTable, compareTable(runs, overlaps));
  files.write(kComparePage, comparePage(runs, overlaps));
  files.commit();
}

}  // namespace foci
