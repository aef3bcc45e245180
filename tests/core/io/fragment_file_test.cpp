// Fragments in guide files.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "core/image/fragments.h"
#include "core/image/hash.h"
#include "core/io/guide_file.h"
#include "core/io/guides/fragment_storage.h"
#include "tests/support/guide_files.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

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
  const LayerSet some = {Layer::kCoverage, Layer::kNormal};
  const auto read = ReadGuides(folder / "g.exr", Layers(some));
  ASSERT_TRUE(read);
  ASSERT_TRUE(read->fragments);
  EXPECT_EQ(read->fragments->values.layers(), some);
  EXPECT_EQ(read->fragments->pixel, guides.fragments->pixel);
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

TEST(FragmentFile, DamagedOnesAreNull) {
  const GuideSet guides = GuidesWithFragments(20, 11);
  const std::vector<std::byte> bytes = internal::EncodeFragments(guides, false);
  ASSERT_TRUE(internal::DecodeFragments(bytes, guides));
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 7) {
    EXPECT_FALSE(internal::DecodeFragments(std::span(bytes).first(size), guides)) << size;
  }
  const auto changed = [&](std::size_t at) {
    std::vector<std::byte> other = bytes;
    other[at] ^= std::byte{0x40};
    return internal::DecodeFragments(other, guides);
  };
  for (std::size_t at = 0; at < 24; ++at) EXPECT_FALSE(changed(at)) << at;
  GuideSet larger(21, 11);
  larger.Add(Layer::kCoverage), larger.Add(Layer::kNormal);
  EXPECT_FALSE(internal::DecodeFragments(bytes, larger));
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
  EXPECT_NE(refused([](Fragments& f) { f.values.Remove(Layer::kObject); }).find("hold"), std::string::npos);
  EXPECT_NE(refused([](Fragments& f) { f.values.Plane(Layer::kCoverage)[0] = 1.5f; }).find("cover more"),
            std::string::npos);
  EXPECT_NE(refused([](Fragments& f) { f.values.Plane(Layer::kNormal)[0] = 9.0f; }).find("unit vector"),
            std::string::npos);
}

}  // namespace
}  // namespace scumble
