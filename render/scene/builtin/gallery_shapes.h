// Parametric surfaces over the unit square, for the gallery. Normals along cross(du, dv) point
// outwards. Private to the gallery.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <vector>

namespace foci {

using Shape = std::function<glm::vec3(glm::vec2)>;
using Curve = std::function<glm::vec3(float)>;

/// corner + u edge_u + v edge_v.
Shape rectangle(const glm::vec3& corner, const glm::vec3& edge_u, const glm::vec3& edge_v);

Shape ball(const glm::vec3& center, float radius);

/// A profile of (radius, height) points, smoothly joined (Catmull-Rom), turned about a vertical
/// axis. `flutes` grooves of relative depth `flute_depth` run along it.
Shape lathe(const glm::vec3& foot, std::vector<glm::vec2> profile, int flutes = 0,
            float flute_depth = 0.0f);

/// A tube around a curve over 0 to 1, u around it, v along. `aside` is never along the curve.
Shape tube(const Curve& curve, const std::function<float(float)>& radius, const glm::vec3& aside);

/// A leaf of a plant: from `base` along `rise`, bent by `droop`, `width` at its widest.
Shape leaf(const glm::vec3& base, const glm::vec3& rise, const glm::vec3& side, float droop);

/// A head about `center`, life-sized at scale 1, that faces +z; azimuth and elevation (rad) span
/// the unit square. `hair` roughens skull and neck.
Shape head(const glm::vec3& center, float scale, glm::vec2 azimuth, glm::vec2 elevation, bool hair);

/// The torus knot that winds p times about its axis (z) and q times about its core.
Curve torusKnot(const glm::vec3& center, float scale, int p, int q);

}  // namespace foci
