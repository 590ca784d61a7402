// Weights and sizes of surfels so that their kernels sum to one over the surface. Private to the
// scene.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "render/scene/neighbours.h"

namespace foci {

/// Circular surfels and who is near whom. All vectors have one entry a surfel.
struct KernelProblem {
  const std::vector<glm::vec3>& position_m;
  const std::vector<glm::vec3>& normal;
  const Neighbours& near;
  const std::vector<std::uint64_t>& sheet;  ///< bit b: the b-th neighbour lies on the same surface
  const std::vector<float>& spacing_m;      ///< > 0
};

struct KernelEffort {
  int weight_iterations = 0;    ///< >= 0
  int sigma_rounds = 0;         ///< of adapting the sizes too, before those iterations
  int rendered_iterations = 0;  ///< of the weights after them, for the kernels as they are rendered
  std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// Least squares over the surface itself, not only at its samples, where an irregular sampling's
/// sum is above its mean. With E = |sum_j w_j G_j - 1|^2 integrated over the surface, v_j =
/// sigma_j^2:
///   dE/dw_i = 0:  sum_j w_j G_{v_i + v_j}(x_i - x_j) = 1, by the multiplicative iteration
///                 w_i <- w_i / sum (ISRA, Daube-Witherspoon and Muehllehner 1986; formulas.md, 5);
///   dE/dv_i = 2 w_i sum_j w_j dG/dv (x_i - x_j), dG/dv = G (d^2 / 2v^2 - 1/v), v = v_i + v_j:
///   small
///                 steps of log v_i against it, within a factor of 1.6 of the given sigma. Sizes at
///                 the border of a surface stay, or they would fill the space beyond it.
/// G are Gaussians, whose overlaps are Gaussians; the `rendered_iterations` take the kernels as
/// rendered, of compact support, and prefiltered by a pixel of 0.63 of the spacing
/// (kernel_overlap.h). Neighbours beyond the k-th are made up for by the kernel's mass outside.
/// @param sigma_m  > 0; changed where `sigma_rounds` > 0
/// @return weights, m^2, > 0 and at most 2 pi sigma^2: no single kernel covers more than everything
std::vector<float> solveKernels(const KernelProblem& problem, const KernelEffort& effort,
                                std::vector<float>& sigma_m);

}  // namespace foci
