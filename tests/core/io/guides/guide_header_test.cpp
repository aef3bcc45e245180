// What stands beside the pixels of a guide file: names, camera, attributes, and Cryptomatte made of the ids.
#include "core/io/guides/guide_header.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "core/image/hash.h"
#include "core/io/format_dispatch.h"
#include "core/io/guide_file.h"
#include "core/io/guides/cryptomatte.h"
#include "core/io/guides/own_guides.h"
#include "tests/support/guide_files.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

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

}  // namespace
}  // namespace scumble
