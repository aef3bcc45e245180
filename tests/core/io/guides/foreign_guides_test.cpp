// Guides of other programs: names of channels, coverage, Cryptomatte.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "core/io/guide_file.h"
#include "core/io/guides/cryptomatte.h"
#include "tests/support/guide_files.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

TEST(ForeignGuides, NamesOfManyRenderersAreKnown) {
  const TemporaryFolder folder;
  const auto read_with = [&](std::vector<std::string> names) {
    names.insert(names.end(), {"N.X", "N.Y", "N.Z"});
    const std::size_t z = names.size() - 1;
    if (names[0] == "Picture.A") names.insert(names.end(), {"Picture.R", "Picture.G", "Picture.B"});
    WriteExr(folder / "names.exr", OIIO::ImageSpec(2, 2, 1, OIIO::TypeDesc::FLOAT), names,
             [&](std::size_t c, std::size_t) { return c == z || c < 2      ? 1.0f
                                                      : c < z - 2 || c > z ? 0.5f
                                                                           : 0.0f; });
    GuideReadOptions options = OnlyNormals();
    options.required.Add(Layer::kDepth);
    return ReadGuides(folder / "names.exr", options);
  };
  for (const char* alpha : {"A", "RGBA.A", "beauty.A", "Picture.A"}) {
    for (const char* depth : {"Depth.R", "depth.Y", "zDepth.R", "Z.Z", "zDepth"}) {
      const auto read = read_with({alpha, depth});
      ASSERT_TRUE(read) << alpha << ", " << depth << ": " << read.error().message;
      EXPECT_EQ(read->Plane(Layer::kCoverage)[3], 1.0f) << alpha;
      EXPECT_EQ(read->Plane(Layer::kDepth)[3], 1.0f) << depth;
    }
  }
  for (const std::vector<std::string>& colors :
       {std::vector<std::string>{"A", "Z", "Depth.R", "RGBA.A"}, {"A", "Z", "Depth.R", "diffuse.A"}}) {
    const auto read = read_with(colors);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->Plane(Layer::kDepth)[0], 1.0f) << "a colour is not it where there is another";
    EXPECT_EQ(read->Plane(Layer::kCoverage)[0], 1.0f);
  }
  ExpectRefusal(read_with({"diffuse.A", "specular.A", "Pz"}), ErrorKind::kInput,
                {"no layer A, depth", "Known names are A, alpha, Combined.A", "for A; depth.Z, Z, depth",
                 "it also holds", "Pz", "diffuse.A", "specular.A"});
}

TEST(ForeignGuides, IdsOfABareNameAreReadWhereTheyAreRequired) {
  const TemporaryFolder folder;
  std::vector<std::string> names = kNormalAndA;
  names.insert(names.end(), {"material", "object", "object.ID"});
  WriteExr(folder / "bare.exr", OIIO::ImageSpec(2, 2, 1, OIIO::TypeDesc::FLOAT), names, [](std::size_t c, std::size_t) {
    return c == 4 || c == 5 ? 5e8f : c == 6 ? 7.0f : 1.0f;
  });
  GuideReadOptions options = OnlyNormals();
  options.required.Add(Layer::kObject);
  options.optional = {Layer::kObject, Layer::kMaterial};
  const auto read = ReadGuides(folder / "bare.exr", options);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->Plane(Layer::kObject)[3], 7.0f) << "object.ID goes before object";
  EXPECT_FALSE(read->Has(Layer::kMaterial));
  options.required.Add(Layer::kMaterial);
  ExpectRefusal(ReadGuides(folder / "bare.exr", options), ErrorKind::kInput, {"layer material", "above 2^24"});
}

TEST(ForeignGuides, OnlyThePicturesAlphaIsCoverage) {
  const TemporaryFolder folder;
  const auto read_with = [&](std::vector<std::string> names) {
    names.insert(names.end(), {"N.X", "N.Y", "N.Z"});
    WriteExr(folder / "alpha.exr", OIIO::ImageSpec(2, 2, 1, OIIO::TypeDesc::FLOAT), names,
             [&](std::size_t c, std::size_t) { return c == 0 || c == names.size() - 1 ? 1.0f : 0.0f; });
    return ReadGuides(folder / "alpha.exr", OnlyNormals());
  };
  EXPECT_TRUE(read_with({"Picture.A", "Picture.R", "picture.g", "Picture.B", "shadow.R", "shadow.G", "shadow.B"}));
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"shadow.A", "shadow.R", "shadow.G", "shadow.B", "R", "G", "B"},
        {"specular.A", "R", "G", "B"},
        {"shadow.A", "shadow.R"}}) {
    ExpectRefusal(read_with(names), ErrorKind::kInput, {"no layer A", names[0]});
  }
}

// As Arnold and Karma name them, in one view layer or beside it.
TEST(ForeignGuides, CryptomatteOfOtherRenderersGivesIdsAndNames) {
  const TemporaryFolder folder;
  const auto bits_of = [](const char* name) { return std::bit_cast<float>(MatteBits(MatteHash(name))); };
  const auto write = [&](const std::string& prefix, const std::string& matte, const char* components,
                         const char* more = nullptr) {
    OIIO::ImageSpec spec(2, 2, 1, OIIO::TypeDesc::FLOAT);
    spec.attribute("cryptomatte/1234567/name", matte);
    char manifest[80];
    std::snprintf(manifest, sizeof manifest, R"({"Pear":"%08x","/set/Dish":"%08x"})", MatteHash("Pear"),
                  MatteHash("/set/Dish"));
    spec.attribute("cryptomatte/1234567/manifest", manifest);
    std::vector<std::string> names = {"A", prefix + "N.X", prefix + "N.Y", prefix + "N.Z"};
    for (const char* level : {"00.", "01."}) {
      for (const char* c = components; *c; ++c) names.push_back(matte + level + *c);
    }
    for (const char* unread : {"", "00"}) names.push_back(std::string("crypto_asset") + unread + ".A");
    if (more) names.push_back(more);
    WriteExr(folder / "matte.exr", spec, names, [&](std::size_t c, std::size_t i) {
      if (c == 4) return i == 3 ? 0.0f : bits_of(i == 2 ? "/set/Dish" : "Pear");
      if (c == 5) return i == 0 ? 0.25f : 1.0f;
      if (c == 6) return i == 0 ? bits_of("/set/Dish") : 0.0f;
      if (c == 7) return i == 0 ? 0.75f : 0.0f;
      return c == 0 || c == 3 || c == names.size() - 1 ? 1.0f : 0.0f;
    });
  };
  GuideReadOptions options = OnlyNormals();
  options.required.Add(Layer::kObject);
  struct MatteNames {
    const char *prefix, *matte, *components;
  };
  for (const MatteNames& one : {MatteNames{"", "crypto_object", "RGBA"},
                                {"", "CRYPTO_OBJECT", "rgba"},
                                {"", "CryptoObject", "rgba"},
                                {"rl.", "rl.crypto_object", "rgba"},
                                {"rl.", "crypto_object", "RGBA"}}) {
    write(one.prefix, one.matte, one.components);
    const auto read = ReadGuides(folder / "matte.exr", options);
    ASSERT_TRUE(read) << one.prefix << one.matte << ": " << read.error().message;
    const auto name_at = [&](std::size_t i) {
      return read->object_names.at(static_cast<std::uint32_t>(read->Plane(Layer::kObject)[i]));
    };
    EXPECT_EQ(name_at(0), "/set/Dish") << "it covers more than the Pear";
    EXPECT_EQ(name_at(1), "Pear");
    EXPECT_EQ(name_at(2), "/set/Dish");
    EXPECT_EQ(read->Plane(Layer::kObject)[3], 0.0f);
    EXPECT_EQ(read->object_names.size(), 2u);
    EXPECT_TRUE(InspectGuides(folder / "matte.exr")->layers.begin()->second.Has(Layer::kObject));
  }
  write("", "crypto_object", "RGBA", "object.ID");
  const auto read = ReadGuides(folder / "matte.exr", options);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->Plane(Layer::kObject)[1], 1.0f) << "the file's own ids";
  EXPECT_TRUE(read->object_names.empty());
}

// Reads a file where objects are optional.
void ExpectNoObject(const fs::path& path) {
  GuideReadOptions options = OnlyNormals();
  options.optional = {Layer::kDepth, Layer::kObject};
  const auto read = ReadGuides(path, options);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_FALSE(read->Has(Layer::kObject));
}

TEST(ForeignGuides, ACryptomatteThatLostItsIdsIsRefusedWhereItIsNeeded) {
  const TemporaryFolder folder;
  std::vector<std::string> names = kNormalAndA;
  for (const char* c : {"R", "G", "B", "A"}) names.push_back(std::string("crypto_object00.") + c);
  for (const bool is_half : {true, false}) {
    OIIO::ImageSpec spec(2, 2, static_cast<int>(names.size()), is_half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
    spec.channelnames = names;
    if (!is_half) spec.attribute("compression", "dwaa");
    const std::vector<float> ones(4 * names.size(), 1.0f);
    auto output = OIIO::ImageOutput::create((folder / "lost.exr").string());
    ASSERT_TRUE(output->open((folder / "lost.exr").string(), spec)) << output->geterror();
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, ones.data())) << output->geterror();
    ASSERT_TRUE(output->close());
    EXPECT_TRUE(ReadGuides(folder / "lost.exr", OnlyNormals())) << "nothing needs it";
    ExpectNoObject(folder / "lost.exr");
    GuideReadOptions options = OnlyNormals();
    options.required.Add(Layer::kObject);
    ExpectRefusal(ReadGuides(folder / "lost.exr", options), ErrorKind::kInput,
                  {"lost.exr", "Cryptomatte", is_half ? "half floats" : "dwaa"});
  }
}

TEST(ForeignGuides, OnlyTheCryptomattesOwnPartNeedsExactNumbers) {
  const TemporaryFolder folder;
  std::vector<OIIO::ImageSpec> specs(2, OIIO::ImageSpec(2, 2, 5, OIIO::TypeDesc::FLOAT));
  specs[0].channelnames = {"A", "normal.X", "normal.Y", "normal.Z", "Z"};
  specs[0].attribute("oiio:subimagename", "data");
  specs[0].attribute("compression", "dwaa");
  specs[1].channelnames = {"crypto_object00.R", "crypto_object00.G", "crypto_object00.B", "crypto_object00.A", "other"};
  specs[1].attribute("oiio:subimagename", "mattes");
  specs[1].attribute("compression", "zips");
  const std::string file = (folder / "parts.exr").string();
  const std::vector<float> ones(20, 1.0f);
  auto output = OIIO::ImageOutput::create(file);
  ASSERT_TRUE(output->open(file, 2, specs.data())) << output->geterror();
  ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, ones.data())) << output->geterror();
  ASSERT_TRUE(output->open(file, specs[1], OIIO::ImageOutput::AppendSubimage)) << output->geterror();
  ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, ones.data())) << output->geterror();
  ASSERT_TRUE(output->close());
  GuideReadOptions options = OnlyNormals();
  options.required.Add({Layer::kDepth, Layer::kObject});
  const auto read = ReadGuides(file, options);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->object_names.size(), 1u);
}

TEST(ForeignGuides, ADamagedManifestIsRefusedWhereItIsNeeded) {
  const TemporaryFolder folder;
  std::vector<std::string> names = kNormalAndA;
  for (const char* c : {"R", "G", "B", "A"}) names.push_back(std::string("crypto_object00.") + c);
  OIIO::ImageSpec spec(2, 2, 1, OIIO::TypeDesc::FLOAT);
  spec.attribute("cryptomatte/1234567/name", "crypto_object");
  spec.attribute("cryptomatte/1234567/manifest", R"({"Pear":"zz"})");
  WriteExr(folder / "damaged.exr", spec, names, [](std::size_t, std::size_t) { return 1.0f; });
  ExpectNoObject(folder / "damaged.exr");
  GuideReadOptions options = OnlyNormals();
  options.required.Add(Layer::kObject);
  ExpectRefusal(ReadGuides(folder / "damaged.exr", options), ErrorKind::kInput, {"damaged.exr", "manifest is damaged"});
}

}  // namespace
}  // namespace scumble
