#include "base/mapped_vector.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>

namespace foci {
namespace FOCI_FILE {

TEST(MappedVector, ReadsTheMappedValuesInPlace) {
  const auto values = std::make_shared<const std::array<int, 3>>(std::array{1, 2, 3});
  const MappedVector<int> mapped(*values, values), copy = mapped;
  EXPECT_EQ(mapped.data(), values->data());
  EXPECT_EQ(mapped.size(), 3u);
  EXPECT_EQ(mapped, (MappedVector<int>{1, 2, 3}));
  EXPECT_EQ(copy.data(), values->data());
  EXPECT_EQ(values.use_count(), 3);
}

TEST(MappedVector, CopiesBeforeTheFirstChange) {
  const auto values = std::make_shared<const std::array<int, 3>>(std::array{1, 2, 3});
  MappedVector<int> changed(*values, values);
  changed[1] = 5;
  changed.push_back(7);
  EXPECT_EQ(changed, (MappedVector<int>{1, 5, 3, 7}));
  EXPECT_EQ((*values)[1], 2);
  EXPECT_EQ(values.use_count(), 1);
}

}  // namespace FOCI_FILE
}  // namespace foci
