// The foundations: colour, hashes, layer names, ids and the rules of a guide set.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/image/check.h"
#include "core/image/color.h"
#include "core/image/guides.h"
#include "core/image/hash.h"
#include "core/image/jitter_rate.h"
#include "core/image/layers.h"
#include "tests/support/numbers.h"

namespace scumble {
namespace {

// ---- colour ----------------------------------------------------------------------------------------------------

TEST(Color, EverySrgbValueSurvivesTheRoundTrip) {
  float previous = -1.0f;
  for (int v = 0; v < 65536; ++v) {
    const float linear = Srgb16ToLinear(static_cast<std::uint16_t>(v));
    ASSERT_EQ(Srgb16FromLinear(linear), v);
    ASSERT_GT(linear, previous) << "the table must rise, at " << v;
    previous = linear;
  }
  EXPECT_EQ(Srgb16ToLinear(0), 0.0f);
  EXPECT_EQ(Srgb16ToLinear(65535), 1.0f);
}

TEST(Color, KnownValues) {
  EXPECT_EQ((Srgb16FromLinear(0.5f) + 128) / 257, 188);
  EXPECT_NEAR(SrgbToLinear(0.5f), 0.214041f, 1e-6f);
  EXPECT_NEAR(SrgbToLinear(0.04045f), 0.0031308f, 1e-6f);
  EXPECT_TRUE(std::isnan(SrgbToLinear(kNan)));
  EXPECT_NEAR(Luminance(1.0f, 1.0f, 1.0f), 1.0f, 1e-6f);
}

TEST(Color, EncodingClampsWhatNoIntegerHolds) {
  EXPECT_EQ(Srgb16FromLinear(-1.0f), 0);
  EXPECT_EQ(Srgb16FromLinear(-kInfinity), 0);
  EXPECT_EQ(Srgb16FromLinear(kNan), 0);
  EXPECT_EQ(Srgb16FromLinear(1.0f), 65535);
  EXPECT_EQ(Srgb16FromLinear(std::nextafter(1.0f, 0.0f)), 65535);
  EXPECT_EQ(Srgb16FromLinear(65504.0f), 65535);
  EXPECT_EQ(Srgb16FromLinear(kInfinity), 65535);
  EXPECT_EQ(Srgb16FromLinear(std::numeric_limits<float>::denorm_min()), 0);
}

// ---- chance ----------------------------------------------------------------------------------------------------

TEST(Chance, UnitFloatsFillTheUnitIntervalEvenly) {
  constexpr int kBins = 64, kCount = 64 * 4096;
  std::vector<int> bins(kBins, 0);
  double sum = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const float u = UnitFloat(Hash(7, i));
    ASSERT_GE(u, 0.0f);
    ASSERT_LT(u, 1.0f);
    ++bins[static_cast<int>(u * kBins)];
    sum += u;
  }
  EXPECT_NEAR(sum / kCount, 0.5, 0.005);
  double chi_square = 0.0;
  for (int count : bins) chi_square += (count - 4096.0) * (count - 4096.0) / 4096.0;
  EXPECT_LT(chi_square, 63.0 + 6.0 * std::sqrt(2.0 * 63.0)) << "63 degrees of freedom, six standard deviations";
}

TEST(Chance, UnitFloatNeverRoundsUpToOne) {
  EXPECT_LT(UnitFloat(~0ull), 1.0f);
  EXPECT_EQ(UnitFloat(~0ull), 1.0f - 0x1.0p-24f);
  EXPECT_EQ(UnitFloat(0), 0.0f);
}

TEST(Chance, OneFlippedBitFlipsHalfOfTheHash) {
  double flipped = 0.0;
  int pairs = 0;
  for (int i = 0; i < 64; ++i) {
    for (int bit = 0; bit < 64; ++bit, ++pairs) {
      flipped += __builtin_popcountll(Mix64(Hash(i)) ^ Mix64(Hash(i) ^ (1ull << bit)));
    }
  }
  EXPECT_NEAR(flipped / pairs, 32.0, 0.5);
}

TEST(Chance, OrderAndCountOfArgumentsMatter) {
  EXPECT_NE(Hash(1, 2), Hash(2, 1));
  EXPECT_NE(Hash(0), Hash(0, 0));
  EXPECT_NE(Hash(), Hash(0));
  EXPECT_EQ(Hash(-1), Hash(std::int64_t(-1))) << "a negative cell is the same cell in any integer type";
  EXPECT_NE(HashText("ab"), HashText("ba"));
  EXPECT_NE(HashText(""), HashText(std::string_view("\0", 1)));
  // Other machines and compilers must give these very values, or equal guides give different pictures.
  static_assert(Mix64(0) == 0xe220a8397b1dcdafull, "the first number of SplitMix64 with seed 0");
}

// ---- layer names -----------------------------------------------------------------------------------------------

struct NameCase {
  const char* name;
  Layer layer;
  int component;
  const char* prefix;
};

TEST(ChannelNames, KnownOnes) {
  const NameCase cases[] = {
      {"A", Layer::kCoverage, 0, ""},
      {"a", Layer::kCoverage, 0, ""},
      {"ViewLayer.Combined.A", Layer::kCoverage, 0, "ViewLayer"},
      {"normal.X", Layer::kNormal, 0, ""},
      {"ViewLayer.Normal.X", Layer::kNormal, 0, "ViewLayer"},
      {"VIEWLAYER.NORMAL.y", Layer::kNormal, 1, "VIEWLAYER"},
      {"N.Z", Layer::kNormal, 2, ""},
      {"beauty.n.x", Layer::kNormal, 0, "beauty"},
      {"Z", Layer::kDepth, 0, ""},
      {"depth", Layer::kDepth, 0, ""},
      {"depth.Z", Layer::kDepth, 0, ""},
      {"View Layer.Depth.Z", Layer::kDepth, 0, "View Layer"},
      {"Scene v1.2 (final).Normal.Z", Layer::kNormal, 2, "Scene v1.2 (final)"},
      {"a.b.c.position.Y", Layer::kPosition, 1, "a.b.c"},
      {"P.Z", Layer::kPosition, 2, ""},
      {"ViewLayer.IndexOB.X", Layer::kObject, 0, "ViewLayer"},
      {"ViewLayer.IndexMA.X", Layer::kMaterial, 0, "ViewLayer"},
      {"ViewLayer.DiffCol.G", Layer::kAlbedo, 1, "ViewLayer"},
      {"lpe.LDE.R", Layer::kLpeLDE, 0, ""},
      {"LPE.lde.b", Layer::kLpeLDE, 2, ""},
      {"View.lpe.LD12E.G", Layer::kLpeLD12E, 1, "View"},
      {"lpe.full.B", Layer::kLpeFull, 2, ""},
      {"luminance.Y", Layer::kLuminance, 0, ""},
      {"motion.Y", Layer::kMotion, 1, ""},
      {"object.ID", Layer::kObject, 0, ""},
      {"ViewLayer.UV.U", Layer::kUv, 0, "ViewLayer"},
      {"UV.V", Layer::kUv, 1, ""},
      {"cosine.Y", Layer::kCosine, 0, ""},
      {"UVA.A", Layer::kCoverage, 0, "UVA"},
  };
  for (const NameCase& expected : cases) {
    const auto found = ParseChannelName(expected.name);
    ASSERT_TRUE(found) << expected.name;
    EXPECT_EQ(Info(found->layer).name, std::string(Info(expected.layer).name)) << expected.name;
    EXPECT_EQ(found->component, expected.component) << expected.name;
    EXPECT_EQ(found->prefix, expected.prefix) << expected.name;
  }
}

TEST(ChannelNames, UnknownOnes) {
  for (const char* name :
       {"", ".", "X", "R", "ViewLayer.Combined.R", "Denoising Normal.X", "ViewLayer.Denoising Normal.X", "abnormal.X",
        "normal", "normal.W", "normalX", "normal.X.left", "lpe.LDDDE.R", "Mist.V", "normal.X ", "Shadow Catcher.R",
        "beauty.lpe", "ViewLayer.UV.A", "UV.A"}) {
    EXPECT_FALSE(ParseChannelName(name)) << name;
  }
}

TEST(ChannelNames, EveryChannelOfTheTableIsItself) {
  int index = 0;
  for (const LayerInfo& info : AllLayers()) {
    EXPECT_EQ(static_cast<int>(info.layer), index++) << info.name << " is out of order";
    EXPECT_EQ(ChannelCount(info.layer), static_cast<int>(info.channels.size()));
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      for (const std::string before : {"", "My.View Layer"}) {
        const auto found =
            ParseChannelName(before.empty() ? std::string(info.channels[c]) : before + "." + info.channels[c]);
        ASSERT_TRUE(found) << info.channels[c];
        EXPECT_EQ(found->layer, info.layer) << info.channels[c];
        EXPECT_EQ(found->component, c);
        EXPECT_EQ(found->prefix, before);
      }
    }
  }
  EXPECT_EQ(index, kLayerCount);
}

TEST(ChannelNames, ThePageListsThoseOfOtherPrograms) {
  std::ifstream file(SCUMBLE_SOURCE_DIR "/docs/guides.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  for (const LayerInfo& info : AllLayers()) {
    std::string names;
    for (const std::string& name : ChannelNames(info.layer, 0)) {
      names += (names.empty() ? "`" : ", `") + name + "`";
      const auto found = ParseChannelName(name);
      ASSERT_TRUE(found) << name;
      EXPECT_EQ(found->layer, info.layer) << name;
      EXPECT_EQ(found->prefix, "") << name;
    }
    if (ChannelNames(info.layer, 0).size() == 1) continue;  // no other program's
    const std::string row = std::string("| `") + info.name + "` | " + names + " |\n";
    EXPECT_NE(page.find(row), std::string::npos) << "docs/guides.md lacks: " << row;
  }
}

TEST(LayerSets, AddRemoveContain) {
  LayerSet set{Layer::kNormal, Layer::kDepth};
  EXPECT_TRUE(set.Has(Layer::kNormal));
  EXPECT_FALSE(set.Has(Layer::kCoverage));
  EXPECT_EQ(set.ToString(), "normal, depth");
  EXPECT_TRUE(AlwaysWritten().Contains(set));
  EXPECT_FALSE(set.Contains(AlwaysWritten()));
  EXPECT_TRUE(set.Contains(LayerSet()));
  EXPECT_EQ(set.Remove(Layer::kDepth).Remove(Layer::kDepth).ToString(), "normal");
  EXPECT_TRUE(set.Remove(Layer::kNormal).empty());
  EXPECT_EQ(set.ToString(), "none");
  EXPECT_EQ(set.Add(AlwaysWritten()), AlwaysWritten());
}

TEST(LayerSets, FromText) {
  auto set = ParseLayers("lpe.LDE,Normal,,A,");
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_EQ(*set, (LayerSet{Layer::kLpeLDE, Layer::kNormal, Layer::kCoverage}));
  auto empty = ParseLayers("");
  ASSERT_TRUE(empty);
  EXPECT_TRUE(empty->empty());
  for (const LayerInfo& info : AllLayers()) {
    auto one = ParseLayers(info.name);
    ASSERT_TRUE(one) << info.name;
    EXPECT_EQ(*one, LayerSet{info.layer});
  }
  auto wrong = ParseLayers("normal,wibble");
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().kind, ErrorKind::kUsage);
  EXPECT_NE(wrong.error().message.find("'wibble'"), std::string::npos);
  for (const LayerInfo& info : AllLayers()) EXPECT_NE(wrong.error().message.find(info.name), std::string::npos);
}

// ---- ids -------------------------------------------------------------------------------------------------------

TEST(Ids, AreExactInAFloatAndNeverTheBackground) {
  std::vector<std::string> names;
  for (int i = 0; i < 20000; ++i) names.push_back("Object." + std::to_string(i));
  const auto ids = IdsForNames(names);
  ASSERT_EQ(ids.size(), names.size());
  EXPECT_EQ(std::set<std::uint32_t>(ids.begin(), ids.end()).size(), names.size())
      << "20,000 names do collide in 24 bits";
  for (std::uint32_t id : ids) {
    ASSERT_GE(id, 1u);
    ASSERT_LT(id, 1u << 24);
    ASSERT_EQ(static_cast<std::uint32_t>(static_cast<float>(id)), id);
  }
}

TEST(Ids, FollowTheNameAlone) {
  const std::vector<std::string> few = {"Ball", "Cube", "Ball", ""};
  const std::vector<std::string> more = {"Torus", "Cube", "", "Café", "Ball"};
  const auto a = IdsForNames(few), b = IdsForNames(more);
  EXPECT_EQ(a[0], a[2]) << "equal names share an id";
  EXPECT_EQ(a[0], b[4]);
  EXPECT_EQ(a[1], b[1]);
  EXPECT_EQ(a[3], b[2]);
  EXPECT_TRUE(IdsForNames({}).empty());
}

// Two names whose hashes fall on the same id, in alphabetical order.
std::pair<std::string, std::string> CollidingNames() {
  std::unordered_map<std::uint32_t, std::string> seen;
  for (int i = 0;; ++i) {
    const std::string name = "n" + std::to_string(i);
    const auto slot = static_cast<std::uint32_t>(HashText(name) % ((1u << 24) - 1));
    const auto [found, fresh] = seen.emplace(slot, name);
    if (!fresh) return std::minmax(found->second, name);
  }
}

TEST(Ids, ACollisionMovesTheLaterName) {
  const auto [early, late] = CollidingNames();
  const std::vector<std::string> alone_early = {early}, alone_late = {late}, both = {late, early};
  const std::uint32_t id = IdsForNames(alone_early)[0];
  ASSERT_EQ(IdsForNames(alone_late)[0], id) << "the pair must collide for this test to mean anything";
  const auto ids = IdsForNames(both);
  EXPECT_EQ(ids[1], id);
  EXPECT_EQ(ids[0], id == (1u << 24) - 1 ? 1u : id + 1);
}

// ---- guide sets ------------------------------------------------------------------------------------------------

GuideSet ValidGuides(int width = 4, int height = 3) {
  GuideSet guides(width, height);
  for (Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject, Layer::kMaterial, Layer::kAlbedo,
                      Layer::kLuminance})
    guides.Add(layer);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kCoverage)[i] = 1.0f;
    guides.Plane(Layer::kNormal, 2)[i] = 1.0f;
    guides.Plane(Layer::kDepth)[i] = 2.0f;
    guides.Plane(Layer::kObject)[i] = kMostId;
    guides.Plane(Layer::kMaterial)[i] = 0.5f;  // integers of 32 bits are fractions once they are read as floats
  }
  return guides;
}

TEST(GuideSets, AddFillsWithTheBackground) {
  GuideSet guides(2, 2);
  for (const LayerInfo& info : AllLayers()) {
    EXPECT_FALSE(guides.Has(info.layer));
    guides.Add(info.layer);
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      for (float value : guides.Plane(info.layer, c)) EXPECT_EQ(value, info.layer == Layer::kDepth ? kInfinity : 0.0f);
    }
  }
  guides.Plane(Layer::kDepth)[3] = 5.0f;
  guides.Add(Layer::kDepth);
  EXPECT_EQ(guides.Plane(Layer::kDepth)[3], 5.0f) << "adding a layer again must not wipe it";
  guides.Plane(Layer::kNormal, 1)[2] = 7.0f;
  EXPECT_EQ(guides.Vec3(Layer::kNormal, guides.Index(0, 1)), glm::vec3(0, 7, 0));
  guides.Remove(Layer::kDepth);
  EXPECT_FALSE(guides.Has(Layer::kDepth));
  EXPECT_THROW(guides.Plane(Layer::kDepth), InternalError);
  EXPECT_THROW(guides.Plane(Layer::kCoverage, 1), InternalError);
  EXPECT_THROW(GuideSet(-1, 2), InternalError);
}

TEST(GuideSets, AllBackgroundIsValid) {
  GuideSet guides(3, 3);
  for (const LayerInfo& info : AllLayers()) guides.Add(info.layer);
  EXPECT_TRUE(guides.Validate("empty"));
  EXPECT_TRUE(ValidGuides().Validate("full"));
}

struct Defect {
  const char* what;
  std::function<void(GuideSet&)> spoil;  // pixels (1, 1) and (3, 2)
  std::vector<const char*> words;
};

TEST(GuideSets, EveryDefectIsNamedCountedAndLocated) {
  const auto set = [](Layer layer, int component, float value) {
    return [=](GuideSet& g) { g.Plane(layer, component)[5] = g.Plane(layer, component)[11] = value; };
  };
  const Defect defects[] = {
      {"coverage above 1", set(Layer::kCoverage, 0, 2.0f), {"layer A", "0 to 1"}},
      {"coverage below 0", set(Layer::kCoverage, 0, -0.5f), {"layer A"}},
      {"coverage NaN", set(Layer::kCoverage, 0, kNan), {"layer A"}},
      {"normal NaN", set(Layer::kNormal, 1, kNan), {"layer normal", "NaN"}},
      {"normal infinite", set(Layer::kNormal, 0, kInfinity), {"layer normal"}},
      {"normal zero", set(Layer::kNormal, 2, 0.0f), {"layer normal", "zero"}},
      {"normal packed", set(Layer::kNormal, 2, 0.4f), {"layer normal", "[-1, 1]"}},
      {"depth NaN", set(Layer::kDepth, 0, kNan), {"layer depth", "NaN"}},
      {"depth negative", set(Layer::kDepth, 0, -1.0f), {"layer depth", "negative"}},
      {"id NaN", set(Layer::kObject, 0, kNan), {"layer object", "NaN", "16777216"}},
      {"id infinite", set(Layer::kMaterial, 0, kInfinity), {"layer material", "above 2^24"}},
      {"id negative", set(Layer::kMaterial, 0, -1.0f), {"layer material", "negative"}},
      {"id beyond a float's whole numbers", set(Layer::kObject, 0, 16777218.0f), {"layer object"}},
      {"id beyond 32 bits", set(Layer::kObject, 0, 1e30f), {"layer object"}},
      {"colour infinite", set(Layer::kAlbedo, 1, kInfinity), {"layer albedo", "infinite"}},
      {"colour NaN", set(Layer::kLuminance, 0, kNan), {"layer luminance", "NaN"}},
  };
  for (const Defect& defect : defects) {
    GuideSet guides = ValidGuides();
    defect.spoil(guides);
    const Status status = guides.Validate("ball.exr");
    ASSERT_FALSE(status) << defect.what;
    EXPECT_EQ(status.error().kind, ErrorKind::kInput);
    const std::string& message = status.error().message;
    EXPECT_EQ(message.rfind("ball.exr", 0), 0u) << message;
    EXPECT_NE(message.find("2 pixels, first at (1, 1)"), std::string::npos) << defect.what << ": " << message;
    for (const char* word : defect.words) EXPECT_NE(message.find(word), std::string::npos) << message;
  }
}

TEST(GuideSets, ABadPixelCountsOnceWhateverItsChannels) {
  GuideSet guides = ValidGuides();
  guides.Plane(Layer::kAlbedo, 0)[7] = kNan;
  guides.Plane(Layer::kAlbedo, 1)[7] = kNan;
  const Status one = guides.Validate("g");
  ASSERT_FALSE(one);
  EXPECT_NE(one.error().message.find("1 pixel, first at (3, 1)"), std::string::npos) << one.error().message;
  guides.Plane(Layer::kAlbedo, 2)[2] = kInfinity;
  const Status two = guides.Validate("g");
  ASSERT_FALSE(two);
  EXPECT_NE(two.error().message.find("2 pixels, first at (2, 0)"), std::string::npos) << two.error().message;
}

TEST(GuideSets, TheBackgroundMayHoldAnything) {
  GuideSet guides = ValidGuides();
  guides.Plane(Layer::kCoverage)[6] = 0.0f;
  guides.Plane(Layer::kNormal, 0)[6] = kNan;
  guides.Plane(Layer::kDepth)[6] = -kInfinity;
  guides.Plane(Layer::kObject)[6] = kInfinity;
  guides.Plane(Layer::kMaterial)[6] = kNan;
  guides.Plane(Layer::kAlbedo)[6] = kNan;
  EXPECT_TRUE(guides.Validate("g"));
}

// Values above 2^24 and NaN stand for no id: in 32 bits the conversion would be undefined, and 2^33 + 7168 the id 7168
// on some machines.
TEST(GuideSets, IdsAreThoseThatFloatsHold) {
  for (const float whole : {1.0f, 7168.0f, 16777215.0f, 16777216.0f}) EXPECT_EQ(IdOf(whole), std::uint32_t(whole));
  EXPECT_EQ(IdOf(3.75f), 3u);
  for (const float none :
       {0.0f, -0.0f, -1.0f, 16777218.0f, 0x1p32f, 0x1p33f + 7168.0f, 1e30f, kInfinity, -kInfinity, kNan}) {
    EXPECT_EQ(IdOf(none), 0u) << none;
  }
}

TEST(GuideSets, SizesAndLayersThatCannotBe) {
  for (const auto& [width, height] :
       {std::pair{0, 0}, {0, 5}, {5, 0}, {kMaxImageSide + 1, 1}, {1, kMaxImageSide + 1}}) {
    const Status status = GuideSet(width, height).Validate("g");
    ASSERT_FALSE(status);
    const std::string size = std::to_string(width) + "×" + std::to_string(height);
    EXPECT_NE(status.error().message.find(size), std::string::npos) << status.error().message;
  }
  GuideSet guides = ValidGuides();
  guides.Remove(Layer::kNormal);
  const Status status = guides.Validate("g");
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("at least A and normal"), std::string::npos);
}

TEST(Checks, SayWhatFailedWithBothValues) {
  try {
    SCUMBLE_CHECK_EQ(2 + 2, 5);
    FAIL() << "a failed check must throw";
  } catch (const InternalError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("2 + 2 == 5 (4 against 5)"), std::string::npos) << message;
    EXPECT_NE(message.find("image_test.cpp:"), std::string::npos) << message;
  }
  EXPECT_NO_THROW(SCUMBLE_CHECK(true));
}

TEST(JitterStep, IsExactAndIndependentOfTheRange) {
  EXPECT_EQ(JitterStep(0.0, 1000, 24, 1), 0);
  EXPECT_EQ(JitterStep(-1.0, 1000, 24, 1), 1000);
  EXPECT_EQ(JitterStep(12.0, 0, 24, 1), 0);
  EXPECT_EQ(JitterStep(12.0, 1, 24, 1), 0);
  EXPECT_EQ(JitterStep(12.0, 2, 24, 1), 1);
  EXPECT_EQ(JitterStep(12.0, -1, 24, 1), -1) << "floor, before frame 0 too";
  EXPECT_EQ(JitterStep(12.0, 1000000007, 24000, 1001), 1000000007LL * 12 * 1001 / 24000);
  EXPECT_EQ(JitterStep(1000.0, 2000000000, 24000000, 1001000), 83416666666) << "more than 64 bits on the way";
}

}  // namespace
}  // namespace scumble
