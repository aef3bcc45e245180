// Prints a hash of the picture after each finishing effect, with each of its keys and each two of its choices changed.
// The first line is the form of this program's functions with SCUMBLE_WIDE_LOOPS: "avx2" or "default".
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/image/check.h"
#include "core/image/hash.h"
#include "core/style/color_ramp.h"
#include "core/style/finish_keys.h"
#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

__attribute__((target("avx2"))) const char* Form() { return "avx2"; }
__attribute__((target("default"))) const char* Form() { return "default"; }

struct Change {
  std::string key;
  KeyValue value;
  std::string text;
};

// Choices and flags that are not the default's.
std::vector<Change> OtherChoices(const FinishPass& pass) {
  std::vector<Change> changes;
  for (const FinishKey& key : EffectOf(pass).keys) {
    const KeyValue now = key.get(pass);
    if (key.kind == KeyKind::kFlag) changes.push_back({key.name, !std::get<bool>(now), "other"});
    if (key.kind != KeyKind::kChoice) continue;
    for (const std::string& choice : key.choices) {
      if (KeyValue(choice) != now) changes.push_back({key.name, choice, choice});
    }
  }
  return changes;
}

// Numbers, each a little above its least value.
std::vector<Change> OtherNumbers(const FinishPass& pass) {
  std::vector<Change> changes;
  for (const FinishKey& key : EffectOf(pass).keys) {
    const double number = key.name == "far" ? 7.0 : std::min(key.most, key.least + 2.5);  // beyond what is near
    if (key.kind == KeyKind::kNumber) changes.push_back({key.name, number, std::to_string(number)});
    if (key.kind == KeyKind::kWhole)
      changes.push_back({key.name, std::int64_t(number), std::to_string(std::int64_t(number))});
  }
  return changes;
}

class Printer {
 public:
  Printer() {
    guides_.attributes["scumble:light"] = "exact";
    guides_.Add(Layer::kLpeLSE);
    for (int c = 0; c < 3; ++c) {
      const auto light = guides_.Plane(Layer::kLpeFull, c), highlight = guides_.Plane(Layer::kLpeLSE, c);
      for (std::size_t i = 0; i < light.size(); ++i) highlight[i] = light[i] * light[i];
    }
    measures_ = MeasureFinish(guides_);
  }

  void Print(const FinishEffect& effect, const std::vector<Change>& changes) const {
    FinishPass pass = *MakeFinishPass(effect.name);
    std::string name = effect.name;
    if (auto* const toon = std::get_if<ToonPass>(&pass.effect)) toon->ramp_colors = ramp_;
    if (auto* const palette = std::get_if<PalettePass>(&pass.effect))
      palette->target = ColorSpread{{0.4, 0.1, 0.0}, {0.02}};
    for (const Change& change : changes) {
      name += " " + change.key + "=" + change.text;
      SCUMBLE_CHECK(SetFinishKey(pass, change.key, change.value));
    }
    Picture picture = picture_;
    const FinishStep step{pass, {}};
    const FinishFrame frame{&guides_, measures_, 1.0, 7};
    if (!ApplyFinish({&step, 1}, FinishPass::Stage::kPaint, frame, 1, {}, picture)) {
      std::printf("refused %s\n", name.c_str());  // choices that exclude each other
      return;
    }
    std::uint64_t hash = 0;
    for (const std::uint16_t value : picture.rgba) hash = HashOn(hash, value);
    std::printf("%016llx %s\n", static_cast<unsigned long long>(hash), name.c_str());
  }

 private:
  GuideSet guides_ = LitBalls();
  Picture picture_ = CoveredPicture(guides_);
  FinishMeasures measures_;
  std::shared_ptr<const ColorRamp> ramp_ =
      std::make_shared<const ColorRamp>(*ParseColorRamp("#202040 #fff4d0 / #405060 #c0d0e0"));
};

void PrintAll() {
  const Printer printer;
  for (const FinishEffect& effect : FinishEffects()) {
    const FinishPass pass = *MakeFinishPass(effect.name);
    printer.Print(effect, {});
    for (const Change& number : OtherNumbers(pass)) printer.Print(effect, {number});
    const std::vector<Change> choices = OtherChoices(pass);
    for (std::size_t a = 0; a < choices.size(); ++a) {
      printer.Print(effect, {choices[a]});
      for (std::size_t b = a + 1; b < choices.size(); ++b) {
        if (choices[a].key != choices[b].key) printer.Print(effect, {choices[a], choices[b]});
      }
    }
  }
}

}  // namespace
}  // namespace scumble

int main() {
  std::puts(scumble::Form());
  scumble::PrintAll();
}
