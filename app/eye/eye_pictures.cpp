#include "app/eye/eye_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "app/graphics/image.h"
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

Image blank(int size_px) {
  return {.size_px = {size_px, size_px},
          .rgb = std::vector<std::uint8_t>(3 * static_cast<std::size_t>(size_px) * size_px, 255)};
}

}  // namespace

std::vector<std::uint8_t> psfPng(const Psf& psf, double* bar_arcmin) {
  const int size = psf.size;
  const double peak = *std::max_element(psf.light.begin(), psf.light.end());
  Image image = blank(kZoom * size);
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

std::vector<std::uint8_t> wavefrontPng(const Pupil& pupil, double* most_um) {
  const PupilWavefront wavefront(
      pupil.wavefront ? pupil.wavefront : Wavefront{.zernike_um = {}, .pupil_m = pupil.diameter_m});
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
  Image image = blank(kWavefront_px);
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

namespace {

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

}  // namespace

Plot fieldMtfPlot(const EyeFigures& eye) {
  constexpr std::array kColors{"#2f8f5b", "#3a78c2", "#d9822b", "#a23b72", "#7a8190", "#5b4b9a"};
  Plot plot = emptyMtfPlot();
  plot.name = "contrast beside the line of sight";
  for (std::size_t k = 0; k < eye.fields.size(); ++k) {
    PlotSeries series{.name = decimal(eye.fields[k].field_deg, 0) + " deg",
                      .color = kColors[k % kColors.size()],
                      .discs = false};
    for (std::size_t i = 0; i < eye.cycles_per_deg.size(); ++i) {
      series.points.push_back({.x = eye.cycles_per_deg[i], .y = eye.fields[k].white_mtf[i]});
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

Plot mtfPlot(const EyeFigures& eye) {
  Plot plot = emptyMtfPlot();
  const auto add = [&](const char* name, const char* color, bool dashed, const auto& contrastAt) {
    PlotSeries series{.name = name, .color = color, .discs = false, .dashed = dashed};
    for (std::size_t i = 0; i < eye.cycles_per_deg.size(); ++i) {
      series.points.push_back({.x = eye.cycles_per_deg[i], .y = contrastAt(i)});
    }
    plot.series.push_back(std::move(series));
  };
  add("white light", "#2f8f5b", false, [&](std::size_t i) { return eye.white_mtf[i]; });
  add("555 nm", "#3a78c2", false, [&](std::size_t i) { return eye.green_mtf[i]; });
  add("diffraction", "#7a8190", true, [&](std::size_t i) {
    return diffractionMtf(eye.pupil.diameter_m, 555e-9, eye.cycles_per_deg[i]);
  });
  const double pupil_mm = 1000.0 * eye.pupil.diameter_m;
  if (pupil_mm >= 2.0 && pupil_mm <= 6.0) {
    add("mean of 200 eyes", "#d9822b", true,
        [&](std::size_t i) { return meanMtf(pupil_mm, eye.cycles_per_deg[i]); });
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
  PlotSeries series{.name = "white light", .color = "#2f8f5b"};
  for (std::size_t i = 0; i < eye.through.defocus_D.size(); ++i) {
    series.points.push_back({.x = eye.through.defocus_D[i], .y = eye.through.contrast[i]});
  }
  plot.series.push_back(std::move(series));
  plot.levels.push_back(
      {kInFocusShare * *std::max_element(eye.through.contrast.begin(), eye.through.contrast.end()),
       "80 % of the best"});
  return plot;
}

}  // namespace foci
