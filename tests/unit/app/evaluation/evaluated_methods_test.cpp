#include "app/evaluation/evaluated_methods.h"

#include <gtest/gtest.h>

#include "base/input_error.h"

namespace foci {
namespace FOCI_FILE {

TEST(EvaluatedMethods, KeepNumberAndVariant) {
  const auto chosen =
      evaluatedMethods({"sweep:7", "inflate", "inflate:spark", "pinhole"}, SettingRange::quick);
  ASSERT_EQ(chosen.size(), 4u);
  EXPECT_EQ(chosen[0].name, "sweep");
  EXPECT_EQ(chosen[0].spec(), "sweep:7");
  EXPECT_EQ(chosen[0].fileName(), "sweep-7");
  EXPECT_EQ(chosen[1].spec(), "inflate");
  EXPECT_EQ(chosen[2].spec(), "inflate:spark");
  EXPECT_EQ(chosen[2].fileName(), "inflate-spark");
  EXPECT_EQ(&familyOf(chosen[2].name), &familyOf("inflate"));
  EXPECT_EQ(chosen[3].spec(), "pinhole");
}

TEST(EvaluatedMethods, AnUnknownVariantIsRefusedWithTheKnownOnes) {
  try {
    evaluatedMethods({"inflate:sparks"}, SettingRange::quick);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "--method inflate:sparks: expected inflate, inflate:spark, "
                 "inflate:splat-transform");
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
