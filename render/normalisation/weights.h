// Solves the weights and sizes of surfels so that their kernels are a partition of unity over the
// surface (docs/formulas.md, section 5). Private to the scene.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "render/scene/neighbours.h"

namespace foci {

/// Circular surfels and their neighbours. All vectors have one entry for each surfel.
struct KernelProblem {
  const std::vector<glm::vec3>& position_m;
  const std::vector<glm::vec3>& normal;
  const std::vector<glm::vec3>& seen_along;  ///< unit length: the kernels are summed across it
  const Neighbours& near;
  const std::vector<std::uint64_t>& sheet;  ///< bit b: the b-th neighbour lies on the same surface
  const std::vector<float>& spacing_m;      ///< > 0
  /// Whether spacing_m^2 are the true areas, on average over each neighbourhood.
  bool areas_known = false;
};

struct KernelEffort {
  int weight_iterations = 0;    ///< >= 0
  int sigma_rounds = 0;         ///< >= 0; rounds that adapt the sizes too, before those
  int rendered_iterations = 0;  ///< >= 0; last, for the kernels as they are rendered
  std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// Minimises E = int |sum_j w_j G_j - 1|^2 over the surface, where G_j is a Gaussian of variance
/// v_j = sigma_j^2 and weight w_j. The integral runs over the surface, because at the samples of an
/// irregular sampling the sum is above its mean.
///
/// Weights. dE/dw_i = 0 asks for sum_j w_j G_{v_i + v_j}(x_i - x_j) = 1. Each iteration divides w_i
/// by that sum (ISRA, Daube-Witherspoon and Muehllehner 1986).
///
/// The sum is taken across the direction `seen_along`, which need not be the normal: the kernels
/// are foreshortened, their variances too.
///
/// Sizes. With v = v_i + v_j and d the distance,
///   dE/dv_i = 2 w_i sum_j w_j dG/dv,  dG/dv = G (d^2 / (2 v^2) - 1/v).
/// Small steps of log v_i go against this gradient, within a factor of 1.6 of the given sigma. At
/// the border of a surface sizes stay; they would grow into the empty space beyond.
///
/// The `rendered_iterations` use the rendered kernels instead of Gaussians: of compact support
/// (kernel_overlap.h). The kernel mass outside the k-th neighbour's distance is added, since
/// neighbours beyond it are not known. A sum that is even without a pixel's prefilter, as in a
/// magnified view, is even with it, but not the other way round. So the weights of a mesh are
/// solved without one. Those of points are solved without one for a quarter of the iterations, then
/// with a pixel of 0.63 of the spacing: where points are missing, no weights make the sum even
/// without it.
///
/// Sums. Where areas are known, the kernels sum to the mean of the initial sums around each surfel
/// instead of to one: neighbours on other sheets and folds then take no area away. At a strongly
/// curved place the neighbours are no single sheet in any direction, and a sum of one would need
/// weights that oscillate. At a border they sum to what the surface covers there, so that outlines
/// stay where they are.
///
/// @param sigma_m  > 0; changed if `sigma_rounds` > 0
/// @return weights, m^2, > 0 and at most 2 pi sigma^2, where one kernel alone is opaque
std::vector<float> solveKernels(const KernelProblem& problem, const KernelEffort& effort,
                                std::vector<float>& sigma_m);

}  // namespace foci
