// Cycles' lighting passes, made here, turned into light-path layers.
#include "core/io/cycles_light.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

using Passes = std::map<std::string, float>;  // value of R; G is twice, B three times as much

const Passes kAll = {{"Combined", 7.0f}, {"Emit", 0.0f},     {"DiffDir", 2.0f},  {"DiffInd", 5.0f},
                     {"DiffCol", 0.5f},  {"GlossDir", 3.0f}, {"GlossCol", 0.25f}};
const Passes kLdde = {{"Combined", 6.0f}, {"Emit", 0.0f},     {"DiffDir", 2.0f}, {"DiffInd", 4.0f},
                      {"DiffCol", 0.5f},  {"GlossDir", 0.0f}, {"GlossCol", 0.0f}};
const Passes kLd12e = {{"Combined", 5.0f}, {"Emit", 0.0f},     {"DiffDir", 2.0f}, {"DiffInd", 3.0f},
                       {"DiffCol", 0.5f},  {"GlossDir", 0.0f}, {"GlossCol", 0.0f}};

void WritePasses(const fs::path& path, const Passes& passes, int width = 3, const std::string& second_layer = "") {
  OIIO::ImageSpec spec(width, 2, 0, OIIO::TypeDesc::FLOAT);
  std::vector<float> pixel;
  for (const std::string& layer : {std::string("View Layer"), second_layer}) {
    for (const auto& [name, value] : passes) {
      if (layer.empty()) continue;
      for (int c = 0; c < 3; ++c) {
        spec.channelnames.push_back(layer + "." + name + "." + "RGB"[c]);
        pixel.push_back(value * float(c + 1));
      }
    }
  }
  spec.nchannels = int(spec.channelnames.size());
  std::vector<float> pixels;
  for (int i = 0; i < width * 2; ++i) pixels.insert(pixels.end(), pixel.begin(), pixel.end());
  auto output = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(output && output->open(path.string(), spec) && output->write_image(OIIO::TypeDesc::FLOAT, pixels.data()));
  ASSERT_TRUE(output->close());
}

struct Render {
  TemporaryFolder folder;
  Passes all = kAll, ldde = kLdde, ld12e = kLd12e;
  Expected<CyclesLight> Read(int samples = 16) {
    WritePasses(folder / "stem.x.all.16.exr", all);
    WritePasses(folder / "stem.x.ldde.16.exr", ldde);
    WritePasses(folder / "stem.x.ld12e.16.exr", ld12e);
    return ReadCyclesLight(folder / "stem.x", samples);
  }
};

TEST(CyclesLight, LayersAreProductsOfPasses) {
  Render render;
  const auto light = render.Read();
  ASSERT_TRUE(light.ok()) << light.error().message;
  EXPECT_EQ(light->guides.width(), 3);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(light->guides.Vec3(Layer::kLpeFull, i), glm::vec3(7, 14, 21));
    EXPECT_EQ(light->guides.Vec3(Layer::kLpeLDE, i), glm::vec3(1, 4, 9)) << "0.5 · 2, channel by channel";
    EXPECT_EQ(light->guides.Vec3(Layer::kLpeLSE, i), glm::vec3(0.75f, 3, 6.75f));
    EXPECT_EQ(light->guides.Vec3(Layer::kLpeLDDE, i), glm::vec3(2, 8, 18)) << "of the ldde file";
    EXPECT_EQ(light->guides.Vec3(Layer::kLpeLD12E, i), glm::vec3(2.5f, 10, 22.5f)) << "of the ld12e file";
    EXPECT_EQ(light->emits[i], 0);
  }
  EXPECT_TRUE(light->glossy);
}

TEST(CyclesLight, KnowsWhatShinesAndWhatIsDiffuse) {
  Render render;
  render.all["GlossCol"] = 0.0f;
  render.all["Emit"] = 1e-9f;
  const auto light = render.Read();
  ASSERT_TRUE(light.ok());
  EXPECT_FALSE(light->glossy);
  EXPECT_EQ(light->emits, std::vector<std::uint8_t>(6, 1));
}

TEST(CyclesLight, NaNPasses) {
  Render render;
  render.all["DiffDir"] = std::nanf("");
  const auto light = render.Read();
  ASSERT_TRUE(light.ok()) << "what is wrong with it is the comparison's to say";
  EXPECT_TRUE(std::isnan(light->guides.Plane(Layer::kLpeLDE)[0]));
}

TEST(CyclesLight, ErrorsNameFileAndPass) {
  const auto expect = [](const Expected<CyclesLight>& refused, const std::string& file, const std::string& part) {
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().kind, ErrorKind::kInput);
    EXPECT_NE(refused.error().message.find(file), std::string::npos) << refused.error().message;
    EXPECT_NE(refused.error().message.find(part), std::string::npos) << refused.error().message;
  };
  Render missing_pass;
  missing_pass.ldde.erase("DiffInd");
  expect(missing_pass.Read(), "stem.x.ldde.16.exr", "no channel DiffInd.R");
  Render other_count;
  expect(other_count.Read(64), "stem.x.all.64.exr", "");
  Render twice;
  ASSERT_TRUE(twice.Read().ok());
  WritePasses(twice.folder / "stem.x.all.16.exr", kAll, 3, "Other");
  expect(ReadCyclesLight(twice.folder / "stem.x", 16), "stem.x.all.16.exr", "twice");
  WritePasses(twice.folder / "stem.x.all.16.exr", kAll, 4);
  expect(ReadCyclesLight(twice.folder / "stem.x", 16), "stem.x.ldde.16.exr", "is 3×2");
}

TEST(CyclesLight, SpecularColorIsAlbedoTooAndWhatOnlyShinesHasNone) {
  const TemporaryFolder folder;
  const auto guides_of = [](float albedo) {
    GuideSet guides(3, 2);
    guides.Add(Layer::kAlbedo);
    guides.Plane(Layer::kAlbedo, 1)[4] = albedo;
    return guides;
  };
  WritePasses(folder / "data.exr", {{"GlossCol", 0.25f}, {"Emit", 0.0f}});
  GuideSet guides = guides_of(0.125f);
  const auto glossy = CompleteAlbedo(folder / "data.exr", guides);
  ASSERT_TRUE(glossy.ok());
  EXPECT_EQ(guides.Vec3(Layer::kAlbedo, 4), glm::vec3(0.25f, 0.625f, 0.75f));
  EXPECT_EQ(*glossy, std::vector<std::uint8_t>(6, 0));
  WritePasses(folder / "lamp.exr", {{"GlossCol", 0.0f}, {"Emit", 2.0f}});
  guides = guides_of(0.125f);
  const auto lamp = CompleteAlbedo(folder / "lamp.exr", guides);
  ASSERT_TRUE(lamp.ok());
  EXPECT_EQ(*lamp, (std::vector<std::uint8_t>{1, 1, 1, 1, 0, 1})) << "the fifth pixel has an albedo as well";
  GuideSet other(2, 2);
  other.Add(Layer::kAlbedo);
  EXPECT_FALSE(CompleteAlbedo(folder / "data.exr", other).ok());
  WritePasses(folder / "none.exr", {{"DiffCol", 0.5f}});
  EXPECT_FALSE(CompleteAlbedo(folder / "none.exr", guides).ok());
}

}  // namespace
}  // namespace scumble
