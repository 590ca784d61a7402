#include "tests/faces/hard_faces.h"

#include <cmath>

namespace foci::faces {

Person hardPerson(std::uint32_t index) {
  Person person = somebody(index);
  person.lashes = 0.8;
  person.shade = 0.8;
  person.lids = 0.8;
  return person;
}

Photography hardLight(std::uint32_t seed) {
  return {.blur_px = 0.9,
          .noise = 4.0,
          .exposure = 0.7,
          .light_yaw_rad = 0.9,
          .ambient = 0.4,
          .seed = seed};
}

std::vector<HardFace> hardFaces(std::uint32_t people) {
  static const Face kBystander(somebody(4));
  std::vector<HardFace> all;
  for (std::uint32_t index = 1; index <= people; ++index) {
    const auto draw = [&](std::uint32_t which) {
      return 2.0 * static_cast<double>(noiseAt(index, which, 5)) - 1.0;
    };
    HardFace usual{.what = "", .person = hardPerson(index)};
    usual.moment = {.head_m = {0.04 * draw(0), 0.02 + 0.03 * draw(1), 0.5},
                    .yaw_rad = 0.12 * draw(2),
                    .pitch_rad = 0.1 * draw(3),
                    .looks_at_m = {0.25 * draw(4), 0.1 + 0.1 * draw(5), 0.0}};
    usual.how = hardLight(index);
    usual.how.light_yaw_rad *= draw(6);
    const auto add = [&](const char* what, auto change) {
      HardFace face = usual;
      face.what = what;
      change(face);
      all.push_back(face);
    };
    add("lashes and shaded corners", [](HardFace&) {});
    add("narrow lids", [](HardFace& f) { f.person.lids = 0.55; });
    add("glasses with glints", [](HardFace& f) {
      f.person.glasses = true;
      f.person.mirrored = 0.12f;
    });
    add("make-up", [](HardFace& f) { f.person.made_up = true; });
    add("gaze 30 degrees aside", [&](HardFace& f) {
      const double side = index % 2 == 0 ? 1.0 : -1.0;
      f.moment.looks_at_m.x = f.moment.head_m.x + side * std::tan(0.524) * f.moment.head_m.z;
    });
    add("side light", [&](HardFace& f) {
      f.how.light_yaw_rad = index % 2 == 0 ? 1.4 : -1.4;
      f.how.ambient = 0.12;
    });
    add("noise in dim light", [](HardFace& f) {
      f.how.noise = 12.0;
      f.how.exposure = 0.25;
    });
    add("a second face", [](HardFace& f) {
      f.how.beside = &kBystander;
      f.how.beside_at = {.head_m = {-0.22, 0.0, 0.75}};
    });
    add("at the edge", [&](HardFace& f) { f.moment.head_m.x = index % 2 == 0 ? 0.225 : -0.225; });
  }
  return all;
}

}  // namespace foci::faces
