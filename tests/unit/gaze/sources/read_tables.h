// What tests of tables of gaze share.
#pragma once

#include <gtest/gtest.h>

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {

inline std::string refusal(std::string_view bytes, const TraceColumns& columns = {}) {
  return refusalBy([&] { readTrace(ScratchFile(bytes).path(), columns, {}); });
}

inline void expectPoint(const std::optional<glm::dvec2>& point_px, double x, double y) {
  constexpr double kRounding = 1e-9;  // a handful of double operations
  ASSERT_TRUE(point_px);
  EXPECT_LT(glm::distance(*point_px, glm::dvec2(x, y)), kRounding);
}

}  // namespace foci
