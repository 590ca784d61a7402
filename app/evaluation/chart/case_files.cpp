#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/evaluation/chart/cases.h"
#include "base/file.h"
#include "base/image_codec.h"
#include "base/text.h"
#include "render/image/srgb.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/gaussian_cloud.h"
#include "render/scene/harmonics.h"
#include "render/scene/io/ply.h"
#include "render/scene/principal_axes.h"

namespace foci {
namespace {

/// Of a Gaussian that stands for an opaque surfel: the largest that 3D Gaussian Splatting shows.
constexpr float kMostOpaque = 0.99f;
/// Thickness of a surfel's Gaussian over its width.
constexpr double kFlatness = 0.01;

/// Little-endian, as PLY and glTF are here.
template <class T>
void appendRaw(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// The properties before and after the harmonics.
void appendPlace(std::string& bytes, const glm::vec3& position_m, const glm::vec3& display) {
  appendRaw(bytes, position_m);
  appendRaw(bytes, (display - 0.5f) / kHarmonic0);
}

/// @param axes   orthonormal and right-handed
/// @param sigma  along each of the axes
void appendShape(std::string& bytes, float opacity, const glm::dmat3& axes,
                 const glm::dvec3& sigma) {
  const double alpha = std::clamp(double{opacity}, 1e-6, 1.0 - 1e-6);
  appendRaw(bytes, static_cast<float>(std::log(alpha / (1.0 - alpha))));
  appendRaw(bytes, glm::vec3(glm::log(glm::max(sigma, glm::dvec3(1e-9)))));
  const glm::quat turn(glm::quat_cast(axes));
  for (const float part : {turn.w, turn.x, turn.y, turn.z}) appendRaw(bytes, part);
}

std::string gaussianHeader(std::size_t count, int degree, bool preserves_light) {
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  if (preserves_light) header += "comment SplatRenderMode: mip\n";
  header += "element vertex " + std::to_string(count) + "\n";
  const auto property = [&](const std::string& name) { header += "property float " + name + "\n"; };
  for (const char* name : {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2"}) property(name);
  for (int i = 0; i < 3 * harmonicsOf(degree); ++i) property("f_rest_" + std::to_string(i));
  for (const char* name :
       {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"}) {
    property(name);
  }
  return header + "end_header\n";
}

std::string gaussianPly(const GaussianCloud& cloud) {
  std::string bytes = gaussianHeader(cloud.size(), cloud.degree, cloud.preserves_light);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    appendPlace(bytes, cloud.position_m[i], cloud.color[i]);
    const std::int16_t* of = cloud.harmonics.data() + i * cloud.harmonicsPerGaussian();
    for (std::size_t channel = 0; channel < 3; ++channel) {
      for (std::size_t k = channel; k < cloud.harmonicsPerGaussian(); k += 3) {
        appendRaw(bytes, kHarmonicsStep * static_cast<float>(of[k]));
      }
    }
    const PrincipalAxes all = principalAxes(matrixOf(cloud.covariance_m2[i]));
    appendShape(bytes, cloud.opacity[i], all.axes,
                glm::sqrt(glm::max(all.variance, glm::dvec3(0.0))));
  }
  return bytes;
}

std::string gaussianPly(const SurfelCloud& surfels) {
  std::string bytes = gaussianHeader(surfels.size(), 0, false);
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    appendPlace(bytes, surfels.position_m[i], displayColorOf(surfels, i));
    const glm::dvec3 u(surfels.axis_u_m[i]), v(surfels.axis_v_m[i]);
    const glm::dvec3 x = glm::normalize(u), y = glm::normalize(v);
    const double wide = glm::length(u), high = glm::length(v);
    const float opacity = opacityOf(surfels, i);
    appendShape(bytes, std::min(opacity, kMostOpaque), {x, y, glm::cross(x, y)},
                {wide, high, kFlatness * std::min(wide, high)});
  }
  return bytes;
}

std::vector<std::uint8_t> texturePng(const MeshTexture& texture) {
  std::vector<std::uint8_t> rgb;
  for (const auto& pixel : texture.pixels()) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float linear = static_cast<float>(pixel[c]) / 65535.0f;
      rgb.push_back(static_cast<std::uint8_t>(std::lround(255.0f * srgbFromLinear(linear))));
    }
  }
  const glm::ivec2 size_px(texture.size_px());
  return encodePng(size_px.x, size_px.y, 3, rgb.data());
}

constexpr std::size_t kPoints = 1000;  // that a COLMAP model shows

std::string textRow(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) text += " " + exactText(value);
  return text;
}

}  // namespace

void writePoints(const std::filesystem::path& file, const SurfelCloud& surfels) {
  PointCloud points;
  points.position_m.assign(surfels.position_m.begin(), surfels.position_m.end());
  points.color.assign(surfels.color.begin(), surfels.color.end());
  points.opacity.assign(surfels.opacity.begin(), surfels.opacity.end());
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const glm::vec3 across = glm::cross(surfels.axis_u_m[i], surfels.axis_v_m[i]);
    points.normal.push_back(glm::normalize(across));
    points.radius_m.push_back(std::sqrt(glm::length(across)) / kSigmaPerRadius);
  }
  writePly(file, points);
}

void writeGaussians(const std::filesystem::path& file, const Scene& scene) {
  writeText(file, std::visit([](const auto& cloud) { return gaussianPly(cloud); }, scene.splats));
}

void writeGlb(const std::filesystem::path& file, const TriangleMesh& mesh) {
  assert(mesh.materials.size() == 1 && mesh.materials[0].texture && mesh.color.empty());
  const auto png = texturePng(*mesh.materials[0].texture);
  glm::vec3 low(std::numeric_limits<float>::infinity()), high = -low;
  std::string data;
  for (const glm::vec3& corner : mesh.corners_m) {
    appendRaw(data, corner);
    low = glm::min(low, corner);
    high = glm::max(high, corner);
  }
  const std::size_t places = data.size();
  for (const glm::vec2& uv : mesh.uv)
    appendRaw(data, glm::vec2(uv.x, 1.0f - uv.y));  // from the top
  const std::size_t images = data.size();
  data.append(png.begin(), png.end());
  data.resize((data.size() + 3) / 4 * 4, '\0');

  constexpr int kFloats = 5126;
  const std::size_t corners = mesh.corners_m.size();
  const nlohmann::ordered_json gltf = {
      {"asset", {{"version", "2.0"}, {"generator", "foci"}}},
      {"extensionsUsed", {"KHR_materials_unlit"}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"mesh", 0}}}},
      {"meshes",
       {{{"primitives",
          {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}, {"material", 0}}}}}}},
      {"materials",
       {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0}}},
         {"doubleSided", true},
         {"extensions", {{"KHR_materials_unlit", nlohmann::ordered_json::object()}}}}}},
      {"textures", {{{"source", 0}}}},
      {"images", {{{"bufferView", 2}, {"mimeType", "image/png"}}}},
      {"accessors",
       {{{"bufferView", 0},
         {"componentType", kFloats},
         {"count", corners},
         {"type", "VEC3"},
         {"min", {low.x, low.y, low.z}},
         {"max", {high.x, high.y, high.z}}},
        {{"bufferView", 1}, {"componentType", kFloats}, {"count", corners}, {"type", "VEC2"}}}},
      {"bufferViews",
       {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", places}},
        {{"buffer", 0}, {"byteOffset", places}, {"byteLength", images - places}},
        {{"buffer", 0}, {"byteOffset", images}, {"byteLength", png.size()}}}},
      {"buffers", {{{"byteLength", data.size()}}}}};
  std::string text = gltf.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string glb = "glTF";
  const auto length = static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + data.size());
  for (const std::uint32_t word : {2u, length, static_cast<std::uint32_t>(text.size())}) {
    appendRaw(glb, word);
  }
  glb += "JSON" + text;
  appendRaw(glb, static_cast<std::uint32_t>(data.size()));
  glb += std::string("BIN\0", 4) + data;
  writeText(file, glb);
}

std::string nerfTransforms(const View& view, const std::string& image, const std::string& points) {
  const glm::dvec2 size_px(view.size_px), focal_px(view.focal_px);
  const glm::dmat4 world_from_camera = glm::inverse(glm::dmat4(view.eye_from_world));
  auto rows = nlohmann::ordered_json::array();
  for (int i = 0; i < 4; ++i) {
    rows.push_back({world_from_camera[0][i], world_from_camera[1][i], world_from_camera[2][i],
                    world_from_camera[3][i]});
  }
  nlohmann::ordered_json json = {{"camera_model", "PINHOLE"},
                                 {"w", view.size_px.x},
                                 {"h", view.size_px.y},
                                 {"fl_x", focal_px.x},
                                 {"fl_y", focal_px.y},
                                 {"cx", view.principal_px.x},
                                 {"cy", view.principal_px.y},
                                 {"camera_angle_x", 2.0 * std::atan(0.5 * size_px.x / focal_px.x)},
                                 {"camera_angle_y", 2.0 * std::atan(0.5 * size_px.y / focal_px.y)},
                                 {"frames", {{{"file_path", image}, {"transform_matrix", rows}}}}};
  if (!points.empty()) json["ply_file_path"] = points;
  return json.dump(1) + "\n";
}

ColmapModel colmapModel(const View& view, const std::string& image, const Scene& scene) {
  glm::dmat4 camera_from_eye(1.0);
  camera_from_eye[1].y = camera_from_eye[2].z = -1.0;
  const glm::dmat4 camera_from_world = camera_from_eye * glm::dmat4(view.eye_from_world);
  const glm::dquat turn = glm::quat_cast(glm::dmat3(camera_from_world));
  const glm::dvec3 shift_m(camera_from_world[3]);
  ColmapModel model{
      .cameras = "# CAMERA_ID MODEL WIDTH HEIGHT fx fy cx cy\n1 PINHOLE" +
                 textRow({1.0 * view.size_px.x, 1.0 * view.size_px.y, view.focal_px.x,
                          view.focal_px.y, view.principal_px.x, view.principal_px.y}) +
                 "\n",
      .images = "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, then its points\n1" +
                textRow({turn.w, turn.x, turn.y, turn.z, shift_m.x, shift_m.y, shift_m.z}) + " 1 " +
                image + "\n\n",
      .points3D = "# POINT3D_ID X Y Z R G B ERROR TRACK[]\n"};
  const auto addPoints = [&](const auto& cloud) {
    const std::size_t step = std::max<std::size_t>(1, cloud.size() / kPoints);
    for (std::size_t i = 0; i < cloud.size(); i += step) {
      const glm::vec3& p = cloud.position_m[i];
      model.points3D += std::to_string(i / step + 1) + textRow({p.x, p.y, p.z});
      const glm::vec3 code = 255.0f * displayColorOf(cloud, i);
      for (int c = 0; c < 3; ++c) model.points3D += " " + std::to_string(std::lround(code[c]));
      model.points3D += " 0\n";
    }
  };
  std::visit(addPoints, scene.splats);
  return model;
}

}  // namespace foci
