// Pictures with ICC profiles, against the formulas of their colour spaces.
#include "core/io/color_profile.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <lcms2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/io/atomic_file.h"
#include "core/io/picture_file.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

using ProfileBytes = std::vector<std::byte>;

ProfileBytes Saved(cmsHPROFILE profile) {
  cmsUInt32Number size = 0;
  cmsSaveProfileToMem(profile, nullptr, &size);
  ProfileBytes bytes(size);
  cmsSaveProfileToMem(profile, bytes.data(), &size);
  cmsCloseProfile(profile);
  return bytes;
}

// A white point and primaries as (x, y), and one power as the curve.
struct Space {
  std::array<double, 2> white, red, green, blue;
  double gamma;
};
constexpr Space kAdobeRgb{{0.3127, 0.3290}, {0.64, 0.33}, {0.21, 0.71}, {0.15, 0.06}, 563.0 / 256.0};
constexpr Space kRec709{{0.3127, 0.3290}, {0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, 0.0};

ProfileBytes ProfileOf(const Space& space) {
  const cmsCIExyY white{space.white[0], space.white[1], 1.0};
  const cmsCIExyYTRIPLE primaries{
      {space.red[0], space.red[1], 1.0}, {space.green[0], space.green[1], 1.0}, {space.blue[0], space.blue[1], 1.0}};
  cmsToneCurve* const curve = cmsBuildGamma(nullptr, space.gamma);
  cmsToneCurve* curves[] = {curve, curve, curve};
  ProfileBytes bytes = Saved(cmsCreateRGBProfile(&white, &primaries, curves));
  cmsFreeToneCurve(curve);
  return bytes;
}

glm::dvec3 XyzOf(const std::array<double, 2>& xy) { return {xy[0] / xy[1], 1.0, (1.0 - xy[0] - xy[1]) / xy[1]}; }

glm::dmat3 XyzFromRgb(const Space& space) {
  const glm::dmat3 primaries(XyzOf(space.red), XyzOf(space.green), XyzOf(space.blue));
  const glm::dvec3 scale = glm::inverse(primaries) * XyzOf(space.white);
  return {primaries[0] * scale[0], primaries[1] * scale[1], primaries[2] * scale[2]};
}

double SrgbCode(double linear) {
  const double clamped = std::clamp(linear, 0.0, 1.0);
  return clamped <= 0.0031308 ? 12.92 * clamped : 1.055 * std::pow(clamped, 1.0 / 2.4) - 0.055;
}

ProfileBytes LinearGrey() {
  cmsToneCurve* const curve = cmsBuildGamma(nullptr, 1.0);
  ProfileBytes bytes = Saved(cmsCreateGrayProfile(cmsD50_xyY(), curve));
  cmsFreeToneCurve(curve);
  return bytes;
}

// Colours all over the cube, alpha among them.
Picture Cube() {
  constexpr int kLevels = 9;
  Picture picture(kLevels * kLevels, kLevels);
  const auto code = [](int i) { return static_cast<std::uint16_t>(65535 * i / (kLevels - 1)); };
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const std::uint16_t texel[] = {code(x % kLevels), code(x / kLevels), code(y),
                                     static_cast<std::uint16_t>(500 * x)};
      std::copy_n(texel, 4, picture.At(x, y));
    }
  }
  return picture;
}

constexpr double kCode = 1.0 / 255.0;

void ExpectCodes(const Picture& found, const Picture& given, const std::function<glm::dvec3(glm::dvec3)>& expected,
                 double most) {
  ASSERT_EQ(found.rgba.size(), given.rgba.size());
  for (std::size_t i = 0; i < given.rgba.size(); i += 4) {
    const glm::dvec3 code(given.rgba[i], given.rgba[i + 1], given.rgba[i + 2]), right = expected(code / 65535.0);
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(found.rgba[i + std::size_t(c)] / 65535.0, right[c], most) << i << " " << c;
    ASSERT_EQ(found.rgba[i + 3], given.rgba[i + 3]);
  }
}

glm::dvec3 SrgbFromAdobe(glm::dvec3 code) {
  static const glm::dmat3 matrix = glm::inverse(XyzFromRgb(kRec709)) * XyzFromRgb(kAdobeRgb);
  const glm::dvec3 linear = matrix * glm::pow(code, glm::dvec3(kAdobeRgb.gamma));
  return {SrgbCode(linear.x), SrgbCode(linear.y), SrgbCode(linear.z)};
}

TEST(ColorProfile, AdobeRgbBecomesSrgbByTheFormulas) {
  const Picture given = Cube();
  Picture picture = given;
  internal::ConvertToSrgb(ProfileOf(kAdobeRgb), picture);
  ExpectCodes(picture, given, SrgbFromAdobe, 0.5 * kCode);
}

TEST(ColorProfile, GreyFollowsItsOwnCurve) {
  Picture given(256, 1);
  for (int x = 0; x < 256; ++x) std::fill_n(given.At(x, 0), 3, static_cast<std::uint16_t>(257 * x));
  Picture picture = given;
  internal::ConvertToSrgb(LinearGrey(), picture);
  ExpectCodes(
      picture, given, [](glm::dvec3 grey) { return glm::dvec3(SrgbCode(grey.x), SrgbCode(grey.y), SrgbCode(grey.z)); },
      0.5 * kCode);
}

TEST(ColorProfile, AGreyProfileOfAColouredPictureIsNone) {
  Picture picture = Cube();
  internal::ConvertToSrgb(LinearGrey(), picture);
  EXPECT_EQ(picture.rgba, Cube().rgba);
}

TEST(ColorProfile, SrgbAndWhatIsNoProfileOfColoursKeepTheCodes) {
  cmsToneCurve* const curve = cmsBuildGamma(nullptr, 2.2);
  cmsToneCurve* curves[] = {curve, curve, curve, curve};
  const ProfileBytes cmyk = Saved(cmsCreateLinearizationDeviceLink(cmsSigCmykData, curves));
  cmsFreeToneCurve(curve);
  const ProfileBytes srgb = Saved(cmsCreate_sRGBProfile());
  for (const ProfileBytes& profile :
       {srgb, cmyk, ProfileBytes(srgb.begin(), srgb.begin() + 100), ProfileBytes(200), ProfileBytes()}) {
    Picture picture = Cube();
    internal::ConvertToSrgb(profile, picture);
    EXPECT_EQ(picture.rgba, Cube().rgba) << profile.size();
  }
  Picture none;
  internal::ConvertToSrgb(ProfileOf(kAdobeRgb), none);
}

// Codes of 8 bits, which JPEG keeps within a few in even areas.
TEST(ColorProfile, EveryFormatThatCarriesOneIsConverted) {
  const TemporaryFolder folder;
  const ProfileBytes profile = ProfileOf(kAdobeRgb);
  Picture given(16, 16);
  const std::uint16_t color[] = {120 * 257, 180 * 257, 90 * 257, 65535};
  for (int i = 0; i < 256; ++i) std::copy_n(color, 4, given.rgba.data() + 4 * i);
  for (const char* const name : {"a.png", "a.tif", "a.jpg"}) {
    OIIO::ImageSpec spec(16, 16, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("ICCProfile", OIIO::TypeDesc(OIIO::TypeDesc::UINT8, static_cast<int>(profile.size())),
                   profile.data());
    std::vector<std::uint8_t> bytes;
    for (int i = 0; i < 256; ++i) bytes.insert(bytes.end(), {120, 180, 90});
    auto output = OIIO::ImageOutput::create(name);
    ASSERT_TRUE(output && output->open((folder / name).string(), spec)) << name;
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::UINT8, bytes.data()) && output->close()) << name;
    const auto picture = ReadPicture(folder / name);
    ASSERT_TRUE(picture) << picture.error().message;
    SCOPED_TRACE(name);
    const double most = std::string(name) == "a.jpg" ? 3 * kCode : 0.6 * kCode;
    ExpectCodes(*picture, given, SrgbFromAdobe, most);
    const auto stored = ReadPicture(folder / name, {}, Profiles::kIgnore);
    ASSERT_TRUE(stored) << stored.error().message;
    ExpectCodes(
        *stored, given, [](glm::dvec3 code) { return code; }, most);
  }
}

// A PNG of one colour, with or without a profile.
void WritePng(const std::filesystem::path& path, const ProfileBytes& profile,
              const std::array<std::uint8_t, 3>& color = {120, 180, 90}) {
  OIIO::ImageSpec spec(16, 16, 3, OIIO::TypeDesc::UINT8);
  if (!profile.empty()) {
    const OIIO::TypeDesc type(OIIO::TypeDesc::UINT8, static_cast<int>(profile.size()));
    spec.attribute("ICCProfile", type, profile.data());
  }
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < 256; ++i) bytes.insert(bytes.end(), color.begin(), color.end());
  auto output = OIIO::ImageOutput::create("a.png");
  ASSERT_TRUE(output && output->open(path.string(), spec));
  ASSERT_TRUE(output->write_image(OIIO::TypeDesc::UINT8, bytes.data()) && output->close());
}

void SpoilPixels(const std::filesystem::path& png) {
  auto bytes = ReadWholeFile(png);
  ASSERT_TRUE(bytes);
  std::string text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  const std::size_t pixels = text.find("IDAT");
  ASSERT_NE(pixels, std::string::npos);
  std::fill_n((*bytes).begin() + static_cast<std::ptrdiff_t>(pixels + 4), 8, std::byte{0xff});
  ASSERT_TRUE(WriteFileAtomically(png, *bytes));
}

// A profile that keeps all codes is known without the pixels.
TEST(ColorProfile, WhetherAPngHasOtherColours) {
  const TemporaryFolder folder;
  const std::filesystem::path png = folder / "a.png";
  for (const ProfileBytes& profile : {ProfileBytes(), Saved(cmsCreate_sRGBProfile())}) {
    WritePng(png, profile);
    Expected<bool> other = HasOtherColors(png);
    ASSERT_TRUE(other) << other.error().message;
    EXPECT_FALSE(*other);
    SpoilPixels(png);
    other = HasOtherColors(png);
    ASSERT_TRUE(other) << other.error().message;
    EXPECT_FALSE(*other);
  }
  WritePng(png, ProfileOf(kAdobeRgb));
  const Expected<bool> other = HasOtherColors(png);
  ASSERT_TRUE(other) << other.error().message;
  EXPECT_TRUE(*other);
  WritePng(png, ProfileOf(kAdobeRgb), {0, 0, 0});
  const Expected<bool> black = HasOtherColors(png);
  ASSERT_TRUE(black) << black.error().message;
  EXPECT_FALSE(*black) << "black is black in either";
  WritePng(png, ProfileOf(kAdobeRgb));
  SpoilPixels(png);
  EXPECT_FALSE(HasOtherColors(png)) << "the picture cannot be read";
}

std::string TextOf(const ProfileBytes& bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

std::string Digits(std::size_t number, bool lowest_first) {
  std::string text;
  for (int i = 0; i < 4; ++i) text += static_cast<char>(number >> 8 * (lowest_first ? i : 3 - i));
  return text;
}

std::string EmbeddedIn(const std::string& file) {
  const auto found = internal::EmbeddedProfile(std::as_bytes(std::span(file)));
  return {reinterpret_cast<const char*>(found.data()), found.size()};
}

// What OpenImageIO writes, with a profile before it.
TEST(ColorProfile, WebpIsConvertedToo) {
  const TemporaryFolder folder;
  OIIO::ImageSpec spec(16, 16, 3, OIIO::TypeDesc::UINT8);
  std::vector<std::uint8_t> pixels;
  for (int i = 0; i < 256; ++i) pixels.insert(pixels.end(), {120, 180, 90});
  auto output = OIIO::ImageOutput::create("a.webp");
  ASSERT_TRUE(output && output->open((folder / "a.webp").string(), spec));
  ASSERT_TRUE(output->write_image(OIIO::TypeDesc::UINT8, pixels.data()) && output->close());
  const std::string plain = TextOf(*ReadWholeFile(folder / "a.webp")), profile = TextOf(ProfileOf(kAdobeRgb));
  const std::string size{15, 0, 0, 15, 0, 0};
  std::string body = "WEBPVP8X" + Digits(10, true) + ' ' + std::string(3, 0) + size + "ICCP" +
                     Digits(profile.size(), true) + profile + std::string(profile.size() % 2, 0) + plain.substr(12);
  const std::string file = "RIFF" + Digits(body.size(), true) + body;
  EXPECT_EQ(EmbeddedIn(file), profile);
  EXPECT_EQ(EmbeddedIn(plain), "");
  EXPECT_EQ(EmbeddedIn(file.substr(0, 100)), "");
  Picture given(16, 16);
  const std::uint16_t color[] = {120 * 257, 180 * 257, 90 * 257, 65535};
  for (int i = 0; i < 256; ++i) std::copy_n(color, 4, given.rgba.data() + 4 * i);
  for (const bool is_decoded : {false, true}) {
    ASSERT_TRUE(WriteFileAtomically(folder / "b.webp", std::as_bytes(std::span(file))));
    const auto picture =
        is_decoded ? DecodePicture(std::as_bytes(std::span(file)), "b.webp") : ReadPicture(folder / "b.webp");
    ASSERT_TRUE(picture) << picture.error().message;
    ExpectCodes(*picture, given, SrgbFromAdobe, 4 * kCode);
  }
}

TEST(ColorProfile, OfHeifIsFoundInItsBox) {
  const std::string profile = TextOf(ProfileOf(kAdobeRgb));
  const std::string box = Digits(12 + profile.size(), false) + "colrprof" + profile;
  const std::string file = Digits(24, false) + "ftypheic" + std::string(12, 0) + "ipco" + box + "ispe";
  EXPECT_EQ(EmbeddedIn(file), profile);
  EXPECT_EQ(EmbeddedIn(file.substr(0, 60)), "") << "the file ends in it";
  EXPECT_EQ(EmbeddedIn(Digits(24, false) + "ftypheic" + "colrnclx" + std::string(9, 0)), "");
}

}  // namespace
}  // namespace scumble
