#include "app/replay/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <sstream>

#include "app/graphics/html.h"
#include "app/graphics/image.h"
#include "app/graphics/plot.h"
#include "app/platform/output_files.h"
#include "app/replay/fixation_tables.h"
#include "base/base64.h"
#include "base/text.h"
#include "gaze/sources/rows.h"

namespace foci {
namespace {

constexpr const char *kCompareTable = "compare.tsv", *kComparePage = "compare.html";
constexpr int kComparePicture_px = 300;

/// Colours of the runs (Okabe and Ito 2008), readable on light and dark pages.
constexpr std::array<const char*, 7> kColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                "#e69f00", "#56b4e9", "#999999"};

const char* colorOf(std::size_t run) { return kColors.at(run % kColors.size()); }

std::string blurText(const ComparedRun& run, const char* absent) {
  const auto blur = run.meanBlur_arcmin();
  return blur ? decimal(*blur, 3) : absent;
}

Image differenceFrom(const Image& first, const Image& other) {
  Image difference = first;
  for (std::size_t i = 0; i < first.rgb.size(); ++i) {
    const int apart = std::abs(int{first.rgb[i]} - int{other.rgb[i]});
    difference.rgb[i] =
        static_cast<std::uint8_t>(std::min(255, static_cast<int>(kDifferenceGain) * apart));
  }
  return difference;
}

void embed(std::ostream& out, const Image& image, const std::string& caption) {
  out << "<figure><img alt=\"" << escaped(caption) << "\" src=\"data:image/jpeg;base64,";
  const auto jpeg = jpegOf(thumbnail(image, std::min(kComparePicture_px, image.size_px.x)));
  Base64 base64(out);
  base64.add(jpeg.data(), jpeg.size());
  base64.finish();
  out << "\"><figcaption>" << escaped(caption) << "</figcaption></figure>\n";
}

void writeFigures(std::ostream& out, const std::vector<ComparedRun>& runs) {
  out << "<table><tr><th>run</th><th>frames</th><th>duration, s</th><th>fixations</th><th>mean "
         "focus, D</th><th>mean pupil, mm</th><th>mean blur, arcmin</th></tr>\n";
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const ComparedRun& run = runs[i];
    out << "<tr><td><b style=\"color:" << colorOf(i) << "\">&#9632;</b> " << escaped(run.name)
        << "</td><td>" << run.frames.size() << "</td><td>" << decimal(run.duration_s(), 2)
        << "</td><td>" << run.fixations << "</td><td>" << decimal(run.meanFocus_D(), 3)
        << "</td><td>" << decimal(run.meanPupil_mm(), 2) << "</td><td>" << blurText(run, "&ndash;")
        << "</td></tr>\n";
  }
  out << "</table>\n<p class=\"quiet\">Blur: diameter of the blur disc of the surface that is "
         "looked at, pupil times |1 / distance - focus|.</p>\n";
}

void writeDwell(std::ostream& out, const std::vector<ComparedRun>& runs) {
  std::set<std::string> objects;
  for (const ComparedRun& run : runs) {
    for (const auto& [object, dwell_s] : run.dwell_s) {
      if (dwell_s > 0.0) objects.insert(object);
    }
  }
  if (objects.empty()) return;
  out << "<h2>Dwell time, s</h2>\n<table><tr><th>object</th>";
  for (const ComparedRun& run : runs) out << "<th>" << escaped(run.name) << "</th>";
  out << "</tr>\n";
  for (const std::string& object : objects) {
    out << "<tr><td>" << escaped(object) << "</td>";
    for (const ComparedRun& run : runs) {
      const auto found = run.dwell_s.find(object);
      out << "<td>" << (found == run.dwell_s.end() ? "&ndash;" : decimal(found->second, 2))
          << "</td>";
    }
    out << "</tr>\n";
  }
  out << "</table>\n";
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
      << decimal(kDifferenceGain, 0) << ".</p>\n";
  for (std::size_t k = 0; k < kPictures; ++k) {
    out << "<div class=\"sheet\">\n";
    for (const ComparedRun& run : runs) embed(out, run.pictures[k], run.name);
    const Image& first = runs[0].pictures[k];
    for (std::size_t i = 1; i < runs.size(); ++i) {
      const Image& other = runs[i].pictures[k];
      if (other.size_px != first.size_px) continue;
      embed(out, differenceFrom(first, other), runs[i].name + ", difference");
    }
    out << "</div>\n";
  }
}

}  // namespace

std::string compareTable(const std::vector<ComparedRun>& runs) {
  std::set<std::string> objects;
  for (const ComparedRun& run : runs) {
    for (const auto& [object, dwell_s] : run.dwell_s) objects.insert(object);
  }
  std::string table =
      "run\tframes\tduration_s\tfixations\tmean_focus_D\tmean_pupil_mm\tmean_blur_arcmin";
  for (const std::string& object : objects) table += "\tdwell_s " + visible(object);
  table += '\n';
  for (const ComparedRun& run : runs) {
    table += visible(run.folder.string()) + '\t' + std::to_string(run.frames.size()) + '\t' +
             decimal(run.duration_s(), 3) + '\t' + std::to_string(run.fixations) + '\t' +
             decimal(run.meanFocus_D(), 4) + '\t' + decimal(run.meanPupil_mm(), 3) + '\t' +
             blurText(run, "n/a");
    for (const std::string& object : objects) {
      const auto found = run.dwell_s.find(object);
      table += '\t' + (found == run.dwell_s.end() ? "n/a" : decimal(found->second, 4));
    }
    table += '\n';
  }
  return table;
}

std::string comparePage(const std::vector<ComparedRun>& runs) {
  std::ostringstream out;
  out << pageStart(std::to_string(runs.size()) + " runs - foci compare", "") << "<h1>"
      << runs.size() << " runs side by side</h1>\n";
  writeFigures(out, runs);
  writeDwell(out, runs);
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
  std::vector<ComparedRun> runs;
  runs.reserve(folders.size());
  for (const std::filesystem::path& folder : folders) runs.push_back(readRun(folder));
  OutputFolder files(out, guard);
  files.write(kCompareTable, compareTable(runs));
  files.write(kComparePage, comparePage(runs));
  files.commit();
}

namespace {

template <class Get>
double meanOf(const std::vector<RunFrame>& frames, const Get& get) {
  double sum = 0.0;
  for (const RunFrame& frame : frames) sum += get(frame);
  return sum / static_cast<double>(frames.size());
}

}  // namespace

double ComparedRun::duration_s() const {
  const auto count = static_cast<double>(frames.size());
  return frames.size() < 2 ? 0.0 : frames.back().time_s * count / (count - 1.0);
}

double ComparedRun::meanFocus_D() const {
  return meanOf(frames, [](const RunFrame& frame) { return frame.focus_D; });
}

double ComparedRun::meanPupil_mm() const {
  return meanOf(frames, [](const RunFrame& frame) { return frame.pupil_mm; });
}

std::optional<double> ComparedRun::meanBlur_arcmin() const {
  double sum = 0.0;
  std::size_t count = 0;
  for (const RunFrame& frame : frames) {
    if (!std::isfinite(frame.surface_D)) continue;
    sum += 1e-3 * frame.pupil_mm * std::abs(frame.surface_D - frame.focus_D) * kArcminPerRad;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / static_cast<double>(count);
}

ComparedRun readRun(const std::filesystem::path& folder) {
  ComparedRun run{.folder = folder, .name = folder.lexically_normal().filename().string()};
  if (run.name.empty()) run.name = folder.lexically_normal().parent_path().filename().string();
  run.frames = framesOfRun(folder);
  const double first_s = run.frames.front().time_s;
  for (RunFrame& frame : run.frames) frame.time_s -= first_s;
  run.fixations = fixationsOfRun(folder).size();
  NamedTable objects = tableOfRun(folder, "objects.tsv");
  const std::size_t object = objects.column("object"), dwell = objects.column("dwell_s");
  objects.withoutComments();  // an object may be named #1
  while (objects.next()) {
    run.dwell_s[std::string(objects.text(object))] += objects.needed(dwell);
  }
  std::vector<std::size_t> wanted;
  for (std::size_t k = 0; k < kPictures; ++k) {
    wanted.push_back((2 * k + 1) * run.frames.size() / (2 * kPictures));
  }
  run.pictures = videoFrames(folder, wanted);
  return run;
}

}  // namespace foci
