// Coherent mode: seeds on the surface against a plain version of the rules in transfer/seeds/surface_seeds.h, and their
// purpose: paint that stays in place while the object or the camera moves.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "tests/support/transfer_fixtures.h"
#include "transfer/nearest/guide_distance.h"
#include "transfer/seeds/surface_seeds.h"

namespace scumble {
namespace {

using namespace testing;

void SetPref(GuideSet& guides, std::size_t i, const glm::vec3& place) {
  for (int c = 0; c < 3; ++c) guides.Plane(Layer::kPref, c)[i] = place[c];
}

// Guides with pref by a function of the pixel; everything covered.
GuideSet WithPref(GuideSet guides, const std::function<glm::vec3(int x, int y)>& pref) {
  guides.Add(Layer::kPref);
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < guides.width(); ++x) {
      const std::size_t i = guides.Index(x, y);
      if (guides.Plane(Layer::kCoverage)[i] > 0.0f) SetPref(guides, i, pref(x, y));
    }
  }
  return guides;
}

// Hills in two objects of unlike scale and depth, a bit of nonsense among them.
GuideSet Landscape(int width, int height) {
  GuideSet guides = WithPref(HillGuides(width, height), [=](int x, int y) {
    const float scale = x < width / 2 ? 0.013f : 4.1f;
    return scale * glm::vec3(x, y, 3.0f * std::sin(0.1f * x) + 2.0f * std::cos(0.07f * y));
  });
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = guides.Index(x, y);
      if (!(guides.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
      guides.Plane(Layer::kObject)[i] = x < width / 2 ? 7.0f : 16000001.0f;
      guides.Plane(Layer::kDepth)[i] = 5.0f + 0.03f * static_cast<float>(y);
      if (x > 10 && x < 15 && y > 40) SetPref(guides, i, glm::vec3(std::nanf("")));
      if (x > 20 && x < 24 && y > 40) SetPref(guides, i, glm::vec3(3e38f, -3e38f, 0.0f));
      if (x > 30 && x < 34 && y > 40) SetPref(guides, i, glm::vec3(std::numeric_limits<float>::infinity()));
      if (x > 70 && x < 74 && y > 40) guides.Plane(Layer::kDepth)[i] = 0.0f;
    }
  }
  return guides;
}

Style CoherentStyle(int size, int levels) {
  Style style = PlainStyle(NoisePicture(size));
  style.transfer.levels = levels;
  style.transfer.coherent = true;
  return style;
}

// The rules, pixel by pixel, without any of the engine's tables and short cuts: 27 cubes are looked at for each pixel
// and exponent.
class PlainCoherent {
 public:
  PlainCoherent(const GuideSet& guides, const Style& style, std::uint64_t seed)
      : guides_(guides),
        settings_(style.transfer),
        exemplar_(style.exemplars[0].picture, style.transfer.rim, style.exemplars[0].picture.width),
        test_(settings_.threshold, settings_.threshold_metric),
        seed_(seed),
        octave_(guides.pixel_count(), std::nan("")) {
    FindOctaves();
  }

  SourceField Run() {
    SourceField field;
    field.Reset(guides_.width(), guides_.height());
    int low = 1000, high = -1000;
    for (const double octave : octave_) {
      if (std::isnan(octave)) continue;
      low = std::min(low, int(std::floor(octave))), high = std::max(high, int(std::floor(octave)));
    }
    for (int e = high + settings_.levels; e > low; --e) Settle(e, field);
    for (std::size_t i = 0; i < guides_.pixel_count(); ++i) {
      if (!Covered(i) || field.level[i] != SourceField::kNoSource) continue;
      const Source own = exemplar_.NearestNeighbour(guides_.Vec3(Layer::kNormal, i));
      field.Set(i, own.x, own.y, 0, 0);
    }
    return field;
  }

 private:
  bool Covered(std::size_t i) const { return guides_.Plane(Layer::kCoverage)[i] > 0.0f; }
  std::uint32_t Object(std::size_t i) const { return std::bit_cast<std::uint32_t>(guides_.Plane(Layer::kObject)[i]); }
  double Depth(std::size_t i) const {
    const float depth = guides_.Plane(Layer::kDepth)[i];
    return depth > 0.0f ? depth : 1.0;
  }
  bool HasPlace(std::size_t i) const {
    const glm::vec3 p = guides_.Vec3(Layer::kPref, i);
    return Covered(i) && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  }

  void FindOctaves() {
    std::map<std::uint32_t, std::vector<float>> steps;
    for (int y = 0; y < guides_.height(); ++y) {
      for (int x = 0; x < guides_.width(); ++x) {
        const std::size_t i = guides_.Index(x, y);
        if (!HasPlace(i)) continue;
        double step = 1e300;
        for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}}) {
          if (x + dx >= guides_.width() || y + dy >= guides_.height()) continue;
          const std::size_t j = guides_.Index(x + dx, y + dy);
          if (!HasPlace(j) || Object(j) != Object(i)) continue;
          const glm::dvec3 d = glm::dvec3(guides_.Vec3(Layer::kPref, i)) - glm::dvec3(guides_.Vec3(Layer::kPref, j));
          const double to = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
          if (to > 0.0) step = std::min(step, to);
        }
        if (step / Depth(i) < 1e30) steps[Object(i)].push_back(static_cast<float>(step / Depth(i)));
      }
    }
    for (auto& [object, list] : steps) std::sort(list.begin(), list.end());
    for (std::size_t i = 0; i < octave_.size(); ++i) {
      if (!HasPlace(i) || steps[Object(i)].empty()) continue;
      const auto& list = steps[Object(i)];
      int exponent = 0;
      const double mantissa = std::frexp(double(list[list.size() / 2]) * Depth(i), &exponent);
      octave_[i] = static_cast<float>(exponent - 1 + (2.0 * mantissa - 1.0));
    }
  }

  // The key of the nearest point and the squared distance to it, in edges.
  std::pair<std::uint64_t, float> Piece(std::size_t i, int e) const {
    const std::uint64_t place = Hash(seed_, Object(i), e), prefix = Hash(place, 0);
    double low[3];
    float local[3];
    for (int c = 0; c < 3; ++c) {
      const double at =
          guides_.Plane(Layer::kPref, c)[i] / std::ldexp(1.0, e) + UnitFloat(Mix64(place + std::uint64_t(c)));
      if (!(std::fabs(at) < std::ldexp(1.0, 50))) return {0, 0.0f};
      low[c] = std::floor(at), local[c] = static_cast<float>(at - low[c]);
    }
    std::pair<std::uint64_t, float> best{0, std::numeric_limits<float>::infinity()};
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const int d[3] = {dx, dy, dz};
          std::uint64_t packed = 0;
          for (int c = 0; c < 3; ++c) {
            packed = packed << 21 | (std::uint64_t(std::int64_t(low[c]) + d[c]) & 0x1fffff);
          }
          const std::uint64_t key = Mix64(prefix ^ packed), chance = Mix64(key);
          float squared = 0.0f;
          for (int c = 0; c < 3; ++c) {
            const float j = static_cast<float>(chance >> (21 * c) & 0x1fffff) / 2097152.0f;
            const float to = static_cast<float>(d[c]) + (0.5f + (j - 0.5f) * settings_.jitter) - local[c];
            squared += to * to;
          }
          if (squared < best.second) best = {key, squared};
        }
      }
    }
    return best;
  }

  // The seed's normal in the middle of its cell of Lambert's map of equal areas.
  glm::vec3 Steady(glm::vec3 n, std::uint64_t key) const {
    const float cell = 0.5f * std::min(0.25f, settings_.threshold);
    const float to_map = std::sqrt(2.0f / (1.0f + n.z));
    const auto round = [&](float v, int purpose) {
      const float shift = UnitFloat(Hash(key, purpose));
      return (std::floor(v / cell + shift) - shift + 0.5f) * cell;
    };
    glm::vec2 at(round(n.x * to_map, 1), round(n.y * to_map, 2));
    float squared = at.x * at.x + at.y * at.y;
    if (squared > 2.0f) at *= std::sqrt(2.0f / squared), squared = 2.0f;
    return {at.x * std::sqrt(1.0f - squared / 4.0f), at.y * std::sqrt(1.0f - squared / 4.0f), 1.0f - squared / 2.0f};
  }

  void Settle(int e, SourceField& field) const {
    std::map<std::uint64_t, std::tuple<float, std::size_t>> seeds;
    std::vector<std::uint64_t> keys(octave_.size(), 0);
    for (std::size_t i = 0; i < octave_.size(); ++i) {
      if (std::isnan(octave_[i])) continue;
      const int above = e - int(std::floor(octave_[i]));
      if (above < 1 || above > settings_.levels) continue;
      const auto [key, squared] = Piece(i, e);
      if (key == 0) continue;
      keys[i] = key;
      const auto found = seeds.try_emplace(key, squared, i).first;
      found->second = std::min(found->second, {squared, i});
    }
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (keys[i] == 0 || field.level[i] != SourceField::kNoSource) continue;
      const std::size_t q = std::get<1>(seeds.at(keys[i]));
      const int level = e - int(std::floor(float(octave_[q]) + UnitFloat(Hash(keys[i], 0))));
      if (level < 1 || level >= settings_.levels) continue;
      const glm::vec3 normal = guides_.Vec3(Layer::kNormal, q);
      const Source u = exemplar_.NearestNeighbour(Steady(normal, keys[i]));
      const int width = guides_.width();
      const Source s{u.x + int(i) % width - int(q) % width, u.y + int(i) / width - int(q) / width};
      if (!exemplar_.Usable(s.x, s.y)) continue;
      if (!test_.Alike(guides_.Vec3(Layer::kNormal, i), exemplar_.Normal(s.x, s.y))) continue;
      field.Set(i, s.x, s.y, 0, level);
    }
  }

  const GuideSet& guides_;
  TransferSettings settings_;
  PreparedExemplar exemplar_;
  GuideTest test_;
  std::uint64_t seed_;
  std::vector<double> octave_;
};

TEST(Coherent, FollowsThePlainRules) {
  const GuideSet guides = Landscape(120, 80);
  for (const auto& [levels, jitter, seed] : {std::tuple{6, 1.0f, 3}, {3, 0.5f, 4}, {7, 0.0f, 5}, {1, 1.0f, 6}}) {
    Style style = CoherentStyle(200, levels);
    style.transfer.jitter = jitter;
    TransferOptions options;
    options.seed = std::uint64_t(seed);
    const SourceField field = MustTransfer(style, guides, options).field;
    const SourceField plain = PlainCoherent(guides, style, options.seed).Run();
    EXPECT_EQ(field.level, plain.level) << levels;
    EXPECT_EQ(field.x, plain.x) << levels;
    EXPECT_EQ(field.y, plain.y) << levels;
    EXPECT_EQ(*std::max_element(field.level.begin(), field.level.end()), levels - 1);
  }
}

TEST(Coherent, SameBytesForAnyThreadsAndRegions) {
  const GuideSet guides = Landscape(120, 80);
  Style style = CoherentStyle(200, 6);
  style.transfer.variety = 15.0;
  TransferOptions options;
  options.threads = 1;
  const Picture one = MustTransfer(style, guides, options).picture;
  for (const int threads : {2, 3, 7}) {
    options.threads = threads;
    EXPECT_EQ(MustTransfer(style, guides, options).picture.rgba, one.rgba) << threads;
  }
  const auto prepared = Prepare(style, guides.height());
  ASSERT_TRUE(prepared.ok());
  TransferScratch scratch;
  Picture tiled(guides.width(), guides.height());
  for (int y = 0; y < 80; y += 17) {
    for (int x = 0; x < 120; x += 31) {
      options.region = Region{x, y, x + 31, y + 17};
      ASSERT_TRUE(Transfer(*prepared, guides, options, scratch, tiled).ok());
    }
  }
  EXPECT_EQ(tiled.rgba, one.rgba);
}

TEST(Coherent, AsksForPrefAndNothingElsePaysForIt) {
  Style style = CoherentStyle(64, 4);
  EXPECT_TRUE(RequiredLayers(style).Has(Layer::kPref));
  const auto prepared = Prepare(style, 32);
  TransferScratch scratch;
  Picture out;
  const Status missing = Transfer(*prepared, HillGuides(32, 32), {}, scratch, out);
  ASSERT_FALSE(missing.ok());
  EXPECT_NE(missing.error().message.find("needs layer pref"), std::string::npos) << missing.error().message;

  const GuideSet with = Landscape(60, 40);
  GuideSet without = with;
  without.Remove(Layer::kPref);
  for (const Method method : {Method::kStyleBlit, Method::kLitSphere, Method::kBruteForce}) {
    style.transfer.method = method;
    style.transfer.coherent = false;
    EXPECT_FALSE(RequiredLayers(style).Has(Layer::kPref));
    const Picture off = MustTransfer(style, without).picture;
    EXPECT_EQ(MustTransfer(style, with).picture.rgba, off.rgba);
    style.transfer.coherent = true;
    if (method == Method::kStyleBlit) continue;
    EXPECT_FALSE(RequiredLayers(style).Has(Layer::kPref));  // no seeds: nothing to be coherent
    EXPECT_EQ(MustTransfer(style, without).picture.rgba, off.rgba);
  }
}

// A sphere in the picture, whose middle is at (cx, cy).
GuideSet BallAt(int width, int height, float cx, float cy, float radius, float object = 1.0f) {
  const auto normal = [=](int x, int y) {
    const float nx = (static_cast<float>(x) + 0.5f - cx) / radius, ny = (cy - static_cast<float>(y) - 0.5f) / radius;
    const float z2 = 1.0f - nx * nx - ny * ny;
    return z2 > 0.0f ? glm::vec3(nx, ny, std::sqrt(z2)) : glm::vec3(0.0f);
  };
  GuideSet guides = WithPref(MakeGuides(width, height, normal), normal);
  for (float& id : guides.Plane(Layer::kObject)) id = id > 0.0f ? object : 0.0f;
  return guides;
}

// How many of the pixels that both show take the same source after a move by (dx, dy) pixels.
double ShareKept(const SourceField& before, const SourceField& after, int dx, int dy) {
  double kept = 0, all = 0;
  for (int y = std::max(0, -dy); y < before.height - std::max(0, dy); ++y) {
    for (int x = std::max(0, -dx); x < before.width - std::max(0, dx); ++x) {
      const std::size_t i = before.Index(x, y), j = after.Index(x + dx, y + dy);
      if (before.level[i] == SourceField::kNoSource || after.level[j] == SourceField::kNoSource) continue;
      ++all, kept += before.x[i] == after.x[j] && before.y[i] == after.y[j];
    }
  }
  return kept / all;
}

TEST(Coherent, WholePixelsMoveThePaintExactly) {
  Style style = CoherentStyle(180, 6);
  const GuideSet at = BallAt(160, 120, 50.25f, 60.5f, 40.0f), moved = BallAt(160, 120, 87.25f, 67.5f, 40.0f);
  const auto share = [&] { return ShareKept(MustTransfer(style, at).field, MustTransfer(style, moved).field, 37, 7); };
  EXPECT_GT(share(), 0.99);  // but for places that a float's rounding moved across a border
  style.transfer.coherent = false;
  EXPECT_LT(share(), 0.3);
}

TEST(Coherent, InstancesOfOneShapeArePaintedUnlike) {
  const Style style = CoherentStyle(180, 6);
  const SourceField a = MustTransfer(style, BallAt(100, 100, 50.0f, 50.0f, 40.0f, 1.0f)).field;
  const SourceField b = MustTransfer(style, BallAt(100, 100, 50.0f, 50.0f, 40.0f, 2.0f)).field;
  EXPECT_LT(ShareKept(a, b, 0, 0), 0.3);
}

GuideSet Wall(int size, float turned_degrees, float pixels_per_unit = 100.0f, float noise = 0.0f) {
  const float a = turned_degrees * 3.14159265f / 180.0f;
  const glm::vec3 normal(std::sin(a), 0.2f, std::cos(a));
  return WithPref(MakeGuides(size, size, [=](int, int) { return glm::normalize(normal); }), [=](int x, int y) {
    return glm::vec3(static_cast<float>(x) / pixels_per_unit, noise * static_cast<float>((x + y) % 2 * 2 - 1),
                     static_cast<float>(y) / pixels_per_unit);
  });
}

// A quarter of a degree is one and a half exemplar pixels, and a fourteenth of a grid cell: that many chunks change.
TEST(Coherent, PaintDoesNotSlideWhileTheSurfaceTurns) {
  Style style = CoherentStyle(700, 6);
  style.transfer.rim = 0.0;
  const GuideSet before = Wall(200, 10.0f), after = Wall(200, 10.25f);
  const auto share = [&] {
    return ShareKept(MustTransfer(style, before).field, MustTransfer(style, after).field, 0, 0);
  };
  EXPECT_GT(share(), 0.8);
  EXPECT_LT(share(), 0.999);
  style.transfer.coherent = false;
  EXPECT_LT(share(), 0.1);
}

// Height 0 would lie between two layers of cubes if the grids were not moved.
TEST(Coherent, AFloorAtHeightZeroIsOneSurface) {
  const Style style = CoherentStyle(300, 6);
  const SourceField flat = MustTransfer(style, Wall(160, 0.0f)).field;
  const SourceField noisy = MustTransfer(style, Wall(160, 0.0f, 100.0f, 1e-7f)).field;
  EXPECT_GT(ShareKept(flat, noisy, 0, 0), 0.999);
}

// A zoom by 3 % changes some of the largest chunks; the borders of the others stay in place on the surface.
TEST(Coherent, AZoomKeepsMostPieces) {
  const Style style = CoherentStyle(900, 5);
  const GuideSet near = Wall(200, 0.0f, 103.0f), far = Wall(200, 0.0f, 100.0f);
  const SourceField a = MustTransfer(style, far).field, b = MustTransfer(style, near).field;
  double same = 0, all = 0;
  for (int y = 0; y < 190; ++y) {
    for (int x = 0; x < 190; ++x) {
      const std::size_t i = a.Index(x, y), j = b.Index(int(std::lround(x * 1.03)), int(std::lround(y * 1.03)));
      ++all, same += a.level[i] == b.level[j];
    }
  }
  EXPECT_GT(same / all, 0.85);
  EXPECT_LT(same / all, 0.9999);
}

TEST(Coherent, JitterFpsBoilsOnTheSurface) {
  Style style = CoherentStyle(200, 6);
  const GuideSet guides = BallAt(120, 120, 60.0f, 60.0f, 50.0f);
  TransferOptions first, second;
  second.frame = 1;
  const Picture still = MustTransfer(style, guides, first).picture;
  EXPECT_EQ(MustTransfer(style, guides, second).picture.rgba, still.rgba);
  style.transfer.jitter_fps = -1.0;
  EXPECT_EQ(MustTransfer(style, guides, first).picture.rgba, still.rgba);
  EXPECT_NE(MustTransfer(style, guides, second).picture.rgba, still.rgba);
}

TEST(Coherent, ObjectsOfOnePixelAndEmptyPicturesTakeTheirOwn) {
  const Style style = CoherentStyle(64, 5);
  GuideSet specks = WithPref(
      MakeGuides(20, 20, [](int x, int y) { return x % 2 || y % 2 ? glm::vec3(0.0f) : glm::vec3(0.0f, 0.6f, 0.8f); }),
      [](int x, int y) { return glm::vec3(x, y, 0.0f); });
  for (const std::int8_t level : MustTransfer(style, specks).field.level) EXPECT_LE(level, 0);
  const GuideSet nothing =
      WithPref(MakeGuides(9, 7, [](int, int) { return glm::vec3(0.0f); }), [](int, int) { return glm::vec3(0.0f); });
  for (const std::int8_t level : MustTransfer(style, nothing).field.level) EXPECT_EQ(level, SourceField::kNoSource);
}

}  // namespace
}  // namespace scumble
