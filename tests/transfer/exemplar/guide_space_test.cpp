// Matching by normals, light and colour together: every form of it against a plain reference.
#include <algorithm>
#include <limits>
#include <optional>

#include "core/filter/outline_distance.h"
#include "tests/support/numbers.h"
#include "tests/support/scene_exemplar_fixtures.h"
#include "transfer/lookup_table.h"
#include "transfer/seeds/seeds.h"

namespace scumble {
namespace {

using namespace testing;

const Layer kFifteen[] = {Layer::kAlbedo, Layer::kLpeLDE, Layer::kLpeLSE, Layer::kLpeLDDE};  // with the normal

// Light of every layer from a different light for each channel, shadowed in every third of bands of 16 columns; in
// `steps` even steps, so that equal guides abound, or in none for 0.
void AddLight(GuideSet& guides, int steps, float scale = 1.0f) {
  const auto add = [&](Layer layer) {
    guides.Add(layer);
    for (int c = 0; c < ChannelCount(layer); ++c) {
      glm::vec3 lamp = AnyDirection(Hash(int(layer), c));
      lamp.z = std::fabs(lamp.z);
      for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
        float light = 1.5f * std::fmax(0.0f, glm::dot(lamp, guides.Vec3(Layer::kNormal, i)));
        if (int(i) % guides.width() / 16 % 3 == 2) light *= 0.25f;
        if (steps > 0) light = std::floor(light * steps) / steps;
        guides.Plane(layer, c)[i] = scale * light;
      }
    }
  };
  for (const Layer layer : kFifteen) add(layer);
  add(Layer::kLuminance), add(Layer::kShadow);
}

// A style on a sphere of 48 pixels, or on hills, with light of its own.
Style LitStyle(bool sphere, const GuideWeights& weights, int steps = 0) {
  GuideSet guides = sphere ? SphereGuides(48) : HillGuides(56, 40);
  AddLight(guides, steps);
  Style style = SceneStyle(WideNoise(guides.width(), guides.height()), std::move(guides));
  style.exemplars[0].is_sphere = sphere;
  style.transfer.guide_weights = weights;
  style.transfer.levels = 5;
  style.transfer.threshold = 0.4f;
  return style;
}

GuideWeights Weights(std::initializer_list<std::pair<Layer, float>> values) {
  GuideWeights weights;
  for (const auto& [layer, weight] : values) weights[layer] = weight;
  return weights;
}

GuideWeights FifteenDimensions() {
  return Weights({{Layer::kNormal, 0.75f},
                  {Layer::kAlbedo, 0.5f},
                  {Layer::kLpeLDE, 1.0f},
                  {Layer::kLpeLSE, 0.3f},
                  {Layer::kLpeLDDE, 2.0f}});
}

GuideSet LitHills(int steps = 0, float scale = 1.0f) {
  GuideSet guides = HillGuides(72, 64);
  AddLight(guides, steps, scale);
  return guides;
}

// ---- the reference: as the headers say it, pixel by pixel ----------------------------------------------------------

// The smallest value that 90% of the covered pixels do not exceed.
float Percentile90(const GuideSet& guides, Layer layer) {
  std::vector<float> all;
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    if (!(guides.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
    const glm::vec3 v = ChannelCount(layer) == 3 ? guides.Vec3(layer, i) : glm::vec3(guides.Plane(layer)[i]);
    const float light = ChannelCount(layer) == 3 ? 0.2126f * v.r + 0.7152f * v.g + 0.0722f * v.b : v.r;
    all.push_back(std::fmax(0.0f, light));
  }
  std::sort(all.begin(), all.end());
  return all[(all.size() * 9 + 9) / 10 - 1];
}

class Reference {
 public:
  Reference(const Style& style, const PreparedExemplar& exemplar, const GuideSet& guides, float brightness)
      : weights_(style.transfer.guide_weights),
        exemplar_(exemplar),
        own_(*style.exemplars[0].guides),
        guides_(guides),
        test_(style.transfer.threshold) {
    for (const Layer layer :
         {Layer::kLuminance, Layer::kLpeLDE, Layer::kLpeLD12E, Layer::kLpeFull, Layer::kLpeLDDE, Layer::kLpeLSE}) {
      if (!(weights_[layer] > 0.0f)) continue;
      white_ = Percentile90(own_, layer);
      break;
    }
    brightness_ = brightness;
    sources_ = exemplar.UsablePixels();
    for (const Source& u : sources_) values_.push_back(RestOfSource(u));
  }

  // Without the normal's.
  std::vector<float> ExtraDistance(const GuideSet& set, std::size_t i, float factor) const {
    std::vector<float> extra_values;
    for (const LayerInfo& info : AllLayers()) {
      if (info.layer == Layer::kNormal || !(weights_[info.layer] > 0.0f)) continue;
      for (int c = 0; c < ChannelCount(info.layer); ++c) {
        const float value = set.Plane(info.layer, c)[i];
        float coordinate = std::fmin(1.0f, std::fmax(0.0f, value));
        if (GuideWeights::IsRadiance(info.layer)) {
          const float light = std::fmax(0.0f, value) * factor;
          coordinate = std::isinf(light) ? 1.0f : light / (1.0f + light);
        }
        if (std::isnan(value)) coordinate = 0.0f;
        extra_values.push_back(weights_[info.layer] * coordinate);
      }
    }
    return extra_values;
  }
  std::vector<float> RestOfSource(Source u) const { return ExtraDistance(own_, own_.Index(u.x, u.y), 1.0f / white_); }
  std::vector<float> ExtraValuesOf(std::size_t i) const { return ExtraDistance(guides_, i, brightness_ / white_); }

  Source Nearest(std::size_t i) const {
    const auto extra_values = ExtraValuesOf(i);
    const glm::vec3 normal = weights_[Layer::kNormal] * FacingDirection(guides_.Vec3(Layer::kNormal, i));
    double least = std::numeric_limits<double>::infinity();
    Source best;
    for (std::size_t s = 0; s < sources_.size(); ++s) {
      const Source u = sources_[s];
      const glm::vec3 there = weights_[Layer::kNormal] * exemplar_.Normal(u.x, u.y);
      double sum = 0.0;
      for (int c = 0; c < 3; ++c) sum += (double(normal[c]) - there[c]) * (double(normal[c]) - there[c]);
      const auto& values = values_[s];
      for (std::size_t d = 0; d < extra_values.size(); ++d)
        sum += (double(extra_values[d]) - values[d]) * (double(extra_values[d]) - values[d]);
      if (sum < least) least = sum, best = u;
    }
    return best;
  }

  // Whether pixel i may show u; it comes from `seed`, whose nearest neighbour is `best`.
  bool Accepts(std::size_t i, Source u, std::size_t seed, Source best) const {
    if (!exemplar_.Usable(u.x, u.y)) return false;
    const glm::vec3 of_seed = guides_.Vec3(Layer::kNormal, seed);
    glm::vec3 normal = guides_.Vec3(Layer::kNormal, i);
    auto extra_values = ExtraValuesOf(i);
    if (!Near(of_seed, ExtraValuesOf(seed), best)) {
      const auto off = ExtraValuesOf(seed), there = RestOfSource(best);
      normal += exemplar_.Normal(best.x, best.y) - of_seed;
      for (std::size_t k = 0; k < extra_values.size(); ++k) extra_values[k] += there[k] - off[k];
    }
    return Near(normal, extra_values, u);
  }

 private:
  bool Near(glm::vec3 normal, const std::vector<float>& extra_values, Source u) const {
    const glm::vec3 d = weights_[Layer::kNormal] * normal - weights_[Layer::kNormal] * exemplar_.Normal(u.x, u.y);
    const auto values = RestOfSource(u);
    float off = 0.0f;
    for (std::size_t k = 0; k < extra_values.size(); ++k)
      off += (extra_values[k] - values[k]) * (extra_values[k] - values[k]);
    return d.x * d.x + d.y * d.y + d.z * d.z + off < test_ * test_;
  }

  GuideWeights weights_;
  const PreparedExemplar& exemplar_;
  const GuideSet& own_;
  const GuideSet& guides_;
  float test_, white_ = 1.0f, brightness_ = 1.0f;
  std::vector<Source> sources_;
  std::vector<std::vector<float>> values_;
};

// The parallel form, section 3.2 of StyleBlit.
Source StyleBlitSource(const Reference& reference, const GuideSet& guides, const Style& style,
                       const std::vector<Source>& own, int x, int y) {
  for (int level = style.transfer.levels - 1; level >= 1; --level) {
    PixelPosition q;
    std::int64_t nearest = std::numeric_limits<std::int64_t>::max();
    for (int row = -1; row <= 1; ++row) {
      for (int column = -1; column <= 1; ++column) {
        const PixelPosition s = SeedOfCell({0, 0, 1.0f, 0}, level, (x >> level) + column, (y >> level) + row);
        const std::int64_t d = std::int64_t(s.x - x) * (s.x - x) + std::int64_t(s.y - y) * (s.y - y);
        if (d < nearest) nearest = d, q = s;
      }
    }
    if (q.x < 0 || q.y < 0 || q.x >= guides.width() || q.y >= guides.height()) continue;
    if (!(guides.Plane(Layer::kCoverage)[guides.Index(q.x, q.y)] > 0.0f)) continue;
    const Source u = own[guides.Index(q.x, q.y)], candidate{u.x + x - q.x, u.y + y - q.y};
    if (reference.Accepts(guides.Index(x, y), candidate, guides.Index(q.x, q.y), u)) return candidate;
  }
  return own[guides.Index(x, y)];
}

void ExpectReference(Style style, const GuideSet& guides, float stops) {
  const auto exemplar = MustPrepare(style);
  const Reference reference(style, *exemplar, guides, std::exp2(stops));
  const auto coverage = guides.Plane(Layer::kCoverage);
  std::vector<Source> own(guides.pixel_count());
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (coverage[i] > 0.0f) own[i] = reference.Nearest(i);
  }
  TransferOptions options;
  options.exposure = stops;
  for (const Method method : {Method::kLitSphere, Method::kStyleBlit, Method::kBruteForce}) {
    style.transfer.method = method;
    const SourceField field = MustTransfer(style, guides, options).field;
    std::vector<Source> expected = own;
    std::vector<bool> free(own.size(), true);
    int shared = 0;
    for (std::size_t i = 0; i < own.size(); ++i) {
      if (!(coverage[i] > 0.0f)) continue;
      const int x = int(i) % guides.width(), y = int(i) / guides.width();
      if (method == Method::kStyleBlit) expected[i] = StyleBlitSource(reference, guides, style, own, x, y);
      if (method == Method::kBruteForce && free[i]) {
        for (std::size_t j = i; j < own.size(); ++j) {
          if (!free[j] || !(coverage[j] > 0.0f)) continue;
          const Source u{own[i].x + int(j) % guides.width() - x, own[i].y + int(j) / guides.width() - y};
          if (j == i || reference.Accepts(j, u, i, own[i])) expected[j] = u, free[j] = false;
        }
      }
    }
    for (std::size_t i = 0; i < own.size(); ++i) {
      if (!(coverage[i] > 0.0f)) continue;
      ASSERT_EQ((Source{field.x[i], field.y[i]}), expected[i]) << "method " << int(method) << ", pixel " << i;
      shared += !(expected[i] == own[i]);
    }
    if (method != Method::kLitSphere) {
      EXPECT_GT(shared, 200) << "chunks, not single pixels";
    }
  }
}

// With a weight for outlines, what is near one takes its paint near the sphere's rim, whatever it faces. Distances are
// pixels at the reference height: in a picture of half that height twice as much is near.
TEST(GuideSpace, OutlinesAreMatchedByTheirDistance) {
  const auto with_outline = [](GuideSet guides) {
    internal::FillOutlineDistance({0, 0, guides.width(), guides.height()}, guides);
    return guides;
  };
  Style style = SceneStyle(WideNoise(200, 200), with_outline(SphereGuides(200)));
  style.exemplars[0].is_sphere = true;
  style.transfer.reference_height = 64;
  style.transfer.guide_weights = Weights({{Layer::kNormal, 0.01f}, {Layer::kOutline, 1.0f}});
  for (const int height : {64, 32}) {
    const auto prepared = Prepare(style, height, {});
    ASSERT_TRUE(prepared) << prepared.error().message;
    const double per_pixel = 200.0 / prepared->exemplar->height();  // of the guides for one of the exemplar
    GuideSet scene = MakeGuides(64, height, [](int, int) { return glm::vec3(0, 0, 1); });
    scene.Add(Layer::kOutline);
    for (const float distance : {3.0f, 5.0f, 8.0f}) {
      scene.Plane(Layer::kOutline)[0] = distance;
      float values[GuideSpace::kMaxExtra];
      prepared->space->Read(scene, 0, 1.0f, values);
      EXPECT_NEAR(values[0], 1.0f - distance / (24.0f * float(height) / 64.0f), 1e-5f);
      const Source found = prepared->space->Nearest(0, {0, 0, 1}, values);
      const double x = (found.x + 0.5) * per_pixel - 100.0, y = (found.y + 0.5) * per_pixel - 100.0;
      EXPECT_NEAR((100.0 - std::sqrt(x * x + y * y)) / per_pixel, distance, 1.2) << height << ' ' << distance;
    }
  }
}

TEST(GuideSpace, EveryMethodEqualsThePlainReferenceInFifteenDimensions) {
  for (const bool sphere : {true, false}) {
    const Style style = LitStyle(sphere, FifteenDimensions(), 2);
    const auto prepared = Prepare(style, 64);
    ASSERT_TRUE(prepared.ok()) << prepared.error().message;
    EXPECT_EQ(prepared->space->dimensions(), 15);
    ExpectReference(style, LitHills(2), 0.75f);
  }
}

TEST(GuideSpace, FewDimensionsAndNormalsThatCountNothing) {
  for (const auto& weights :
       {Weights({{Layer::kLuminance, 0.5f}}), Weights({{Layer::kNormal, 0.0f}, {Layer::kLuminance, 1.0f}}),
        Weights({{Layer::kShadow, 1.0f}, {Layer::kLpeLSE, 0.25f}}),
        Weights({{Layer::kNormal, 0.0f}, {Layer::kShadow, 2.0f}})}) {
    Style style = LitStyle(true, weights, 4);
    style.transfer.threshold = 0.3f;
    ExpectReference(style, LitHills(4), -1.0f);
  }
}

TEST(GuideSpace, DefinedForEveryValue) {
  // The exemplar's 90th percentile is 2, so that 2 is 0.5 and 6 is 0.75.
  GuideSet guides = SphereGuides(32);
  for (const Layer layer : {Layer::kLuminance, Layer::kAlbedo}) guides.Add(layer);
  for (float& value : guides.Plane(Layer::kLuminance)) value = 2.0f;
  Style style = PlainStyle(NoisePicture(32));
  style.exemplars[0].guides = std::move(guides);
  style.transfer.guide_weights = Weights({{Layer::kLuminance, 4.0f}, {Layer::kAlbedo, 2.0f}});
  const auto prepared = Prepare(style, 32);
  ASSERT_TRUE(prepared.ok()) << prepared.error().message;
  const GuideSpace& space = *prepared->space;
  EXPECT_TRUE(space.has_radiance());
  EXPECT_EQ(space.radiance(), Layer::kLuminance);
  EXPECT_EQ(space.white(), 2.0f);
  GuideSet scene = SphereGuides(8);
  for (const Layer layer : {Layer::kLuminance, Layer::kAlbedo}) scene.Add(layer);
  const auto read = [&](float luminance, float albedo, float brightness) {
    scene.Plane(Layer::kLuminance)[0] = luminance, scene.Plane(Layer::kAlbedo, 1)[0] = albedo;
    float extra_values[GuideSpace::kMaxExtra];
    space.Read(scene, 0, brightness, extra_values);
    return std::pair(extra_values[1], extra_values[3]);  // albedo comes first, its green second
  };
  EXPECT_EQ(read(2.0f, 0.25f, 1.0f), std::pair(0.5f, 2.0f));
  EXPECT_EQ(read(1.0f, 1.0f, 6.0f), std::pair(2.0f, 3.0f));
  EXPECT_EQ(read(0.0f, -1.0f, 1.0f), std::pair(0.0f, 0.0f));
  EXPECT_EQ(read(-kInfinity, 7.0f, 1.0f), std::pair(2.0f, 0.0f));
  EXPECT_EQ(read(kInfinity, kInfinity, 1.0f), std::pair(2.0f, 4.0f));
  EXPECT_EQ(read(3e38f, kNan, 1e10f), std::pair(0.0f, 4.0f));
  EXPECT_EQ(read(kNan, -kInfinity, 1.0f), std::pair(0.0f, 0.0f));
}

// ---- weights -------------------------------------------------------------------------------------------------------

Picture PaintedPicture(const Style& style, const GuideSet& guides, TransferOptions options = {}) {
  return MustTransfer(style, guides, options).picture;
}

TEST(GuideSpace, TwiceTheWeightsAtTwiceTheThresholdAreTheSame) {
  const GuideSet guides = LitHills(3);
  for (const auto metric : {ThresholdMetric::kL2, ThresholdMetric::kL1}) {
    for (const Method method : {Method::kLitSphere, Method::kStyleBlit, Method::kBruteForce}) {
      Style once = LitStyle(true, FifteenDimensions(), 3), twice = once;
      for (Style* style : {&once, &twice}) style->transfer.method = method, style->transfer.threshold_metric = metric;
      for (const LayerInfo& info : AllLayers()) twice.transfer.guide_weights[info.layer] *= 2.0f;
      EXPECT_FALSE(method != Method::kLitSphere &&
                   PaintedPicture(once, guides).rgba == PaintedPicture(twice, guides).rgba)
          << "a threshold half as large cuts more";
      twice.transfer.threshold *= 2.0f;
      EXPECT_TRUE(PaintedPicture(once, guides).rgba == PaintedPicture(twice, guides).rgba);
    }
  }
}

TEST(GuideSpace, NormalsThatCountTwiceAreTheTreeOfNormals) {
  GuideSet guides = LitHills();
  guides.Add(Layer::kPref);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kPref, 0)[i] = float(i % 72), guides.Plane(Layer::kPref, 1)[i] = float(i / 72);
  }
  for (int key = 0; key < 6; ++key) {
    Style plain = LitStyle(key % 2 == 0, {});
    plain.transfer.nearest = NearestSearch::kTree;
    plain.transfer.threshold = 0.125f;
    if (key == 1) plain.transfer.method = Method::kLitSphere;
    if (key == 2) plain.transfer.method = Method::kBruteForce;
    if (key == 3) plain.transfer.coherent = true;
    if (key == 4) plain.transfer.variety = 15.0;
    if (key == 5) plain.transfer.match_step = 3;
    Style twice = plain;
    twice.transfer.guide_weights[Layer::kNormal] = 2.0f;
    twice.transfer.threshold = 0.25f;
    EXPECT_TRUE(PaintedPicture(plain, guides).rgba == PaintedPicture(twice, guides).rgba) << key;
  }
}

TEST(GuideSpace, SharesOfTheBrightestAreWhatIsCompared) {
  // For any strength of the lights, with the exposure that fits.
  const Style style = LitStyle(true, Weights({{Layer::kLuminance, 1.0f}, {Layer::kLpeLDE, 1.0f}}));
  const auto prepared = Prepare(style, 64);
  ASSERT_TRUE(prepared.ok());
  std::optional<Picture> first;
  for (const float scale : {1.0f, 1024.0f, 1.0f / 256}) {
    const GuideSet guides = LitHills(0, scale);
    const auto stops = MeasureExposure({&*prepared, 1}, guides);
    ASSERT_TRUE(stops.has_value());
    EXPECT_NEAR(std::exp2(*stops) * Percentile90(guides, Layer::kLuminance), prepared->space->white(),
                0.004 * prepared->space->white());
    TransferOptions options;
    options.exposure = *stops;
    GuideSet albedo = guides;  // not weighed, so it does not matter
    albedo.Remove(Layer::kAlbedo);
    const Picture picture = PaintedPicture(style, albedo, options);
    if (!first) first = picture;
    EXPECT_TRUE(picture.rgba == first->rgba) << scale;
  }
  const auto dark = Prepare(LitStyle(true, Weights({{Layer::kShadow, 1.0f}})), 64);
  ASSERT_TRUE(dark.ok());
  EXPECT_FALSE(MeasureExposure({&*dark, 1}, LitHills()).has_value()) << "shares are not exposed";
}

TEST(GuideSpace, ALayerThatIsDarkInTheExemplarFitsNoExposure) {
  Style style = LitStyle(true, Weights({{Layer::kLuminance, 1.0f}, {Layer::kLpeLSE, 1.0f}}));
  const auto lit = Prepare(style, 64);
  std::ranges::fill(style.exemplars[0].guides->Plane(Layer::kLuminance), 0.0f);
  const auto by_highlights = Prepare(style, 64);
  for (int c = 0; c < 3; ++c) std::ranges::fill(style.exemplars[0].guides->Plane(Layer::kLpeLSE, c), 0.0f);
  const auto dark = Prepare(style, 64);
  ASSERT_TRUE(lit && by_highlights && dark);
  EXPECT_EQ(lit->space->radiance(), Layer::kLuminance);
  EXPECT_EQ(by_highlights->space->radiance(), Layer::kLpeLSE);
  EXPECT_NE(MeasureExposure({&*by_highlights, 1}, LitHills(0, 8.0f)), 0.0);
  EXPECT_EQ(MeasureExposure({&*dark, 1}, LitHills(0, 8.0f)), 0.0);
}

// ---- every machine, every cut --------------------------------------------------------------------------------------

TEST(GuideSpace, ThreadsAndRegionsMakeNoDifference) {
  const GuideSet guides = LitHills(5);
  for (int key = 0; key < 5; ++key) {
    Style style = LitStyle(key % 2 == 0, FifteenDimensions(), 5);
    style.transfer.blend_radius = 2;
    if (key == 1) style.transfer.method = Method::kLitSphere;
    if (key == 2) style.transfer.variety = 20.0;
    if (key == 3) style.transfer.hybrid = 4.0;
    if (key == 4) style.transfer.match_step = 2;
    TransferOptions options;
    options.threads = 1;
    const Picture whole = PaintedPicture(style, guides, options);
    options.threads = 4;
    EXPECT_TRUE(PaintedPicture(style, guides, options).rgba == whole.rgba) << key;
    const auto prepared = Prepare(style, guides.height());
    ASSERT_TRUE(prepared.ok());
    Picture parts(guides.width(), guides.height());
    TransferScratch scratch;
    for (const Region& region : {Region{0, 0, 33, 64}, Region{33, 0, 72, 20}, Region{33, 20, 72, 64}}) {
      options.region = region;
      ASSERT_TRUE(Transfer(*prepared, guides, options, scratch, parts).ok());
    }
    EXPECT_TRUE(parts.rgba == whole.rgba) << key;
  }
}

TEST(GuideSpace, TheToneOfAHybridIsTheNearestNeighboursInAllGuides) {
  Style style = LitStyle(true, FifteenDimensions(), 5);
  style.transfer.method = Method::kLitSphere;
  style.transfer.blend_radius = 0;
  const GuideSet guides = LitHills(5);
  const Picture plain = PaintedPicture(style, guides);
  style.transfer.hybrid = 3.0;
  const Picture hybrid = PaintedPicture(style, guides);
  // Tone and texture of one place are its paint, within rounding.
  for (std::size_t i = 0; i < plain.rgba.size(); ++i) ASSERT_NEAR(hybrid.rgba[i], plain.rgba[i], 1) << i;
}

// ---- several exemplars ---------------------------------------------------------------------------------------------

TEST(GuideSpace, EachExemplarIsSearchedByItsOwnLight) {
  Style style = LitStyle(true, Weights({{Layer::kLuminance, 1.0f}}));
  style.transfer.method = Method::kLitSphere;
  style.exemplars.push_back(style.exemplars[0]);
  style.exemplars[0].luminance = 1.0, style.exemplars[1].luminance = 0.1;
  for (float& value : style.exemplars[1].guides->Plane(Layer::kLuminance)) value *= 0.25f;
  const GuideSet guides = LitHills();
  const SourceField both = MustTransfer(style, guides).field;
  const auto prepared = Prepare(style, 64);
  ASSERT_TRUE(prepared.ok());
  int of[2] = {0, 0};
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    if (both.level[i] == SourceField::kNoSource) continue;
    const int k = both.exemplar[i];
    EXPECT_EQ(k, prepared->illumination.Choose(guides.Plane(Layer::kLuminance)[i]));
    float extra_values[GuideSpace::kMaxExtra];
    prepared->space->Read(guides, i, 1.0f, extra_values);
    ASSERT_EQ((Source{both.x[i], both.y[i]}),
              prepared->space->Nearest(k, guides.Vec3(Layer::kNormal, i), extra_values));
    ++of[k];
  }
  EXPECT_GT(of[0], 500);
  EXPECT_GT(of[1], 500);
}

// ---- refusals ------------------------------------------------------------------------------------------------------

TEST(GuideSpace, RefusesWhatItCannotMatchBy) {
  const auto refusal = [](const Style& style) {
    const auto prepared = Prepare(style, 64);
    return prepared.ok() ? std::string() : prepared.error().message;
  };
  Style style = LitStyle(true, Weights({{Layer::kLuminance, 1.0f}}));
  EXPECT_EQ(refusal(style), "");
  style.exemplars[0].guides->Remove(Layer::kLuminance);
  EXPECT_NE(refusal(style).find("no guides with layer luminance"), std::string::npos);
  style.exemplars[0].guides.reset();
  EXPECT_NE(refusal(style).find("no guides with layer luminance"), std::string::npos);
  style = LitStyle(true, {});
  for (const float weight : {-1.0f, kNan, kInfinity}) {
    style.transfer.guide_weights = Weights({{Layer::kShadow, weight}});
    EXPECT_NE(refusal(style).find("transfer.guide_weights.shadow must be 0 or more"), std::string::npos) << weight;
  }
  style.transfer.guide_weights = Weights({{Layer::kNormal, 0.0f}});
  EXPECT_NE(refusal(style).find("all 0"), std::string::npos);
  for (const Layer layer : {Layer::kObject, Layer::kPosition, Layer::kDepth, Layer::kPref}) {
    style.transfer.guide_weights = Weights({{layer, 1.0f}});
    EXPECT_NE(refusal(style).find("can have a weight"), std::string::npos) << Info(layer).name;
  }
  // And scenes that lack a layer.
  const auto prepared = Prepare(LitStyle(true, Weights({{Layer::kLpeLSE, 1.0f}})), 64);
  ASSERT_TRUE(prepared.ok());
  TransferScratch scratch;
  Picture out;
  const Status done = Transfer(*prepared, HillGuides(72, 64), {}, scratch, out);
  ASSERT_FALSE(done.ok());
  EXPECT_NE(done.error().message.find("needs layer lpe.LSE"), std::string::npos);
}

}  // namespace
}  // namespace scumble
