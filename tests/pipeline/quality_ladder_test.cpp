// The steps of --quality and --budget-ms, by style and by the user's own settings.
#include "pipeline/variant/quality_ladder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "pipeline/frame/provenance.h"
#include "pipeline/variant/trial_painter.h"

namespace scumble {
namespace {

constexpr LadderFrame kCast{true, 1280, 720, false}, kGiven{false, 1280, 720, true};

StyleSet Open(const std::string& style, const std::vector<std::string>& sets = {}) {
  StyleRequest options;
  options.style = std::string(SCUMBLE_SOURCE_DIR) + "/exemplars/" + style, options.sets = *ParseStyleOverrides(sets);
  auto opened = OpenStyles(options, RunContext());
  EXPECT_TRUE(opened.ok()) << (opened.ok() ? "" : opened.error().message);
  return opened.ok() ? std::move(*opened) : StyleSet();
}

std::vector<std::string> Texts(const Variant& variant) {
  std::vector<std::string> texts;
  for (const StyleOverride& set : variant.settings) texts.push_back(set.text);
  return texts;
}

bool Sets(const Variant& variant, const std::string& setting) {
  const std::vector<std::string> texts = Texts(variant);
  return std::find(texts.begin(), texts.end(), setting) != texts.end();
}

std::vector<std::string> Names(const std::vector<Variant>& variants) {
  std::vector<std::string> names;
  for (const Variant& variant : variants) names.push_back(variant.name);
  return names;
}

bool Sets(const std::vector<Variant>& variants, const std::string& key) {
  return std::any_of(variants.begin(), variants.end(), [&](const Variant& variant) {
    return std::any_of(variant.settings.begin(), variant.settings.end(),
                       [&](const StyleOverride& set) { return set.key == key; });
  });
}

TEST(QualityLadder, BeginsWithTheStyleItselfAndNamesEachWayOnce) {
  for (const char* const style : {"charcoal", "ink", "sumi-e", "chiaroscuro", "scene-oil"}) {
    const StyleSet styles = Open(style);
    for (const LadderFrame& frame : {kCast, kGiven}) {
      const std::vector<Variant> variants = QualityLadder(styles, frame);
      ASSERT_GE(variants.size(), 2u) << style;
      EXPECT_EQ(variants.front().name, "the style");
      EXPECT_EQ(OptionsOf(variants.front()), "");
      std::vector<std::string> names = Names(variants);
      std::sort(names.begin(), names.end());
      EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end()) << style;
    }
  }
}

// Guides may be smaller where they are made, and where the picture's sides are multiples.
TEST(QualityLadder, GuidesAreSmallerOnlyWhereTheyMayBe) {
  const StyleSet styles = Open("charcoal");
  const auto factors = [&](const LadderFrame& frame) {
    std::vector<int> all;
    for (const Variant& variant : QualityLadder(styles, frame)) all.push_back(UpsampleOf(variant));
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  };
  EXPECT_EQ(factors(kCast), (std::vector<int>{1, 2, 4}));
  EXPECT_EQ(factors({true, 960, 540, false}), (std::vector<int>{1, 2, 4}));
  EXPECT_EQ(factors({true, 962, 542, false}), (std::vector<int>{1, 2})) << "542 is no multiple of 4";
  EXPECT_EQ(factors({true, 961, 540, false}), (std::vector<int>{1}));
  EXPECT_EQ(factors({true, 1280, 720, true}), (std::vector<int>{1})) << "--upsample was given";
  EXPECT_EQ(factors(kGiven), (std::vector<int>{1}));
}

// Where light takes samples, sixteen and four of them stand right below the style as it is, and four in all that is
// below: what they leave is noise, which lies far below a style's own error, and they take most of the time there is.
TEST(QualityLadder, SamplesGoFirstWhereThereAreAny) {
  LadderFrame frame = kCast;
  frame.samples = 64;
  const std::vector<Variant> variants = QualityLadder(Open("chiaroscuro"), frame);
  ASSERT_GE(variants.size(), 5u);
  EXPECT_EQ(variants[0].samples, 0) << "as many as the verb has";
  EXPECT_EQ(variants[1].name, "--samples 16");
  EXPECT_EQ(variants[2].name, "--samples 4");
  EXPECT_EQ(variants[3].name, "--upsample 2 --samples 4");
  for (std::size_t i = 2; i < variants.size(); ++i) EXPECT_EQ(variants[i].samples, 4) << variants[i].name;
  const auto most = [&](int samples) {
    frame.samples = samples;
    int all = 0;
    for (const Variant& variant : QualityLadder(Open("chiaroscuro"), frame)) all = std::max(all, variant.samples);
    return all;
  };
  EXPECT_EQ(most(17), 16);
  EXPECT_EQ(most(16), 4) << "no step takes more than there are, or as many";
  EXPECT_EQ(most(4), 0);
  EXPECT_EQ(most(0), 0) << "no choice";
  frame.samples = 64;
  EXPECT_EQ(OptionsOf(VariantOf(Quality::kFinal, Open("chiaroscuro"), frame)), "");
  EXPECT_EQ(OptionsOf(VariantOf(Quality::kPreview, Open("chiaroscuro"), frame)), "--upsample 2 --samples 4");
  EXPECT_EQ(OptionsOf(VariantOf(Quality::kDraft, Open("chiaroscuro"), frame)), "--upsample 2 --upscale --samples 4");
}

TEST(QualityLadder, StylesThatAskForLight) {
  EXPECT_FALSE(AsksForLight(Open("charcoal").styles.front()));
  EXPECT_TRUE(AsksForLight(Open("chiaroscuro").styles.front())) << "exemplars by their light";
  EXPECT_TRUE(AsksForLight(Open("scene-oil").styles.front())) << "weighs it";
  EXPECT_TRUE(AsksForLight(Open("charcoal", {"transfer.shadow=paint"}).styles.front()));
}

// LadderSteps hold nothing that the style has anyway, and nothing that makes its look.
TEST(QualityLadder, StepsSetWhatTheStyleHasNotAndLeaveItsLookAlone) {
  EXPECT_FALSE(Sets(QualityLadder(Open("charcoal"), kCast), "transfer.hybrid")) << "charcoal is not split";
  EXPECT_TRUE(Sets(QualityLadder(Open("sumi-e"), kCast), "transfer.hybrid"));
  EXPECT_FALSE(Sets(QualityLadder(Open("ink"), kCast), "transfer.blend_radius")) << "ink is crisp";
  EXPECT_FALSE(Sets(QualityLadder(Open("charcoal", {"transfer.method=litsphere"}), kCast), "transfer.method"));
  StyleSet slow = Open("charcoal");
  slow.styles.front().transfer.method = Method::kBruteForce;
  EXPECT_EQ(QualityLadder(slow, kGiven)[1].name, "--set transfer.method=styleblit");
  for (const char* const key : {"transfer.threshold", "transfer.colorize", "transfer.edge", "transfer.edge_aware",
                                "transfer.variety", "transfer.scale", "transfer.levels", "transfer.rim"}) {
    for (const char* const style : {"sumi-e", "tinted-oil", "scene-oil"}) {
      EXPECT_FALSE(Sets(QualityLadder(Open(style), kCast), key)) << style << " " << key;
    }
  }
}

// A search for each pixel takes longer than one for each seed, where it is not by a formula or a table.
TEST(QualityLadder, StylesThatWeighGuidesKeepTheirChunks) {
  StyleSet weighed = Open("scene-oil");
  EXPECT_FALSE(Sets(QualityLadder(weighed, kCast), "transfer.method"));
  EXPECT_EQ(OptionsOf(VariantOf(Quality::kDraft, weighed, kCast)), "--upsample 2 --upscale");
  weighed.styles.front().transfer.method = Method::kBruteForce;
  EXPECT_EQ(OptionsOf(VariantOf(Quality::kDraft, weighed, kCast)),
            "--upsample 2 --upscale --set transfer.method=styleblit");
}

// Strokes of half the sharpness are more of the paint than any that the Lit Sphere smears: it comes after all else.
TEST(QualityLadder, TheLitSphereIsTheLastResort) {
  for (const char* const style : {"charcoal", "sumi-e", "chiaroscuro"}) {
    for (const LadderFrame& frame : {kCast, kGiven}) {
      bool smears = false;
      for (const Variant& variant : QualityLadder(Open(style), frame)) {
        const bool is_lit_sphere = Sets(variant, "transfer.method=litsphere");
        EXPECT_TRUE(is_lit_sphere || !smears) << style << ": " << variant.name;
        smears = is_lit_sphere;
      }
      EXPECT_TRUE(smears) << style;
      for (const Quality quality : {Quality::kDraft, Quality::kPreview}) {
        EXPECT_EQ(OptionsOf(VariantOf(quality, Open(style), frame)).find("litsphere"), std::string::npos) << style;
      }
    }
  }
}

TEST(QualityLadder, DraftsAreHalfTheSizeAndScaledUp) {
  EXPECT_EQ(OptionsOf(VariantOf(Quality::kDraft, Open("charcoal"), kCast)), "--upsample 2 --upscale");
  EXPECT_EQ(OptionsOf(VariantOf(Quality::kDraft, Open("charcoal"), kGiven)), "--set transfer.blend_radius=0");
  EXPECT_EQ(OptionsOf(VariantOf(Quality::kDraft, Open("sumi-e"), kGiven)), "--set transfer.blend_radius=0")
      << "its split is what it looks like";
  LadderFrame over = kCast;
  over.full_size = true;
  EXPECT_EQ(OptionsOf(VariantOf(Quality::kDraft, Open("charcoal"), over)), "--set transfer.blend_radius=0")
      << "something lies underneath";
  EXPECT_EQ(OptionsOf(VariantOf(Quality::kDraft, Open("chiaroscuro"), over)),
            "--upsample 2 --set transfer.blend_radius=0");
  for (const Variant& variant : QualityLadder(Open("charcoal"), over)) EXPECT_FALSE(variant.upscale) << variant.name;
}

// One setting is for all styles of a picture: a step that takes from one must not give to another.
TEST(QualityLadder, NoStyleComesToMoreThanItHas) {
  StyleSet two = Open("charcoal");
  two.styles.push_back(Open("charcoal").styles.front());
  two.styles[0].transfer.method = Method::kBruteForce;
  const auto has = [&](const char* setting) {
    for (const Variant& variant : QualityLadder(two, kGiven)) {
      if (Sets(variant, setting)) return true;
    }
    return false;
  };
  EXPECT_TRUE(has("transfer.method=styleblit"));
  two.styles[1].transfer.method = Method::kLitSphere;
  EXPECT_FALSE(has("transfer.method=styleblit")) << "charcoal would be painted by chunks, which takes more time";
  EXPECT_TRUE(has("transfer.method=litsphere"));
  for (const Quality quality : {Quality::kPreview, Quality::kDraft}) {
    const Variant variant = VariantOf(quality, two, kGiven);
    EXPECT_TRUE(Sets(variant, "transfer.method=litsphere")) << "the other one would stay at brute force";
  }
}

TEST(QualityLadder, WhatTheUserSetsStays) {
  EXPECT_FALSE(Sets(QualityLadder(Open("charcoal", {"transfer.blend_radius=3"}), kCast), "transfer.blend_radius"));
  const StyleSet decided = Open("charcoal", {"transfer.method=styleblit", "transfer.blend_radius=1"});
  EXPECT_EQ(Names(QualityLadder(decided, kGiven)), (std::vector<std::string>{"the style"}))
      << "nothing is left to take";
  // For one style by its name, the others may change.
  const std::string charcoal = std::string(SCUMBLE_SOURCE_DIR) + "/exemplars/charcoal";
  StyleSet named = Open("charcoal", {charcoal + ":transfer.method=styleblit"});
  EXPECT_FALSE(Sets(QualityLadder(named, kCast), "transfer.method"));
}

TEST(QualityLadder, AWayAppliedIsTheSameAsItsOptions) {
  for (const char* const style : {"charcoal", "sumi-e"}) {
    for (const std::vector<std::string>& sets :
         {std::vector<std::string>{"transfer.threshold=0.2"}, {"transfer.blend_radius=2"}}) {
      const StyleSet opened = Open(style, sets);
      for (const Variant& variant : QualityLadder(opened, kGiven)) {
        StyleSet applied = opened;
        ASSERT_TRUE(ApplyVariant(variant, applied).ok());
        std::vector<std::string> all = Texts(variant);
        all.insert(all.end(), sets.begin(), sets.end());
        const StyleSet given = Open(style, all);
        ExemplarHashes one, other;
        EXPECT_EQ(SettingsText(applied, {}, one), SettingsText(given, {}, other)) << style << " " << variant.name;
      }
    }
  }
}

TEST(QualityLadder, NamedPointsAreOfTheLadderAndFinalIsTheStyle) {
  for (const char* const style : {"charcoal", "ink", "sumi-e", "chiaroscuro", "scene-oil"}) {
    const StyleSet styles = Open(style);
    for (const LadderFrame& frame :
         {kCast, kGiven, LadderFrame{true, 961, 541, false}, LadderFrame{true, 960, 540, false},
          LadderFrame{true, 1280, 720, false, 64}, LadderFrame{true, 961, 541, true, 8}}) {
      const std::vector<std::string> names = Names(QualityLadder(styles, frame));
      const auto place = [&](Quality quality) {
        const Variant variant = VariantOf(quality, styles, frame);
        const auto found = std::find(names.begin(), names.end(), variant.name);
        EXPECT_NE(found, names.end()) << style << " " << variant.name;
        return found - names.begin();
      };
      EXPECT_EQ(place(Quality::kFinal), 0);
      EXPECT_GE(place(Quality::kPreview), place(Quality::kFinal));
      EXPECT_GE(place(Quality::kDraft), place(Quality::kPreview));
    }
  }
}

// Where only normals are cast, nothing quicker would go unseen; light is cast at half the size, and
// guides that are there are painted without blending.
TEST(QualityLadder, PreviewTakesWhatIsDear) {
  const auto preview = [](const char* style, const LadderFrame& frame) {
    return OptionsOf(VariantOf(Quality::kPreview, Open(style), frame));
  };
  EXPECT_EQ(preview("charcoal", kCast), "");
  EXPECT_EQ(preview("sumi-e", kCast), "") << "its split is what it looks like";
  EXPECT_EQ(preview("chiaroscuro", kCast), "--upsample 2");
  EXPECT_EQ(preview("chiaroscuro", {true, 961, 541, false}), "--set transfer.blend_radius=0");
  EXPECT_EQ(preview("charcoal", kGiven), "--set transfer.blend_radius=0");
}

// What lies underneath is part of a trial's work.
TEST(TrialPainter, ReadsWhatLiesUnderneath) {
  StyleSet styles = Open("charcoal");
  GuideSet guides(32, 32);
  for (const LayerInfo& info : AllLayers()) {
    if (AlwaysWritten().Has(info.layer)) guides.Add(info.layer);
  }
  for (float& a : guides.Plane(Layer::kCoverage)) a = 1.0f;
  for (float& z : guides.Plane(Layer::kNormal, 2)) z = 1.0f;
  const Variant plain = QualityLadder(styles, kGiven).front();
  const PictureRequest picture;
  const RunContext context;
  const std::string name = "guides", none, missing = "nowhere/under.png";  // they are borrowed
  TrialPainter bare(styles, picture, {}, name, none, context);
  EXPECT_TRUE(bare.Paint(plain, guides).ok());
  TrialPainter over(styles, picture, {}, name, missing, context);
  const auto painted = over.Paint(plain, guides);
  ASSERT_FALSE(painted.ok());
  EXPECT_NE(painted.error().message.find(missing), std::string::npos) << painted.error().message;
}

}  // namespace
}  // namespace scumble
