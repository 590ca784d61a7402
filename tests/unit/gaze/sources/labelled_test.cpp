// Recordings with the labels of human coders, in tables as spreadsheets and scripts write them.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "base/input_error.h"
#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

const Screen kScreen{.size_px = {1920, 1080}, .size_m = {0.5313, 0.2989}, .distance_m = 0.6};

/// Four samples, which two coders label.
std::string table(char separator, const std::string& before = "") {
  std::string text =
      "time_s;x_px;y_px;coder_A;coder_B\n"
      "0.00;100;200;fixation;fixation\n"
      "0.01;101;200;saccade;fixation\n"
      "0.02;400;210;pso;undefined\n"
      "0.03;401;210;fixation;blink\n";
  std::replace(text.begin(), text.end(), ';', separator);
  return before + text;
}

LabelledTrace read(const std::string& bytes) {
  return readLabelledTrace(ScratchFile(bytes).path(), kScreen);
}

std::string refusal(const std::string& bytes) {
  return refusalBy([&] { read(bytes); });
}

TEST(ReadLabelled, LabelsAreTheSameWithEachSeparator) {
  for (const std::string& text :
       {table('\t'), table(';'), table(','), table(' '), table('|', "sep=|\n"),
        table(';', "\xef\xbb\xbfsep=;\r\n"), table(';', "# sampling_Hz=100\n")}) {
    const LabelledTrace labelled = read(text);
    ASSERT_EQ(labelled.coders.size(), 2u) << text;
    EXPECT_EQ(labelled.coders[0].name, "coder_A");
    const std::vector<std::optional<GazeState>> first = {
        GazeState::fixation, GazeState::saccade, GazeState::oscillation, GazeState::fixation};
    EXPECT_EQ(labelled.coders[0].labels, first) << text;
    EXPECT_FALSE(labelled.coders[1].labels[2]);
    EXPECT_EQ(labelled.coders[1].labels[3], GazeState::blink);
  }
}

TEST(ReadLabelled, ACoderWithoutAKnownWordIsRefused) {
  std::string numbers = table(';');
  for (std::size_t at = 0; (at = numbers.find("fixation", at)) != std::string::npos;) {
    numbers.replace(at, 8, "Fixation");
  }
  // The coder A has a saccade.
  const std::string refused = refusal(numbers.replace(numbers.find("blink"), 5, "Blink"));
  EXPECT_NE(refused.find("column \"coder_B\": no label is known, the first is \"Fixation\": "
                         "expected fixation, saccade"),
            std::string::npos)
      << refused;
  EXPECT_NE(refusal("time_s;x_px;y_px\n0;1;2\n0.01;1;2\n").find("no column coder"),
            std::string::npos);
}

}  // namespace FOCI_FILE
}  // namespace foci
