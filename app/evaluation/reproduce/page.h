// The reproduction as a page: the figures to reach, Table 1 beside the paper's own numbers, Figures
// 1 and 6.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/reproduce/figures.h"
#include "app/evaluation/reproduce/growth.h"
#include "app/evaluation/reproduce/measure.h"
#include "app/evaluation/reproduce/ratios.h"

namespace foci {

struct ReproducedScene {
  const ReproduceScene& scene;
  const SceneResult& result;
  std::vector<std::vector<FigurePanel>> figure6;
};

struct ReproduceFacts {
  std::vector<ReproducedScene> scenes = {};  ///< the plane, then the lion
  std::vector<ReproduceRatio> ratios = {};
  std::vector<FigurePanel> figure1 = {};
  std::optional<Growth> growth = {};
  ReproduceEffort effort;
  std::vector<unsigned> threads;
  double seconds = 0.0;
  bool quick = false;  ///< the page does not judge a quick run
};

/// A complete HTML page, with its images inside.
std::string reproducePage(const ReproduceFacts& facts);

}  // namespace foci
