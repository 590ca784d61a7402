// The readers of Gaussians on files that the test writes, and on damaged ones.
#include "render/scene/io/gaussian_formats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/harmonics.h"
#include "render/scene/io/open_scene.h"
#include "tests/temporary_folder.h"
#include "tests/unit/render/read_gaussians.h"
#include "tests/unit/render/scene/io/gaussian_files_ply.h"
#include "tests/unit/render/scene/io/gaussian_files_sog.h"
#include "tests/unit/render/scene/io/gaussian_files_spz.h"

namespace foci {
namespace FOCI_FILE {

struct Format {
  const char* name;
  int degree;
  std::string bytes;
  /// Steps of the format: of position, relative of deviations, of rotation, of colour, of
  /// harmonics.
  float position, sigma, rotation, color, harmonics;
};

std::vector<Format> formats() {
  constexpr float kByte = 1.0f / 255.0f, kFine = 1e-5f, kStep = kHarmonicsStep;
  std::vector<Format> all;
  for (int degree = 0; degree <= 3; ++degree) {
    all.push_back({"PLY", degree, gaussianPly(degree), kFine, kFine, kFine, kFine, kStep});
    all.push_back({"compressed PLY", degree, compressedPly(degree, true), kFine, kFine, 2e-3f,
                   kByte, 8.0f / 256.0f});
    for (const unsigned version : {1u, 2u, 3u}) {
      all.push_back(
          {"SPZ", degree, spzFile(version, degree), 2e-3f, 0.04f, 0.01f, 0.01f, 1.0f / 128.0f});
    }
    all.push_back(
        {"SPZ", degree, gzipped(spzFile(3, degree)), 3e-4f, 0.04f, 2e-3f, 0.01f, 1.0f / 128.0f});
    all.push_back({"SPZ", degree, spz4File(degree), 3e-4f, 0.04f, 2e-3f, 0.01f, 1.0f / 128.0f});
    all.push_back({"KSPLAT", degree, ksplatFile(0, degree), kFine, kFine, kFine, kByte, kStep});
    for (const std::string& sog : {sogFile(degree), zip(sogFolder(degree))}) {
      all.push_back({"SOG", degree, sog, 2e-4f, kFine, 0.01f, kFine, kStep});
    }
    for (const unsigned mode : {1u, 2u}) {
      all.push_back({"KSPLAT", degree, ksplatFile(mode, degree), 2e-4f, 1e-3f, 1e-3f, kByte,
                     mode == 1 ? 2.0f * kStep : 1.0f / 127.0f});
    }
  }
  all.push_back({"compressed PLY", 0, compressedPly(0, false), kFine, kFine, 2e-3f, kByte, 0.0f});
  all.push_back({"splat", 0, splatFile(), kFine, kFine, 0.01f, kByte, 0.0f});
  return all;
}

TEST(GaussianFormats, AreReadByTheirContent) {
  const TemporaryFolder folder;
  for (const Format& format : formats()) {
    SCOPED_TRACE(std::string(format.name) + " of degree " + std::to_string(format.degree));
    const auto file = readGaussians(folder.write("scene.bin", format.bytes));
    ASSERT_TRUE(file);
    EXPECT_EQ(file->format, format.name);
    const GaussianCloud& cloud = file->cloud;
    ASSERT_EQ(cloud.size(), 2u);
    ASSERT_EQ(cloud.degree, format.degree);
    EXPECT_EQ(file->dropped, 0u);
    EXPECT_NEAR(cloud.position_m[1].z, kPosition.z + 1.0f, 2.0f * format.position);
    EXPECT_NEAR(cloud.opacity[0], kOpacity, 2e-3f);
    const Covariance3 expected = covarianceOf(kSigma, kRotation), v = cloud.covariance_m2[0];
    // Axes of 0.1 and 0.4 at most: errors of sigma and rotation, both doubled by the square.
    const float slack = 0.16f * 2.0f * (format.sigma + format.rotation);
    EXPECT_NEAR(v.xx, expected.xx, slack);
    EXPECT_NEAR(v.xy, expected.xy, slack);
    EXPECT_NEAR(v.xz, expected.xz, slack);
    EXPECT_NEAR(v.yy, expected.yy, slack);
    EXPECT_NEAR(v.yz, expected.yz, slack);
    EXPECT_NEAR(v.zz, expected.zz, slack);
    EXPECT_GT(v.xx, 2.0f * v.yy);  // the turn by 90 degrees
    for (int channel = 0; channel < 3; ++channel) {
      EXPECT_NEAR(cloud.position_m[0][channel], kPosition[channel], format.position);
      EXPECT_NEAR(cloud.color[0][channel], kColor[channel], format.color);
    }
    for (int k = 0; k < harmonicsOf(format.degree); ++k) {
      for (int channel = 0; channel < 3; ++channel) {
        const std::size_t second = cloud.harmonicsPerGaussian();
        const auto at =
            second + 3 * static_cast<std::size_t>(k) + static_cast<std::size_t>(channel);
        EXPECT_NEAR(kHarmonicsStep * cloud.harmonics[at], coefficient(channel, k),
                    format.harmonics);
      }
    }
  }
}

TEST(GaussianFormats, SpzStatesTheWayOfItsAxes) {
  // Names of the directions of x, y and z, by number (nianticlabs/spz, CoordinateSystem).
  const std::vector<std::string> systems = {"",    "LDB", "RDB", "LUB", "RUB", "LDF",
                                            "RDF", "LUF", "RUF", "LBD", "RBD", "LBU",
                                            "RBU", "LFD", "RFD", "LFU", "RFU"};
  const TemporaryFolder folder;
  const GaussianCloud base = readGaussians(folder.write("base.spz", spz4File(3)))->cloud;
  for (unsigned number = 1; number < systems.size(); ++number) {
    SCOPED_TRACE(systems[number]);
    const auto turned = [&](const glm::vec3& v) {  // to right, up, back
      glm::vec3 out(0.0f);
      for (int i = 0; i < 3; ++i) {
        const char way = systems[number][static_cast<std::size_t>(i)];
        if (way == 'L' || way == 'R') out.x = way == 'R' ? v[i] : -v[i];
        if (way == 'U' || way == 'D') out.y = way == 'U' ? v[i] : -v[i];
        if (way == 'F' || way == 'B') out.z = way == 'B' ? v[i] : -v[i];
      }
      return out;
    };
    const auto file = readGaussians(folder.write("axes.spz", spz4File(3, number)));
    const GaussianCloud& cloud = file->cloud;
    EXPECT_TRUE(file->y_is_up);
    EXPECT_EQ(cloud.position_m[1], turned(base.position_m[1]));
    // What is seen, and how far it reaches, along directions that turn with the scene.
    for (const glm::vec3& d :
         {glm::vec3(1, 0, 0), glm::vec3(0, 0.6f, 0.8f), glm::vec3(-0.48f, 0.6f, 0.64f)}) {
      const auto reach = [](const Covariance3& v, const glm::vec3& e) {
        return glm::dot(e, glm::mat3(v.xx, v.xy, v.xz, v.xy, v.yy, v.yz, v.xz, v.yz, v.zz) * e);
      };
      EXPECT_NEAR(reach(cloud.covariance_m2[0], turned(d)), reach(base.covariance_m2[0], d), 1e-6f);
      EXPECT_LT(glm::distance(colorOf(cloud, 0, turned(d)), colorOf(base, 0, d)), 5e-3f);
    }
  }
}

TEST(GaussianFormats, OfDegree4TheFirstThreeAreShown) {
  const TemporaryFolder folder;
  const auto file = readGaussians(folder.write("four.spz", spz4File(4)));
  ASSERT_EQ(file->cloud.degree, 3);
  ASSERT_EQ(file->remarks.size(), 1u);
  EXPECT_NE(file->remarks[0].find("degree 4: degrees 0 to 3 are shown"), std::string::npos);
  for (int k = 0; k < harmonicsOf(3); ++k) {
    const auto at = file->cloud.harmonicsPerGaussian() + 3 * static_cast<std::size_t>(k);
    EXPECT_NEAR(kHarmonicsStep * file->cloud.harmonics[at], coefficient(0, k), 1.0f / 128.0f);
  }
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

/// The Gaussians of a PLY as text, a record in each line of `rows`.
GaussianFile readRows(const std::vector<std::string>& properties, const std::string& rows,
                      const std::string& comments = "") {
  std::string text = "ply\nformat ascii 1.0\n" + comments + "element vertex " +
                     std::to_string(std::count(rows.begin(), rows.end(), '\n')) + "\n";
  for (const std::string& property : properties) text += "property " + property + "\n";
  const TemporaryFolder folder;
  return *readGaussians(folder.write("rows.ply", text + "end_header\n" + rows));
}

const std::vector<std::string> kRest = {"float opacity", "float rot_0", "float rot_1",
                                        "float rot_2", "float rot_3"};

std::vector<std::string> withRest(std::vector<std::string> first) {
  first.insert(first.end(), kRest.begin(), kRest.end());
  return first;
}

TEST(GaussianFormats, DiscsHaveNoThirdScale) {
  const GaussianFile file =
      readRows(withRest({"float x", "float y", "float z", "float f_dc_0", "float f_dc_1",
                         "float f_dc_2", "float scale_0", "float scale_1"}),
               "1 2 3 0 0 0 -1 -2 5 1 0 0 0\n");
  const Covariance3& v = file.cloud.covariance_m2.at(0);
  EXPECT_NEAR(v.xx, std::exp(-2.0f), 1e-6f);
  EXPECT_NEAR(v.yy, std::exp(-4.0f), 1e-6f);
  EXPECT_LT(v.zz, 1e-12f);
  EXPECT_EQ(file.format, "PLY of 2D Gaussians");
}

TEST(GaussianFormats, ColoursMayBeRedGreenBlue) {
  const auto colors = [](const char* type, const char* values) {
    const std::string t = type;
    return readRows(withRest({"float x", "float y", "float z", t + " red", t + " green",
                              t + " blue", "float scale_0", "float scale_1", "float scale_2"}),
                    std::string("1 2 3 ") + values + " -1 -1 -1 5 1 0 0 0\n")
        .cloud.color.at(0);
  };
  const glm::vec3 expected(1.0f, 51.0f / 255.0f, 0.0f);
  EXPECT_LT(glm::distance(colors("uchar", "255 51 0"), expected), 1e-6f);
  EXPECT_LT(glm::distance(colors("int", "255 51 0"), expected), 1e-6f);
  EXPECT_LT(glm::distance(colors("float", "255 51 0"), expected), 1e-6f);
  EXPECT_LT(glm::distance(colors("float", "1 0.2 0"), expected), 1e-6f);
}

const std::vector<std::string> kPlain =
    withRest({"float x", "float y", "float z", "float f_dc_0", "float f_dc_1", "float f_dc_2",
              "float scale_0", "float scale_1", "float scale_2"});

TEST(GaussianFormats, CommentsStateTheLowPass) {
  const auto preserves = [](const std::string& comments) {
    return readRows(kPlain, "1 2 3 0 0 0 -1 -1 -1 5 1 0 0 0\n", comments).cloud.preserves_light;
  };
  EXPECT_FALSE(preserves(""));
  EXPECT_TRUE(preserves("comment Exported from Brush\ncomment SplatRenderMode: mip\n"));
  EXPECT_FALSE(preserves("comment SplatRenderMode: default\n"));
  EXPECT_TRUE(preserves("comment antialiased 1\n"));
  EXPECT_FALSE(preserves("comment antialiased 0\n"));
  EXPECT_TRUE(preserves("comment   SPLATRENDERMODE:  MIP  \n"));
  EXPECT_FALSE(preserves("comment antialiased 1\ncomment SplatRenderMode: default\n"));
  EXPECT_TRUE(preserves("comment SplatRenderMode: default\ncomment antialiased 1\n"));
  const TemporaryFolder folder;
  const std::string packed = replaced(compressedPly(0, true), "element chunk",
                                      "comment SplatRenderMode: mip\nelement chunk");
  EXPECT_TRUE(readGaussians(folder.write("p.ply", packed))->cloud.preserves_light);
}

TEST(GaussianFormats, TheFilterOfMipSplattingWidensAndKeepsLight) {
  std::vector<std::string> properties = kPlain;
  properties.emplace_back("float filter_3D");
  const GaussianFile file =
      readRows(properties, "1 2 3 0 0 0 " + std::to_string(std::log(0.3f)) + " " +
                               std::to_string(std::log(0.4f)) + " " +
                               std::to_string(std::log(0.3f)) + " 0 1 0 0 0 0.4\n");
  const Covariance3& v = file.cloud.covariance_m2.at(0);
  EXPECT_NEAR(v.xx, 0.25f, 1e-5f);  // 0.3^2 + 0.4^2
  EXPECT_NEAR(v.yy, 0.32f, 1e-5f);
  EXPECT_NEAR(file.cloud.opacity.at(0), 0.5f * 0.6f * 0.6f * std::sqrt(0.5f), 1e-5f);
  EXPECT_TRUE(file.cloud.preserves_light);
}

TEST(GaussianFormats, ThoseOfTimeAndOfNetworksAreNamed) {
  std::vector<std::string> properties = kPlain;
  properties.emplace_back("float trbf_center");
  const GaussianFile file = readRows(properties, "1 2 3 0 0 0 -1 -1 -1 5 1 0 0 0 0.5\n");
  EXPECT_NE(file.remarks.at(0).find("change in time (property trbf_center)"), std::string::npos);
  properties.back() = "float f_anchor_feat_0";
  try {
    readRows(properties, "1 2 3 0 0 0 -1 -1 -1 5 1 0 0 0 0.5\n");
    FAIL() << "read";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("Scaffold-GS"), std::string::npos) << error.what();
  }
}

TEST(GaussianFormats, MistakesOfExportersAreNamed) {
  const auto remarks = [](const char* scales, const char* opacity) {
    std::string rows;
    for (int i = 0; i < 100; ++i) {
      const std::string place =
          std::to_string(0.1 * (i % 10)) + " " + std::to_string(0.1 * (i / 10));
      rows +=
          place + (i % 2 == 0 ? " 0" : " 0.02") + " 0 0 0 " + scales + " " + opacity + " 1 0 0 0\n";
    }
    std::string all;
    for (const std::string& remark : readRows(kPlain, rows).remarks) all += remark + "\n";
    return all;
  };
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_EQ(remarks("-3 -3 -3", "2"), "");
  EXPECT_TRUE(has(remarks("-3 -3 -3", "0.9"), "without the logit"));
  const std::string linear = remarks("0.3 0.3 0.3", "2");
  EXPECT_TRUE(has(linear, "all scales are positive as if they were stored without the logarithm"));
  EXPECT_EQ(std::count(linear.begin(), linear.end(), '\n'), 1)
      << "one remark is enough: " << linear;
  const std::string both = remarks("0.3 0.3 0.3", "0.9");
  EXPECT_TRUE(has(both, "all opacities 0 to 1"));
  EXPECT_EQ(std::count(both.begin(), both.end(), '\n'), 1) << both;
}

TEST(GaussianFormats, PlyOfDegree4ShowsThree) {
  std::vector<std::string> properties = kPlain;
  std::string row = "1 2 3 0 0 0 -1 -1 -1 5 1 0 0 0";
  for (int i = 0; i < 72; ++i) {
    properties.push_back("float f_rest_" + std::to_string(i));
    row += " " + std::to_string(0.01 * i);
  }
  const GaussianFile file = readRows(properties, row + "\n");
  ASSERT_EQ(file.cloud.degree, 3);
  EXPECT_EQ(file.remarks.at(0), kDegree4);
  // By channel in the file: green of the second coefficient is the 26th.
  EXPECT_NEAR(kHarmonicsStep * file.cloud.harmonics.at(4), 0.25f, kHarmonicsStep);
}

TEST(GaussianFormats, ALineSaysThatNoneIsSeen) {
  const TemporaryFolder folder;
  std::string ply = gaussianPly(0);
  const float invisible = -20.0f;  // a logit
  const std::size_t record = 15 * sizeof(float), opacity = 7 * sizeof(float);
  for (std::size_t end : {ply.size() - record, ply.size()}) {
    std::memcpy(ply.data() + end - record + opacity, &invisible, sizeof(float));
  }
  const auto file = readGaussians(folder.write("scene.ply", ply));
  ASSERT_TRUE(file);
  ASSERT_EQ(file->remarks.size(), 1u);
  EXPECT_NE(file->remarks[0].find("below 1/255"), std::string::npos);
  EXPECT_TRUE(readGaussians(folder.write("seen.ply", gaussianPly(0)))->remarks.empty());
}

TEST(GaussianFormats, ReadAFolderOfSogByItsMeta) {
  const TemporaryFolder folder;
  for (const auto& [name, bytes] : sogFolder(3)) folder.write(name, bytes);
  EXPECT_TRUE(isScene(folder.path() / "meta.json"));
  const auto read = readGaussians(folder.path() / "meta.json");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->format, "SOG");
  EXPECT_EQ(read->cloud.degree, 3);
  EXPECT_NEAR(read->cloud.opacity[0], kOpacity, 1e-5f);
  std::filesystem::remove(folder.path() / "u.webp");
  EXPECT_THROW(readGaussians(folder.path() / "meta.json"), InputError);
}

TEST(GaussianFormats, RefuseEveryShorterFileInOneLine) {
  const TemporaryFolder folder;
  for (const Format& format : formats()) {
    SCOPED_TRACE(std::string(format.name) + " of degree " + std::to_string(format.degree));
    const std::size_t size = format.bytes.size();
    // Some in the header, some beyond it.
    for (std::size_t length = 0; length < size; length += length < 512 ? 13 : size / 48 + 1) {
      const auto path = folder.write("short.bin", format.bytes.substr(0, length));
      try {
        const auto file = readGaussians(path);
        EXPECT_LT(file ? file->cloud.size() : 0u, 2u) << length;
      } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        EXPECT_EQ(std::string(error.what()).find(path.string()), 0u);
      }
    }
  }
}

/// The message of the reader, without the file's name.
std::string refusalOf(const std::string& bytes) {
  const TemporaryFolder folder;
  const auto path = folder.write("bad.bin", bytes);
  try {
    return readGaussians(path) ? "read" : "another format";
  } catch (const InputError& error) {
    return std::string(error.what()).substr(path.string().size() + 2);
  }
}

TEST(GaussianFormats, SayWhatIsWrong) {
  EXPECT_EQ(refusalOf(replaced(gaussianPly(0), "property float scale_1", "property float scale_9")),
            "element vertex: expected the property scale_1 of a Gaussian");
  EXPECT_EQ(refusalOf(replaced(gaussianPly(1), "f_rest_8", "f_other8")),
            "element vertex: has 8 properties f_rest: expected 0, 9, 24, 45 or 72, for degree 0 to "
            "4");
  for (const char* telling : {"f_dc_0", "scale_0", "rot_0"}) {
    EXPECT_EQ(refusalOf(replaced(gaussianPly(0), telling, "other")),
              std::string("element vertex: expected the property ") + telling + " of a Gaussian");
  }
  EXPECT_EQ(
      refusalOf(replaced(compressedPly(0, true), "property float max_b", "property float max_c")),
      "compressed PLY of Gaussians: expected an element chunk of float min_x, min_y, ... (12 "
      "or 18 properties)");
  EXPECT_EQ(refusalOf("NGSP" + std::string("\x05\0\0\0", 4) + std::string(60, '\0')),
            "is SPZ of version 5: expected version 1 to 4");
  EXPECT_EQ(refusalOf(sogFile(0, 3)), "is SOG of version 3: expected version 1 or 2");
  EXPECT_EQ(refusalOf(zip({{"meta.json", "{\"version\":2,\"count\":1e30}"}})),
            "meta.json: count: expected a whole number, found 1e+30");
  EXPECT_EQ(refusalOf(zip({{"meta.json", "{\"version\":2,\"count\":9}"}})),
            "meta.json: means/files/0: expected the name of an image, found nothing");
  EXPECT_EQ(refusalOf(zip({{"meta.json", "[{"}})),
            "meta.json: expected the JSON of a SOG of version 1 or 2");
  EXPECT_EQ(
      refusalOf("{\"means\":{\"shape\":[9,3],\"files\":[\"../l.webp\"]},\"quats\":0,\"sh0\":0}"),
      "names the image ../l.webp: expected one in its folder");
  EXPECT_EQ(refusalOf(zip({{"model.usd", "another scene"}})),
            "is a ZIP archive that begins with \"model.usd\": unpack it, and give the scene in it");
  std::string flipped = sogFile(0);
  const std::size_t pixels = flipped.find("WEBPVP8L") + 24;
  flipped[pixels] = static_cast<char>(flipped[pixels] ^ 0x55);
  EXPECT_EQ(refusalOf(flipped), "is damaged: l.webp");
  std::string many = spzFile(2, 0);
  many[11] = '\x7f';
  EXPECT_NE(refusalOf(many).find("Gaussians in"), std::string::npos);
  std::string damaged = spz4File(0);
  damaged.back() = static_cast<char>(damaged.back() ^ 0x55);
  damaged[damaged.size() - 8] = static_cast<char>(damaged[damaged.size() - 8] ^ 0x55);
  EXPECT_NE(refusalOf(damaged), "another format");
  std::string packed = gzipped(spzFile(3, 1));
  EXPECT_NE(refusalOf(packed.substr(0, packed.size() - 20)).find("is damaged"), std::string::npos);
}

TEST(GaussianFormats, NameTheKeyOfASogThatIsWrong) {
  const auto refusal = [](const char* what, const char* by) {
    SogMembers members = sogFolder(1);
    members[0].second = replaced(members[0].second, what, by);
    return refusalOf(zip(members));
  };
  EXPECT_EQ(refusal("\"scales\":{\"shape\":[2,3],\"mins\"", "\"scales\":{\"least\""),
            "meta.json: scales/mins: expected a list of 3 numbers, found nothing");
  EXPECT_EQ(refusal("\"mins\":[0.000000", "\"mins\":[null"),
            "meta.json: means/mins: expected a list of 3 numbers, found a list of 3: "
            "[null,-1.098612,1.386294]");
  EXPECT_EQ(refusal("\"q.webp\"", "7"),
            "meta.json: quats/files/0: expected the name of an image, found 7");
  EXPECT_EQ(refusal("-4.0", "true"), "meta.json: shN/mins: expected a number, found true");
  EXPECT_EQ(refusal("{\"means\"", "{\"antialias\":1,\"means\""),
            "meta.json: antialias: expected true or false, found 1");
}

TEST(GaussianFormats, BucketsOfAKsplatHoldItsGaussians) {
  for (const unsigned mode : {1u, 2u}) {
    std::string file = ksplatFile(mode, 0);
    file[4096 + 36] = '\0';  // partly filled buckets
    EXPECT_EQ(refusalOf(file), "a section is damaged: 2 Gaussians, and 0 in its buckets");
  }
}

TEST(GaussianFormats, SayWhatIsWrongWithADamagedFileOfTheirExtension) {
  const TemporaryFolder folder;
  const auto refusal = [&](const char* name, const std::string& bytes) -> std::string {
    try {
      readGaussians(folder.write(name, bytes));
      return "read";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  std::string record(32, '\0');
  record[28] = static_cast<char>(255);  // a rotation of length 1: w, 0, 0, 0
  for (const std::size_t at : {29u, 30u, 31u}) record[at] = static_cast<char>(128);
  const std::string four = record + record + record + record;
  EXPECT_EQ(refusal("a.splat", four), "read");
  EXPECT_TRUE(has(refusal("a.splat", four + "cut"), "is cut off: 131 bytes"));
  std::string one_bad = four;
  one_bad[28] = static_cast<char>(128);
  EXPECT_EQ(refusal("a.splat", one_bad), "read");
  EXPECT_TRUE(has(refusal("a.splat", std::string(96, 'x')), "is no .splat file"));
  EXPECT_TRUE(has(refusal("a.splat", ""), "is no .splat file"));
  EXPECT_TRUE(has(refusal("a.spz", std::string(99, 'x')), "is no SPZ file: expected NGSP"));
  EXPECT_TRUE(has(refusal("a.ksplat", std::string(9999, 'x')), "is no .ksplat file"));
  const std::string packed = gzipped(spzFile(3, 1));
  EXPECT_TRUE(has(refusal("a.sog", sogFile(1).substr(0, 40)), "a.sog: "));
  EXPECT_TRUE(has(refusal("a.spz", packed.substr(0, packed.size() - 20)), "the file ends before"));
}

/// The file with one Gaussian more for each of `further`, which have this property and are else as
/// the first. All are of this type and in this format.
std::string plyOf(const std::string& format, const std::string& type, const std::string& property,
                  const std::vector<double>& further) {
  const std::string little = gaussianPly(1);
  const std::size_t end = little.find("end_header\n") + 11;
  std::string header = replaced(little.substr(0, end), "binary_little_endian", format);
  header = replaced(header, "vertex 2", "vertex " + std::to_string(2 + further.size()));
  std::vector<std::string> names;
  for (std::size_t at = 0; (at = header.find("property float ", at)) != std::string::npos;) {
    header.replace(at + 9, 5, type);
    at += 10 + type.size();
    names.push_back(header.substr(at, header.find('\n', at) - at));
  }
  std::string file = header;
  for (std::size_t i = 0; i < 2 + further.size(); ++i) {
    for (std::size_t k = 0; k < names.size(); ++k) {
      float stored = 0.0f;
      std::memcpy(&stored, little.data() + end + 4 * (k + (i == 1 ? names.size() : 0)), 4);
      double value = stored;
      if (i >= 2 && names[k] == property) value = further[i - 2];
      std::string bytes;
      if (type == "double") {
        put(bytes, value);
      } else {
        put(bytes, static_cast<float>(value));
      }
      if (format == "binary_big_endian") std::reverse(bytes.begin(), bytes.end());
      file += format == "ascii" ? exactText(value) + " " : bytes;
    }
    if (format == "ascii") file += "\n";
  }
  return file;
}

TEST(GaussianFormats, PlyIsReadInEveryFormat) {
  const TemporaryFolder folder;
  const auto expected = readGaussians(folder.write("a.ply", gaussianPly(1)));
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    for (const char* type : {"float", "double"}) {
      const auto read = readGaussians(folder.write("b.ply", plyOf(format, type, "", {})));
      ASSERT_TRUE(read) << format;
      EXPECT_EQ(read->cloud.position_m, expected->cloud.position_m) << format << type;
      EXPECT_EQ(read->cloud.covariance_m2, expected->cloud.covariance_m2) << format << type;
      EXPECT_EQ(read->cloud.harmonics, expected->cloud.harmonics) << format << type;
    }
  }
  const std::string ascii = plyOf("ascii", "float", "", {});
  EXPECT_NE(refusalOf(ascii.substr(0, ascii.size() - 5) + "x\n").find("expected a number, found"),
            std::string::npos);
}

TEST(GaussianFormats, InfinityInDoublesIsNotFinite) {
  const double inf = std::numeric_limits<double>::infinity();
  const TemporaryFolder folder;
  for (const char* property : {"x", "f_dc_1", "f_rest_4", "scale_2"}) {
    const auto read = readGaussians(
        folder.write("inf.ply", plyOf("binary_little_endian", "double", property, {inf, 0.5})));
    EXPECT_EQ(read->cloud.size(), 3u) << property;
    EXPECT_EQ(read->dropped, 1u) << property;
  }
}

TEST(GaussianFormats, CoordinatesOfAMapKeepTheirDetail) {
  const TemporaryFolder folder;
  const std::vector<double> places = {500000.001, 500000.002};
  const auto read = [&](const char* type) {
    // Without the two Gaussians near the origin.
    std::string file = plyOf("ascii", type, "x", places);
    file = replaced(file, "vertex 4", "vertex 2");
    const std::size_t end = file.find("end_header\n") + 11;
    const std::size_t third = file.find('\n', file.find('\n', end) + 1) + 1;
    return *readGaussians(folder.write("map.ply", file.erase(end, third - end)));
  };
  const GaussianFile fine = read("double"), coarse = read("float");
  EXPECT_NEAR(fine.cloud.position_m[0].x, 0.001f, 1e-7f);
  EXPECT_NEAR(fine.cloud.position_m[1].x, 0.002f, 1e-7f);
  EXPECT_EQ(fine.remarks, (std::vector<std::string>{"positions are relative to 500000 0 0 of the "
                                                    "file, to keep their millimetres"}));
  ASSERT_EQ(coarse.remarks.size(), 1u);
  EXPECT_NE(coarse.remarks[0].find("floats lose their detail"), std::string::npos);
}

TEST(GaussianFormats, LeaveOutGaussiansThatAreNotFinite) {
  std::string file = gaussianPly(0);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(file.data() + file.find("end_header\n") + 11, &nan, sizeof(nan));
  const TemporaryFolder folder;
  const auto read = readGaussians(folder.write("nan.ply", file));
  EXPECT_EQ(read->cloud.size(), 1u);
  EXPECT_EQ(read->dropped, 1u);
}

TEST(GaussianFormats, OtherFilesAreNotTakenForThem) {
  const TemporaryFolder folder;
  // Small floats, and bytes that would be a quaternion of length 1.
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1HHH";
  for (const std::string& bytes : {std::string(64, 'x'), std::string(320, '\0'), obj}) {
    EXPECT_FALSE(isSplatFile(folder.write("a", bytes)));
  }
  EXPECT_FALSE(readGaussians(
      folder.write("d.ply",
                   "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                   "property float z\nend_header\n0 0 0\n")));
}

TEST(GaussianFormats, OpenAsAScene) {
  const TemporaryFolder folder;
  const OpenedScene scene = openScene(folder.write("s.ply", gaussianPly(1)), 0.5, {});
  ASSERT_TRUE(scene.scene.gaussians());
  EXPECT_EQ(scene.scene.position_m()[0], 0.5f * kPosition);
  EXPECT_NEAR(scene.scene.gaussians()->covariance_m2[0].zz, 0.25f * 0.16f, 1e-5f);
  EXPECT_THROW(openPoints(readScene(folder.path() / "s.ply"), 1.0), InputError);
}

}  // namespace FOCI_FILE
}  // namespace foci
