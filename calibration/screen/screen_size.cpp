#include "calibration/screen/screen_size.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/input_error.h"
#include "base/quantile.h"
#include "base/text.h"
#include "calibration/location.h"

namespace foci {
namespace {

constexpr double kMinPxPerMetre = 200.0, kMaxPxPerMetre = 100'000.0;
constexpr double kOblong = 0.1;
constexpr std::size_t kMinRuns = 3;
constexpr double kRefusedAt = 3.0;   // robust deviations from the median
constexpr double kMinRefused = 0.1;  // of the median: observers' runs differ by less

void refuseDistance(const char* how, double distance_m) {
  if (distance_m >= kMinDistance_m && distance_m <= kMaxDistance_m) return;
  throw InputError(how, significant(distance_m, 6) + " m: expected 0.1 to 10 m");
}

/// 16 x 9 or 16 x 10 cm: displays of any size state their ratio so, TVs 160 x 90 cm.
bool mayBeRatio(const std::optional<glm::dvec2>& size_m) {
  return size_m == glm::dvec2(0.16, 0.09) || size_m == glm::dvec2(0.16, 0.1) ||
         size_m == glm::dvec2(1.6, 0.9);
}

/// Whether a side in whole cm, which may be rounded generously, is that of the timing.
bool sameSide(int mm, int cm) {
  constexpr int kRounding_mm = 10, kRounding_percent = 15;
  const int off_mm = std::abs(mm - 10 * cm);
  return off_mm <= kRounding_mm || 10 * off_mm <= kRounding_percent * cm;
}

}  // namespace

glm::dvec2 pxPerMetreOfCard(double width_px, std::optional<double> height_px) {
  const double x = width_px / kBankCard_m.x;
  const double y = height_px ? *height_px / kBankCard_m.y : x;
  for (double density : {x, y}) {
    if (!(density >= kMinPxPerMetre && density <= kMaxPxPerMetre)) {
      throw InputError("bank card", significant(density, 6) + " px/m: expected 200 to 100000");
    }
  }
  if (std::abs(x / y - 1.0) > kOblong) {
    throw InputError("bank card", "width over height is off by " +
                                      decimal(100.0 * std::abs(x / y - 1.0), 0) +
                                      " %: expected 85.60 x 53.98 mm");
  }
  return {x, y};
}

BlindSpotDistance distanceByBlindSpot(std::span<const BlindSpotRun> runs) {
  constexpr const char* kWhere = "blind spot";
  if (runs.size() < kMinRuns) {
    throw InputError(kWhere, std::to_string(runs.size()) + " runs: expected 3 or more");
  }
  const double slope = std::tan(glm::radians(kBlindSpot_deg));
  BlindSpotDistance result;
  double sum = 0.0, square = 0.0, directions = 0.0;
  std::size_t kept = 0;
  for (const bool outwards : {false, true}) {
    std::vector<double> found;
    for (const BlindSpotRun& run : runs) {
      if (!(run.offset_m > 0.0)) throw InputError(kWhere, "an offset that is not above 0");
      if (run.outwards == outwards) found.push_back(run.offset_m / slope);
    }
    if (found.empty()) continue;
    std::vector<double> sorted = found;
    const double median = quantile(sorted, 0.5);
    for (double& d : sorted) d = std::abs(d - median);
    const double limit =
        std::max(kRefusedAt * kSigmaPerMad * quantile(sorted, 0.5), kMinRefused * median);
    double direction_sum = 0.0;
    std::size_t in_direction = 0;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (runs[i].outwards != outwards) continue;
      const double d = runs[i].offset_m / slope;
      if (std::abs(d - median) > limit) {
        result.refused.push_back(i);
        continue;
      }
      direction_sum += d;
      square += (d - median) * (d - median);
      ++in_direction;
    }
    sum += direction_sum / static_cast<double>(in_direction);
    directions += 1.0;
    kept += in_direction;
  }
  if (kept < 2 || 2 * kept < runs.size()) {
    throw InputError(kWhere, "the runs disagree: repeat them with the head still");
  }
  std::ranges::sort(result.refused);
  result.distance_m = sum / directions;
  result.sd_m = std::sqrt(square / static_cast<double>(kept - 1) / static_cast<double>(kept));
  refuseDistance(kWhere, result.distance_m);
  return result;
}

double distanceByFace_m(double face_px, double reference_px, double reference_m) {
  const double distance_m = reference_m * reference_px / face_px;
  if (!(face_px > 0.0 && reference_px > 0.0)) {
    throw InputError("face size", "expected sizes above 0 px");
  }
  refuseDistance("face size", distance_m);
  return distance_m;
}

EdidSize edidSize(std::span<const unsigned char> edid) {
  constexpr std::array<unsigned char, 8> kHeader{0, 255, 255, 255, 255, 255, 255, 0};
  constexpr std::size_t kBlock = 128, kTiming = 54;
  if (edid.size() < kBlock || !std::equal(kHeader.begin(), kHeader.end(), edid.begin())) {
    throw InputError("EDID", "no EDID header");
  }
  const unsigned sum = std::accumulate(edid.begin(), edid.begin() + kBlock, 0u);
  if (sum % 256 != 0) throw InputError("EDID", "wrong checksum");
  const auto byte = [&](std::size_t at) { return static_cast<int>(edid[at]); };
  const int width_cm = byte(21), height_cm = byte(22);
  EdidSize size;
  if (width_cm > 0 && height_cm > 0) size.size_m = glm::dvec2(width_cm, height_cm) / 100.0;
  // A detailed timing starts with a pixel clock above 0; its sizes are 12 bits each.
  if (byte(kTiming) != 0 || byte(kTiming + 1) != 0) {
    const int width_mm = byte(kTiming + 12) | (byte(kTiming + 14) & 0xF0) << 4;
    const int height_mm = byte(kTiming + 13) | (byte(kTiming + 14) & 0x0F) << 8;
    const bool stated = width_mm > 0 && height_mm > 0;
    const bool differs = !sameSide(width_mm, width_cm) || !sameSide(height_mm, height_cm);
    if (stated && differs && size.size_m && !mayBeRatio(size.size_m)) {
      size.warning = printed(
          "its detailed timing states %d x %d mm, and its bytes 21 and 22 %d x %d cm: the latter "
          "are taken, a bank card is more certain",
          width_mm, height_mm, width_cm, height_cm);
    } else if (stated) {
      size.size_m = glm::dvec2(width_mm, height_mm) / 1000.0;
    }
  }
  if (mayBeRatio(size.size_m)) {
    size.warning = printed("it states %.0f x %.0f cm, which may be a ratio only: use a bank card",
                           100.0 * size.size_m->x, 100.0 * size.size_m->y);
  }
  return size;
}

double disagreement(const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 ratio = glm::abs(a / b - 1.0);
  return std::max(ratio.x, ratio.y);
}

}  // namespace foci
