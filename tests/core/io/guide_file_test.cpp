// Guides through EXR files: no loss, and a clear refusal of every file that is no guide file.
#include "core/io/guide_file.h"

#include <Imath/half.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "core/image/hash.h"
#include "core/io/file/atomic_file.h"
#include "core/io/format_dispatch.h"
#include "core/io/guides/cryptomatte.h"
#include "core/io/guides/guide_header.h"
#include "core/io/guides/own_guides.h"
#include "tests/support/guide_files.h"
#include "tests/support/numbers.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

// ---- round trips -----------------------------------------------------------------------------------------------

TEST(GuideFile, EveryLayerKeepsItsBitsAtOddSizes) {
  const TemporaryFolder folder;
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 97}, {97, 1}, {37, 23}, {130, 67}}) {
    const GuideSet guides = RandomGuides(width, height);
    ASSERT_TRUE(WriteGuides(folder / "g.exr", guides));
    const auto read = ReadGuides(folder / "g.exr", Everything());
    ASSERT_TRUE(read) << read.error().message;
    ExpectSameBits(*read, guides);
  }
  EXPECT_EQ(folder.List(), std::vector<std::string>{"g.exr"});
}

TEST(GuideFile, AllLosslessCompressionsKeepTheBits) {
  const TemporaryFolder folder;
  const GuideSet guides = RandomGuides(37, 23);
  for (const char* compression : {"none", "rle", "zips", "zip", "piz"}) {
    GuideWriteOptions options;
    options.compression = compression;
    ASSERT_TRUE(WriteGuides(folder / "g.exr", guides, options)) << compression;
    const auto file = OIIO::ImageInput::open((folder / "g.exr").string());
    ASSERT_TRUE(file);
    EXPECT_EQ(file->spec().get_string_attribute("compression"), compression);
    const auto read = ReadGuides(folder / "g.exr", Everything());
    ASSERT_TRUE(read) << compression << ": " << read.error().message;
    ExpectSameBits(*read, guides);
  }
}

TEST(GuideFile, LossyCompressionAndOtherEndingsAreRefused) {
  const TemporaryFolder folder;
  const GuideSet guides = RandomGuides(3, 3);
  for (const char* compression : {"pxr24", "b44", "b44a", "dwaa", "dwab", "dwaa:45", "ZIP", "", "zip:9"}) {
    GuideWriteOptions options;
    options.compression = compression;
    ExpectRefusal(WriteGuides(folder / "g.exr", guides, options), ErrorKind::kUsage,
                  {"'" + std::string(compression) + "'", "none, rle, zips, zip, piz"});
  }
  for (const char* name : {"g.png", "g", "g.exr.tif"}) {
    ExpectRefusal(WriteGuides(folder / name, guides), ErrorKind::kUsage, {name, ".exr"});
  }
  EXPECT_TRUE(folder.List().empty());
}

TEST(GuideFile, HalfRoundsColoursAsInMemoryAndLeavesDataAlone) {
  const TemporaryFolder folder;
  GuideSet guides = RandomGuides(37, 23);
  guides.Plane(Layer::kAlbedo)[0] = 1.0f / 3.0f;
  guides.Plane(Layer::kAlbedo)[1] = 1e-9f;
  guides.Plane(Layer::kLpeFull)[0] = 65504.0f;
  guides.Plane(Layer::kLpeFull)[1] = 70000.0f;  // beyond half floats: the brightest one, not infinity
  guides.Plane(Layer::kLpeFull)[2] = 3e38f;
  GuideWriteOptions options;
  options.half = true;
  ASSERT_TRUE(WriteGuides(folder / "g.exr", guides, options));
  const auto read = ReadGuides(folder / "g.exr", Everything());
  ASSERT_TRUE(read) << read.error().message;
  GuideSet rounded = guides;
  RoundColorLayersToHalf(rounded);
  ExpectSameBits(*read, rounded);
  EXPECT_EQ(rounded.Plane(Layer::kAlbedo)[0], 0.333251953125f);
  EXPECT_EQ(rounded.Plane(Layer::kAlbedo)[1], 0.0f);
  EXPECT_EQ(rounded.Plane(Layer::kLpeFull)[0], 65504.0f);
  EXPECT_EQ(rounded.Plane(Layer::kLpeFull)[1], 65504.0f);
  EXPECT_EQ(rounded.Plane(Layer::kLpeFull)[2], 65504.0f);
  for (const LayerInfo& info : AllLayers()) {
    for (int c = 0; c < ChannelCount(info.layer) && !info.is_color; ++c) {
      const auto a = rounded.Plane(info.layer, c), b = guides.Plane(info.layer, c);
      EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin())) << info.name;
    }
  }
  GuideSet twice = rounded;
  RoundColorLayersToHalf(twice);
  ExpectSameBits(twice, rounded);
}

// ---- the header ------------------------------------------------------------------------------------------------

TEST(GuideFile, NamesCameraAndAttributesSurvive) {
  const TemporaryFolder folder;
  GuideSet guides = RandomGuides(5, 4);
  guides.object_names = {{1, "plain"},          {2, "with spaces  and\ttab"},  {3, "two\nlines\n"},
                         {4, "back\\slash\\n"}, {5, "Käse · 球 · \U0001F3A8"}, {6, ""},
                         {7, " leading"},       {16777215, "last\\"}};
  guides.material_names = {{9, "\n"}, {10, "\\"}, {11, "a\r\nb"}};
  guides.attributes = {{"scumble:generator", "guidegen 0.1"}, {"scumble:note", "two\nlines, Käse"}};
  GuideCamera camera;
  camera.name = "Kamera 1\nmit Zeile";
  for (int i = 0; i < 16; ++i) {
    camera.view_from_world[i / 4][i % 4] = std::ldexp(1.0 + 1.0 / (3.0 + i), i * 7 - 50) * (i % 2 ? -1 : 1);
    camera.clip_from_view[i / 4][i % 4] = 1.0 / (7.0 + i);
  }
  camera.view_from_world[0][0] = 0.1;
  camera.view_from_world[0][1] = -0.0;
  camera.clip_from_view[3][3] = std::numeric_limits<double>::denorm_min();
  camera.clip_from_view[3][2] = std::numeric_limits<double>::max();
  guides.camera = camera;
  ASSERT_TRUE(WriteGuides(folder / "g.exr", guides));
  const auto read = ReadGuides(folder / "g.exr", Everything());
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->object_names, guides.object_names);
  EXPECT_EQ(read->material_names, guides.material_names);
  EXPECT_EQ(read->attributes, guides.attributes);
  ASSERT_TRUE(read->camera);
  EXPECT_EQ(read->camera->name, camera.name);
  EXPECT_EQ(std::memcmp(&read->camera->view_from_world, &camera.view_from_world, sizeof camera.view_from_world), 0);
  EXPECT_EQ(std::memcmp(&read->camera->clip_from_view, &camera.clip_from_view, sizeof camera.clip_from_view), 0);

  const auto info = InspectGuides(folder / "g.exr");
  ASSERT_TRUE(info) << info.error().message;
  EXPECT_EQ(info->width, 5);
  EXPECT_EQ(info->height, 4);
  EXPECT_EQ(info->layers.at(""), EveryLayer());
  EXPECT_EQ(info->header.object_names, guides.object_names);
  EXPECT_EQ(info->header.camera->name, camera.name);
  EXPECT_EQ(info->header.pixel_count(), 0u);
  EXPECT_NE(info->channels.find("normal.X"), std::string::npos);
}

// A point times a matrix as OpenEXR means it: row vectors, divided by w.
glm::dvec3 Through(const OIIO::ParamValue& matrix, glm::dvec3 p) {
  const float* m = static_cast<const float*>(matrix.data());
  glm::dvec4 result(0.0);
  for (int c = 0; c < 4; ++c) result[c] = p.x * m[c] + p.y * m[4 + c] + p.z * m[8 + c] + m[12 + c];
  return glm::dvec3(result) / result.w;
}

// By ImfStandardAttributes.h the camera looks down +Z, and (0, 0) to (1, 1) is the picture from its upper left corner.
TEST(GuideFile, OtherProgramsFindTheStandardMatrices) {
  const TemporaryFolder folder;
  GuideSet guides = RandomGuides(2, 2);
  guides.camera.emplace();
  guides.camera->view_from_world[3] = glm::dvec4(0, 0, -5, 1);  // the camera stands at (0, 0, 5)
  guides.camera->clip_from_view = glm::dmat4(2, 0, 0, 0, 0, 2, 0, 0, 0, 0, -1, -1, 0, 0, -0.2, 0);  // 90° would be 1
  ASSERT_TRUE(WriteGuides(folder / "g.exr", guides));
  const auto file = OIIO::ImageInput::open((folder / "g.exr").string());
  ASSERT_TRUE(file);
  const auto* view = file->spec().find_attribute("worldtocamera", OIIO::TypeMatrix);
  const auto* ndc = file->spec().find_attribute("worldtoNDC", OIIO::TypeMatrix);
  ASSERT_TRUE(view && ndc);
  const glm::dvec3 point(1, 0.5, 0);  // five metres ahead, a metre to the right, half a metre up
  EXPECT_EQ(Through(*view, point), glm::dvec3(1, 0.5, 5));
  const glm::dvec3 seen = Through(*ndc, point);
  EXPECT_NEAR(seen.x, 0.5 + 0.5 * 2 * 1 / 5, 1e-6);
  EXPECT_NEAR(seen.y, 0.5 - 0.5 * 2 * 0.5 / 5, 1e-6);
}

// Two objects with names that need escapes, in two materials; RandomGuides but for the ids.
GuideSet NamedGuides() {
  GuideSet guides = RandomGuides(21, 13);
  guides.attributes["scumble:generator"] = "test";
  guides.object_names = {{7, "The \"ring\""}, {9, "Back\\slash\tand β"}};
  guides.material_names = {{5, "Red"}};
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    const bool covered = guides.Plane(Layer::kCoverage)[i] > 0.0f;
    guides.Plane(Layer::kObject)[i] = !covered ? 0.0f : i % 2 ? 7.0f : 9.0f;
    guides.Plane(Layer::kMaterial)[i] = covered && i > 30 ? 5.0f : 0.0f;
  }
  return guides;
}

TEST(GuideFile, CryptomatteStandsBesideTheIds) {
  const TemporaryFolder folder;
  const GuideSet guides = NamedGuides();
  GuideWriteOptions options;
  options.cryptomatte = true;
  ASSERT_TRUE(WriteGuides(folder / "a.exr", guides, options));
  auto input = OIIO::ImageInput::open((folder / "a.exr").string());
  ASSERT_TRUE(input);
  const OIIO::ImageSpec spec = input->spec();
  std::vector<float> pixels(std::size_t(spec.nchannels) * guides.pixel_count());
  ASSERT_TRUE(input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, pixels.data()));
  const auto hex = [](const std::string& name) {
    char text[16];
    std::snprintf(text, sizeof text, "%08x", static_cast<unsigned>(MatteHash(name)));
    return std::string(text);
  };
  const std::string objects = "{\"Back\\\\slash\\u0009and β\":\"" + hex("Back\\slash\tand β") +
                              "\",\"The \\\"ring\\\"\":\"" + hex("The \"ring\"") + "\"}";
  for (const auto& [matte, layer, names, manifest] :
       {std::tuple("CryptoObject", Layer::kObject, guides.object_names, objects),
        std::tuple("CryptoMaterial", Layer::kMaterial, guides.material_names, "{\"Red\":\"" + hex("Red") + "\"}")}) {
    const std::string start = "cryptomatte/" + hex(matte).substr(0, 7) + "/";
    EXPECT_EQ(spec.get_string_attribute(start + "name"), matte);
    EXPECT_EQ(spec.get_string_attribute(start + "hash"), "MurmurHash3_32");
    EXPECT_EQ(spec.get_string_attribute(start + "conversion"), "uint32_to_float32");
    const std::string text(spec.get_string_attribute(start + "manifest"));
    EXPECT_EQ(text, manifest) << "proper JSON, sorted by name";
    const auto read = ReadManifest(text, "a.exr");
    ASSERT_TRUE(read) << read.error().message;
    for (const auto& [id, name] : names) {
      EXPECT_EQ(read->at(MatteBits(MatteHash(name))), name);
    }
    const int first = spec.channelindex(std::string(matte) + "00.R");
    ASSERT_GE(first, 0);
    for (int c = 0; c < 4; ++c) EXPECT_EQ(spec.channelindex(std::string(matte) + "00." + "RGBA"[c]), first + c);
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      const float* const matted = &pixels[i * std::size_t(spec.nchannels) + std::size_t(first)];
      const auto id = static_cast<std::uint32_t>(guides.Plane(layer)[i]);
      const std::uint32_t expected = id == 0 ? 0u : MatteBits(MatteHash(names.at(id)));
      ASSERT_EQ(std::bit_cast<std::uint32_t>(matted[0]), expected) << matte << " at " << i;
      ASSERT_EQ(matted[1], guides.Plane(Layer::kCoverage)[i]);
      ASSERT_EQ(matted[2], 0.0f);
      ASSERT_EQ(matted[3], 0.0f);
    }
  }
}

TEST(GuideFile, OurIdsGoBeforeACryptomatteBesideThem) {
  const TemporaryFolder folder;
  GuideSet guides = NamedGuides();
  GuideWriteOptions options;
  ASSERT_TRUE(WriteGuides(folder / "plain.exr", guides, options));
  options.cryptomatte = true;
  ASSERT_TRUE(WriteGuides(folder / "matted.exr", guides, options));
  const auto plain = ReadGuides(folder / "plain.exr", Everything()),
             matted = ReadGuides(folder / "matted.exr", Everything());
  ASSERT_TRUE(plain && matted) << matted.error().message;
  ExpectSameBits(*matted, *plain);
  EXPECT_EQ(matted->object_names, plain->object_names);
  EXPECT_EQ(matted->attributes, plain->attributes);
  const auto module = LoadFormats("a test");
  ASSERT_TRUE(module) << module.error().message;
  const auto by_module = (*module)->read_guides(folder / "matted.exr", Everything());
  ASSERT_TRUE(by_module) << by_module.error().message;
  ExpectSameBits(*by_module, *plain);
  for (const char* file : {"plain.exr", "matted.exr"}) {
    const auto info = InspectGuides(folder / file);
    ASSERT_TRUE(info) << info.error().message;
    EXPECT_EQ(info->layers.at("").ToString(), guides.layers().ToString());
    EXPECT_EQ(info->has_cryptomatte, std::string(file) == "matted.exr");
  }
  EXPECT_TRUE(internal::ReadPlainGuides(folder / "matted.exr", Everything())) << "without the module";
}

TEST(GuideFile, IdsWithoutANameHaveNoMatte) {
  const TemporaryFolder folder;
  GuideSet guides = NamedGuides();
  guides.object_names.erase(9);
  guides.Remove(Layer::kMaterial);
  GuideWriteOptions options;
  options.cryptomatte = true;
  ASSERT_TRUE(WriteGuides(folder / "a.exr", guides, options));
  auto input = OIIO::ImageInput::open((folder / "a.exr").string());
  ASSERT_TRUE(input);
  EXPECT_LT(input->spec().channelindex("CryptoMaterial00.R"), 0);
  const int id = input->spec().channelindex("CryptoObject00.R");
  std::vector<float> plane(guides.pixel_count());
  ASSERT_TRUE(input->read_image(0, 0, id, id + 1, OIIO::TypeDesc::FLOAT, plane.data()));
  for (std::size_t i = 0; i < plane.size(); ++i) ASSERT_EQ(plane[i] != 0.0f, guides.Plane(Layer::kObject)[i] == 7.0f);
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

TEST(GuideHeader, DamagedTextNeverDoesHarm) {
  using namespace internal;
  EXPECT_FALSE(MatrixFromText(""));
  EXPECT_FALSE(MatrixFromText("1 2 3"));
  EXPECT_FALSE(MatrixFromText("1 2 3 x 1 2 3 4 1 2 3 4 1 2 3 4"));
  EXPECT_TRUE(NamesFromText("").empty());
  EXPECT_TRUE(NamesFromText("\n\n").empty());
  EXPECT_TRUE(NamesFromText("nospace").empty());
  EXPECT_EQ(NamesFromText("7 a\\").at(7), "a\\");
  for (int round = 0; round < 2000; ++round) {
    std::string text;
    for (int i = 0; i < 40; ++i) text += static_cast<char>("0123456789 \\n\n\r.-e\xff"[Hash(round, i) % 20]);
    NamesFromText(text);
    MatrixFromText(text);
  }
}

// ---- reading -------------------------------------------------------------------------------------------------

TEST(GuideFile, OnlyWhatIsAskedForIsRead) {
  const TemporaryFolder folder;
  GuideSet guides = RandomGuides(7, 5);
  guides.Remove(Layer::kMotion);
  ASSERT_TRUE(WriteGuides(folder / "g.exr", guides));
  GuideReadOptions options = OnlyNormals();
  options.optional = {Layer::kMotion, Layer::kShadow, Layer::kLpeLSE};
  const auto read = ReadGuides(folder / "g.exr", options);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->layers().ToString(), "A, normal, shadow, lpe.LSE");
  for (const LayerInfo& info : AllLayers()) {
    if (!read->Has(info.layer)) guides.Remove(info.layer);
  }
  ExpectSameBits(*read, guides);
}

TEST(GuideFile, AMissingLayerIsNamedWithWhatThereIs) {
  const TemporaryFolder folder;
  GuideSet guides = RandomGuides(3, 3);
  guides.Remove(Layer::kLuminance);
  guides.Remove(Layer::kDepth);
  ASSERT_TRUE(WriteGuides(folder / "ball.exr", guides));
  GuideReadOptions options;
  options.required.Add(Layer::kLuminance);
  ExpectRefusal(ReadGuides(folder / "ball.exr", options), ErrorKind::kInput,
                {"ball.exr", "no layer depth, luminance", "It has A, normal, object"});
  WriteExr(folder / "half.exr", OIIO::ImageSpec(2, 2, 1, OIIO::TypeDesc::FLOAT), {"A", "normal.X", "normal.Y"},
           [](std::size_t, std::size_t) { return 1.0f; });
  ExpectRefusal(ReadGuides(folder / "half.exr", OnlyNormals()), ErrorKind::kInput, {"no layer normal", "normal.Y"});
}

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

// Coverage in a part of 3×2 pixels, normals in another that holds the lower row only.
void WriteTwoParts(const fs::path& path, const std::string& part = "shape",
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

TEST(GuideFile, AnEmptySetIsNotWritten) {
  const TemporaryFolder folder;
  EXPECT_FALSE(WriteGuides(folder / "g.exr", GuideSet()));
  EXPECT_FALSE(WriteGuides(folder / "g.exr", GuideSet(4, 4))) << "no layers";
  EXPECT_TRUE(folder.List().empty());
}

// ---- files that are none -----------------------------------------------------------------------------------------

TEST(GuideFile, WhatIsNoGuideFile) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "folder.exr");
  ASSERT_TRUE(WriteFileAtomically(folder / "empty.exr", ""));
  ASSERT_TRUE(WriteFileAtomically(folder / "text.exr", "This is not a picture, whatever its name says.\n"));
  const std::vector<std::pair<const char*, const char*>> cases = {
      {"missing.exr", "no such file"}, {"folder.exr", "folder"}, {"empty.exr", "empty"}, {"text.exr", "text.exr"}};
  for (const auto& [name, words] : cases) {
    ExpectRefusal(ReadGuides(folder / name), ErrorKind::kInput, {name, words});
    ExpectRefusal(InspectGuides(folder / name), ErrorKind::kInput, {name, words});
  }
}

TEST(GuideFile, NamesWithSpecialCharactersAreOnlyNames) {
  const TemporaryFolder folder;
  const GuideSet guides = RandomGuides(3, 2);
  for (const char* name :
       {"a b.exr", "Käse 球.exr", "what?x=1.exr", "100%.exr", "frame.####.exr", "-o.exr", "a'b\"c.exr"}) {
    ASSERT_TRUE(WriteGuides(folder / name, guides)) << name;
    const auto read = ReadGuides(folder / name, Everything());
    ASSERT_TRUE(read) << name << ": " << read.error().message;
    ExpectSameBits(*read, guides);
  }
}

TEST(GuideFile, ATruncatedFileIsRefusedAtAnyLength) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteGuides(folder / "whole.exr", RandomGuides(37, 23)));
  const auto whole = ReadWholeFile(folder / "whole.exr");
  ASSERT_TRUE(whole);
  const fs::path cut = folder / "cut.exr";
  for (std::size_t k = 0; k < 120; ++k) {
    const std::size_t length = k < 60 ? k * k / 2 : whole->size() - 1 - Hash(k) % (whole->size() - 1);
    if (length >= whole->size()) continue;
    ASSERT_TRUE(WriteFileAtomically(cut, std::span(whole->data(), length)));
    ExpectRefusal(ReadGuides(cut, Everything()), ErrorKind::kInput, {"cut.exr"});
  }
}

TEST(GuideFile, FlippedBytesNeverCrash) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteGuides(folder / "whole.exr", RandomGuides(37, 23)));
  const auto whole = ReadWholeFile(folder / "whole.exr");
  ASSERT_TRUE(whole);
  const fs::path damaged = folder / "damaged.exr";
  int refused = 0;
  for (std::uint64_t round = 0; round < 300; ++round) {
    auto bytes = *whole;
    const std::size_t reach = round % 2 ? bytes.size() : std::min<std::size_t>(bytes.size(), 1500);  // the header
    for (std::uint64_t k = 0; k <= round % 3; ++k)
      bytes[Hash(round, k) % reach] ^= std::byte(1 + Hash(round, k, 1) % 255);
    ASSERT_TRUE(WriteFileAtomically(damaged, std::span<const std::byte>(bytes)));
    const auto read = ReadGuides(damaged, Everything());
    if (read) continue;
    ++refused;
    ExpectRefusal(read, ErrorKind::kInput, {"damaged.exr"});
  }
  EXPECT_GT(refused, 100) << "most damage shows";
}

}  // namespace
}  // namespace scumble
