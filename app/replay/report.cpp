#include "app/replay/report.h"

#include <algorithm>
#include <fstream>
#include <ranges>
#include <sstream>
#include <stdexcept>

#include "app/graphics/html.h"
#include "app/record/gaze_marker.h"
#include "app/record/tables.h"
#include "app/replay/report_explorer.h"
#include "base/base64.h"
#include "base/file.h"
#include "base/text.h"
#include "gaze/sources/trace_summary.h"
#include "render/optics/defocus.h"

namespace foci {
namespace {

std::string colorMark(const char* color) {
  return std::string("<span class=\"state\" aria-hidden=\"true\" style=\"background:") + color +
         "\"></span>";
}

std::string stateMark(GazeState state) { return colorMark(colorOf(state)); }

std::string percent(double share) { return decimal(100.0 * share, 1) + "&thinsp;%"; }

/// What the run is, as plain text: "lion.ply, seen by gaze.tsv".
std::string nameOfRun(const Study& study, const GazeTrace& trace) {
  const std::string scene = study.scene.file ? study.scene.file->filename().string()
                                             : "the built-in " + study.scene.builtin;
  const std::string gaze = trace.simulated
                               ? "a simulated observer"
                               : std::filesystem::path(study.gaze.source).filename().string();
  return scene + ", seen by " + gaze;
}

/// The pupil of the run: every diameter of a fixed one, else the median.
std::string pupilCell(const ReportFacts& facts) {
  constexpr std::size_t kMaxDiameters = 4;
  const RunSummary& summary = facts.summary;
  const PupilModel pupil = facts.run.start.observer.pupil;
  const std::string median = decimal(summary.pupil_mm, 1) + " mm";
  const auto diameters = valuesOf(facts.run.changes, "observer.pupil_mm");
  if (pupil == PupilModel::fixed && !diameters.empty()) {
    std::string all = listed(diameters);
    if (diameters.size() > kMaxDiameters) {
      all = decimal(facts.pupil_min_mm, 1) + " to " + decimal(facts.pupil_max_mm, 1);
    }
    return numberCell(escaped(all) + " mm",
                      "pupil, changed during the run (median " + median + ")");
  }
  return numberCell(median, pupil == PupilModel::fixed ? "pupil, fixed"
                            : pupil == PupilModel::recording
                                ? "pupil (median), as recorded"
                                : "pupil (median), from the luminance of the images");
}

std::string headline(const Study& study, const GazeTrace& trace, const ReportFacts& facts) {
  const RunSummary& summary = facts.summary;
  std::string html = "<h1>" + escaped(nameOfRun(study, trace)) + "</h1>\n";
  html += "<p class=\"quiet\">foci " FOCI_VERSION " &middot; study " +
          escaped(study.file.string()) + " &middot; gaze " + escaped(trace.format) + ", " +
          decimal(trace.rate_Hz, 0) + " Hz</p>\n";
  html += noticesOf(facts.warnings);
  if (trace.simulated) {
    html +=
        "<p class=\"notice\">The gaze is simulated: an oculomotor model looked, no person "
        "did.</p>\n";
  }
  if (!facts.run.changes.empty()) {
    html += "<p class=\"notice\">Settings changed during the run: " +
            escaped(changesText(facts.run.changes)) +
            ". Sentences below about the eye and the method hold for the first frame.</p>\n";
  }
  for (const std::string& assumption : trace.assumed) {
    html += "<p class=\"quiet\">The recording does not state this, so foci assumed: " +
            escaped(assumption) + ".</p>\n";
  }
  html += "<p class=\"quiet\">Eye movements by detector " +
          escaped(labelOf(study.gaze.events.detector)) + "; " +
          escaped(qualityText(facts.quality)) + "</p>\n";
  const Screen screen = study.screenInForce();
  if (study.display.kind == DisplayKind::headset) {
    const EyeField field = fieldOfBothEyes(study.headsetEyes());
    html += "<p>The display is a headset: both eyes see " +
            decimal(field.left_deg + field.right_deg, 0) + " &times; " +
            decimal(field.up_deg + field.down_deg, 0) + " deg of it, with " +
            decimal(study.display.pixels_per_degree, 1) + " px a degree straight ahead.</p>\n";
  } else if (study.screen.is_default) {
    html +=
        "<p class=\"notice\">The study names no screen. Angles and blur hold for the default "
        "one: " +
        std::to_string(screen.size_px.x) + " &times; " + std::to_string(screen.size_px.y) +
        " px on " + decimal(screen.size_m.x, 3) + " &times; " + decimal(screen.size_m.y, 3) +
        " m, seen from " + decimal(screen.distance_m, 2) + " m.</p>\n";
  }
  html += "<div class=\"numbers\">\n";
  html += numberCell(
      decimal(summary.duration_s, 2) + " s",
      counted(summary.frames, "frame") + ", " + decimal(study.output.fps, 0) + " per second");
  html += numberCell(summary.fixations, "fixation");
  html += numberCell(summary.saccades, "saccade");
  html += numberCell(percent(1.0 - summary.gaze_valid), "of the gaze samples have no gaze");
  html += pupilCell(facts);
  html +=
      numberCell(std::to_string(summary.frames_rendered) + " of " + std::to_string(summary.frames),
                 "frames rendered; the others reuse the frame before");
  html +=
      numberCell(decimal(summary.rendered_ms_median, 1) + " ms",
                 "a frame rendered (median; 95&thinsp;%: " + decimal(summary.rendered_ms_p95, 1) +
                     " ms); of all " + decimal(summary.render_ms_median, 1) +
                     " ms (95&thinsp;%: " + decimal(summary.render_ms_p95, 1) + " ms)");
  return html + "</div>\n";
}

}  // namespace

std::string focusText(const Study& study, const ReportFacts& facts) {
  if (study.focus.fixed_D || facts.summary.fixations < 2) return "";
  const auto [least, most] = std::ranges::minmax_element(facts.rows, {}, &ChartRow::focus_D);
  const double range_D = most->focus_D - least->focus_D;
  const Screen screen = study.screenInForce();
  const double focal_px = study.imageSize_px().x * screen.distance_m / screen.size_m.x;
  const double change_px = 0.5 * 1e-3 * facts.summary.pupil_mm * range_D * focal_px;  // C = A/2 D d
  if (change_px >= kVisibleBlur_px) return "";
  const glm::ivec2 size_px = study.imageSize_px();
  const bool too_few_px = change_px * screen.size_px.x >= kVisibleBlur_px * size_px.x;
  return "focus varies by " + decimal(range_D, 2) + " D: no visible blur" +
         (too_few_px ? concat(" in frames of ", size_px.x, " x ", size_px.y,
                              " px; set a larger output.size_px (screen: ", screen.size_px.x, " x ",
                              screen.size_px.y, ")")
                     : "; move nearer, or set a larger pupil");
}

std::string toleranceText(const Study& study, const ReportFacts& facts) {
  if (facts.frames_over == 0) return "";
  return "In " + std::to_string(facts.frames_over) + " of " + std::to_string(facts.summary.frames) +
         " frames, the first at " + decimal(facts.first_over_s, 2) +
         " s, 5 % of the pixels may err by more than the tolerance of " +
         decimal(study.quality.tolerance, 1) + " just-noticeable differences, by up to " +
         decimal(facts.worst_error, 1) +
         (study.quality.frame_ms
              ? ": the frame-time budget (quality.frame_ms) leaves no time for more."
              : ": method auto was still measuring the error, or has no better quality level "
                "(docs/methods.md).");
}

namespace {

/// What one dioptre of defocus does, and how the focus is chosen.
std::string opticsText(const Study& study, const ReportFacts& facts) {
  const Screen screen = study.screenInForce();
  // With a fixed pupil the text is about the first frame, else about the median.
  const double pupil_mm =
      study.observer.pupil == PupilModel::fixed ? study.observer.pupil_mm : facts.summary.pupil_mm;
  const double pupil_m = pupil_mm / 1000.0;
  const double px_per_m = screen.size_px.x / screen.size_m.x;
  const double angle_rad = blurAngle_rad(pupil_m, 0.0, 1.0);
  return "<p>With a pupil of " + decimal(pupil_mm, 1) +
         " mm one dioptre of defocus blurs a point to a disc " +
         decimal(angle_rad * 180.0 / 3.14159265358979 * 60.0, 2) +
         " arcmin wide: " + decimal(angle_rad * screen.distance_m * px_per_m, 2) +
         " px on the screen, " +
         decimal(2e6 * retinalRadius_m(pupil_m, study.observer.retina_mm / 1000.0, 0.0, 1.0), 1) +
         " &micro;m on the retina." + escaped(eyeSentences(study)) + " Rendered by method <i>" +
         escaped(study.render.method) + "</i>.</p>\n";
}

std::string dataLossText(const ReportFacts& facts) {
  if (facts.samples == 0) return "<p>No gaze sample falls into the time replayed.</p>\n";
  return "<p>Of " + std::to_string(facts.samples) + " gaze samples " +
         std::to_string(facts.samples_without_gaze) + " have no position, " +
         std::to_string(facts.samples_blink) +
         " are marked as blinks by the tracker; the longest data loss lasts " +
         decimal(facts.longest_data_loss_s, 3) + " s. " +
         std::to_string(facts.frames_without_gaze) + " of " + std::to_string(facts.summary.frames) +
         " frames fall into a blink, data loss or a pause of the recording. There, as in saccades, "
         "the focus stays.</p>\n";
}

std::string legend(const std::vector<RunMark>& marks, bool pauses) {
  std::string html = "<p class=\"legend\">";
  for (const GazeState state : {GazeState::saccade, GazeState::pursuit, GazeState::blink,
                                GazeState::lost, GazeState::unjudged}) {
    html += "<span>" + stateMark(state) + std::string(nameOf(state)) + "</span>";
  }
  if (pauses) html += "<span>" + colorMark(kPauseColor) + "pause of the recording</span>";
  html += "<span>plain ground: fixation</span>";
  if (!marks.empty()) {
    html += "<span>solid line: event marker</span><span>dashed line: changed setting</span>";
  }
  return html + "</p>\n";
}

std::string configuration(const Study& study, bool changes) {
  std::string html = "<details><summary>The study as resolved" +
                     std::string(changes ? ", at the first frame" : "") + "</summary><table>\n";
  for (const ResolvedKey& key : resolvedKeys(study)) {
    html += "<tr>" + cell("<code>" + std::string(key.name) + "</code>") +
            cell(escaped(key.json == "null" ? "n/a" : key.json), "value") +
            cell(escaped(std::string(key.meaning)), "quiet") + "</tr>\n";
  }
  return html + "</table></details>\n";
}

std::string methodsSection(const MethodsText& text) {
  std::istringstream lines(text.markdown + "\n" + text.bibtex);
  std::string html = "<details><summary>Methods and references, ready to paste</summary><pre>";
  for (std::string line; std::getline(lines, line);) html += escaped(line) + "\n";
  return html + "</pre></details>\n";
}

void embedVideo(std::ostream& out, const std::filesystem::path& video) {
  constexpr std::uintmax_t kMaxBytes = 6'000'000;
  std::ifstream in(video, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + video.string());
  out << "<video controls loop muted playsinline preload=\"metadata\" "
         "aria-label=\"video of the run\" src=\"";
  if (std::filesystem::file_size(video) > kMaxBytes) {
    out << "video.mp4\"></video>\n<p class=\"quiet\">The video is too large for this page, which "
           "shows video.mp4 of the same folder.</p>\n";
    return;
  }
  out << "data:video/mp4;base64,";
  Base64 base64(out);
  std::vector<char> block(1 << 18);
  while (in.read(block.data(), static_cast<std::streamsize>(block.size())), in.gcount() > 0) {
    base64.add(reinterpret_cast<const std::uint8_t*>(block.data()),
               static_cast<std::size_t>(in.gcount()));
  }
  base64.finish();
  out << "\"></video>\n";
}

void contactSheet(std::ostream& out, const ReportFacts& facts) {
  out << "<div class=\"sheet\">\n";
  for (const SheetImage& image : facts.sheet) {
    out << "<figure class=\"seek\" data-at=\"" << decimal(image.time_s, 4) << "\" data-trial=\""
        << escaped(trialAt(facts.trials, image.time_s)) << "\"><img alt=\"frame at "
        << decimal(image.time_s, 2) << " s\" src=\"" << imageUri(image.jpeg) << "\"><figcaption>"
        << stateMark(image.state) << nameOf(image.state) << " &middot; <span data-time=\""
        << decimal(image.time_s, 2) << "\">" << decimal(image.time_s, 2) << "</span> s<br>focus "
        << decimal(image.focus_D, 2) << " D, " << distanceText(image.focus_D);
    if (image.surface_distance_m) {
      out << " &middot; surface " << decimal(*image.surface_distance_m, 2) << " m";
    }
    out << "</figcaption></figure>\n";
  }
  out << "</div>\n";
}

/// What was looked at for how long; "" for a scene without objects.
std::string objectsText(const std::vector<ObjectLooks>& objects) {
  if (objects.size() < 2) return "";
  std::vector<const ObjectLooks*> seen;
  for (std::size_t i = 1; i < objects.size(); ++i) {
    if (objects[i].dwell_s > 0.0) seen.push_back(&objects[i]);
  }
  std::ranges::stable_sort(seen, std::ranges::greater(),
                           [](const ObjectLooks* one) { return one->dwell_s; });
  constexpr std::size_t kMost = 40;
  std::string text =
      "<h2 id=\"objects\">What the gaze met</h2>\n<div "
      "class=\"wide\"><table><tr><th>object</th><th>first look, s</th><th>dwell time, "
      "s</th><th>fixations</th><th>visits</th><th>mean distance, m</th></tr>\n";
  for (std::size_t i = 0; i < std::min(seen.size(), kMost); ++i) {
    const ObjectLooks& one = *seen[i];
    text += "<tr>" + cell(escaped(one.name)) +
            cell(one.first_look_s ? decimal(*one.first_look_s, 2) : "&ndash;") +
            cell(decimal(one.dwell_s, 2)) + cell(std::to_string(one.fixations)) +
            cell(std::to_string(one.visits)) + cell(decimal(*one.mean_distance_m, 2)) + "</tr>\n";
  }
  text += "</table></div>\n<p class=\"quiet\">";
  if (seen.size() > kMost) text += std::to_string(seen.size() - kMost) + " more in objects.tsv. ";
  const std::size_t unseen = objects.size() - 1 - seen.size();
  if (unseen > 0) text += std::to_string(unseen) + " objects were never looked at. ";
  text += "On no object: " + decimal(objects[0].dwell_s, 2) +
          " s. First look: onset of the first fixation, on the recording's clock.</p>\n";
  return text;
}

/// Links to the sections.
std::string contents(const ReportFacts& facts) {
  std::string html = "<p class=\"quiet\">";
  const auto link = [&](const char* id, const char* title) {
    html += std::string("<a href=\"#") + id + "\">" + title + "</a> ";
  };
  link("saw", "What the eye saw");
  if (facts.scene) link("scene", "The scene in three dimensions");
  link("sheet", "Contact sheet");
  if (facts.objects.size() > 1) link("objects", "What the gaze met");
  if (!facts.heat.empty()) link("heat", "Where gaze rested");
  link("time", "Over time");
  link("fixations", "Fixations");
  return html + "</p>\n";
}

std::string tableLinks() {
  std::string html = "<p>Tables:";
  for (const char* file : {"fixations.tsv", "saccades.tsv", "events.tsv", "frames.tsv",
                           "gaze3d.tsv", "objects.tsv", "methods.md", "references.bib"}) {
    html += std::string(" <a href=\"") + file + "\">" + file + "</a>";
  }
  return html + "</p>\n";
}

void heatSection(std::ostream& out, const ReportFacts& facts) {
  if (facts.heat.empty()) return;
  out << "<h2 id=\"heat\">Where gaze rested</h2>\n<div class=\"pair\">\n";
  for (const HeatPicture& picture : facts.heat) {
    out << "<figure><img alt=\"heatmap " << escaped(picture.caption) << "\" src=\""
        << imageUri(jpegOf(picture.image)) << "\"><figcaption>" << escaped(picture.caption)
        << "</figcaption></figure>\n";
  }
  out << "</div>\n"
      << heatBarHtml(facts.most_heat_s_per_m2)
      << "<p class=\"quiet\">Seconds of gaze per square metre of the surface; grey was not looked "
         "at. The scale ends at what 1 % of the time exceeds.</p>\n";
}

}  // namespace

std::string writeReport(const std::filesystem::path& file, const std::filesystem::path& video,
                        const GazeTrace& trace, const ReportFacts& facts,
                        const MethodsText& methods) {
  const Study& study = facts.run.start;
  const std::vector<RunMark> marks = marksOf(facts.run);
  const auto charts =
      chartsSvg(facts.rows, study.screen.size_px, marks, facts.pauses, facts.headset);
  std::ofstream out(file, std::ios::binary);
  out << pageStart(nameOfRun(study, trace) + " - foci replay",
                   std::string(kExplorerStyle) + kSceneStyle)
      << headline(study, trace, facts) << contents(facts) << trialChoice(facts.trials)
      << "<h2 id=\"saw\">What the eye saw</h2>\n";
  embedVideo(out, video);
  const double first_s = facts.rows.front().time_s, last_s = facts.rows.back().time_s;
  out << opticsText(study, facts);
  if (facts.scene) writeSceneSection(out, *facts.scene, first_s, last_s);
  out << "<h2 id=\"sheet\">Contact sheet</h2>\n<p class=\"quiet\">From each twelfth of the replay "
         "the frame at which a fixation had lasted longest. The ring marks the gaze; broken, where "
         "the eye does not fixate.</p>\n";
  contactSheet(out, facts);
  out << objectsText(facts.objects);
  heatSection(out, facts);
  out << "<h2 id=\"time\">Over time</h2>\n";
  if (charts.image) {
    out << legend(marks, !facts.pauses.empty()) << "<div id=\"charts\">" << *charts.image
        << "</div>\n";
  } else {
    out << "<p class=\"notice\">No charts: " << escaped(charts.problem) << ".</p>\n";
  }
  out << "<p class=\"quiet\">Gaze in px of the study's screen, from its top-left corner; under the "
         "pointer also in degrees from its centre, to the right and upwards.</p>\n"
      << clockChoice() << marksTable(marks) << dataLossText(facts)
      << "<h2 id=\"fixations\">Fixations</h2>\n<p class=\"quiet\">A click on a row, on a frame of "
         "the contact sheet or on the charts moves the video there.</p>\n"
      << fixationRows(facts.fixations) << tableLinks() << methodsSection(methods)
      << configuration(study, !facts.run.changes.empty()) << "<p class=\"quiet\">" << facts.threads
      << (facts.threads == 1 ? " thread" : " threads") << ", rendered on " << escaped(facts.device)
      << ". Machine, hashes of every input and the frames' own are in manifest.json.</p>\n"
      << explorerScript(facts.rows, study.screenInForce());
  if (facts.scene) writeSceneScript(out, *facts.scene, first_s);
  out << kPageEnd;
  out.close();
  if (!out) throw std::runtime_error(cannotWrite(file));
  return charts.problem;
}

namespace {

constexpr std::size_t kSheetImages = 12;
constexpr int kSheetWidth_px = 480;

}  // namespace

ContactSheet::ContactSheet(std::size_t frames)
    : frames_(frames), count_(std::min(frames, kSheetImages)) {}

void ContactSheet::offer(std::size_t frame, const FrameRecord& record,
                         const std::vector<glm::dvec2>& points_px, const Image& image) {
  fixating_ = record.eye.state == GazeState::fixation ? fixating_ + 1 : 0;
  const std::size_t stretch = frame * count_ / frames_;
  const bool is_new = stretch >= chosen_.size();
  // Frames of neighbouring stretches, close together, would show the same fixation.
  const bool apart = chosen_.size() < 2 || 2 * (frame - chosen_before_) * count_ >= frames_;
  if (!is_new && (fixating_ <= best_ || !apart)) return;
  if (is_new) chosen_before_ = chosen_at_;
  chosen_at_ = frame;
  if (is_new) chosen_.emplace_back();
  best_ = is_new ? 0 : fixating_;
  chosen_.back() = {record, thumbnail(image, std::min(kSheetWidth_px, image.size_px.x)), points_px};
}

std::vector<SheetImage> ContactSheet::images(const glm::ivec2& image_px) const {
  std::vector<SheetImage> sheet;
  for (const auto& [record, small, points_px] : chosen_) {
    Image image = small;
    const double scale = static_cast<double>(small.size_px.x) / image_px.x;
    for (const glm::dvec2& point_px : points_px) {
      drawMarker(image, scale * point_px, !isFixating(record));
    }
    sheet.push_back({.time_s = record.time_s,
                     .state = record.eye.state,
                     .focus_D = record.eye.focus_D,
                     .surface_distance_m = record.eye.surface_distance_m,
                     .jpeg = jpegOf(image)});
  }
  return sheet;
}

}  // namespace foci
