// Guides as other programs lay them out: view layers, parts, data windows, backgrounds, filtered rims, and normals that
// are not of length 1.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "core/io/guide_file.h"
#include "tests/support/guide_files.h"
#include "tests/support/numbers.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

TEST(GuideFile, OneOfSeveralViewLayers) {
  const TemporaryFolder folder;
  WriteExr(folder / "two.exr", OIIO::ImageSpec(3, 2, 1, OIIO::TypeDesc::FLOAT),
           {"A", "Back.Normal.X", "Back.Normal.Y", "Back.Normal.Z", "View 1.2.N.X", "View 1.2.N.Y", "View 1.2.N.Z"},
           [](std::size_t c, std::size_t) { return c == 0 || c == 1 || c == 6 ? 1.0f : 0.0f; });
  ExpectRefusal(ReadGuides(folder / "two.exr", OnlyNormals()), ErrorKind::kInput,
                {"two.exr", "several view layers", "'Back'", "'View 1.2'", "--view-layer"});
  const auto info = InspectGuides(folder / "two.exr");
  ASSERT_TRUE(info) << info.error().message;
  EXPECT_EQ(info->layers.size(), 2u) << "looking at it needs no choice";
  EXPECT_TRUE(info->layers.at("View 1.2").Has(Layer::kNormal));
  ExpectRefusal(ReadGuides(folder / "two.exr", OnlyNormals("Front")), ErrorKind::kInput,
                {"'Front'", "'Back'", "'View 1.2'"});
  const auto back = ReadGuides(folder / "two.exr", OnlyNormals("Back"));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->Vec3(Layer::kNormal, 5), glm::vec3(1, 0, 0));
  const auto view = ReadGuides(folder / "two.exr", OnlyNormals("View 1.2"));
  ASSERT_TRUE(view) << view.error().message;
  EXPECT_EQ(view->Vec3(Layer::kNormal, 5), glm::vec3(0, 0, 1));
}

TEST(GuideFile, ALayerIsNeverPutTogetherFromTwoViewLayers) {
  const TemporaryFolder folder;
  WriteExr(folder / "mixed.exr", OIIO::ImageSpec(2, 2, 1, OIIO::TypeDesc::FLOAT),
           {"A", "P.X", "P.Y", "P.Z", "View.Normal.X", "View.Normal.Y", "View.Normal.Z", "View.P.X"},
           [](std::size_t c, std::size_t) { return c == 0 || c == 6 ? 1.0f : static_cast<float>(c); });
  GuideReadOptions options = OnlyNormals();
  options.optional = {Layer::kPosition};
  auto read = ReadGuides(folder / "mixed.exr", options);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_FALSE(read->Has(Layer::kPosition)) << "View's position is incomplete, the other one is of something else";
}

// Coverage in a part of 3×2 pixels, normals in another that holds the lower row only.
void WriteTwoParts(const std::filesystem::path& path, const std::string& part = "shape",
                   const std::vector<std::string>& channels = {"normal.X", "normal.Y", "normal.Z"}) {
  std::vector<OIIO::ImageSpec> specs = {OIIO::ImageSpec(3, 2, 1, OIIO::TypeDesc::FLOAT),
                                        OIIO::ImageSpec(3, 1, 3, OIIO::TypeDesc::FLOAT)};
  specs[0].channelnames = {"A"};
  specs[0].attribute("oiio:subimagename", "cover");
  specs[1].channelnames = channels;
  specs[1].attribute("oiio:subimagename", part);
  specs[1].y = 1;
  specs[1].full_height = 2;
  auto output = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(output->open(path.string(), 2, specs.data())) << output->geterror();
  const std::vector<float> coverage = {0, 0, 0, 1, 1, 1}, normals = {0, 1, 0, 0, 1, 0, 0, 1, 0};
  ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, coverage.data())) << output->geterror();
  ASSERT_TRUE(output->open(path.string(), specs[1], OIIO::ImageOutput::AppendSubimage)) << output->geterror();
  ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, normals.data())) << output->geterror();
  ASSERT_TRUE(output->close());
}

TEST(GuideFile, PartsOfOneFileBelongTogether) {
  const TemporaryFolder folder;
  WriteTwoParts(folder / "parts.exr");
  WriteTwoParts(folder / "N.exr", "N", {"X", "Y", "Z"});  // Z by itself would be depth
  WriteTwoParts(folder / "colors.exr", "normals", {"R", "G", "B"});
  for (const char* const name : {"parts.exr", "N.exr", "colors.exr"}) {
    const auto read = ReadGuides(folder / name, OnlyNormals());
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->height(), 2);
    EXPECT_FALSE(read->Has(Layer::kDepth));
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_EQ(read->Plane(Layer::kCoverage)[i], i < 3 ? 0.0f : 1.0f);
      EXPECT_EQ(read->Vec3(Layer::kNormal, i), glm::vec3(0, i < 3 ? 0 : 1, 0));
    }
  }
}

TEST(GuideFile, ADataWindowLandsWhereItBelongs) {
  const TemporaryFolder folder;
  OIIO::ImageSpec spec(3, 2, 1, OIIO::TypeDesc::FLOAT);
  spec.x = 14, spec.y = 21;
  spec.full_x = 10, spec.full_y = 20, spec.full_width = 8, spec.full_height = 5;
  WriteExr(folder / "crop.exr", spec, {"A", "normal.X", "normal.Y", "normal.Z", "albedo.R", "albedo.G", "albedo.B"},
           [](std::size_t c, std::size_t i) {
             return c == 0 || c == 3 ? 1.0f : c == 4 ? static_cast<float>(i + 1) : 0.0f;
           });
  GuideReadOptions options = OnlyNormals();
  options.required.Add(Layer::kAlbedo);
  const auto read = ReadGuides(folder / "crop.exr", options);
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->width(), 8);
  ASSERT_EQ(read->height(), 5);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 8; ++x) {
      const bool inside = x >= 4 && x < 7 && y >= 1 && y < 3;
      const std::size_t i = read->Index(x, y);
      EXPECT_EQ(read->Plane(Layer::kCoverage)[i], inside ? 1.0f : 0.0f) << x << ", " << y;
      EXPECT_EQ(read->Plane(Layer::kAlbedo)[i], inside ? static_cast<float>((y - 1) * 3 + x - 4 + 1) : 0.0f);
    }
  }
}

TEST(GuideFile, OverscanIsCutOff) {
  const TemporaryFolder folder;
  OIIO::ImageSpec spec(7, 6, 1, OIIO::TypeDesc::FLOAT);
  spec.x = -2, spec.y = -3;
  spec.full_x = 0, spec.full_y = 0, spec.full_width = 4, spec.full_height = 2;
  WriteExr(folder / "over.exr", spec, kNormalAndA, [](std::size_t c, std::size_t i) {
    return c == 0 ? static_cast<float>(i) / 64.0f : c == 3 ? 1.0f : 0.0f;
  });
  const auto read = ReadGuides(folder / "over.exr", OnlyNormals());
  ASSERT_TRUE(read) << read.error().message;
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 4; ++x) {
      EXPECT_EQ(read->Plane(Layer::kCoverage)[read->Index(x, y)], static_cast<float>((y + 3) * 7 + x + 2) / 64.0f);
    }
  }
}

// What a renderer leaves in its background is not looked at: it is infinitely far, and of no object.
TEST(GuideFile, BackgroundIsBackgroundWhateverItHolds) {
  const TemporaryFolder folder;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const OIIO::ImageSpec spec(3, 1, 1, OIIO::TypeDesc::FLOAT);
  for (const char* compression : {"zip", "dwaa"}) {  // the plain reader's, and the library's
    OIIO::ImageSpec one = spec;
    one.attribute("compression", compression);
    for (const float left : {0.0f, -1.0f, nan}) {
      WriteExr(folder / "sky.exr", one, {"A", "depth.Z", "normal.X", "normal.Y", "normal.Z", "object.ID", "albedo.R"},
               [&](std::size_t c, std::size_t i) {
                 const bool is_covered = i > 0;
                 if (c == 0) return is_covered ? 1.0f : 0.0f;
                 if (c == 6) return 0.5f;
                 return !is_covered ? left : c == 2 || c == 3 ? 0.0f : 1.0f;
               });
      GuideReadOptions options = OnlyNormals();
      options.required.Add(Layer::kDepth).Add(Layer::kObject);
      const auto read = ReadGuides(folder / "sky.exr", options);
      ASSERT_TRUE(read) << read.error().message;
      EXPECT_EQ(read->Plane(Layer::kDepth)[0], BackgroundValue(Layer::kDepth)) << compression << " " << left;
      EXPECT_EQ(read->Plane(Layer::kObject)[0], 0.0f) << compression << " " << left;
      EXPECT_EQ(read->Vec3(Layer::kNormal, 0), glm::vec3(0.0f)) << compression << " " << left;
      EXPECT_NEAR(read->Plane(Layer::kDepth)[1], 1.0f, 1e-3f);
    }
  }
}

// What pixel filters leave: coverage beside 0 and 1, and normals premultiplied by little coverage.
TEST(GuideFile, FilteredRimsAreTaken) {
  const TemporaryFolder folder;
  const auto read_with = [&](const char* compression, std::vector<float> coverage, std::vector<float> lengths) {
    OIIO::ImageSpec spec(static_cast<int>(coverage.size()), 1, 1, OIIO::TypeDesc::FLOAT);
    spec.attribute("compression", compression);
    WriteExr(folder / "rim.exr", spec, kNormalAndA, [&](std::size_t c, std::size_t i) {
      return c == 0 ? coverage[i] : c == 1 ? lengths[i] : 0.0f;
    });
    return ReadGuides(folder / "rim.exr", OnlyNormals());
  };
  for (const char* compression : {"zip", "dwaa"}) {  // the plain reader's, and the library's
    const auto read = read_with(compression, {std::nextafter(1.0f, 2.0f), 1.07f, 0.0625f, 0.001f, -0.03f},
                                {1.0f, 1.07f, 0.05f, 0.0005f, -0.03f});
    ASSERT_TRUE(read) << compression << ": " << read.error().message;
    const auto coverage = read->Plane(Layer::kCoverage);
    EXPECT_EQ(coverage[0], 1.0f);
    EXPECT_EQ(coverage[1], 1.0f);
    EXPECT_NEAR(coverage[2], 0.0625f, 1e-3f);
    EXPECT_EQ(coverage[4], 0.0f);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(read->Vec3(Layer::kNormal, i), glm::vec3(1, 0, 0)) << i;
    EXPECT_EQ(read->Vec3(Layer::kNormal, 4), glm::vec3(0.0f)) << "background";
    ExpectRefusal(read_with(compression, {2.0f}, {1.0f}), ErrorKind::kInput, {"layer A is outside 0 to 1"});
    ExpectRefusal(read_with(compression, {0.5f}, {0.0f}), ErrorKind::kInput, {"layer normal"});
  }
}

TEST(GuideFile, PackedNormalsAreRefused) {
  const TemporaryFolder folder;
  WriteExr(folder / "packed.exr", OIIO::ImageSpec(4, 4, 1, OIIO::TypeDesc::FLOAT), kNormalAndA,
           [](std::size_t c, std::size_t i) {
             const glm::vec3 n = glm::normalize(glm::vec3(0.3f * (i % 4) - 0.5f, 0.3f * (i / 4) - 0.5f, 1.0f));
             return c == 0 ? 1.0f : 0.5f + 0.5f * n[static_cast<int>(c) - 1];
           });
  ExpectRefusal(ReadGuides(folder / "packed.exr", OnlyNormals()), ErrorKind::kInput,
                {"packed.exr", "packed", "-1 to 1"});
}

TEST(GuideFile, ShortNormalsAreNormalisedAndZeroOnesRefused) {
  const TemporaryFolder folder;
  const auto read_with_length = [&](float length) {
    WriteExr(folder / "n.exr", OIIO::ImageSpec(2, 1, 1, OIIO::TypeDesc::FLOAT), kNormalAndA,
             [=](std::size_t c, std::size_t i) { return c == 0       ? 1.0f
                                                        : c == 1 + i ? length
                                                                     : 0.0f; });
    return ReadGuides(folder / "n.exr", OnlyNormals());
  };
  for (float length : {1.0f, 0.9985f, 0.9f, 0.5f, 0.2f, 2.0f, 9.0f}) {
    const auto read = read_with_length(length);
    ASSERT_TRUE(read) << length << ": " << read.error().message;
    // 0.9985 is what half floats may leave of a unit vector; it is kept or made 1, either is a unit normal.
    const float tolerance = std::fabs(length - 1.0f) < 0.002f ? 0.002f : 1e-6f;
    EXPECT_NEAR(glm::length(read->Vec3(Layer::kNormal, 0)), 1.0f, tolerance) << length;
    EXPECT_NEAR(read->Vec3(Layer::kNormal, 1).y, 1.0f, tolerance) << length;
  }
  for (float bad : {0.0f, 0.01f, 20.0f, kInfinity, std::numeric_limits<float>::quiet_NaN()}) {
    ExpectRefusal(read_with_length(bad), ErrorKind::kInput, {"n.exr", "layer normal", "2 pixels, first at (0, 0)"});
  }
}

TEST(GuideFile, ABlenderFileWithoutPositionsIsRefusedInWords) {
  const TemporaryFolder folder;
  const std::vector<std::string> passes = {"ViewLayer.Combined.R", "ViewLayer.Combined.A", "ViewLayer.Normal.X",
                                           "ViewLayer.Normal.Y",   "ViewLayer.Normal.Z",   "ViewLayer.Depth.Z"};
  OIIO::ImageSpec spec(2, 2, 1, OIIO::TypeDesc::FLOAT);
  const auto one = [](std::size_t, std::size_t) { return 1.0f; };
  WriteExr(folder / "combined.exr", spec, passes, one);
  spec.attribute("Software", "Blender 3.4.1 (Release)");
  WriteExr(folder / "software.exr", spec, kNormalAndA, one);
  for (const char* name : {"combined.exr", "software.exr"}) {
    ExpectRefusal(ReadGuides(folder / name, OnlyNormals()), ErrorKind::kInput,
                  {name, "Blender", "holds no camera", "the pass Position", "View Layer > Passes", "--camera FILE"});
  }
  ExpectRefusal(ReadGuides(folder / "combined.exr"), ErrorKind::kInput, {"Cryptomatte Object"});
  EXPECT_TRUE(InspectGuides(folder / "combined.exr")) << "looking at it is no harm";
}

}  // namespace
}  // namespace scumble
