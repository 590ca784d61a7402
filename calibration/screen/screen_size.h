// Screen geometry without a measuring device. Size: a bank card, or the display's EDID.
// Distance: the blind spot, or the size of the observer's face.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

inline constexpr glm::dvec2 kBankCard_m{0.08560, 0.05398};  ///< ISO/IEC 7810 ID-1
inline constexpr double kBlindSpot_deg = 13.5;  ///< centre to fovea, temporal (Li et al. 2020)
inline constexpr double kMinDistance_m = 0.1, kMaxDistance_m = 10.0;  ///< eye to screen
inline constexpr double kEdidTolerance =
    0.05;  ///< a larger disagreement is reported; chosen by hand

/// Pixels per metre along both axes, from a card's width and, where pixels may be oblong, its
/// height.
/// @throws InputError unless both densities lie within 200 to 100000 px/m and agree within 10 %
glm::dvec2 pxPerMetreOfCard(double width_px, std::optional<double> height_px);

/// One run of the blind spot: distance on the screen from the fixation mark to the place where the
/// dot vanished or came back.
struct BlindSpotRun {
  double offset_m = 0.0;  ///< > 0
  bool outwards = true;   ///< the dot moved away from the mark
};

struct BlindSpotDistance {
  double distance_m = 0.0;
  double sd_m = 0.0;                 ///< of the mean
  std::vector<std::size_t> refused;  ///< runs that disagree with the others
};

/// distance = offset / tan(13.5 deg). The reaction time shifts inward and outward runs in opposite
/// directions, so both directions have equal weight. A run is refused where it differs from its
/// direction's median by more than 3 robust deviations and more than 10 %.
/// @throws InputError with fewer than 3 runs, fewer than 2 or half of them in agreement, or a
///   distance outside 0.1 to 10 m
BlindSpotDistance distanceByBlindSpot(std::span<const BlindSpotRun> runs);

/// A face half as large is twice as far: distance = reference_m * reference_px / face_px.
/// @throws InputError unless the distance lies within 0.1 to 10 m
double distanceByFace_m(double face_px, double reference_px, double reference_m);

struct EdidSize {
  std::optional<glm::dvec2> size_m{};  ///< of the visible area; absent where it states none
  std::string warning{};               ///< why the size is doubtful, or empty
};

/// Size that the display states (VESA E-EDID): the first detailed timing in mm, unless it is more
/// than 1 cm and 15 % off the centimetres of bytes 21 and 22.
/// @throws InputError where the header or the checksum is wrong
EdidSize edidSize(std::span<const unsigned char> edid);

/// Largest relative difference of two sizes along an axis.
double disagreement(const glm::dvec2& a, const glm::dvec2& b);

}  // namespace foci
