// How large a screen's pixels are and how far it stands: a bank card, the blind spot, the display's
// own word, the size of the observer's face.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

inline constexpr glm::dvec2 kBankCard_m{0.08560, 0.05398};  ///< ISO/IEC 7810 ID-1
inline constexpr double kBlindSpot_deg = 13.5;              ///< temporal, from the fovea
inline constexpr double kEdidTolerance = 0.05;  ///< disagreement above this share is shown

/// Pixels per metre along both axes, from a card's width and, where pixels may be oblong, its
/// height.
/// @throws InputError unless 200 to 100000 px/m come out, and the two agree within 10 %
glm::dvec2 pxPerMetreOfCard(double width_px, std::optional<double> height_px);

/// One run of the blind spot: how far from the fixation mark the dot vanished or came back, on the
/// screen.
struct BlindSpotRun {
  double offset_m = 0.0;  ///< > 0
  bool outwards = true;   ///< the dot moved away from the mark
};

struct BlindSpotDistance {
  double distance_m = 0.0;
  double sd_m = 0.0;                 ///< of the mean
  std::vector<std::size_t> refused;  ///< runs that disagree with the others
};

/// distance = offset / tan(13.5 deg), each direction's mean counted alike, since the edges found
/// inwards and outwards differ by the reaction time. Runs beyond 3 robust deviations, but at least
/// 10 %, of their direction's median are refused.
/// @throws InputError with fewer than 3 runs, fewer than 2 in agreement, or an impossible distance
BlindSpotDistance distanceByBlindSpot(std::span<const BlindSpotRun> runs);

/// A face half as large is twice as far: distance = reference_m * reference_px / face_px.
/// @throws InputError unless 0.1 to 10 m come out
double distanceByFace_m(double face_px, double reference_px, double reference_m);

/// Size of the visible area as the display itself states it (VESA E-EDID: the first detailed timing
/// in mm, else the whole centimetres of bytes 21 and 22); absent where it states none.
/// @throws InputError where the header or the checksum is wrong
std::optional<glm::dvec2> edidSize_m(std::span<const unsigned char> edid);

/// Largest relative difference of two sizes along an axis.
double disagreement(const glm::dvec2& a, const glm::dvec2& b);

}  // namespace foci
