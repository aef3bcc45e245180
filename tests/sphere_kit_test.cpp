// The artist's kit, from the template to the style that loads.
#include "style/sphere_kit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "image/hash.h"
#include "io/atomic_file.h"
#include "io/guide_file.h"
#include "io/picture_file.h"
#include "style/style_file.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

Picture RandomPicture(int width, int height) {
  Picture picture(width, height);
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
    picture.rgba[i] = i % 4 == 3 ? 65535 : static_cast<std::uint16_t>(Hash(width, i) % 256 * 257);
  }
  return picture;
}

// An orthographic unit sphere that fills the square, lit from the upper left.
GuideSet SphereGuides(int size) {
  GuideSet guides(size, size);
  for (Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kLuminance}) guides.Add(layer);
  const glm::vec3 light = glm::normalize(glm::vec3(-1, 1, 1));
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const float nx = (2.0f * x + 1.0f) / size - 1.0f, ny = 1.0f - (2.0f * y + 1.0f) / size;
      if (nx * nx + ny * ny >= 1.0f) continue;
      const std::size_t i = guides.Index(x, y);
      const glm::vec3 n(nx, ny, std::sqrt(1.0f - nx * nx - ny * ny));
      guides.Plane(Layer::kCoverage)[i] = 1.0f;
      for (int c = 0; c < 3; ++c) guides.Plane(Layer::kNormal, c)[i] = n[c];
      guides.Plane(Layer::kDepth)[i] = 2.0f - n.z;
      guides.Plane(Layer::kLuminance)[i] = std::max(0.0f, glm::dot(n, light));
    }
  }
  return guides;
}

Picture InnerSquare(const Picture& picture, int margin) {
  const int size = picture.width - 2 * margin;
  Picture inner(size, size);
  for (int y = 0; y < size; ++y) std::copy_n(picture.At(margin, margin + y), 4 * size, inner.At(0, y));
  return inner;
}

TEST(SphereKit, TheTemplateShowsTheLitSphereAndMarksOnlyTheMargin) {
  for (int size : {1, 2, 7, 8, 9, 33, 64, 255, 512}) {
    const Picture picture = DrawTemplate({-45, 35, SphereGuides(size)});
    const int margin = TemplateMargin(size);
    ASSERT_GE(margin, 1);
    ASSERT_EQ(picture.width, size + 2 * margin);
    ASSERT_EQ(picture.height, size + 2 * margin);
    // The same sphere in the dark, everywhere transparent: what is drawn then is the marks alone.
    GuideSet nothing = SphereGuides(size);
    for (float& coverage : nothing.Plane(Layer::kCoverage)) coverage = 0.0f;
    const Picture marks = DrawTemplate({-45, 35, nothing});
    for (std::uint16_t value : InnerSquare(marks, margin).rgba)
      ASSERT_EQ(value, 65535) << "a mark inside, size " << size;
    if (size >= 33) {
      EXPECT_EQ(marks.At(margin / 2, margin / 2)[0], 0) << "the cross in the corner";
      EXPECT_EQ(marks.At(size + 2 * margin - margin / 2 - 1, margin / 2)[0], 0) << "and in the next";
    }
    for (std::size_t i = 3; i < picture.rgba.size(); i += 4) ASSERT_EQ(picture.rgba[i], 65535) << "paper is opaque";
  }
  const Picture picture = DrawTemplate({-45, 35, SphereGuides(64)});
  const int margin = TemplateMargin(64);
  EXPECT_GT(picture.At(margin + 18, margin + 18)[0], picture.At(margin + 46, margin + 46)[0])
      << "lit from the upper left";
  EXPECT_GT(picture.At(margin + 46, margin + 46)[0], 0) << "form shows in the shade";
  EXPECT_EQ(picture.At(margin, margin)[0], 65535) << "outside the disc";
}

TEST(SphereKit, FromTemplateToStyle) {
  const TemporaryFolder folder;
  const auto written = WriteSphereKit(folder / "mine", {KitLight{-45, 35, SphereGuides(64)}});
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(written->size(), 4u);
  for (const fs::path& path : *written) EXPECT_TRUE(fs::is_regular_file(path)) << path;
  ExpectRefusal(LoadStyle(folder / "mine"), ErrorKind::kInput, {"lit.png", "not there yet", "template.png"});

  fs::copy_file(folder / "mine/template.png", folder / "mine/lit.png");
  const auto whole = LoadStyle(folder / "mine");
  ASSERT_TRUE(whole) << whole.error().message;
  const auto painted = ReadPicture(folder / "mine/template.png");
  ASSERT_TRUE(painted);
  const Picture inner = InnerSquare(*painted, TemplateMargin(64));
  ASSERT_EQ(whole->exemplars.at(0).picture.width, 64);
  EXPECT_EQ(whole->exemplars.at(0).picture.rgba, inner.rgba);
  EXPECT_EQ(whole->transfer.threshold, TransferSettings().threshold) << "the starter file only repeats defaults";
  EXPECT_EQ(whole->transfer.blend_radius, TransferSettings().blend_radius);
  EXPECT_EQ(whole->transfer.scale, TransferSettings().scale);
  EXPECT_FALSE(whole->paper.color || whole->paper.picture);

  ASSERT_TRUE(WritePicture(folder / "mine/lit.png", inner));
  const auto alone = LoadStyle(folder / "mine");
  ASSERT_TRUE(alone) << alone.error().message;
  EXPECT_EQ(alone->exemplars.at(0).picture.rgba, inner.rgba);

  for (const auto& [width, height] : {std::pair{64, 80}, {80, 64}, {65, 65}, {79, 79}, {160, 160}}) {
    ASSERT_TRUE(WritePicture(folder / "mine/lit.png", RandomPicture(width, height)));
    ExpectRefusal(
        LoadStyle(folder / "mine"), ErrorKind::kInput,
        {"lit.png is " + std::to_string(width) + "×" + std::to_string(height), "guides.exr", "64×64", "80×80"});
  }
}

TEST(SphereKit, AnArtistsStyleFileIsKept) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteFileAtomically(folder / "style.toml", "# mine\n"));
  const auto written = WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(16)}});
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(written->size(), 3u) << "what was kept is not listed as written";
  const auto kept = ReadWholeFile(folder / "style.toml");
  ASSERT_TRUE(kept);
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(kept->data()), kept->size()), "# mine\n");
}

TEST(SphereKit, FurtherLightsGetFilesOfTheirOwn) {
  const TemporaryFolder folder;
  const auto written =
      WriteSphereKit(folder.path(), {KitLight{-45, 35, SphereGuides(16)}, KitLight{60, 10, SphereGuides(16)}});
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(folder.List(), (std::vector<std::string>{"HOWTO.txt", "guides-2.exr", "guides.exr", "style.toml",
                                                     "template-2.png", "template.png"}));
  const auto howto = ReadWholeFile(folder / "HOWTO.txt");
  ASSERT_TRUE(howto);
  const std::string text(reinterpret_cast<const char*>(howto->data()), howto->size());
  EXPECT_NE(text.find("azimuth -45, elevation 35"), std::string::npos);
  EXPECT_NE(text.find("azimuth 60, elevation 10"), std::string::npos);
}

TEST(SphereKit, ATemplateIsRecognisedAtEverySizeAndOtherPicturesAreNot) {
  for (int size : {63, 64, 65, 200, 511, 512}) {
    const Picture drawn = DrawTemplate({-40, 40, SphereGuides(size)});
    EXPECT_TRUE(LooksLikeTemplate(drawn)) << size;
    EXPECT_FALSE(LooksLikeTemplate(InnerSquare(drawn, TemplateMargin(size)))) << size;
    EXPECT_FALSE(LooksLikeTemplate(RandomPicture(drawn.width, drawn.width))) << size;
  }
  EXPECT_FALSE(LooksLikeTemplate(Picture()));
  EXPECT_FALSE(LooksLikeTemplate(Picture(1, 1)));
  EXPECT_FALSE(LooksLikeTemplate(Picture(30, 20)));
}

TEST(SphereKit, ATemplateNamedAsAStyleIsRefusedAndAPaintingStandsForItsFolder) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(64)}}));
  ExpectRefusal(LoadStyle(folder / "template.png"), ErrorKind::kInput, {"template.png", "whole template", "folder"});
  ExpectRefusal(LoadStyle(folder.path()), ErrorKind::kInput, {"lit.png", "paint over", "template.png"});
  std::filesystem::copy_file(folder / "template.png", folder / "lit.png");
  const auto style = LoadStyle(folder / "lit.png");
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_EQ(style->exemplars[0].picture.width, 64) << "without the margin";
}

TEST(SphereKit, APaintedTemplateIsNotOverwritten) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(32)}}));
  EXPECT_TRUE(WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(32)}})) << "the same may be written again";
  Picture painted = DrawTemplate({0, 0, SphereGuides(32)});
  painted.At(20, 20)[0] = 40000;
  ASSERT_TRUE(WritePicture(folder / "template.png", painted));
  const auto before = ReadPicture(folder / "template.png");
  ExpectRefusal(WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(32)}}), ErrorKind::kOutput,
                {"template.png", "painting"});
  EXPECT_EQ(ReadPicture(folder / "template.png")->rgba, before->rgba);
}

TEST(SphereKit, TheMarginIsInTheGuides) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(20)}}));
  const auto guides =
      ReadGuides(folder / "guides.exr", {{Layer::kCoverage, Layer::kNormal, Layer::kLuminance}, {}, "", "", {}});
  ASSERT_TRUE(guides) << guides.error().message;
  EXPECT_EQ(SphereMargin(*guides), TemplateMargin(20));
  EXPECT_FALSE(SphereMargin(SphereGuides(20))) << "guides of no kit";
  GuideSet odd = SphereGuides(20);
  for (const char* bad : {"-1", "21", "nonsense", "", "3 apples", "99999999999999999999"}) {
    odd.attributes["scumble:sphereMargin"] = bad;
    EXPECT_FALSE(SphereMargin(odd)) << bad;
  }
}

TEST(SphereKit, GuidesOfAnotherProgramAreASceneOfTheirOwn) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WritePicture(folder / "lit.png", RandomPicture(16, 16)));
  ASSERT_TRUE(WriteGuides(folder / "other.exr", SphereGuides(16)));
  ASSERT_TRUE(WriteFileAtomically(folder / "style.toml", "[[exemplar]]\nimage = 'lit.png'\nguides = 'other.exr'\n"));
  const auto style = LoadStyle(folder.path());
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_FALSE(style->exemplars[0].is_sphere);
  ASSERT_TRUE(style->exemplars[0].guides);
  EXPECT_EQ(style->exemplars[0].guides->width(), 16);
}

TEST(SphereKit, AnUnwritableFolderIsAnOutputError) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteFileAtomically(folder / "file", "x"));
  ExpectRefusal(WriteSphereKit(folder / "file/kit", {KitLight{0, 0, SphereGuides(16)}}), ErrorKind::kOutput, {"file"});
}

}  // namespace
}  // namespace scumble
