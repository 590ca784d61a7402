#include "app/evaluation/chart/camera_files.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

#include "base/text.h"

namespace foci {
namespace {

constexpr std::size_t kPoints = 1000;  // that a COLMAP model shows

std::string textRow(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) text += " " + exactText(value);
  return text;
}

}  // namespace

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
