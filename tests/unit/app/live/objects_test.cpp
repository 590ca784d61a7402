// Objects of interest that are placed by pointing.
#include "app/live/objects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace foci {
namespace FOCI_FILE {

TEST(LiveObjects, AreFourDegreesWideAndHaveNamesOfTheirOwn) {
  std::vector<NamedShape> objects;
  for (int i = 0; i < 3; ++i) objects.push_back(objectAt({0.0, 1.0, -2.0}, 2.0, objects));
  EXPECT_EQ(objects[2].name, "object 3");
  EXPECT_NEAR(*objects[2].radius_m, 0.06984, 1e-5);  // 2 m tan 2 deg
  objects.erase(objects.begin());
  EXPECT_EQ(objectAt({}, 1.0, objects).name, "object 1");
}

TEST(LiveObjects, ABoxShowsItsTwelveEdges) {
  const NamedShape box{.name = "box",
                       .center_m = {1.0, 2.0, 3.0},
                       .size_m = glm::dvec3(0.2, 0.4, 0.6),
                       .radius_m = {}};
  const auto ends_m = linesOf(box);
  ASSERT_EQ(ends_m.size(), 24u);
  int along[3] = {0, 0, 0};
  for (std::size_t i = 0; i < ends_m.size(); i += 2) {
    const glm::vec3 edge_m = glm::abs(ends_m[i + 1] - ends_m[i]);
    for (int axis = 0; axis < 3; ++axis) {
      along[axis] += std::abs(edge_m[axis] - static_cast<float>((*box.size_m)[axis])) < 1e-6f;
      const float aside = std::abs(ends_m[i][axis] - static_cast<float>(box.center_m[axis]));
      EXPECT_NEAR(aside, 0.5 * (*box.size_m)[axis], 1e-6);  // each end is a corner
    }
  }
  EXPECT_TRUE(std::ranges::all_of(along, [](int edges) { return edges == 4; }));
}

TEST(LiveObjects, ASphereShowsClosedCirclesOfItsRadius) {
  const NamedShape ball{
      .name = "ball", .center_m = {0.0, 0.0, -1.0}, .size_m = {}, .radius_m = 0.25};
  const auto ends_m = linesOf(ball);
  ASSERT_EQ(ends_m.size() % 2, 0u);
  double length_m = 0.0;
  for (std::size_t i = 0; i < ends_m.size(); i += 2) {
    EXPECT_NEAR(glm::distance(glm::dvec3(ends_m[i]), ball.center_m), 0.25, 1e-6);
    length_m += static_cast<double>(glm::distance(ends_m[i], ends_m[i + 1]));
  }
  EXPECT_NEAR(length_m, 3.0 * 2.0 * 3.14159265 * 0.25, 0.01 * length_m);
}

TEST(LiveObjects, ChangeTheirKindAndKeepTheirWidth) {
  NamedShape shape = objectAt({}, 1.0, {});
  const double radius_m = *shape.radius_m;
  changeKind(shape);
  EXPECT_FALSE(shape.radius_m);
  EXPECT_NEAR(shape.size_m->y, 2.0 * radius_m, 1e-12);
  changeKind(shape);
  EXPECT_FALSE(shape.size_m);
  EXPECT_NEAR(*shape.radius_m, radius_m, 1e-12);
}

}  // namespace FOCI_FILE
}  // namespace foci
