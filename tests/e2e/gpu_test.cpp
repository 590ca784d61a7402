// `--device gpu`, as users run it; on a machine without a GPU, the software driver renders.
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace {

using Json = nlohmann::json;

class OnTheGpu : public testing::Test {
 protected:
  void SetUp() override {
    folder.write("study.toml", smallStudy());
    folder.write("scene.ply", squarePly(24, 1.0));
    folder.write("trace.tsv", steadyTrace());
    const Outcome doctor = runFoci({"doctor", "--json"}, folder.path());
    ASSERT_EQ(doctor.exit_code, 0) << doctor.err;
    const Json gpu = Json::parse(doctor.out)["gpu"];
    if (gpu.contains("problem")) GTEST_SKIP() << gpu["problem"];
    name = gpu["name"];
  }

  Json manifest(const std::string& out) const {
    return Json::parse(folder.read(out + "/manifest.json"));
  }

  TemporaryFolder folder;
  std::string name;
};

TEST_F(OnTheGpu, AReplayNamesItsDeviceAndHasTheSameBytesEachTime) {
  for (const char* out : {"a", "b"}) {
    const Outcome outcome =
        runFoci({"replay", "study.toml", "--device", "gpu", "--out", out}, folder.path());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("foci: renders on " + name), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(manifest("a")["frames_sha256"], manifest("b")["frames_sha256"]);
  EXPECT_EQ(std::string(manifest("a")["device"]).find(name), 0u);
  EXPECT_NE(folder.read("a/report.html").find(name), std::string::npos);
}

TEST_F(OnTheGpu, AReplayOfARunFromAnotherDeviceSaysSo) {
  folder.write("study.toml", smallStudy() + "\n[record]\ndevice = \"another GPU, driver 1\"\n");
  const Outcome outcome = runFoci({"replay", "study.toml", "--out", "out"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("the run was rendered on another GPU, driver 1"), std::string::npos)
      << outcome.err;
}

TEST_F(OnTheGpu, AnImageOfBothEyesIsTheSameAsOnTheCpu) {
  for (const std::string device : {"gpu", "cpu"}) {
    const Outcome outcome = runFoci({"render", "study.toml", "--device", device, "--view",
                                     "side-by-side", "--out", device + ".pfm"},
                                    folder.path());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  const std::string gpu = folder.read("gpu.pfm"), cpu = folder.read("cpu.pfm");
  ASSERT_EQ(gpu.size(), cpu.size());
  std::size_t header = 0;  // three lines of text
  for (int line = 0; line < 3; ++line) header = cpu.find('\n', header) + 1;
  float worst = 0.0f;
  for (std::size_t at = header; at + sizeof(float) <= cpu.size(); at += sizeof(float)) {
    float a = 0.0f, b = 0.0f;
    std::memcpy(&a, gpu.data() + at, sizeof a);
    std::memcpy(&b, cpu.data() + at, sizeof b);
    worst = std::max(worst, std::abs(a - b));
  }
  EXPECT_LT(worst, 0.004f);
}

TEST_F(OnTheGpu, OneLineSaysThatAMethodRendersOnTheCpu) {
  const Outcome outcome =
      runFoci({"render", "study.toml", "--device", "gpu", "--method", "paper", "--out", "a.png"},
              folder.path());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("foci: method paper has no code for the GPU; the CPU renders\n"),
            std::string::npos)
      << outcome.err;
}

TEST_F(OnTheGpu, AnUnknownDeviceIsRefused) {
  const Outcome outcome =
      runFoci({"render", "study.toml", "--device", "tpu", "--out", "a.png"}, folder.path());
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("expected one of \"auto\" \"gpu\" \"cpu\""), std::string::npos)
      << outcome.err;
}

}  // namespace
}  // namespace foci::e2e
