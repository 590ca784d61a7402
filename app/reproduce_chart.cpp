#include "app/reproduce_chart.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "app/html.h"
#include "app/tables.h"

namespace foci {
namespace {

constexpr double kWidth = 960.0, kHeight = 300.0;
constexpr double kLeft = 76.0, kRight = 250.0, kTop = 14.0, kBottom = 34.0;
constexpr double kLineGap = 15.0;  // between labels

struct Line {
  std::string label, color;
  bool dashed = false;
  std::array<double, kApertures> ms{};  // 0: not measured
};

std::vector<Line> linesOf(const ReproduceScene& scene, const std::vector<ReproduceRow>& rows,
                          unsigned threads) {
  const std::array<std::pair<const char*, const char*>, 5> methods = {
      {{"paper", "#8a8f98"},
       {"paper-lod", "#d9822b"},
       {"sweep", "#3b82c4"},
       {"sweep-lod", "#3a9d6e"},
       {"accumulate:200", "#8e6bbf"}}};
  std::vector<Line> lines;
  for (const auto& [method, color] : methods) {
    Line line{.label = method, .color = color};
    for (const ReproduceRow& row : rows) {
      if (row.method == method && row.threads == threads) line.ms[row.aperture] = row.ms_median;
    }
    if (*std::max_element(line.ms.begin(), line.ms.end()) > 0.0) lines.push_back(line);
  }
  for (const bool lod : {false, true}) {
    Line line{.label = lod ? "2003, with level of detail" : "2003, without",
              .color = lod ? "#d9822b" : "#8a8f98",
              .dashed = true};
    for (const PaperRow& row : scene.paper) {
      if (row.lod == lod || row.aperture == 0) line.ms[row.aperture] = 1000.0 * row.seconds;
    }
    lines.push_back(line);
  }
  return lines;
}

/// A power of ten, ms.
std::string timeText(double ms) {
  if (ms >= 1000.0) return decimal(ms / 1000.0, 0) + " s";
  return (ms >= 1.0 ? decimal(ms, 0) : decimal(ms, 2)) + " ms";
}

std::string text(double x, double y, const std::string& words, const char* anchor,
                 const std::string& color = "var(--quiet)") {
  return "<text x=\"" + decimal(x, 1) + "\" y=\"" + decimal(y, 1) + "\" text-anchor=\"" + anchor +
         "\" fill=\"" + color + "\" font-size=\"12\">" + escaped(words) + "</text>\n";
}

}  // namespace

std::string chartOf(const ReproduceScene& scene, const std::vector<ReproduceRow>& rows,
                    unsigned threads) {
  const std::vector<Line> lines = linesOf(scene, rows, threads);
  double least = 1e300, most = 0.0;
  for (const Line& line : lines) {
    for (const double ms : line.ms) {
      if (ms <= 0.0) continue;
      least = std::min(least, ms);
      most = std::max(most, ms);
    }
  }
  const double low = std::floor(std::log10(least)), high = std::ceil(std::log10(most) + 1e-9);
  const auto placeX = [&](std::size_t aperture) {
    return kLeft + 20.0 +
           (kWidth - kLeft - kRight - 40.0) * static_cast<double>(aperture) /
               static_cast<double>(kApertures - 1);
  };
  const auto placeY = [&](double ms) {
    return kTop + (kHeight - kTop - kBottom) * (high - std::log10(ms)) / (high - low);
  };

  std::string svg = "<svg viewBox=\"0 0 " + decimal(kWidth, 0) + " " + decimal(kHeight, 0) +
                    "\" role=\"img\" font-family=\"sans-serif\">\n";
  for (double power = low; power <= high; power += 1.0) {
    const double y = placeY(std::pow(10.0, power));
    svg += "<line x1=\"" + decimal(kLeft, 0) + "\" x2=\"" + decimal(kWidth - kRight, 0) +
           "\" y1=\"" + decimal(y, 1) + "\" y2=\"" + decimal(y, 1) +
           "\" stroke=\"var(--line)\"/>\n" +
           text(kLeft - 8.0, y + 4.0, timeText(std::pow(10.0, power)), "end");
  }
  for (std::size_t aperture = 0; aperture < kApertures; ++aperture) {
    svg += text(
        placeX(aperture), kHeight - 10.0,
        aperture == 0 ? "no blur" : "aperture " + decimal(scene.apertures_m[aperture], 3) + " m",
        "middle");
  }

  // Labels at the right end, pushed apart downwards.
  std::vector<std::pair<double, const Line*>> labels;
  for (const Line& line : lines) {
    std::string points;
    double last_ms = 0.0;
    for (std::size_t aperture = 0; aperture < kApertures; ++aperture) {
      if (line.ms[aperture] <= 0.0) continue;
      last_ms = line.ms[aperture];
      const std::string x = decimal(placeX(aperture), 1), y = decimal(placeY(last_ms), 1);
      points.append(x).append(",").append(y).append(" ");
      svg.append("<circle cx=\"").append(x).append("\" cy=\"").append(y);
      svg.append("\" r=\"3\" fill=\"").append(line.color).append("\"/>\n");
    }
    svg += "<polyline points=\"" + points + "\" fill=\"none\" stroke-width=\"1.8\" stroke=\"" +
           line.color + "\"" + (line.dashed ? " stroke-dasharray=\"5 4\"" : "") + "/>\n";
    labels.emplace_back(placeY(last_ms), &line);
  }
  std::sort(labels.begin(), labels.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  double free_y = 0.0;
  for (const auto& [y, line] : labels) {
    const double at = std::max(y, free_y);
    free_y = at + kLineGap;
    svg += text(kWidth - kRight + 12.0, at + 4.0, line->label, "start", line->color);
  }
  return svg + "</svg>\n";
}

}  // namespace foci
