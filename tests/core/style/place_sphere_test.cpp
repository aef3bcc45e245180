// Exemplars whose sphere does not fill the file, as files.
#include "core/style/place_sphere.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "core/io/picture_file.h"
#include "core/style/sphere_kit.h"
#include "core/style/sphere_template.h"
#include "core/style/style_file.h"
#include "tests/support/painted_spheres.h"
#include "tests/support/refusal.h"
#include "tests/support/sphere_guides.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

class PlaceSphereTest : public testing::Test {
 protected:
  std::string Write(const std::string& name, const Picture& picture) {
    const std::filesystem::path path = folder_.path() / name;
    EXPECT_TRUE(WritePicture(path, picture).ok());
    return path.string();
  }
  TemporaryFolder folder_;
};

// The painting of a sphere that fills its square, laid into a larger sheet.
Picture Laid(const Picture& sphere, int width, int height, int left, int top, double paper) {
  Picture sheet(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      SetGrey(sheet, x, y, std::max(0.0, paper));
      if (paper < 0.0) sheet.At(x, y)[3] = 0;
    }
  }
  const double half = 0.5 * sphere.width;
  for (int y = 0; y < sphere.height; ++y) {
    for (int x = 0; x < sphere.width; ++x) {
      if (std::hypot(x + 0.5 - half, y + 0.5 - half) <= half)
        std::copy_n(sphere.At(x, y), 4, sheet.At(left + x, top + y));
    }
  }
  return sheet;
}

// The part that is cut is the painting that was laid there, but for a pixel.
TEST_F(PlaceSphereTest, TakesTheSphereAsItLies) {
  PaintedSphere painted;
  painted.size = 300, painted.reach = 2.0;
  const Picture sphere = PaintSphere(painted);
  for (const auto& [width, height, paper] : {std::tuple{512, 512, 1.0}, {512, 512, -1.0}, {640, 400, 0.9}}) {
    const std::string file = Write("ball.png", Laid(sphere, width, height, 60, 80, paper));
    const Expected<Style> style = LoadStyle(file);
    ASSERT_TRUE(style) << style.error().message;
    const Exemplar& exemplar = style->exemplars.front();
    ASSERT_TRUE(exemplar.cut);
    EXPECT_NEAR(exemplar.cut->left, 60, 2);
    EXPECT_NEAR(exemplar.cut->top, 80, 2);
    EXPECT_NEAR(exemplar.picture.width, 300, 4);
    EXPECT_EQ(exemplar.picture.width, exemplar.picture.height);
    EXPECT_EQ(exemplar.Origin(), glm::ivec2(exemplar.cut->left, exemplar.cut->top));
    for (int y = 100; y < 200; ++y) {
      const int u = 60 - exemplar.cut->left, v = 80 - exemplar.cut->top;
      ASSERT_NEAR(exemplar.picture.At(150 + u, y + v)[0], sphere.At(150, y)[0], 257) << y;
    }
    const std::string said = DescribeCut(*exemplar.cut);
    EXPECT_NE(said.find(std::to_string(width) + "×" + std::to_string(height)), std::string::npos) << said;
    EXPECT_NE(said.find("around x=2"), std::string::npos) << said;
    EXPECT_NE(said.find("radius of 1"), std::string::npos) << said;
  }
}

// A scan that was cropped by hand, a template that slipped on its canvas or was turned, a whole page.
TEST_F(PlaceSphereTest, ATemplateIsRefusedWhereverItLies) {
  const Picture sheet = DrawTemplate({-40, 40, SphereGuides(256)});
  const int side = sheet.width;
  ASSERT_EQ(side, 320);
  struct Place {
    int width, height, left, top;
    double degrees;
  };
  for (const Place& place : {Place{side, side, 12, -8, 0}, {side, side, 0, 0, 3}, {360, 400, 20, 30, 0}}) {
    Picture moved(place.width, place.height);
    std::fill(moved.rgba.begin(), moved.rgba.end(), std::uint16_t{65535});
    const double turn = glm::radians(place.degrees), half = 0.5 * side;
    for (int y = 0; y < place.height; ++y) {
      for (int x = 0; x < place.width; ++x) {
        const double u = x + 0.5 - place.left - half, v = y + 0.5 - place.top - half;
        const double from_x = std::cos(turn) * u + std::sin(turn) * v + half;
        const double from_y = std::cos(turn) * v - std::sin(turn) * u + half;
        if (from_x < 0 || from_y < 0 || from_x >= side || from_y >= side) continue;
        std::copy_n(sheet.At(int(from_x), int(from_y)), 4, moved.At(x, y));
      }
    }
    const std::string file = Write("moved.png", moved);
    ExpectRefusal(LoadStyle(file), {"moved.png is a whole template, scanned, moved or turned",
                                    "`scumble sphere --rectify \"" + file + "\"`", "crop"});
  }
  ASSERT_TRUE(WriteSphereKit(folder_.path(), {KitLight{-40, 40, SphereGuides(64)}}));
  Write("lit.png", sheet);
  ExpectRefusal(LoadStyle(folder_.path()), {"lit.png is 320×320", "are 64×64", "a scan", "`scumble sphere --rectify`"});
}

TEST_F(PlaceSphereTest, WhatFillsItsSquareStaysByteForByte) {
  for (const double reach : {1.12, 2.0, 1.0}) {
    PaintedSphere painted;
    painted.size = 256, painted.reach = reach;
    const Picture picture = PaintSphere(painted);
    const std::string file = Write("fills.png", picture);
    const Expected<Style> style = LoadStyle(file);
    ASSERT_TRUE(style) << style.error().message;
    EXPECT_FALSE(style->exemplars.front().cut) << reach;
    EXPECT_EQ(style->exemplars.front().picture.rgba, ReadPicture(file)->rgba) << reach;
  }
}

TEST_F(PlaceSphereTest, RefusesInWords) {
  PaintedSphere painted;
  painted.size = 200, painted.reach = 2.0;
  const Picture sphere = PaintSphere(painted);
  const auto refusal = [&](const Picture& picture) {
    const Expected<Style> style = LoadStyle(Write("odd.png", picture));
    EXPECT_FALSE(style);
    if (style) return std::string();
    EXPECT_EQ(style.error().kind, ErrorKind::kInput);
    return style.error().message;
  };
  const auto expect = [&](const Picture& picture, const std::vector<std::string>& words) {
    const std::string said = refusal(picture);
    for (const std::string& word : words) EXPECT_NE(said.find(word), std::string::npos) << word << ": " << said;
  };
  Picture two = Laid(sphere, 500, 500, 20, 20, 1.0);
  const Picture other = Laid(sphere, 500, 500, 260, 270, 1.0);
  for (std::size_t i = 0; i < two.rgba.size(); ++i) two.rgba[i] = std::min(two.rgba[i], other.rgba[i]);
  expect(two, {"odd.png shows more than one sphere, around x=", "crop the picture to it"});
  Picture flat(400, 400);  // every second line of a sphere's height
  const Picture tall = Laid(sphere, 400, 400, 100, 100, 1.0);
  for (int y = 0; y < 400; ++y) {
    const int from = std::clamp(200 + (y - 200) * 3 / 2, 0, 399);
    std::copy_n(tall.At(0, from), 4 * 400, flat.At(0, y));
  }
  expect(flat, {"odd.png shows an ellipse, 2", "pixels long and 13", "until it is round"});
  Picture noise(300, 200);
  for (int i = 0; i < 300 * 200; ++i) SetGrey(noise, i % 300, i / 300, UnitFloat(Hash(i)));
  expect(noise, {"odd.png is 300×200", "its corners are neither", "a square that its sphere fills; crop it"});
  Picture bar = Laid(sphere, 640, 360, 100, 100, 1.0);
  for (int y = 120; y < 200; ++y) {
    for (int x = 200; x < 600; ++x) SetGrey(bar, x, y, 0.3);
  }
  expect(bar, {"odd.png is 640×360", "shows no clear sphere", "crop it to the sphere"});
  painted.size = 20;
  expect(Laid(PaintSphere(painted), 60, 60, 20, 20, 1.0), {"odd.png is 60×60", "less than 30 pixels across"});
}

// What keeps a sphere from being found is named where it can be told, with what to do.
TEST_F(PlaceSphereTest, NamesShadowsAndUnevenPaper) {
  PaintedSphere painted;
  painted.size = 240, painted.reach = 2.0;
  const auto with_shadow = [&](int width, int height) {
    const Picture bare = Laid(PaintSphere(painted), width, height, width / 2 - 120, 60, 0.95);
    Picture sheet = bare;
    for (int y = 250; y < 360; ++y) {
      for (int x = 0; x < width; ++x) {
        if (std::hypot((x - width / 2) / 140.0, (y - 305) / 45.0) > 1.0) continue;
        SetGrey(sheet, x, y, std::min(0.5, bare.At(x, y)[0] / 65535.0));
      }
    }
    return sheet;
  };
  const auto expect_refused = [&](const Picture& picture, const std::vector<std::string>& words) {
    const Expected<Style> style = LoadStyle(Write("odd.png", picture));
    ASSERT_FALSE(style);
    for (const std::string& word : words) {
      EXPECT_NE(style.error().message.find(word), std::string::npos) << word << ": " << style.error().message;
    }
  };
  expect_refused(with_shadow(600, 400),
                 {"odd.png is 600×400, and around x=300, y=1", "the ground below it is darker", "cut the shadow away"});
  Picture uneven = Laid(PaintSphere(painted), 600, 400, 180, 60, 0.95);
  Overlay(uneven, [](double x, double) { return 1.0 - 0.5 * x / 600; });
  expect_refused(uneven, {"odd.png is 600×400", "lit unevenly", "cut the sphere out onto transparency"});

  expect_refused(with_shadow(400, 400), {"odd.png is 400×400, and around x=200, y=1", "the ground below it is darker",
                                         "cut the shadow away", "write fills = true"});
}

// A square's paint may end early on purpose: then its style says so.
TEST_F(PlaceSphereTest, AnUnclearSquareIsRefusedUnlessItFills) {
  Picture picture(400, 400);
  for (int i = 0; i < 400 * 400; ++i) SetGrey(picture, i % 400, i / 400, 1.0);
  for (int y = 100; y < 300; ++y) {
    for (int x = 100; x < 300; ++x) SetGrey(picture, x, y, 0.3);
  }
  const std::string file = Write("box.png", picture);
  const Expected<Style> refused = LoadStyle(file);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kInput);
  for (const char* word : {"box.png is 400×400", "shows no clear sphere", "crop it to the sphere", "fills = true"}) {
    EXPECT_NE(refused.error().message.find(word), std::string::npos) << refused.error().message;
  }
  const Picture stored = *ReadPicture(file);
  std::ofstream(folder_.path() / "style.toml") << "[[exemplar]]\nimage = \"box.png\"\nfills = true\n";
  for (const Expected<Style>& style : {LoadStyle(folder_.path()), LoadStyle(file)}) {
    ASSERT_TRUE(style) << style.error().message;
    EXPECT_EQ(style->exemplars.front().picture.rgba, stored.rgba);
  }
  EXPECT_FALSE(LoadStyle(folder_.path(), *ParseStyleOverrides({"exemplar.1.fills=false"})));
  std::filesystem::remove(folder_.path() / "style.toml");
  EXPECT_TRUE(LoadStyle(file, *ParseStyleOverrides({"exemplar.1.fills=true"})));
}

// What would be cut to its sphere is not where it fills the square by word, and a word is true or false.
TEST_F(PlaceSphereTest, FillsKeepsAnyPictureAsItIs) {
  PaintedSphere painted;
  painted.size = 200, painted.reach = 2.0;
  const std::string file = Write("ball.png", Laid(PaintSphere(painted), 400, 400, 60, 80, 1.0));
  ASSERT_TRUE(LoadStyle(file)->exemplars.front().cut);
  const Expected<Style> style = LoadStyle(file, *ParseStyleOverrides({"exemplar.1.fills=true"}));
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_FALSE(style->exemplars.front().cut);
  EXPECT_EQ(style->exemplars.front().picture.width, 400);
  const Expected<Style> wrong = LoadStyle(file, *ParseStyleOverrides({"exemplar.1.fills=1"}));
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().kind, ErrorKind::kUsage);
  EXPECT_NE(wrong.error().message.find("expected true or false"), std::string::npos) << wrong.error().message;
  std::ofstream(folder_.path() / "style.toml") << "[[exemplar]]\nimage = \"ball.png\"\nfills = \"yes\"\n";
  const Expected<Style> text = LoadStyle(folder_.path());
  ASSERT_FALSE(text);
  EXPECT_NE(text.error().message.find("style.toml:3: exemplar.fills: expected true or false"), std::string::npos)
      << text.error().message;
}

// Guides say where the sphere is, and marks that there is a margin.
TEST_F(PlaceSphereTest, AKitsSphereIsWhereItsGuidesAre) {
  PaintedSphere painted;
  painted.size = 200, painted.reach = 2.0;
  Exemplar exemplar = ExemplarOf(Laid(PaintSphere(painted), 300, 300, 60, 40, 1.0));
  exemplar.guides_file = "guides.exr";
  ASSERT_TRUE(PlaceSphere(exemplar).ok());
  EXPECT_FALSE(exemplar.cut);
  EXPECT_EQ(exemplar.picture.width, 300);
}

}  // namespace
}  // namespace scumble
