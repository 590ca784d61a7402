// The lens as each direction sees it: the eye's aberrations over the visual field (eye_field.h) on
// the image.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "render/optics/defocus.h"
#include "render/optics/eye_field.h"
#include "render/optics/view.h"

namespace foci {

/// The lens in one direction. From the lens point p, on the unit disc, a point at the vergence D
/// appears displaced by
///   P ((F + dF - D I) S p + q(S p) - mean of q)   px,   q_i(u) = u' A_i u.
/// F is the focus of `Defocus`, dF what the field adds, S the shape of the pupil. q is coma:
///   A_x = [3 cx, cy; cy, cx],  A_y = [cy, cx; cx, 3 cy].
/// Its mean is left out, so that no direction is shifted. P maps angles in that direction to the
/// image: a flat image shows them larger away from its middle.
struct LocalLens {
  enum Value : std::size_t {
    kPxx,  ///< P, px for 1 D at the lens's rim
    kPxy,
    kPyx,
    kPyy,
    kSxx,
    kSxy,
    kSyy,
    kFxx,  ///< dF, dioptres
    kFxy,
    kFyy,
    kComaX,  ///< cx, cy, dioptres
    kComaY,
    kCxx,  ///< variance of coma over the lens, px^2
    kCxy,
    kCyy,
    kPadding,
    kValues
  };
  alignas(64) std::array<float, kValues> values{};

  float operator[](Value i) const { return values[i]; }
  glm::vec2 coma_D() const { return {values[kComaX], values[kComaY]}; }
  glm::mat2 imagePerAngle() const {
    return {values[kPxx], values[kPyx], values[kPxy], values[kPyy]};
  }
  glm::mat2 pupil() const { return {values[kSxx], values[kSxy], values[kSxy], values[kSyy]}; }

  /// P (F + dF - D I) S: how the lens's rim is displaced without coma, px.
  glm::mat2 blur_px(const Defocus& defocus, float point_D) const;
};

/// q of `LocalLens` at u.
inline glm::vec2 comaAt(const glm::vec2& c, const glm::vec2& u) {
  return {3.0f * c.x * u.x * u.x + 2.0f * c.y * u.x * u.y + c.x * u.y * u.y,
          c.y * u.x * u.x + 2.0f * c.x * u.x * u.y + 3.0f * c.y * u.y * u.y};
}

/// How coma displaces sub-apertures with these centres, px: the displacements have no mean, and as
/// much variance, summed over both axes, as the coma of the lens less that of a sub-aperture of
/// 1 / n of its area.
std::vector<glm::vec2> comaShifts_px(const LocalLens& lens, const std::vector<glm::vec2>& centres);

/// A grid of local lenses over a view. Read by offsets from `View::principal_px`, so strips and
/// squares of the view share it.
class LensField {
 public:
  /// @param gaze_px  image point of the line of sight
  LensField(const FieldAberrations& eye, bool left, const View& view, const glm::vec2& gaze_px,
            const Defocus& defocus);

  /// Linear between the nodes; beyond them, as at the border.
  LocalLens at(const glm::vec2& offset_px) const;

  /// Smallest and largest blur radius over all meridians, of points within `range_D` of `point_D`
  /// and within `around_px` of the place.
  std::pair<float, float> blurBounds_px(const glm::vec2& offset_px, float around_px,
                                        const Defocus& defocus, float point_D, float range_D) const;

  /// The largest blur radius of a point at that vergence, anywhere in the view.
  float maxBlur_px(const Defocus& defocus, float point_D) const;

  /// Unit direction along which the lens focuses nearest, as `nearestMeridian`.
  glm::vec2 meridianAt(const glm::vec2& offset_px, const Defocus& defocus) const;

  // For the SIMD code and the GPU.
  const std::vector<LocalLens>& nodes() const { return nodes_; }
  const glm::ivec2& size() const { return size_; }
  const glm::vec2& first_px() const { return first_px_; }
  float step_px() const { return step_px_; }

 private:
  std::size_t indexOf(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.x) +
           static_cast<std::size_t>(x);
  }
  glm::ivec2 size_{0};
  glm::vec2 first_px_{0.0f};  // offset of the first node
  float step_px_ = 1.0f, change_per_px_ = 0.0f, change_per_px_D_ = 0.0f;
  std::vector<LocalLens> nodes_;
};

/// Smallest and largest defocus of points within `range_D` of a vergence and within a distance of a
/// place; blur radii over `radius_px_per_D`.
struct OffFocus {
  float min_D, max_D;
};
/// @param offset_px  from the principal point
OffFocus offFocus(const Defocus& defocus, const glm::vec2& offset_px, float around_px,
                  float point_D, float range_D);

/// The field where the lens blurs; null otherwise.
inline const LensField* shownField(const Defocus& defocus) {
  const glm::vec2& radius = defocus.radius_px_per_D;
  return radius.x * radius.y > 0.0f ? defocus.field.get() : nullptr;
}

}  // namespace foci
