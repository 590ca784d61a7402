// `--device gpu`, as users run it; on a machine without a GPU, the software driver renders.
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

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
  EXPECT_NE(outcome.err.find(
                "foci: method paper has no code for the GPU in this scene; the CPU renders\n"),
            std::string::npos)
      << outcome.err;
}

TEST_F(OnTheGpu, TheSummaryOfAnImageNamesTheDevice) {
  for (const std::string device : {"cpu", "gpu"}) {
    const Outcome outcome = runFoci(
        {"render", "study.toml", "--device", device, "--json", "--out", "a.png"}, folder.path());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string named = Json::parse(outcome.out)["device"];
    EXPECT_EQ(named.find(device == "cpu" ? "the CPU, " : name + ", driver "), 0u) << named;
  }
}

TEST_F(OnTheGpu, APartSaysThatAMethodRendersOnTheCpu) {
  const Outcome outcome = runFoci({"replay", "study.toml", "--device", "gpu", "--method", "paper",
                                   "--frames", "0:2", "--out", "part"},
                                  folder.path());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("foci: method paper has no code for the GPU"), std::string::npos)
      << outcome.err;
}

TEST_F(OnTheGpu, AnOlderDriverIsNamed) {
  const std::vector<std::string> old = {"MESA_GL_VERSION_OVERRIDE=4.3"};
  const Outcome doctor = runFoci({"doctor", "--json"}, folder.path(), old);
  ASSERT_EQ(doctor.exit_code, 0) << doctor.err;
  const Json gpu = Json::parse(doctor.out)["gpu"];
  if (!gpu.contains("problem")) GTEST_SKIP() << "the driver is not Mesa's";
  EXPECT_EQ(std::string(gpu["problem"]).find(name + " has OpenGL 4.3"), 0u) << gpu;
  const auto render = [&](const std::string& device) {
    return runFoci({"render", "study.toml", "--device", device, "--out", "a.png"}, folder.path(),
                   old);
  };
  const Outcome refused = render("gpu");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(refused.err, "foci: render.device = \"gpu\": " + std::string(gpu["problem"]) + "\n");
  EXPECT_EQ(render("auto").exit_code, 0);
}

TEST_F(OnTheGpu, AReplayWarnsOfARecordThatChangedItsDevice) {
  const auto replay = [&](const std::string& recorded) {
    folder.write("study.toml", smallStudy() + "\n[record]\ndevice = \"" + recorded + "\"\n");
    const Outcome outcome = runFoci(
        {"replay", "study.toml", "--device", "gpu", "--out", "out", "--overwrite"}, folder.path());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.err.find("the run was rendered on " + recorded) != std::string::npos;
  };
  const Outcome doctor = runFoci({"doctor", "--json"}, folder.path());
  const std::string device =
      name + ", driver " + std::string(Json::parse(doctor.out)["gpu"]["driver"]);
  EXPECT_FALSE(replay(device));
  EXPECT_TRUE(replay(device + ", then the CPU"));
  EXPECT_TRUE(replay("the CPU, then " + device));
}

TEST_F(OnTheGpu, AnUnknownDeviceIsRefused) {
  const Outcome outcome =
      runFoci({"render", "study.toml", "--device", "tpu", "--out", "a.png"}, folder.path());
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("expected one of \"auto\" \"gpu\" \"cpu\""), std::string::npos)
      << outcome.err;
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
