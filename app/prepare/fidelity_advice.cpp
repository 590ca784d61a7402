#include "app/prepare/fidelity_advice.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "render/scene/mesh/sample_mesh.h"

namespace foci {
namespace {

constexpr double kMostPoints = 1e8;      // what --points takes
constexpr double kEnough = 0.5;          // of `defaultPoints`: the spacing is 1.4 times wider
constexpr double kFinestSpacings = 2.0;  // width of a pixel from which finer surfels add nothing

/// Two significant digits, rounded up.
std::string roundNumber(double points) {
  const double step = std::pow(10.0, std::floor(std::log10(points)) - 1.0);
  return decimal(std::min(std::ceil(points / step) * step, kMostPoints), 0);
}

std::string pointsAdvice(const FidelityReport& report, double surfels, double wanted) {
  if (surfels < kEnough * wanted) return "set --points " + roundNumber(wanted);
  if (report.pixelSpacings() < kFinestSpacings) return "try --points " + roundNumber(4.0 * surfels);
  return "more points will hardly help: the surfels are finer than the screen's pixels";
}

}  // namespace

std::vector<std::string> fidelityWarnings(const FidelityReport& report, std::size_t surfels,
                                          const TriangleMesh& mesh) {
  std::vector<std::string> warnings;
  const Fidelity& all = report.all;
  const auto wanted = static_cast<double>(defaultPoints(mesh)), have = static_cast<double>(surfels);
  if (all.leakShare() > kMaxLeakShare || all.largest_leak > kWorstLeak) {
    warnings.push_back(decimal(100.0 * all.leakShare(), 3) +
                       " % of the surface shows what is behind it, at worst " +
                       decimal(100.0 * all.largest_leak, 0) + " % of its light (goal: at most " +
                       decimal(100.0 * kMaxLeakShare, 2) + " %, and " +
                       decimal(100.0 * kWorstLeak, 0) + " %); " +
                       pointsAdvice(report, have, wanted));
  }
  if (all.color_99.value_or(0.0) > kMaxColor99 && have < kEnough * wanted) {
    warnings.push_back("colours are off by more than " + decimal(*all.color_99, 0) +
                       " of 255 on 1 % of the surface: their detail is finer than the surfels; " +
                       pointsAdvice(report, have, wanted));
  }
  return warnings;
}

}  // namespace foci
