#include <cmath>
#include <sstream>

#include "app/eye/eye_pictures.h"
#include "app/eye/eye_report.h"
#include "app/graphics/html.h"
#include "app/platform/output_folder.h"
#include "app/platform/warnings.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr const char* kEyeTable = "eye.tsv";
constexpr const char* kEyePage = "eye.html";

constexpr const char* kEyeStyle = R"(
.psfs { display: grid; grid-template-columns: repeat(auto-fill, minmax(170px, 1fr)); gap: .9rem; }
.wavefront { max-width: 320px; } .wavefront img { border-radius: 50%; } figure img { background: #000; }
)";

std::string prefixOf(const EyeFigures& eye) { return eye.name.substr(0, eye.name.find(' ')) + "_"; }

std::string depthText(const DepthOfFocus& depth) {
  return (depth.complete ? "" : "more than ") + decimal(depth.total_D(), 2) + " D";
}

std::string distanceText(double vergence_D) {
  if (std::abs(vergence_D) < 1e-9) return "infinity";
  return vergence_D > 0.0 ? decimal(1.0 / vergence_D, 3) + " m" : "behind infinity";
}

std::string fromFocusText(double nearer_D) {
  if (std::abs(nearer_D) < 0.005) return "in focus";
  return decimal(std::abs(nearer_D), 2) +
         (nearer_D > 0.0 ? " D nearer than the focus" : " D beyond the focus");
}

std::string sideText(double field_deg) {
  if (field_deg == 0.0) return "On the line of sight";
  return decimal(std::abs(field_deg), 1) + " degrees to the " +
         (field_deg > 0.0 ? "right" : "left");
}

std::string tableOf(const std::vector<EyeFigures>& eyes) {
  std::string text = "eye\tfigure\tat\tunit\tvalue\n";
  const auto row = [&](const EyeFigures& eye, const std::string& what, const std::string& at,
                       const std::string& unit, double value) {
    text += eye.name + "\t" + what + "\t" + at + "\t" + unit + "\t" + significant(value, 6) + "\n";
  };
  for (const EyeFigures& eye : eyes) {
    row(eye, "pupil", "", "mm", 1000.0 * eye.pupil.diameter_m);
    row(eye, "focus", "", "D", eye.focus_D);
    row(eye, "rms", "orders 3 and up", "um", rms_um(eye.pupil.wavefront, 3));
    row(eye, "vergence_in_best_focus", "white light", "D", eye.focus_D - eye.depth.best_D);
    row(eye, "depth_of_focus", eye.depth.complete ? "80 % at 10 cycles/deg" : "at least", "D",
        eye.depth.total_D());
    row(eye, "acuity", "5 % contrast", "logMAR", eye.acuity.logMAR());
    row(eye, "acuity", "5 % contrast", "cycles/deg", eye.acuity.cycles_per_deg);
    for (const PointImage& point : eye.points) {
      row(eye, "strehl", significant(point.vergence_D, 6) + " D", "", point.strehl);
    }
    for (std::size_t i = 0; i < eye.cycles_per_deg.size(); ++i) {
      const std::string at = decimal(eye.cycles_per_deg[i], 0) + " cycles/deg";
      row(eye, "mtf_white", at, "", eye.white_mtf[i]);
      row(eye, "mtf_555nm", at, "", eye.green_mtf[i]);
    }
    for (const FieldFigures& field : eye.fields) {
      const std::string at = significant(field.field_deg, 6) + " deg";
      row(eye, "field_M", at, "D", field.power_D.x);
      row(eye, "field_J0", at, "D", field.power_D.y);
      row(eye, "field_pupil_aspect", at, "", field.aspect);
      for (const PointImage& point : field.points) {
        row(eye, "strehl", at + ", " + significant(point.vergence_D, 6) + " D", "", point.strehl);
      }
      for (std::size_t i = 0; i < eye.cycles_per_deg.size(); ++i) {
        const std::string u = at + ", " + decimal(eye.cycles_per_deg[i], 0) + " cycles/deg";
        row(eye, "mtf_white", u, "", field.white_mtf[i]);
        row(eye, "mtf_555nm", u, "", field.green_mtf[i]);
      }
    }
    for (std::size_t i = 0; i < eye.through.defocus_D.size(); ++i) {
      row(eye, "through_focus", decimal(eye.through.defocus_D[i], 2) + " D", "",
          eye.through.contrast[i]);
    }
  }
  return text;
}

/// One eye's section; its pictures go to `files`.
void writeEye(std::ostream& out, const EyeFigures& eye, OutputFolder& files) {
  const auto save = [&](const std::string& name, const std::vector<std::uint8_t>& png) {
    files.write(name, std::string(png.begin(), png.end()));
    return name;
  };
  std::string title = eye.name;
  title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  double in_focus = 0.0;
  for (const PointImage& point : eye.points) in_focus = std::max(in_focus, point.strehl);
  out << "<h2>" << title << "</h2>\n<div class=\"numbers\">"
      << numberCell(decimal(1000.0 * eye.pupil.diameter_m, 2) + " mm", "pupil")
      << numberCell(decimal(eye.focus_D, 2) + " D", "focus")
      << numberCell(decimal(rms_um(eye.pupil.wavefront, 3), 3) + " &micro;m",
                    "higher-order root mean square")
      << numberCell(decimal(in_focus, 3), "best Strehl ratio of the points below")
      << numberCell(depthText(eye.depth), "depth of focus")
      << numberCell(decimal(eye.acuity.logMAR(), 2) + " logMAR",
                    "acuity, " + decimal(eye.acuity.cycles_per_deg, 0) + " cycles/deg")
      << "</div>\n<h3>A point of light, at 555 nm</h3>\n<div class=\"psfs\">\n";
  const auto showPoints = [&](const std::vector<PointImage>& points, const std::string& prefix) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const PointImage& point = points[i];
      double bar_arcmin = 0.0;
      const std::string name =
          save(prefix + std::to_string(i + 1) + ".png", psfPng(point.psf, &bar_arcmin));
      out << "<figure><img src=\"" << name << "\" alt=\"image of a point at "
          << distanceText(point.vergence_D) << "\"><figcaption>" << distanceText(point.vergence_D)
          << ": " << fromFocusText(point.vergence_D - eye.focus_D) << ". Strehl ratio "
          << decimal(point.strehl, 3) << "; bar " << significant(bar_arcmin)
          << " arcmin</figcaption></figure>\n";
    }
  };
  showPoints(eye.points, prefixOf(eye) + "psf_");
  double most_um = 0.0;
  const std::string map = save(prefixOf(eye) + "wavefront.png", wavefrontPng(eye.pupil, &most_um));
  out << "</div>\n<h3>Wavefront</h3>\n<figure class=\"wavefront\"><img src=\"" << map
      << "\" alt=\"wavefront\"><figcaption>As somebody who faces the eye sees it. The wavefront is "
         "ahead where red and behind where blue, by up to "
      << decimal(most_um, 2)
      << " &micro;m. Lines are 0.25 &micro;m apart, the darkest at 0.</figcaption></figure>\n"
      << "<h3>Contrast</h3>\n";
  const auto chart = [&](const std::string& name, const Plot& plot) {
    const Drawing drawing = layOut(plot);
    out << svgOf(drawing);
    if (const GnuplotChart png = pngOf(drawing); png.image) {
      files.write(name, *png.image);
    } else {
      out << "<p class=\"notice\">No " << name << ": " << escaped(png.problem) << ".</p>\n";
      say("no " + name + ": " + png.problem);
    }
  };
  chart(prefixOf(eye) + "mtf.png", mtfPlot(eye));
  out << "<h3>Through focus</h3>\n";
  chart(prefixOf(eye) + "through_focus.png", throughFocusPlot(eye));
  out << "<p>Depth of focus: " << decimal(eye.depth.nearest_D, 2) << " to "
      << decimal(eye.depth.farthest_D, 2) << " D about the focus.</p>\n";
  if (eye.fields.empty()) return;
  out << "<h3>Beside the line of sight</h3>\n";
  for (std::size_t k = 0; k < eye.fields.size(); ++k) {
    const FieldFigures& field = eye.fields[k];
    out << "<p>" << sideText(field.field_deg) << ": the eye is " << decimal(field.power_D.x, 2)
        << " D stronger than on its line of sight in the mean of all meridians, and "
        << decimal(2.0 * field.power_D.y, 2)
        << " D stronger along the horizontal than along the vertical. The pupil is "
        << decimal(field.aspect, 2) << " times as wide as high.</p>\n<div class=\"psfs\">\n";
    showPoints(field.points, prefixOf(eye) + "field_" + std::to_string(k + 1) + "_psf_");
    out << "</div>\n";
  }
  chart(prefixOf(eye) + "field_mtf.png", fieldMtfPlot(eye));
}

}  // namespace

std::vector<std::filesystem::path> eyeFiles(const std::filesystem::path& out) {
  std::vector<std::filesystem::path> files = {out / kEyeTable, out / kEyePage};
  for (const std::string side : {"both_", "left_", "right_"}) {
    for (const char* name : {"wavefront.png", "mtf.png", "through_focus.png", "field_mtf.png"}) {
      files.push_back(out / (side + name));
    }
    for (std::size_t i = 1; i <= kMostDistances; ++i) {
      files.push_back(out / (side + "psf_" + std::to_string(i) + ".png"));
      for (std::size_t k = 1; k <= kMostFields; ++k) {
        files.push_back(
            out / (side + "field_" + std::to_string(k) + "_psf_" + std::to_string(i) + ".png"));
      }
    }
  }
  return files;
}

std::vector<EyeFigures> reportEye(const Study& study, const EyeRequest& request,
                                  const std::filesystem::path& out, const OutputGuard& guard) {
  OutputFolder files(out, guard);  // before the long computation
  std::vector<EyeFigures> eyes = eyeFiguresOf(study, request);
  std::ostringstream page;
  page << pageStart("foci eye", kEyeStyle) << "<h1>The eye of " << escaped(study.file.string())
       << "</h1>\n<p>This page shows the eye by Fourier optics from the "
          "observer's pupil, focus, refraction and wavefront. Each image of a point is scaled to "
          "its "
          "own peak. Its brightness is the light to the power 1/2.2, so that faint light "
          "shows.</p>\n";
  for (const EyeFigures& eye : eyes) writeEye(page, eye, files);
  page << "<p class=\"quiet\">Depth of focus is the range in which contrast at 10 cycles/deg, in "
          "white light, stays above 80 % of its best. Acuity is an estimate from optics alone: the "
          "finest grating with 5 % contrast has u cycles/deg, and the estimate is log10(30 / u). "
          "People see less, because noise and the retina's sampling limit them. White light has "
          "equal energy and the brightness V(&lambda;) of CIE 1924. The dashed mean of 200 eyes is "
          "that of Watson 2013, behind the glasses of a refraction. Beside the line of sight, the "
          "page adds what the schematic eye of Escudero-Sanz and Navarro 1999 has more than on "
          "its axis.</p>\n"
       << kPageEnd;
  files.write(kEyeTable, tableOf(eyes));
  files.write(kEyePage, page.str());
  files.commit();
  return eyes;
}

}  // namespace foci
