// The axes of a symmetric matrix, by cyclic Jacobi rotations (Golub and Van Loan, 8.5).
#pragma once

#include <glm/glm.hpp>

namespace foci {

struct PrincipalAxes {
  glm::dmat3 axes;  ///< orthonormal columns, right-handed; the unit matrix for a diagonal matrix
  glm::dvec3 variance;  ///< eigenvalues, in the order of the axes
};

/// @param a  symmetric
PrincipalAxes principalAxes(glm::dmat3 a);

}  // namespace foci
