#include "render/gl/shader_text.h"

#include <initializer_list>
#include <string_view>

#include "render/gl/shader_sources.h"
#include "render/kernel/limits.h"

namespace foci {

std::string shaderText(const std::string& stage, const std::string& defines) {
  std::string text = "#version 450 core\n" + defines +
                     "const float kOverlap = " + std::to_string(kOverlap) + ";\n";
  const auto shared = [&](const char* file, std::initializer_list<std::string_view> by) {
    for (const std::string_view each : by) {
      if (each == stage) text += shaderSource(file);
    }
  };
  if (stage != "sum" && stage != "encode") {  // the stages of a frame
    text += shaderSource("frame") + shaderSource("totals");
  }
  shared("keys", {"project", "gaussian_project"});
  shared("batches", {"sweep", "gaussian_composite"});
  shared("cubic", {"interpolate", "gaussian_composite"});
  shared("layers", {"sweep"});
  shared("gaussian_layers", {"gaussian_composite"});
  shared("gaussian_follow", {"gaussian_composite"});
  return text + shaderSource(stage);
}

}  // namespace foci
