// Automatic framing: an eye that sees a whole scene, and a scale that brings the scene to a
// comfortable distance.
#pragma once

#include <glm/glm.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "gaze/geometry/gaze_sample.h"
#include "render/scene/io/scene_facts.h"

namespace foci {

/// From where the eye looks. Front and left are raised by kRaise_deg, so that a landscape shows its
/// ground. Outside is the one of these two that shows more.
enum class Look { front, left, above, outside };

inline constexpr double kRaise_deg = 20.0;
/// Share of the image's width or height, whichever is the tighter, that the scene fills.
inline constexpr double kFilledShare = 0.8;
/// Without a side that the user chose, the eye comes nearer, until depth in view spans
/// kVisibleDepth_D, the scene fills kVisibleAngle_deg, or fills this share of the image.
inline constexpr double kWholeShare = 0.95, kVisibleDepth_D = 1.0, kVisibleAngle_deg = 40.0;
/// An eye at these distances from the middle of the scene sees it in comfort: from the nearest
/// point of easy reading to the size of a house. Chosen by hand.
inline constexpr double kNearest_m = 0.25, kMostDistant_m = 25.0;

struct SceneBox {
  glm::dvec3 low{0.0}, high{0.0};
  std::size_t strays = 0;  ///< points outside

  glm::dvec3 size() const { return high - low; }
  glm::dvec3 middle() const { return 0.5 * (low + high); }
  double longest() const;
};

/// The box of all points, as far as they reach, that are not strays. Strays lie farther from the
/// core, the box of the middle 98 % of each axis, than a quarter of its longest side. If the box of
/// the middle 94 % is less than a third as long, this box is the core: islands of a map and birds
/// in a scan are more than 2 % of some files.
/// @param points  not empty (asserted)
/// @param reach   of each point along the axes, both ways: `SceneFacts::reach`. A point that
///                reaches into where strays lie counts without its reach.
SceneBox boxWithoutStrays(std::span<const glm::vec3> points, std::span<const glm::vec3> reach = {});

/// The box of a scene: of all corners of a mesh, or of points without strays.
SceneBox boxOf(const SceneFacts& facts);

/// An axis that points upwards: 0 x, 1 y, 2 z, with its sign.
struct UpAxis {
  int axis = 1;
  bool negative = false;
  std::string why{};  ///< "the convention of OBJ"
};

/// "x", "-y", ...; nothing for another text.
std::optional<UpAxis> upAxisNamed(std::string_view name);
std::string nameOf(const UpAxis& up);

/// The axis that the file states. Otherwise y in glTF, OBJ and FBX, by their conventions. In
/// others, y or z if the scene is less than a third as long there as along both other axes, because
/// landscapes and rooms are flat. Otherwise z in STL and scans, and y in PLY meshes, as is usual.
UpAxis upAxisOf(const SceneFacts& facts, const SceneBox& box);

struct FramingRequest {
  Screen screen{};
  /// Absent: inside a scan of a room, a street or a landscape (`standIn`). Of others the front, or
  /// the left for a scene that is seen edge-on from there, and nearer, so that blur shows.
  std::optional<Look> look{};
  std::optional<UpAxis> up{};  ///< absent: `upAxisOf`
  /// Metres a unit, as --scale says; absent: see `framingOf`.
  std::optional<double> scale_m{};
};

struct Framing {
  SceneBox box{};  ///< units of the file
  UpAxis up_axis{};
  double scale_m = 1.0;  ///< metres a unit
  std::string why_scale{};
  std::string why_look{};  ///< empty unless foci chose another side than the front, or a distance
  bool entered = false;    ///< the eye stands in the scene, and not outside
  glm::dvec3 position_m{0.0}, look_at_m{0.0}, up{0.0, 1.0, 0.0};

  double distance_m() const { return glm::distance(position_m, look_at_m); }
};

/// The eye looks at the middle of the box, from the distance at which all points in the box lie
/// within kFilledShare of the image, and one of them on its border.
///
/// The scale is what the file states, or a metre a unit. If the eye would then be nearer than
/// kNearest_m or farther away than kMostDistant_m, it is multiplied by the power of ten that brings
/// the distance to 0.5 to 5 m. A large scene keeps its scale, and so does a scan that is entered.
Framing framingOf(const SceneFacts& facts, const FramingRequest& request);

/// What was chosen and why, in one line, without the name of the file.
std::string framingText(const Framing& framing);

/// How high the eye of a person who stands is above the ground.
inline constexpr double kStandingEye_m = 1.6;

struct StandingEye {
  glm::dvec3 position{0.0}, look_at{0.0};  ///< units of the file
  double free_m = 0.0;                     ///< up to what the eye looks at, or the border
  double nearest_m = 0.0;                  ///< of what is in view
};

/// Finds a place with ground below, free sight, and surfaces around. Of all such places the eye
/// takes the one with the longest free line, along which it looks; places with something near in
/// view come first. Works on a grid: a line is free if the cells along it hold no points.
/// @param share  of the scene's points that these are, up to 1
/// @return absent for an object, which has no such place: too small, or nothing around the eye; and
///         where the points lie too far apart to show what is near, as in a survey from the air
std::optional<StandingEye> standIn(std::span<const glm::vec3> points, const SceneBox& box,
                                   const UpAxis& up, double unit_m, double share);

/// A line a fact: counts, bounds, units, materials, opacity, normals. Ends with a line break.
std::string sceneText(const SceneFacts& facts, const Framing& framing);

nlohmann::ordered_json sceneJson(const SceneFacts& facts, const Framing& framing);

}  // namespace foci
