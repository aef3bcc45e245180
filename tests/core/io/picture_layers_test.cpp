// The channels of an EXR file that are its picture, and files of layers without one.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/image/color.h"
#include "core/io/picture_file.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

// One pixel; the channel of that number holds 0.1 · (number + 1).
void WriteChannels(const std::filesystem::path& path, const std::vector<std::string>& names) {
  OIIO::ImageSpec spec(1, 1, static_cast<int>(names.size()), OIIO::TypeDesc::FLOAT);
  spec.channelnames = names;
  std::vector<float> values;
  for (std::size_t c = 0; c < names.size(); ++c) values.push_back(0.1f * static_cast<float>(c + 1));
  const auto output = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(output && output->open(path.string(), spec));
  ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, values.data()) && output->close());
}

class PictureLayers : public testing::Test {
 protected:
  // R, G and B come from the channels of these numbers. Without alpha among them, so that no value is divided by it.
  void ExpectColors(const std::vector<std::string>& names, const std::vector<int>& numbers) {
    WriteChannels(folder_ / "p.exr", names);
    const auto picture = ReadPicture(folder_ / "p.exr");
    ASSERT_TRUE(picture) << picture.error().message;
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(picture->At(0, 0)[c], Srgb16FromLinear(0.1f * static_cast<float>(numbers[c] + 1)))
          << names[0] << " " << c;
    }
  }
  void ExpectNone(const std::vector<std::string>& names) {
    WriteChannels(folder_ / "p.exr", names);
    ExpectRefusal(ReadPicture(folder_ / "p.exr"),
                  {"p.exr holds layers and no picture", names[0], "expected R, G and B, or Y"});
  }
  const TemporaryFolder folder_;
};

TEST_F(PictureLayers, NamesSayWhichIsThePicture) {
  ExpectColors({"R", "G", "B"}, {0, 1, 2});
  ExpectColors({"B", "G", "R", "depth.Z", "normal.X"}, {2, 1, 0});
  ExpectColors({"Y", "depth.Z"}, {0, 0, 0});
  ExpectColors({"Composite.Combined.R", "Composite.Combined.G", "Composite.Combined.B", "ViewLayer.Combined.R"},
               {0, 1, 2});
  ExpectColors({"ViewLayer.Depth.Z", "ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B"},
               {1, 2, 3});
  // A view layer of another name, if it is the only one.
  ExpectColors({"Front.Depth.Z", "Front.Combined.R", "Front.Combined.G", "Front.Combined.B"}, {1, 2, 3});
}

TEST_F(PictureLayers, NamesThatSayNothingAreTakenInTheirOrder) {
  ExpectColors({"first", "second", "third"}, {0, 1, 2});
  ExpectColors({"grey"}, {0, 0, 0});
}

TEST_F(PictureLayers, LayersAreNoPicture) {
  ExpectNone({"A", "depth.Z", "normal.X", "normal.Y", "normal.Z"});
  ExpectNone({"lpe.full.B", "lpe.full.G", "lpe.full.R"});
  ExpectNone({"depth.Z"});
  ExpectNone({"albedo.R", "albedo.G", "luminance.Y"});
}

}  // namespace
}  // namespace scumble
