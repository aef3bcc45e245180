// Fragments in guide files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/image/fragments.h"
#include "core/image/hash.h"
#include "core/io/atomic_file.h"
#include "core/io/channel_file.h"
#include "core/io/guide_file.h"
#include "core/io/guides/cryptomatte.h"
#include "core/io/guides/fragment_storage.h"
#include "tests/support/guide_files.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// Valid guides of a few layers, with one to three fragments in every fifth pixel.
GuideSet GuidesWithFragments(int width, int height) {
  GuideSet guides(width, height);
  auto fragments = std::make_shared<Fragments>();
  for (std::size_t i = 0; i < guides.pixel_count(); i += 5) {
    for (std::size_t k = 0; k <= Hash(i) % Fragments::kMostInPixel; ++k) {
      fragments->pixel.push_back(static_cast<std::uint32_t>(i));
    }
  }
  fragments->values = GuideSet(int(fragments->count()), 1);
  for (std::size_t i = 0; i < fragments->count(); ++i) fragments->cells.push_back(std::uint16_t(Hash(7, i) % 65536));
  int number = 0;
  for (GuideSet* const set : {&guides, &fragments->values}) {
    ++number;
    for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kObject, Layer::kAlbedo}) {
      set->Add(layer);
      for (int c = 0; c < ChannelCount(layer); ++c) {
        const auto plane = set->Plane(layer, c);
        for (std::size_t i = 0; i < plane.size(); ++i) {
          plane[i] = layer == Layer::kObject ? float(Hash(number, i) % 99) : UnitFloat(Hash(number, int(layer), c, i));
        }
      }
    }
    for (std::size_t i = 0; i < set->pixel_count(); ++i) {
      const glm::vec3 normal = glm::normalize(set->Vec3(Layer::kNormal, i) + glm::vec3(0.1f));
      for (int c = 0; c < 3; ++c) set->Plane(Layer::kNormal, c)[i] = normal[c];
      set->Plane(Layer::kCoverage)[i] = number == 1 ? 1.0f : 0.1f + 0.2f * set->Plane(Layer::kCoverage)[i];
    }
  }
  guides.attributes["scumble:generator"] = "test";
  guides.fragments = std::move(fragments);
  return guides;
}

void ExpectSameFragments(const GuideSet& a, const GuideSet& b) {
  ASSERT_TRUE(a.fragments && b.fragments);
  EXPECT_EQ(a.fragments->pixel, b.fragments->pixel);
  EXPECT_EQ(a.fragments->cells, b.fragments->cells);
  ASSERT_EQ(a.fragments->values.layers(), b.fragments->values.layers());
  for (const LayerInfo& info : AllLayers()) {
    if (!a.fragments->values.Has(info.layer)) continue;
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      EXPECT_TRUE(
          std::ranges::equal(a.fragments->values.Plane(info.layer, c), b.fragments->values.Plane(info.layer, c)))
          << info.name;
    }
  }
}

GuideReadOptions Layers(const LayerSet& layers) {
  GuideReadOptions options;
  options.required = layers;
  return options;
}

// Where fragments are, mattes have the two objects that cover most of the pixel.
TEST(FragmentFile, MattesHaveTheSharesOfFragments) {
  const TemporaryFolder folder;
  GuideSet guides = GuidesWithFragments(37, 23);
  std::map<std::uint32_t, std::uint32_t> matte_ids;
  for (std::uint32_t id = 0; id < 99; ++id) {
    guides.object_names[id] = "object " + std::to_string(id);
    matte_ids[id] = MatteBits(MatteHash(guides.object_names[id]));
  }
  GuideWriteOptions options;
  options.cryptomatte = true;
  ASSERT_TRUE(WriteGuides(folder / "g.exr", guides, options));
  const auto read = ReadChannels(folder / "g.exr");
  ASSERT_TRUE(read) << read.error().message;
  const Fragments& fragments = *guides.fragments;
  int shared = 0;
  for (std::size_t i = 0, f = 0; i < guides.pixel_count(); ++i) {
    std::map<std::uint32_t, float> shares;
    float centre = guides.Plane(Layer::kCoverage)[i];
    for (; f < fragments.count() && fragments.pixel[f] == i; ++f) {
      const float coverage = fragments.values.Plane(Layer::kCoverage)[f];
      shares[matte_ids.at(std::uint32_t(fragments.values.Plane(Layer::kObject)[f]))] += coverage;
      centre -= coverage;
    }
    shares[matte_ids.at(std::uint32_t(guides.Plane(Layer::kObject)[i]))] += centre;
    std::vector<float> sorted;
    for (const auto& [id, share] : shares) sorted.push_back(share);
    std::ranges::sort(sorted, std::greater());
    sorted.resize(std::max<std::size_t>(2, sorted.size()));
    shared += sorted[1] > 0.0f;
    for (int rank = 0; rank < 2; ++rank) {
      const auto channel = [&](char name) { return (*read->Find(std::string("CryptoObject00.") + name))[i]; };
      const float coverage = channel("GA"[rank]);
      ASSERT_NEAR(coverage, sorted[std::size_t(rank)], 1e-6f) << i;
      if (coverage == 0.0f) continue;
      ASSERT_NEAR(shares[std::bit_cast<std::uint32_t>(channel("RB"[rank]))], coverage, 1e-6f) << i;
    }
  }
  EXPECT_GT(shared, 100);
}

TEST(FragmentFile, KeepsTheirBits) {
  const TemporaryFolder folder;
  const GuideSet guides = GuidesWithFragments(37, 23);
  ASSERT_TRUE(guides.Validate("guides").ok()) << guides.Validate("guides").error().message;
  ASSERT_TRUE(WriteGuides(folder / "g.exr", guides));
  const auto read = ReadGuides(folder / "g.exr", Layers(guides.layers()));
  ASSERT_TRUE(read) << read.error().message;
  ExpectSameFragments(*read, guides);
  EXPECT_EQ(read->attributes, guides.attributes);
  const auto info = InspectGuides(folder / "g.exr");
  ASSERT_TRUE(info);
  EXPECT_EQ(info->fragments, guides.fragments->count());
}

TEST(FragmentFile, HalvesAreThoseOfMemory) {
  const TemporaryFolder folder;
  GuideSet guides = GuidesWithFragments(37, 23);
  GuideWriteOptions options;
  options.half = true;
  ASSERT_TRUE(WriteGuides(folder / "g.exr", guides, options));
  const auto read = ReadGuides(folder / "g.exr", Layers(guides.layers()));
  ASSERT_TRUE(read);
  RoundColorLayersToHalf(guides);
  ExpectSameFragments(*read, guides);
}

TEST(FragmentFile, HoldTheLayersThatAreRead) {
  const TemporaryFolder folder;
  const GuideSet guides = GuidesWithFragments(20, 11);
  ASSERT_TRUE(WriteGuides(folder / "g.exr", guides));
  const auto read = ReadGuides(folder / "g.exr", Layers({Layer::kCoverage, Layer::kNormal}));
  ASSERT_TRUE(read);
  ASSERT_TRUE(read->fragments);
  // Surfaces are told apart by their ids.
  const LayerSet some = {Layer::kCoverage, Layer::kNormal, Layer::kObject};
  EXPECT_EQ(read->layers(), some);
  EXPECT_EQ(read->fragments->values.layers(), some);
  EXPECT_EQ(read->fragments->pixel, guides.fragments->pixel);
}

TEST(FragmentFile, CellsMayBeUnknown) {
  GuideSet guides = GuidesWithFragments(20, 11);
  auto without = std::make_shared<Fragments>(*guides.fragments);
  without->cells.clear();
  guides.fragments = without;
  const auto decoded = internal::DecodeFragments(internal::EncodeFragments(guides, false), guides, "g.exr");
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_TRUE((*decoded)->cells.empty());
}

TEST(FragmentFile, WithoutThemIsAsBefore) {
  const TemporaryFolder folder;
  GuideSet guides = GuidesWithFragments(20, 11);
  guides.fragments = nullptr;
  ASSERT_TRUE(WriteGuides(folder / "g.exr", guides));
  const auto read = ReadGuides(folder / "g.exr", Layers(guides.layers()));
  ASSERT_TRUE(read);
  EXPECT_FALSE(read->fragments);
  EXPECT_EQ(InspectGuides(folder / "g.exr")->fragments, 0u);
}

TEST(FragmentFile, WhatIsCutOffOrChangedIsRefused) {
  const GuideSet guides = GuidesWithFragments(20, 11);
  const std::vector<std::byte> bytes = internal::EncodeFragments(guides, false);
  const auto refusal = [&](std::span<const std::byte> some, const GuideSet& of) {
    const auto decoded = internal::DecodeFragments(some, of, "g.exr");
    return decoded ? std::string() : decoded.error().message;
  };
  EXPECT_EQ(refusal(bytes, guides), "");
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 7) {
    EXPECT_THAT(refusal(std::span(bytes).first(size), guides), HasSubstr("damaged")) << size;
    EXPECT_FALSE(internal::CountFragments(std::span(bytes).first(size), 20, 11, "g.exr")) << size;
  }
  for (std::size_t at = 0; at < 24; ++at) {
    std::vector<std::byte> other = bytes;
    other[at] ^= std::byte{0x40};
    EXPECT_THAT(refusal(other, guides), AllOf(HasSubstr("g.exr: its "), HasSubstr("scumble guidegen"))) << at;
  }
  GuideSet larger(21, 11);
  larger.Add(Layer::kCoverage), larger.Add(Layer::kNormal);
  EXPECT_THAT(refusal(bytes, larger), HasSubstr("of a picture of 20×11 pixels, the file is 21×11"));
  std::vector<std::byte> later = bytes;
  later[0] = std::byte{2};
  EXPECT_THAT(refusal(later, guides), HasSubstr("has version 2, and this program reads version 1"));
  std::vector<std::byte> cells = bytes;  // the last four bytes are a fragment's
  cells.back() = std::byte{0xc0};
  EXPECT_THAT(refusal(cells, guides), AllOf(HasSubstr(" in cells, expected 0 to 65535"), HasSubstr("guidegen")));
  // Two channels of one name, so that another is missing.
  std::vector<std::byte> twice = bytes;
  const std::string from = "normal.Y", to = "normal.X";
  const auto place = std::ranges::search(twice, from, {}, [](std::byte byte) { return char(byte); });
  ASSERT_FALSE(place.empty());
  std::ranges::transform(to, place.begin(), [](char c) { return std::byte(c); });
  EXPECT_THAT(refusal(twice, guides), HasSubstr("has no channel normal.Y"));
}

// What is wrong in a file ends every command that reads it; the message names the file and the remedy.
TEST(FragmentFile, ADamagedFileIsRefused) {
  const TemporaryFolder folder;
  GuideSet good = GuidesWithFragments(20, 11);
  for (int id = 0; id < 99; ++id) good.object_names[std::uint32_t(id)] = "object " + std::to_string(id);
  const auto refusal = [&](const auto& change) {
    GuideSet guides = good;
    auto fragments = std::make_shared<Fragments>(*good.fragments);
    change(*fragments);
    guides.fragments = fragments;
    EXPECT_TRUE(WriteGuides(folder / "g.exr", guides));
    const auto read = ReadGuides(folder / "g.exr", Layers(guides.layers()));
    if (read) return std::string();
    EXPECT_EQ(read.error().kind, ErrorKind::kInput);
    EXPECT_THAT(read.error().message, HasSubstr((folder / "g.exr").string()));
    return read.error().message;
  };
  const std::string remedy = "make the guides again with scumble guidegen";
  const auto coverage_of_first = [](float value) {
    return [value](Fragments& f) { f.values.Plane(Layer::kCoverage)[0] = value; };
  };
  EXPECT_EQ(refusal([](Fragments&) {}), "");
  EXPECT_THAT(refusal([](Fragments& f) { f.pixel.back() = 220; }),
              AllOf(HasSubstr("outside the picture"), HasSubstr(remedy)));
  EXPECT_THAT(refusal([](Fragments& f) { f.pixel.back() = 0; }), AllOf(HasSubstr("out of order"), HasSubstr(remedy)));
  EXPECT_THAT(refusal([](Fragments& f) { std::fill_n(f.pixel.begin(), 4, 0u); }),
              AllOf(HasSubstr("too many"), HasSubstr(remedy)));
  EXPECT_THAT(refusal(coverage_of_first(std::nanf(""))), AllOf(HasSubstr("a coverage of nan"), HasSubstr(remedy)));
  EXPECT_THAT(refusal(coverage_of_first(-0.5f)), AllOf(HasSubstr("a coverage of -0.5"), HasSubstr(remedy)));
  EXPECT_THAT(refusal(coverage_of_first(1.1f)), AllOf(HasSubstr("cover more than their pixel"), HasSubstr(remedy)));
  EXPECT_THAT(refusal([](Fragments& f) { f.values.Plane(Layer::kObject)[0] = 99.0f; }),
              AllOf(HasSubstr("show objects that the guides do not name"), HasSubstr(remedy)));
  EXPECT_THAT(refusal([](Fragments& f) { f.values.Plane(Layer::kNormal)[0] = 9.0f; }), HasSubstr("unit vector"));
  EXPECT_THAT(refusal([](Fragments& f) { f.values.Plane(Layer::kAlbedo)[0] = std::nanf(""); }),
              HasSubstr("NaN or infinite"));

  // The number of fragments in the file itself.
  ASSERT_TRUE(WriteGuides(folder / "g.exr", good));
  auto bytes = ReadWholeFile(folder / "g.exr");
  ASSERT_TRUE(bytes);
  const std::string type = internal::kFragmentType;
  const auto found = std::ranges::search(*bytes, type, {}, [](std::byte byte) { return char(byte); });
  ASSERT_FALSE(found.empty());
  constexpr std::ptrdiff_t kBehind = 1 + 4 + 12;  // the end of the name, the attribute's size, three numbers
  *(found.end() + kBehind + 1) ^= std::byte{0x40};
  ASSERT_TRUE(WriteFileAtomically(folder / "g.exr", *bytes));
  for (const std::string& message : {ReadGuides(folder / "g.exr", Layers(good.layers())).error().message,
                                     InspectGuides(folder / "g.exr").error().message}) {
    EXPECT_THAT(message, AllOf(HasSubstr("g.exr: its attribute scumble:fragments names"), HasSubstr(remedy)));
  }
}

TEST(Fragments, AreRefusedWhereTheyDoNotFit) {
  const GuideSet guides = GuidesWithFragments(20, 11);
  const auto refused = [&](const auto& change) {
    GuideSet other = guides;
    auto fragments = std::make_shared<Fragments>(*guides.fragments);
    change(*fragments);
    other.fragments = fragments;
    const Status valid = other.Validate("guides");
    return valid.ok() ? std::string() : valid.error().message;
  };
  EXPECT_EQ(refused([](Fragments&) {}), "");
  EXPECT_NE(refused([](Fragments& f) { f.pixel.back() = 220; }).find("outside the picture"), std::string::npos);
  EXPECT_NE(refused([](Fragments& f) { f.pixel.back() = 0; }).find("out of order"), std::string::npos);
  EXPECT_NE(refused([](Fragments& f) { std::fill_n(f.pixel.begin(), 4, 0u); }).find("too many"), std::string::npos);
  EXPECT_NE(refused([](Fragments& f) { f.pixel.pop_back(); }).find("another number"), std::string::npos);
  EXPECT_NE(refused([](Fragments& f) { f.cells.pop_back(); }).find("another number"), std::string::npos);
  EXPECT_NE(refused([](Fragments& f) { f.values.Remove(Layer::kObject); }).find("hold"), std::string::npos);
  EXPECT_NE(refused([](Fragments& f) { f.values.Plane(Layer::kCoverage)[0] = 1.5f; }).find("cover more"),
            std::string::npos);
  EXPECT_NE(refused([](Fragments& f) { f.values.Plane(Layer::kNormal)[0] = 9.0f; }).find("unit vector"),
            std::string::npos);
}

}  // namespace
}  // namespace scumble
