// Woodcut from two blocks. The gouge clears the light out of the black one and runs into the shade in wedges; a flat
// colour from a second block, a little out of register, fills the half-tones under it.
#include <algorithm>
#include <cmath>

#include "exemplars/paint/engine/even_lines.h"
#include "exemplars/paint/engine/media.h"
#include "exemplars/paint/engine/paper.h"
#include "exemplars/paint/sphere.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

constexpr Stock kPaper{Tooth::kFine, 5.0f, {0.965f, 0.94f, 0.885f}, 0.02f};
constexpr glm::vec3 kBlack{0.085f, 0.08f, 0.085f};
constexpr glm::vec3 kBrick{0.80f, 0.33f, 0.20f};
constexpr glm::vec2 kOutOfRegister{-7.0f, 6.0f};  // offset of the colour from its right place

enum Pass : std::uint64_t { kDirection = kFirstStream, kContour, kEdges, kGrain, kBlackCuts = 10, kColorCuts = 20 };

// Radius of the preset "deevad/brush"; pressure makes it 0.42 to 4.5 times as wide.
constexpr float kGouge = 1.3f;
constexpr float kAlongTheLight = 38.0f;  // degrees between the cuts and the direction of the light

float PressureFor(float radius) {
  return radius < 0.44f * kGouge ? 0.0f : std::min((std::log(radius / kGouge) + 0.859f) / 2.36f, 1.0f);
}

// Towards the light, turned by `degrees`, and wandering, so that neighbouring cuts agree and distant ones do not.
Flow CutDirection(float degrees, std::uint64_t stream) {
  const Flow along = TowardsAxis(kKeyLight);
  const Flow around = AroundAxis(kKeyLight);
  return [=](glm::vec2 at) {
    const float angle = glm::radians(degrees + 26.0f * (CloudNoise(at / 170.0f, 2, stream) - 0.5f));
    return along(at) * std::cos(angle) + around(at) * std::sin(angle);
  };
}

// Share of the black block that is cut away: all in the light, nothing in the core.
float Cleared(glm::vec2 at) {
  const Shading shading = ShadingAt(at);
  return Ramp(0.02f, 0.84f, shading.value - 0.24f * shading.reflected);
}

// Between the middles of cuts that model; closer where the form turns away.
float Room(glm::vec2 at) { return 15.0f * (0.72f + 0.28f * NormalAt(at).z); }
// Between those that only clear.
float NarrowRoom(glm::vec2) { return 8.0f; }

struct Cuts {
  std::uint64_t pass;
  float degrees;
  Touch room;           // between their middles
  Touch width;          // of each
  float taper = 34.0f;  // units over which their ends run out
};

class Block {
 public:
  Block(Brush& gouge, const Studio& studio) : gouge_(gouge), studio_(studio), cuts_({kOversampling * studio.size}) {}

  void Cut(const Cuts& cuts) {
    Chance chance(studio_.seed, cuts.pass);
    const Flow flow = CutDirection(cuts.degrees, Hash(studio_.seed, kDirection));
    // The gouge continues past the rim, so that no stubs stay along it.
    const Touch room = [&](glm::vec2 at) {
      return RimDistance(at) < 1.14f && cuts.width(at) > 0.8f ? cuts.room(at) : 0.0f;
    };
    for (const Stroke& line : PlanEvenLines(chance, flow, room)) {
      const float gain = 1.0f + chance.Bell(0.10f);
      const std::uint64_t wobble = chance.Draw();
      const float last = static_cast<float>(line.size() - 1);
      Stroke swelling = line;
      for (std::size_t i = 0; i < line.size(); ++i) {
        const float from_start = static_cast<float>(i) / last;
        const float to_end = std::min(from_start, 1.0f - from_start) * glm::distance(line[0].at, line[1].at) * last;
        const float hand = 0.86f + 0.28f * SmoothNoise(glm::vec2(static_cast<float>(i) / 8.5f, 0.5f), wobble);
        const float run_out = Ramp(-0.2f * cuts.taper, cuts.taper, to_end);
        swelling[i].pressure = PressureFor(0.5f * cuts.width(line[i].at) * gain * hand * run_out);
      }
      gouge_.Paint(cuts_, swelling);
    }
  }

  // The contour of the form is left standing as a line: the eraser removes the cuts there.
  void KeepContour() {
    Chance chance(studio_.seed, kContour);
    const Touch weight = [](glm::vec2 at) { return PressureFor(3.2f + 2.6f * DarknessAt(at)); };
    gouge_.Set(MYPAINT_BRUSH_SETTING_ERASER, 1.0f);
    gouge_.Paint(cuts_,
                 PlanRim(chance, weight,
                         {.lines = 26, .inset = 2.5f, .deviation = 1.2f, .length_min = 0.7f, .length_max = 1.8f}));
    gouge_.Set(MYPAINT_BRUSH_SETTING_ERASER, 0.0f);
  }

  // The print, 0 … 1, of the block shifted by `shift` units: all uncut parts, as far as the block is inked, with the
  // burr of the wood's edges.
  Field Inked(glm::vec2 shift, std::uint64_t stream) const {
    const Field cut = Plane(cuts_.Read(), 3);
    const float scale = static_cast<float>(cut.size) / kSide;
    Field ink({studio_.size});
    for (int y = 0; y < cut.size; ++y) {
      for (int x = 0; x < cut.size; ++x) {
        const glm::vec2 at = cut.Place(x, y) - shift;
        const glm::vec2 pixel = glm::floor(at * scale);
        const float burr = 0.22f * (CloudNoise(at / 6.0f, 2, stream) - 0.5f);
        const float wood = Ramp(0.60f, 0.40f, cut.Near(static_cast<int>(pixel.x), static_cast<int>(pixel.y)) + burr);
        const float edge = 1.0f + 0.006f * (CloudNoise(at / 30.0f, 2, Hash(stream, 1)) - 0.5f);
        ink.At(x / kOversampling, y / kOversampling) += wood * Ramp(edge + 0.009f, edge + 0.006f, RimDistance(at));
      }
    }
    for (float& amount : ink.pixels) amount /= kOversampling * kOversampling;
    return ink;
  }

 private:
  // The edges of a print are crisp and smooth.
  static constexpr int kOversampling = 2;

  Brush& gouge_;
  const Studio& studio_;
  Canvas cuts_;
};

// Clears the light in broad strokes as wide as `share` of `widest`, and once more across where nothing is to stay.
void ClearOpenLight(Block& block, std::uint64_t first_pass, float widest, const Touch& share) {
  block.Cut({first_pass, kAlongTheLight, NarrowRoom, [&](glm::vec2 at) { return widest * share(at); }, 10.0f});
  const Touch across = [&](glm::vec2 at) { return widest * Ramp(0.96f, 1.0f, share(at)); };
  block.Cut({first_pass + 1, kAlongTheLight + 60.0f, NarrowRoom, across, 10.0f});
}

Field PrintBlack(Brush& gouge, const Studio& studio) {
  Block block(gouge, studio);
  block.Cut({kBlackCuts, kAlongTheLight, Room, [](glm::vec2 at) { return 1.12f * Room(at) * Cleared(at); }});
  // Reflected light in the shade; a contour stays outside it.
  const Touch reflected = [](glm::vec2 at) {
    return 9.5f * Ramp(0.20f, 0.9f, ShadingAt(at).reflected) * (1.0f - Cleared(at)) *
           Ramp(1.0f, 0.99f, RimDistance(at));
  };
  block.Cut({kBlackCuts + 1, 60.0f, [](glm::vec2 at) { return 1.25f * Room(at); }, reflected});
  ClearOpenLight(block, kBlackCuts + 2, 17.0f, [](glm::vec2 at) { return Ramp(0.80f, 0.92f, Cleared(at)); });
  block.KeepContour();
  return block.Inked({0.0f, 0.0f}, Hash(studio.seed, kEdges, 0));
}

Field PrintColor(Brush& gouge, const Studio& studio) {
  Block block(gouge, studio);
  block.Cut({kColorCuts, kAlongTheLight, Room,
             [](glm::vec2 at) { return 1.2f * Room(at) * Ramp(0.48f, 0.82f, ShadingAt(at).value); }});
  ClearOpenLight(block, kColorCuts + 1, 18.0f, [](glm::vec2 at) { return Ramp(0.70f, 0.86f, ShadingAt(at).value); });
  return block.Inked(kOutOfRegister, Hash(studio.seed, kEdges, 1));
}

// The transfer of the ink: it skips along the veins of the wood and in hollows of the paper.
float Took(glm::vec2 at, float tooth, std::uint64_t stream) {
  const glm::vec2 vein(at.x / 90.0f + 0.3f * SmoothNoise(at / 120.0f, Hash(stream, 1)), (at.y + 0.12f * at.x) / 3.2f);
  const float grain = CloudNoise(vein, 2, Hash(stream, 2));
  return 1.0f - 0.55f * Ramp(0.70f, 0.95f, grain + 0.35f * (0.5f - tooth));
}

}  // namespace

Expected<Picture> PaintWoodcut(const Studio& studio) {
  SCUMBLE_ASSIGN(Brush gouge, Brush::Load(studio.brushes, "deevad/brush"));
  gouge.Radius(kGouge).Set(MYPAINT_BRUSH_SETTING_HARDNESS, 1.0f);
  auto [tooth, picture] = PrepareGround({studio.size}, kPaper, studio.seed);
  const Field color = PrintColor(gouge, studio);
  const Field black = PrintBlack(gouge, studio);
  for (int y = 0; y < picture.size; ++y) {
    for (int x = 0; x < picture.size; ++x) {
      const glm::vec2 at = picture.Place(x, y);
      const float rough = tooth.At(x, y);
      glm::vec3& here = picture.At(x, y);
      here = glm::mix(here, kBrick, color.At(x, y) * Took(at, rough, Hash(studio.seed, kGrain, 0)));
      here = glm::mix(here, kBlack, black.At(x, y) * Took(at, rough, Hash(studio.seed, kGrain, 1)));
    }
  }
  return ToPicture(picture);
}

Expected<Picture> WoodcutPaper(const Studio& studio) { return PaperTile(studio, kPaper); }

}  // namespace scumble::paint
