#include <nlohmann/json.hpp>

#include "app/platform/json_text.h"
#include "app/study/framing.h"
#include "base/text.h"

namespace foci {
namespace {

std::string numbers(const glm::dvec3& p, const char* between) {
  return printed("%.5g%s%.5g%s%.5g", p.x, between, p.y, between, p.z);
}

std::string countsText(const SceneFacts& facts) {
  std::string text;
  const auto add = [&](std::size_t count, const char* one) {
    if (count > 0) text += (text.empty() ? "" : ", ") + counted(count, one);
  };
  add(facts.points, "point");
  add(facts.triangles, "triangle");
  add(facts.surfels, "surfel");
  add(facts.gaussians, "Gaussian");
  if (facts.dropped > 0) {
    text += ", " + thousands(static_cast<double>(facts.dropped)) +
            " left out (not finite, or over 1e9 units from the origin)";
  }
  return text;
}

std::string materialText(const MaterialFacts& material) {
  std::string text = material.name.empty() ? "(no name)" : shown(material.name);
  for (const TextureFacts& texture : material.textures) {
    text += ", texture " + shown(texture.name) + (texture.found ? "" : " (missing)");
  }
  if (material.opacity < 1.0f) text += ", opacity " + decimal(double{material.opacity}, 2);
  return text;
}

std::string unitText(const SceneFacts& facts, const Framing& framing) {
  const std::string stated =
      facts.unit_m ? "a unit is " + exactText(*facts.unit_m) + " m (" + whatStatesUnit(facts) + ")"
                   : "the file states none";
  return stated + "; foci shows " + exactText(framing.scale_m) + " m a unit: " + framing.why_scale;
}

}  // namespace

std::string sceneText(const SceneFacts& facts, const Framing& framing) {
  std::string text;
  const auto line = [&](const std::string& name, const std::string& value) {
    text +=
        name + std::string(name.size() < 10 ? 10 - name.size() : 1, ' ') + visible(value) + "\n";
  };
  const glm::dvec3 size = framing.box.size();
  line("format", nameOf(facts));
  line("contents", countsText(facts));
  line("bounds",
       numbers(framing.box.low, " ") + " to " + numbers(framing.box.high, " ") + " units, " +
           numbers(size, " x ") +
           (framing.box.strays > 0 ? "; " + thousands(static_cast<double>(framing.box.strays)) +
                                         " stray points lie outside"
                                   : ""));
  line("units", unitText(facts, framing));
  line("size", numbers(size * framing.scale_m, " x ") + " m");
  line("up", nameOf(framing.up_axis) + " (" + framing.up_axis.why + ")");
  if (facts.kind == SceneKind::gaussians) {
    line("harmonics", "of degree " + std::to_string(facts.harmonics_degree));
  } else {
    line("normals", facts.has_normals                   ? "yes"
                    : facts.isMesh()                    ? "no: those of the triangles"
                    : facts.kind == SceneKind::prepared ? "yes; they do not tell front from back"
                                                        : "no: foci estimates them");
  }
  line("colours", facts.has_colors        ? "yes"
                  : facts.material_colors ? "of materials or faces"
                                          : "one colour");
  line("opacity",
       facts.opacity.x == facts.opacity.y
           ? decimal(double{facts.opacity.x}, 2)
           : decimal(double{facts.opacity.x}, 2) + " to " + decimal(double{facts.opacity.y}, 2));
  for (const MaterialFacts& material : facts.materials) line("material", materialText(material));
  for (const std::string& remark : facts.remarks) line("remark", remark);
  return text;
}

nlohmann::ordered_json sceneJson(const SceneFacts& facts, const Framing& framing) {
  auto materials = nlohmann::ordered_json::array();
  for (const MaterialFacts& material : facts.materials) {
    auto textures = nlohmann::ordered_json::array();
    for (const TextureFacts& texture : material.textures) {
      textures.push_back({{"name", texture.name}, {"found", texture.found}});
    }
    materials.push_back(
        {{"name", material.name}, {"opacity", material.opacity}, {"textures", textures}});
  }
  return {{"format", nameOf(facts)},       {"points", facts.points},
          {"triangles", facts.triangles},  {"surfels", facts.surfels},
          {"gaussians", facts.gaussians},  {"dropped", facts.dropped},
          {"strays", framing.box.strays},  {"low", framing.box.low},
          {"high", framing.box.high},      {"unit_m", facts.unit_m},
          {"scale_m", framing.scale_m},    {"size_m", framing.box.size() * framing.scale_m},
          {"up", nameOf(framing.up_axis)}, {"normals", facts.has_normals},
          {"colors", facts.has_colors},    {"opacity", facts.opacity},
          {"materials", materials},        {"remarks", facts.remarks}};
}

}  // namespace foci
