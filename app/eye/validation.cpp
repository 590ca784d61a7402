#include "app/eye/validation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <sstream>
#include <utility>

#include "app/eye/visual_quality.h"
#include "app/graphics/html.h"
#include "app/platform/output_files.h"
#include "app/platform/progress.h"
#include "base/text.h"
#include "gaze/focus/accommodation.h"
#include "gaze/focus/pupil.h"
#include "render/methods/method.h"
#include "render/optics/colours.h"
#include "render/optics/lens_field.h"

namespace foci {
namespace {

using Figures = std::vector<ValidationFigure>;

struct Published {
  double value = 0.0, tolerance = 0.0;
};

/// Adds a figure of a kind: `kind` but for what it was measured under, its bounds and the value.
void addFigure(Figures& figures, ValidationFigure kind, const std::string& what,
               const Published& published, double value) {
  kind.what = what;
  kind.expected = published.value;
  kind.tolerance = published.tolerance;
  kind.value = value;
  figures.push_back(std::move(kind));
}

/// A point of light in the middle of an image.
struct RenderedPoint {
  int size_px;
  SurfelCloud cloud = {};
  View view;
  std::unique_ptr<Method> method = {};

  RenderedPoint(const glm::vec3& at_m, int image_px, float focal_px)
      : size_px(image_px),
        view{.size_px = glm::ivec2(size_px),
             .focal_px = glm::vec2(focal_px),
             .principal_px = 0.5f * static_cast<float>(size_px) -
                             focal_px * glm::vec2(at_m.x, -at_m.y) / -at_m.z} {
    appendSurfel(cloud, at_m, -glm::normalize(at_m), 3e-5f, 4e-9f, glm::vec3(1.0f));
    method = makeMethod("sweep", cloud);
  }

  /// Of its light along x and y. @param field  of the eye; null: as in the line of sight
  glm::dvec2 variance_px2(double pupil_m, double focus_D,
                          const FieldAberrations* field = nullptr) const {
    RenderSettings settings;
    Defocus& defocus = settings.defocus;
    defocus = defocusOfLens(pupil_m, view.focal_px, focus_D, DistanceAlong::sight);
    if (field) {
      defocus.field =
          std::make_shared<const LensField>(*field, false, view, view.principal_px, defocus);
    }
    Frame frame;
    method->render(view, settings, frame);
    double light = 0.0;
    glm::dvec2 sum(0.0), squares(0.0);
    for (int y = 0; y < size_px; ++y) {
      for (int x = 0; x < size_px; ++x) {
        const glm::dvec2 from = glm::dvec2(x, y) + 0.5 - 0.5 * size_px;
        const double each = frame.at(x, y).r;
        light += each;
        sum += each * from;
        squares += each * from * from;
      }
    }
    return squares / light - sum * sum / (light * light);
  }
};

/// Diameter, arcmin, of the disc that spreads light as far as a rendered point of light: four times
/// the standard deviation, beyond that of the sharp point.
double renderedBlur_arcmin(double pupil_m, double defocus_D) {
  const RenderedPoint point({0.0f, 0.0f, -1.0f}, 129, static_cast<float>(1.0 / kArcmin_rad));
  const glm::dvec2 added_px2 =
      point.variance_px2(pupil_m, 1.0 + defocus_D) - point.variance_px2(pupil_m, 1.0);
  return 4.0 * std::sqrt(0.5 * (added_px2.x + added_px2.y));
}

void addBlur(Figures& figures) {
  const ValidationFigure kind{
      .group = "Blur disc of a rendered point of light",
      .unit = "arcmin",
      .source = "Smith 1982: pupil times defocus, 3.4377 arcmin for each mm and D"};
  for (const double pupil_mm : {2.0, 4.0, 6.0}) {
    for (const double defocus_D : {0.5, 1.0, 2.0}) {
      const double expected = pupil_mm * 1e-3 * defocus_D / kArcmin_rad;
      addFigure(figures, kind, decimal(pupil_mm, 0) + " mm, " + decimal(defocus_D, 1) + " D",
                {expected, 0.02 * expected}, renderedBlur_arcmin(pupil_mm * 1e-3, defocus_D));
    }
  }
}

void addChromatic(Figures& figures) {
  ValidationFigure kind{.group = "Chromatic difference of refraction",
                        .unit = "D",
                        .source = "Thibos, Ye, Zhang and Bradley 1992, the Indiana eye"};
  addFigure(figures, kind, "400 nm less 589 nm", {-1.72, 0.02},
            chromaticDifference_D(0.589) - chromaticDifference_D(0.400));
  // The other published formula, of another eye model and other data.
  kind.source = "Atchison and Smith 2005, Cauchy's equation for the eye";
  for (const double nm : {450.0, 500.0, 650.0}) {
    const auto atchison_D = [](double wave_nm) {
      return 1.60911 - 6.70941e5 / (wave_nm * wave_nm) + 5.55334e10 / std::pow(wave_nm, 4) -
             5.59998e15 / std::pow(wave_nm, 6);
    };
    addFigure(figures, kind, decimal(nm, 0) + " nm less 589 nm",
              {atchison_D(nm) - atchison_D(589.0), 0.1},
              chromaticDifference_D(0.589) - chromaticDifference_D(1e-3 * nm));
  }
}

void addPupils(Figures& figures) {
  const ValidationFigure kind{.group = "Pupil diameter, field of 60 deg, 30 years",
                              .unit = "mm",
                              .source = "Watson and Yellott 2012"};
  const std::array luminances_cd_m2{0.01, 1.0, 10.0, 100.0, 1000.0};
  const std::array expected_mm{7.05, 5.12, 3.83, 2.89, 2.38};
  for (std::size_t i = 0; i < expected_mm.size(); ++i) {
    addFigure(figures, kind, significant(luminances_cd_m2[i]) + " cd/m^2", {expected_mm[i], 0.01},
              pupilDiameter_mm({.luminance_cd_m2 = luminances_cd_m2[i],
                                .area_deg2 = std::numbers::pi * 30.0 * 30.0}));
  }
}

/// The pupil as seen from the side: the schematic eye against photographs of 30 eyes, the mean of
/// both sides of their function 0.99 cos((angle + 5.3 deg) / 1.121).
void addPupilShapes(Figures& figures) {
  const ValidationFigure kind{.group = "Width over height of the pupil beside the line of sight",
                              .unit = "",
                              .source = "Mathur, Gehrmann and Atchison 2013, mean of 30 eyes",
                              .digits = 3};
  for (const double field_deg : {20.0, 40.0, 60.0}) {
    const auto side = [&](double deg) {
      return 0.5 * 0.99 * std::cos((deg + 5.3) / 1.121 * std::numbers::pi / 180.0);
    };
    addFigure(figures, kind, decimal(field_deg, 0) + " deg",
              {side(field_deg) + side(-field_deg), 0.05}, fieldOfEye(field_deg, 4e-3).pupil_aspect);
  }
}

/// A point of light in a direction of a right eye's visual field (x towards the temple, y up).
struct FieldPoint {
  double temporal_deg = 0.0, up_deg = 0.0;
  std::string what;
};

/// How much stronger than at the gaze the typical eye is along x and y of the image, as a rendered
/// point of light tells: the focus at which its variance along that axis is least.
glm::dvec2 renderedPower_D(const FieldPoint& at) {
  constexpr double kPupil_m = 4e-3, kPoint_D = 1.0, kStep_D = 3.0;
  const double per_deg = std::numbers::pi / 180.0;
  const double away_rad = std::hypot(at.temporal_deg, at.up_deg) * per_deg;
  const glm::dvec2 along = away_rad > 0.0
                               ? glm::dvec2(at.temporal_deg, at.up_deg) * per_deg / away_rad
                               : glm::dvec2(1.0, 0.0);
  const RenderedPoint point(glm::dvec3(std::sin(away_rad) * along, -std::cos(away_rad)) / kPoint_D,
                            257, 1500.0f);
  const auto variance_px2 = [&](double focus_D) {
    return point.variance_px2(kPupil_m, focus_D, &typicalField());
  };
  // The variance is a parabola of the focus.
  const glm::dvec2 nearer = variance_px2(kPoint_D + kStep_D),
                   farther = variance_px2(kPoint_D - kStep_D);
  const glm::dvec2 middle = variance_px2(kPoint_D);
  return 0.5 * kStep_D * (nearer - farther) / (nearer + farther - 2.0 * middle);
}

/// What ten eyes have beside the fovea, and what a rendered point of light shows there.
void addFields(Figures& figures) {
  struct Measured {
    FieldPoint at;
    Published sphere_D, astigmatism_D;  ///< power; along the meridian less across it; their bounds
  };
  // Medians of the ten eyes, each relative to its median within 5 degrees of the fovea, and twice
  // their standard errors, without outliers (tests/field/fit_field.py). At the gaze all is 0.
  const std::vector<Measured> measured{{{0, 0, "at the gaze"}, {0.0, 0.02}, {0.0, 0.02}},
                                       {{10, 0, "10 deg temporal"}, {0.14, 0.35}, {0.18, 0.22}},
                                       {{20, 0, "20 deg temporal"}, {0.15, 0.42}, {0.74, 0.28}},
                                       {{30, 0, "30 deg temporal"}, {0.27, 0.42}, {1.66, 0.45}},
                                       {{40, 0, "40 deg temporal"}, {0.44, 0.75}, {2.97, 0.59}},
                                       {{-10, 0, "10 deg nasal"}, {0.22, 0.27}, {0.32, 0.18}},
                                       {{-20, 0, "20 deg nasal"}, {0.69, 0.30}, {1.20, 0.23}},
                                       {{-30, 0, "30 deg nasal"}, {1.04, 0.60}, {2.49, 0.31}},
                                       {{-40, 0, "40 deg nasal"}, {1.15, 0.97}, {4.42, 0.45}},
                                       {{0, 10, "10 deg up"}, {0.47, 0.25}, {0.25, 0.12}},
                                       {{0, 20, "20 deg up"}, {0.83, 0.45}, {1.14, 0.30}},
                                       {{0, 25, "25 deg up"}, {0.94, 0.58}, {1.56, 0.39}},
                                       {{0, -10, "10 deg down"}, {0.07, 0.16}, {0.18, 0.13}},
                                       {{0, -20, "20 deg down"}, {0.43, 0.44}, {0.85, 0.29}},
                                       {{0, -25, "25 deg down"}, {0.53, 0.61}, {1.34, 0.36}}};
  const ValidationFigure sphere{
      .group = "Relative refraction of a rendered point of light, as power",
      .unit = "D",
      .source = "Polans and others 2015, median of 10 eyes"};
  ValidationFigure astigmatism = sphere;
  astigmatism.group = "Astigmatism of a rendered point of light, along its meridian";
  std::vector<double> horizontal_D;  // astigmatism, temporal then nasal
  for (const Measured& each : measured) {
    const glm::dvec2 power_D = renderedPower_D(each.at);
    const double astigmatism_D =
        each.at.up_deg == 0.0 ? power_D.x - power_D.y : power_D.y - power_D.x;
    if (each.at.temporal_deg != 0.0) horizontal_D.push_back(astigmatism_D);
    addFigure(figures, sphere, each.at.what, each.sphere_D, 0.5 * (power_D.x + power_D.y));
    addFigure(figures, astigmatism, each.at.what, each.astigmatism_D, astigmatism_D);
  }
  // Twice the standard error of the ten eyes' median. From 30 degrees on, their own medians, 2.06
  // and 3.47 D, lie outside.
  astigmatism.source = "Escudero-Sanz and Navarro 1999, the wide-angle eye";
  const std::array bounds_D{0.15, 0.23, 0.26};
  for (const std::size_t i : {1u, 2u, 3u}) {
    const double deg = 10.0 * static_cast<double>(i + 1);
    astigmatism.known_miss = i == 1 ? "" : "the ten measured eyes have less, too";
    addFigure(figures, astigmatism, decimal(deg, 0) + " deg, mean of both sides",
              {2.0 * power_D(fieldOfEye(deg, 4e-3).added).y, bounds_D[i - 1]},
              0.5 * (horizontal_D[i] + horizontal_D[i + 4]));
  }
  // Astigmatism is quadratic about its axis: a (x - x0)^2.
  const double sum = horizontal_D[2] + horizontal_D[6], apart = horizontal_D[6] - horizontal_D[2];
  addFigure(figures,
            {.group = "Axis of least astigmatism, of rendered points of light",
             .unit = "deg",
             .source = "Atchison, Mathur, Suheimat and Charman 2014; Liu and Thibos 2017",
             .digits = 1},
            "temporal of the line of sight", {4.8, 2.0}, 30.0 * apart / (2.0 * sum));
}

void addMtf(Figures& figures, Progress& progress, std::size_t& done) {
  const std::array expected{0.657, 0.563, 0.427, 0.295, 0.205};
  const ValidationFigure formula{.group = "Mean MTF at 10 cycles/deg, the formula",
                                 .unit = "",
                                 .source = "Watson 2013",
                                 .digits = 3};
  const ValidationFigure refracted{
      .group = "Mean MTF at 10 cycles/deg of typical eyes behind the glasses of a refraction",
      .unit = "",
      .source = "Watson 2013, mean of 200 eyes behind such glasses",
      .digits = 3};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const double mm = static_cast<double>(i + 2);
    addFigure(figures, formula, decimal(mm, 0) + " mm", {expected[i], 0.001}, meanMtf(mm, 10.0));
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const double mm = static_cast<double>(i + 2);
    addFigure(figures, refracted, decimal(mm, 0) + " mm", {expected[i], 0.03},
              refractedContrast(mm * 1e-3, 10.0));
    progress.advance(++done);
  }
}

void addDepthOfFocus(Figures& figures, Progress& progress, std::size_t& done) {
  const ValidationFigure kind{
      .group = "Total depth of focus: contrast at 10 cycles/deg falls to 80 %",
      .unit = "D",
      .source = "Atchison, Charman and Woods 1997"};
  const std::array pupils_mm{2.0, 4.0, 6.0}, expected_D{0.86, 0.59, 0.55};
  for (std::size_t i = 0; i < pupils_mm.size(); ++i) {
    addFigure(figures, kind, decimal(pupils_mm[i], 0) + " mm", {expected_D[i], 0.15},
              depthOfFocus(throughFocus(typicalPupil(1e-3 * pupils_mm[i]), 0.8, 0.1)).total_D());
    progress.advance(++done);
  }
}

/// Seconds from a step of the target until the response has made `share` of it.
double responseTime_s(double from_D, double to_D, double share) {
  Accommodation eye;
  eye.setTarget(0.0, from_D);
  eye.setTarget(1.0, to_D);
  double time_s = 1.0;
  while ((eye.focusAt_D(time_s) - from_D) / (to_D - from_D) < share) time_s += 1e-3;
  return time_s - 1.0;
}

void addAccommodation(Figures& figures) {
  const ValidationFigure step{.group = "Accommodation to a step of 2 D",
                              .unit = "s",
                              .source = "Campbell and Westheimer 1960"};
  for (const bool nearer : {true, false}) {
    const double from_D = nearer ? 0.5 : 2.5, to_D = 3.0 - from_D;
    const double latency_s = responseTime_s(from_D, to_D, 1e-6);
    const std::string way = nearer ? "far to near" : "near to far";
    addFigure(figures, step, "latency, " + way, {nearer ? 0.36 : 0.38, 0.09}, latency_s);
    addFigure(figures, step, "95 % of the response after its start, " + way,
              {nearer ? 0.64 : 0.56, 0.15}, responseTime_s(from_D, to_D, 0.95) - latency_s);
  }
  const ValidationFigure lag{.group = "Lag of accommodation, focus.lag = true",
                             .unit = "D",
                             .source = "Seidemann and Schaeffel 2003"};
  const std::array lags_D{0.35, 0.48, 0.60};
  for (std::size_t i = 0; i < lags_D.size(); ++i) {
    const double target_D = 3.0 + static_cast<double>(i);
    addFigure(figures, lag, decimal(target_D, 0) + " D", {lags_D[i], 0.005},
              target_D - reachableFocus_D({.lag = true}, target_D));
  }
}

}  // namespace

bool ValidationFigure::inBounds() const {
  return std::abs(value - expected) <= tolerance;  // false for NaN
}

std::vector<ValidationFigure> validationFigures() {
  Figures figures;
  Progress progress("validating", "eyes", 8);
  std::size_t done = 0;
  addBlur(figures);
  addChromatic(figures);
  addPupils(figures);
  addPupilShapes(figures);
  addFields(figures);
  addMtf(figures, progress, done);
  addDepthOfFocus(figures, progress, done);
  addAccommodation(figures);
  return figures;
}

namespace {

constexpr const char* kValidationTable = "validation.tsv";
constexpr const char* kValidationPage = "validation.html";

constexpr const char* kValidationStyle = R"(
td.value, th.value { text-align: right; } td svg { width: 132px; height: 16px; vertical-align: middle; }
.out { color: #c0392b; font-weight: 600; }
)";

/// Where the value lies between its bounds: a dot on a line whose ends are the bounds.
std::string dotOf(const ValidationFigure& figure) {
  const double off = (figure.value - figure.expected) / figure.tolerance;
  const double at = 66.0 + 50.0 * std::clamp(std::isfinite(off) ? off : 2.0, -1.2, 1.2);
  return "<svg viewBox=\"0 0 132 16\" role=\"img\" aria-label=\"" + decimal(off, 2) +
         " of the tolerance\"><path d=\"M16 8H116M16 4V12M116 4V12M66 5V11\" "
         "stroke=\"currentColor\" opacity=\".45\" fill=\"none\"/><circle cx=\"" +
         decimal(at, 1) + "\" cy=\"8\" r=\"4\" fill=\"" +
         (figure.inBounds() ? "#2f8f5b" : "#c0392b") + "\"/></svg>";
}

}  // namespace

std::string validationTable(const std::vector<ValidationFigure>& figures) {
  std::string text = "figure\tcondition\tunit\texpected\ttolerance\tvalue\tin_bounds\tsource\n";
  for (const ValidationFigure& one : figures) {
    text += rowOf(one.group, one.what, one.unit, decimal(one.expected, 4),
                  decimal(one.tolerance, 4), decimal(one.value, 4), one.inBounds(), one.source);
  }
  return text;
}

std::string validationPage(const std::vector<ValidationFigure>& figures) {
  std::size_t out_of_bounds = 0, known = 0;
  for (const ValidationFigure& one : figures) {
    if (!one.inBounds()) ++(one.known_miss.empty() ? out_of_bounds : known);
  }
  std::ostringstream page;
  page << pageStart("foci validate", kValidationStyle)
       << "<h1>foci against published measurements</h1>\n<p>" << figures.size() << " figures, "
       << (out_of_bounds == 0
               ? "all within their bounds" +
                     (known == 0 ? "." : " but " + std::to_string(known) + " known misses.")
               : "<span class=\"out\">" + std::to_string(out_of_bounds) + " out of bounds.</span>")
       << " The ends of each line are the bounds, the tick in its middle is the published value, "
          "and the dot is the value here.</p>\n";
  std::string group;
  for (const ValidationFigure& one : figures) {
    if (one.group != group) {
      if (!group.empty()) page << "</table>\n";
      group = one.group;
      page << "<h2>" << escaped(group)
           << "</h2>\n<table><tr><th>condition</th><th class=\"value\">published</th><th "
              "class=\"value\">tolerance</th><th "
              "class=\"value\">here</th><th></th><th>source</th></tr>\n";
    }
    const std::string unit = one.unit.empty() ? "" : " " + escaped(one.unit);
    page << "<tr>" << cell(escaped(one.what))
         << cell(decimal(one.expected, one.digits) + unit, "value")
         << cell("&plusmn;" + significant(one.tolerance, 2), "value")
         << cell(decimal(one.value, one.digits) + unit, one.inBounds() ? "value" : "value out")
         << cell(dotOf(one))
         << cell(escaped(one.source) +
                 (one.known_miss.empty() ? "" : "; known miss: " + escaped(one.known_miss)))
         << "</tr>\n";
  }
  page << "</table>\n<p class=\"quiet\">The typical eye has coma, trefoil and spherical "
          "aberration in the proportions, and with the root mean square, of 2560 normal eyes "
          "(Salmon and van de Pol 2006). Glasses leave errors with a standard deviation of "
       << decimal(kRefractionLeft_D, 2)
       << " D of sphere and of cylinder (Thibos and others 2004). "
          "Depth of focus takes one criterion for all pupils, chosen beforehand.</p>\n"
       << kPageEnd;
  return page.str();
}

std::vector<std::filesystem::path> validationFiles(const std::filesystem::path& out) {
  return {out / kValidationTable, out / kValidationPage};
}

std::vector<ValidationFigure> validate(const std::filesystem::path& out, const OutputGuard& guard) {
  OutputFolder files(out, guard);  // before the long computation
  std::vector<ValidationFigure> figures = validationFigures();
  files.write(kValidationTable, validationTable(figures));
  files.write(kValidationPage, validationPage(figures));
  files.commit();
  return figures;
}

}  // namespace foci
