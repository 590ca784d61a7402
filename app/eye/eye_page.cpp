#include "app/eye/eye_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <sstream>

#include "app/graphics/html.h"
#include "app/graphics/image.h"
#include "app/graphics/plot.h"
#include "app/platform/output_files.h"
#include "app/platform/warnings.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr int kZoom = 2, kWavefront_px = 320;

void put(Image& image, int x, int y, const glm::dvec3& rgb) {
  for (int channel = 0; channel < 3; ++channel) {
    image.rgb[3 * (static_cast<std::size_t>(y) * image.size_px.x + x) + channel] =
        static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(rgb[channel], 0.0, 1.0)));
  }
}

/// The PSF in grey, brightest in white, with a bar of a round number of arcmin. Brightness is the
/// light to the power 1/2.2, so that faint light shows.
std::string psfPng(const Psf& psf, double* bar_arcmin) {
  const int size = psf.size;
  const double peak = std::ranges::max(psf.light);
  Image image = filledImage(glm::ivec2(kZoom * size), 255);
  for (int y = 0; y < kZoom * size; ++y) {
    for (int x = 0; x < kZoom * size; ++x) {
      const double light = psf.at(x / kZoom, y / kZoom) / peak;
      put(image, x, y, glm::dvec3(std::pow(std::max(light, 0.0), 1.0 / 2.2)));
    }
  }
  // A bar of 1, 2 or 5 times a power of ten, at most a third of the picture.
  const double third_arcmin = size * psf.sample_rad / kArcmin_rad / 3.0;
  const double power = std::pow(10.0, std::floor(std::log10(third_arcmin)));
  *bar_arcmin = power * (third_arcmin >= 5.0 * power   ? 5.0
                         : third_arcmin >= 2.0 * power ? 2.0
                                                       : 1.0);
  const int bar_px = static_cast<int>(*bar_arcmin * kArcmin_rad / psf.sample_rad * kZoom);
  for (int y = kZoom * size - 14; y < kZoom * size - 10; ++y) {
    for (int x = 10; x < 10 + bar_px; ++x) put(image, x, y, {0.95, 0.75, 0.2});
  }
  return pngOf(image);
}

/// The wavefront as who faces the eye sees it: warm where it is ahead, blue behind, white at 0; a
/// line each quarter of a micrometre.
std::string wavefrontPng(const Pupil& pupil, double* most_um) {
  const PupilWavefront wavefront = wavefrontIn(pupil);
  const auto error_um = [&](int x, int y) {
    const glm::dvec2 p = 2.0 * (glm::dvec2(x, y) + 0.5) / double{kWavefront_px} - 1.0;
    // The image's axes are opposite to those of who faces the eye.
    return glm::length(p) > 1.0 ? NAN : 1e6 * wavefront.at({-p.x, p.y}).error_m;
  };
  *most_um = 0.1;
  for (int y = 0; y < kWavefront_px; y += 2) {
    for (int x = 0; x < kWavefront_px; x += 2) {
      const double um = error_um(x, y);
      if (std::isfinite(um)) *most_um = std::max(*most_um, std::abs(um));
    }
  }
  Image image = filledImage(glm::ivec2(kWavefront_px), 255);
  for (int y = 0; y < kWavefront_px; ++y) {
    for (int x = 0; x < kWavefront_px; ++x) {
      const double um = error_um(x, y);
      if (!std::isfinite(um)) {
        put(image, x, y, glm::dvec3(0.5));
        continue;
      }
      const double t = um / *most_um;
      const glm::dvec3 end = t > 0.0 ? glm::dvec3(0.78, 0.25, 0.13) : glm::dvec3(0.12, 0.32, 0.7);
      glm::dvec3 rgb = glm::mix(glm::dvec3(1.0), end, std::abs(t));
      const double right = error_um(std::min(x + 1, kWavefront_px - 1), y);
      const double below = error_um(x, std::min(y + 1, kWavefront_px - 1));
      const auto step = [](double value) { return std::floor(4.0 * value); };
      if ((std::isfinite(right) && step(right) != step(um)) ||
          (std::isfinite(below) && step(below) != step(um))) {
        const auto crosses = [&](double other) {
          return std::isfinite(other) && other * um <= 0.0;
        };
        rgb *= crosses(right) || crosses(below) ? 0.1 : 0.6;
      }
      put(image, x, y, rgb);
    }
  }
  return pngOf(image);
}

Plot emptyMtfPlot() {
  Plot plot{.name = "contrast by spatial frequency",
            .x = {.title = "cycles per degree", .from = 0.0, .to = 60.0},
            .y = {.title = "contrast", .from = 0.0, .to = 1.0},
            .end_labels = true,
            .size_px = {640.0, 340.0}};
  for (int u = 0; u <= 60; u += 10) plot.x.ticks.push_back({double(u), std::to_string(u)});
  for (int c = 0; c <= 10; c += 2) plot.y.ticks.push_back({c / 10.0, decimal(c / 10.0, 1)});
  return plot;
}

PlotSeries curveOf(const std::string& name, const char* color, const std::vector<double>& x,
                   const std::vector<double>& y) {
  PlotSeries series{.name = name, .color = color, .discs = false};
  for (std::size_t i = 0; i < x.size(); ++i) series.points.push_back({.x = x[i], .y = y[i]});
  return series;
}

/// White light, a curve for each field angle.
Plot fieldMtfPlot(const EyeFigures& eye) {
  constexpr std::array kColors{"#2f8f5b", "#3a78c2", "#d9822b", "#a23b72", "#7a8190", "#5b4b9a"};
  Plot plot = emptyMtfPlot();
  plot.name = "contrast beside the line of sight";
  for (std::size_t k = 0; k < eye.fields.size(); ++k) {
    plot.series.push_back(curveOf(decimal(eye.fields[k].field_deg, 0) + " deg",
                                  kColors[k % kColors.size()], eye.cycles_per_deg,
                                  eye.fields[k].white_mtf));
  }
  return plot;
}

Plot mtfPlot(const EyeFigures& eye) {
  Plot plot = emptyMtfPlot();
  const std::vector<double>& u = eye.cycles_per_deg;
  plot.series = {curveOf("white light", "#2f8f5b", u, eye.white_mtf),
                 curveOf("555 nm", "#3a78c2", u, eye.green_mtf)};
  const auto addDashed = [&](const char* name, const char* color, const auto& contrastAt) {
    std::vector<double> contrast;
    std::ranges::transform(u, std::back_inserter(contrast), contrastAt);
    plot.series.push_back(curveOf(name, color, u, contrast));
    plot.series.back().dashed = true;
  };
  addDashed("diffraction", "#7a8190", [&](double cycles_per_deg) {
    return diffractionMtf(eye.pupil.diameter_m, 555e-9, cycles_per_deg);
  });
  const double pupil_mm = 1000.0 * eye.pupil.diameter_m;
  if (pupil_mm >= 2.0 && pupil_mm <= 6.0) {
    addDashed("mean of 200 eyes", "#d9822b",
              [&](double cycles_per_deg) { return meanMtf(pupil_mm, cycles_per_deg); });
  }
  return plot;
}

Plot throughFocusPlot(const EyeFigures& eye) {
  std::vector<double> contrast = eye.through.contrast;
  contrast.push_back(0.0);
  Plot plot{.name = "contrast through focus",
            .x = {.title = "focus nearer than the point, D",
                  .from = eye.through.defocus_D.front(),
                  .to = eye.through.defocus_D.back()},
            .y = linearAxis("contrast at 10 cycles/deg", contrast),
            .size_px = {640.0, 300.0}};
  const double step_D = plot.x.to > 2.0 ? 1.0 : plot.x.to > 0.9 ? 0.5 : 0.2;
  for (double at_D = 0.0; at_D <= plot.x.to + 1e-9; at_D += step_D) {
    plot.x.ticks.push_back({at_D, decimal(at_D, 1)});
    if (at_D > 0.0) plot.x.ticks.push_back({-at_D, decimal(-at_D, 1)});
  }
  plot.series = {curveOf("white light", "#2f8f5b", eye.through.defocus_D, eye.through.contrast)};
  plot.series.back().discs = true;
  plot.levels.push_back(
      {kInFocusShare * std::ranges::max(eye.through.contrast), "80 % of the best"});
  return plot;
}

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
    text += rowOf(eye.name, what, at, unit, significant(value, 6));
  };
  const auto imageRows = [&](const EyeFigures& eye, const auto& of, const std::string& where) {
    for (const PointImage& point : of.points) {
      row(eye, "strehl", where + significant(point.vergence_D, 6) + " D", "", point.strehl);
    }
    for (std::size_t i = 0; i < eye.cycles_per_deg.size(); ++i) {
      const std::string at = where + decimal(eye.cycles_per_deg[i], 0) + " cycles/deg";
      row(eye, "mtf_white", at, "", of.white_mtf[i]);
      row(eye, "mtf_555nm", at, "", of.green_mtf[i]);
    }
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
    imageRows(eye, eye, "");
    for (const FieldFigures& field : eye.fields) {
      const std::string at = significant(field.field_deg, 6) + " deg";
      row(eye, "field_M", at, "D", field.power_D.x);
      row(eye, "field_J0", at, "D", field.power_D.y);
      row(eye, "field_pupil_aspect", at, "", field.aspect);
      imageRows(eye, field, at + ", ");
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
  const auto save = [&](const std::string& name, const std::string& png) {
    files.write(name, png);
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
          "its own peak. Its brightness is the light to the power 1/2.2, so that faint light "
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
