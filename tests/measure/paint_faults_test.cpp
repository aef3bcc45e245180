// Each usual mistake, alone in an otherwise good exemplar, is found, and no other is.
#include "measure/paint_faults.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "tests/support/painted_spheres.h"

namespace scumble {
namespace {

std::vector<PaintFault> Faults(const Picture& picture, const PaintFaultContext& context = {},
                               const Picture* bare = nullptr) {
  return FindPaintFaults(MeasurePaint(ExemplarOf(picture), 2.0, bare), context);
}

// Codes, in a row; with what they say where that helps to understand a failure.
std::string Codes(const std::vector<PaintFault>& faults) {
  std::string codes;
  for (const PaintFault& fault : faults) codes += (codes.empty() ? "" : " ") + fault.code;
  return codes;
}

std::string Said(const std::vector<PaintFault>& faults) {
  std::string text;
  for (const PaintFault& fault : faults) text += fault.what + "; " + fault.remedy + "\n";
  return text;
}

// Exactly one fault, with all of `words` in it. Returns it, with a place in any case.
PaintFault ExpectOne(const std::vector<PaintFault>& faults, const std::string& code,
                     const std::vector<std::string>& words) {
  EXPECT_EQ(Codes(faults), code) << Said(faults);
  for (const std::string& word : words)
    EXPECT_NE(Said(faults).find(word), std::string::npos) << word << "\n" << Said(faults);
  PaintFault first = faults.empty() ? PaintFault() : faults.front();
  if (!first.place) first.place = {-1000, -1000};
  return first;
}

PaintedSphere Clean(double reach = 1.0) {
  PaintedSphere sphere;
  sphere.reach = reach, sphere.waver = 0.0;
  return sphere;
}

void ForDisc(Picture& picture, double x, double y, double radius, const std::function<void(int, int)>& change) {
  for (int j = 0; j < picture.height; ++j) {
    for (int i = 0; i < picture.width; ++i) {
      if (std::hypot(i + 0.5 - x, j + 0.5 - y) < radius) change(i, j);
    }
  }
}

TEST(PaintFaults, GoodPaintingsAreSilent) {
  EXPECT_EQ(Codes(Faults(PaintSphere({}))), "") << Said(Faults(PaintSphere({})));
  PaintedSphere full;  // paint fills the square
  full.reach = 2.0;
  EXPECT_EQ(Codes(Faults(PaintSphere(full))), "") << Said(Faults(PaintSphere(full)));
  PaintedSphere wide = Clean(1.1);  // a clean edge, outside the sphere
  EXPECT_EQ(Codes(Faults(PaintSphere(wide))), "") << Said(Faults(PaintSphere(wide)));
  PaintedSphere paper_lights;  // the lights are paper
  paper_lights.light = 0.93, paper_lights.grain = 0.02;
  EXPECT_EQ(Codes(Faults(PaintSphere(paper_lights))), "") << Said(Faults(PaintSphere(paper_lights)));
  PaintedSphere dark = {};  // light paint on dark paper
  dark.paper = 0.2;
  EXPECT_EQ(Codes(Faults(PaintSphere(dark))), "") << Said(Faults(PaintSphere(dark)));
}

TEST(PaintFaults, Sizes) {
  PaintedSphere small;
  small.size = 255;
  ExpectOne(Faults(PaintSphere(small)), "too-small", {"255 pixels", "--size 1024"});
  small.size = 256;
  EXPECT_EQ(Codes(Faults(PaintSphere(small))), "");
  PaintFaultContext other;
  other.several = true, other.largest_size = 1024, other.tonal_range = 60.0;
  ExpectOne(Faults(PaintSphere({}), other), "other-size", {"512 pixels", "1024", "one size"});
}

TEST(PaintFaults, WholeTemplates) {
  PaintedSphere inner = Clean();
  inner.size = 640, inner.radius = 0.4;
  ExpectOne(Faults(PaintSphere(inner)), "margin", {"512 of 640", "crop it to the middle 512×512", "guides.exr"});
  PaintFaultContext marked;
  marked.shows_marks = true;
  ExpectOne(Faults(PaintSphere({}), marked), "margin", {"template"});
}

TEST(PaintFaults, OffCentre) {
  PaintedSphere shifted = Clean();
  shifted.x = 0.53, shifted.y = 0.48;
  // 15.4 and 10.2 pixels of 512: 3.6%.
  ExpectOne(Faults(PaintSphere(shifted)), "off-centre",
            {"3.6% of its diameter", "pixels to the left and 10 pixels down"});
  shifted.x = 0.485, shifted.y = 0.5;
  ExpectOne(Faults(PaintSphere(shifted)), "off-centre", {"1.5% of its diameter", "pixels to the right"});
  shifted.x = 0.506;
  EXPECT_EQ(Codes(Faults(PaintSphere(shifted))), "") << "half a percent is nothing";
  PaintedSphere covered = Clean(1.1);
  covered.x = 0.52;
  EXPECT_EQ(Codes(Faults(PaintSphere(covered))), "") << "paint covers the whole sphere all the same";
}

// Paint that runs over the rim hides where the sphere lies; the template's marks show it.
TEST(PaintFaults, ATemplateByItsMarks) {
  const Picture picture = PaintSphere({});
  PaintFaultContext context;
  const auto faults = [&](const MarkedSphere& marked) {
    context.marked = marked;
    return Faults(picture, context);
  };
  EXPECT_EQ(Codes(faults({258, 254, 254, 0.9})), "") << "within the limits";
  ExpectOne(faults({286, 236, 256, 0}), "off-centre",
            {"7.0% of its diameter", "30 pixels to the left and 20 pixels down"});
  ExpectOne(faults({256, 256, 230.4, 0}), "small-sphere", {"90.0%", "111.1%"});
  ExpectOne(faults({256, 256, 256, -3}), "turned", {"by 3.0°", "back clockwise"});
}

TEST(PaintFaults, SmallSphere) {
  PaintedSphere small = Clean();
  small.radius = 0.45;
  ExpectOne(Faults(PaintSphere(small)), "small-sphere", {"90.", "111."});
  small.radius = 0.497;
  EXPECT_EQ(Codes(Faults(PaintSphere(small))), "");
}

TEST(PaintFaults, Holes) {
  Picture picture = PaintSphere({});
  ForDisc(picture, 300, 200, 20, [&](int x, int y) { picture.At(x, y)[3] = 0; });
  const PaintFault hole = ExpectOne(Faults(picture), "holes",
                                    {"0.6% of the sphere is transparent", "1 hole", "around x=", "fill the holes"});
  EXPECT_NEAR(hole.place->first, 300, 1);
  EXPECT_NEAR(hole.place->second, 200, 1);
  // Places are those of the file.
  PaintFaultContext cut;
  cut.origin = {64, 64};
  EXPECT_NEAR(ExpectOne(Faults(picture, cut), "holes", {}).place->first, 364, 1);
  // A soft edge belongs to the hole.
  ForDisc(picture, 300, 200, 21, [&](int x, int y) {
    if (picture.At(x, y)[3]) picture.At(x, y)[3] = 30000;
  });
  EXPECT_EQ(Codes(Faults(picture)), "holes");
  // Outside the sphere transparency is nothing.
  Picture outside = PaintSphere({});
  outside.At(3, 3)[3] = 0;
  EXPECT_EQ(Codes(Faults(outside)), "");
}

TEST(PaintFaults, SeeThroughPaint) {
  Picture picture = PaintSphere({});
  ForDisc(picture, 300, 200, 30, [&](int x, int y) { picture.At(x, y)[3] = 45000; });
  ExpectOne(Faults(picture), "see-through", {"half see-through", "around x=", "flatten"});
  // All of it: reported once, and the tone is that over white paper.
  Picture all = PaintSphere({});
  for (int i = 0; i < 512 * 512; ++i) all.At(i % 512, i / 512)[3] = 180 * 257;
  ExpectOne(Faults(all), "see-through", {"100% of the sphere is half see-through"});
  const PaintTraits traits = MeasurePaint(ExemplarOf(all), 2.0, nullptr),
                    opaque = MeasurePaint(ExemplarOf(PaintSphere({})), 2.0, nullptr);
  EXPECT_GT(traits.covered_percent, 99.0);
  EXPECT_GT(traits.tone.darkest, opaque.tone.darkest + 10.0);
  EXPECT_GT(traits.tone.range(), 25.0);
  Picture speck = PaintSphere({});
  for (int x = 200; x < 210; ++x) speck.At(x, 200)[3] = 45000;
  EXPECT_EQ(Codes(Faults(speck)), "") << "ten pixels are nothing";
}

TEST(PaintFaults, PremultipliedColours) {
  PaintedSphere light;
  light.dark = 0.5, light.light = 0.95;
  Picture picture = PaintSphere(light);
  ForDisc(picture, 300, 200, 30, [&](int x, int y) {
    const double alpha = std::min(1.0, std::hypot(x - 299.5, y - 199.5) / 30.0);
    for (int c = 0; c < 3; ++c)
      picture.At(x, y)[c] = static_cast<std::uint16_t>(picture.At(x, y)[c] * (0.3 + 0.7 * alpha));
    picture.At(x, y)[3] = static_cast<std::uint16_t>(65535 * (0.3 + 0.7 * alpha));
  });
  ExpectOne(Faults(picture), "premultiplied", {"straight"});
  PaintFaultContext paper;
  paper.has_paper = true;
  Picture clear = PaintSphere(Clean());
  for (int i = 0; i < 512 * 512; ++i) {
    if (std::hypot(i % 512 - 255.5, i / 512 - 255.5) >= 256) clear.At(i % 512, i / 512)[3] = 0;
  }
  EXPECT_EQ(Codes(Faults(clear)), "") << "a style without paper may stand on nothing";
  EXPECT_EQ(ExpectOne(Faults(clear, paper), "clear-corners", {"flatten"}).weight, PaintFault::Weight::kRemark);
}

TEST(PaintFaults, PercentagesAreNumbers) {
  for (const auto& [radius, words] :
       {std::pair{600.0, "100% of the sphere"}, {40.0, "2.5% of the sphere"}, {4.0, "less than 0.1% of the sphere"}}) {
    Picture picture = PaintSphere({});
    ForDisc(picture, 256, 256, radius, [&](int x, int y) { picture.At(x, y)[3] = 0; });
    EXPECT_NE(Said(Faults(picture)).find(words), std::string::npos) << Said(Faults(picture));
  }
}

// The page's sphere, scanned with some noise: whole, and between paint; its lights are paper and look like it.
TEST(PaintFaults, BarePrintedTemplate) {
  PaintedSphere pale = Clean();
  pale.dark = 0.85, pale.light = 1.0, pale.paper = 1.0, pale.grain = 0.0;
  Picture printed = PaintSphere(pale);
  for (int i = 0; i < 512 * 512; ++i) SetGrey(printed, i % 512, i / 512, printed.At(i % 512, i / 512)[0] / 65535.0);
  Picture scan = printed;
  for (int i = 0; i < 512 * 512; ++i) {
    SetGrey(scan, i % 512, i / 512, (printed.At(i % 512, i / 512)[0] / 257 + double(Hash(i) % 7) - 3.0) / 255.0);
  }
  PaintedSphere smooth = Clean();
  smooth.grain = 0.0;
  const Picture drawn = PaintSphere(smooth);
  const auto percent = [&](const Picture& picture) {
    return MeasurePaint(ExemplarOf(picture), 2.0, &drawn, &printed).template_percent;
  };
  EXPECT_GT(percent(scan), 50.0);
  Picture partly = PaintSphere({});
  EXPECT_EQ(percent(partly), 0.0);
  ForDisc(partly, 330, 330, 40, [&](int x, int y) { std::copy_n(scan.At(x, y), 4, partly.At(x, y)); });
  EXPECT_EQ(percent(partly), 0.0) << "on grey paper";
  PaintedSphere white;
  white.paper = 1.0;
  partly = PaintSphere(white);
  EXPECT_EQ(percent(partly), 0.0);
  ForDisc(partly, 330, 330, 40, [&](int x, int y) { std::copy_n(scan.At(x, y), 4, partly.At(x, y)); });
  EXPECT_NEAR(percent(partly), 100.0 * 40 * 40 / 254 / 254, 0.8);
}

TEST(PaintFaults, BareTemplate) {
  PaintedSphere drawn = Clean();
  drawn.grain = 0.0, drawn.paper = 1.0;
  const Picture bare = PaintSphere(drawn);
  EXPECT_EQ(Codes(Faults(PaintSphere({}), {}, &bare)), "");
  Picture holed = PaintSphere({});
  ForDisc(holed, 180, 300, 25, [&](int x, int y) { std::copy_n(bare.At(x, y), 4, holed.At(x, y)); });
  const PaintFault patch = ExpectOne(Faults(holed, {}, &bare), "bare-template",
                                     {"of the sphere is still the template's own grey", "around x=", "paint over it"});
  EXPECT_NEAR(patch.place->first, 180, 2);
  EXPECT_NEAR(patch.place->second, 300, 2);
  Picture speck = PaintSphere({});
  ForDisc(speck, 180, 300, 8, [&](int x, int y) { std::copy_n(bare.At(x, y), 4, speck.At(x, y)); });
  EXPECT_EQ(Codes(Faults(speck, {}, &bare)), "") << "0.1% of the sphere";
}

TEST(PaintFaults, BarePaper) {
  PaintedSphere sphere;
  Picture shade = PaintSphere(sphere), light = PaintSphere(sphere);
  const auto leave_out = [&](Picture& picture, double x, double y, double radius) {
    ForDisc(picture, x, y, radius, [&](int i, int j) { SetGrey(picture, i, j, sphere.paper); });
  };
  leave_out(shade, 390, 390, 20);
  const PaintFault patch =
      ExpectOne(Faults(shade), "bare-paper", {"in the shade", "around x=", "leave paper for lights"});
  EXPECT_NEAR(patch.place->first, 390, 8);
  leave_out(light, 180, 170, 20);
  EXPECT_EQ(Codes(Faults(light)), "") << "a highlight";
  Picture gaps = PaintSphere(sphere);
  for (int i = 0; i < 40; ++i) leave_out(gaps, 340 + double(Hash(i, 1) % 80), 340 + double(Hash(i, 2) % 80), 3);
  EXPECT_EQ(Codes(Faults(gaps)), "") << "paper between strokes";
}

TEST(PaintFaults, Fringe) {
  PaintedSphere sphere;
  sphere.dark = 0.1, sphere.light = 0.5, sphere.reach = 0.985, sphere.waver = 0.06;
  ExpectOne(Faults(PaintSphere(sphere)), "fringe", {"of the sphere's rim", "run over the sphere's edge"});
  sphere.reach = 1.05;
  EXPECT_EQ(Codes(Faults(PaintSphere(sphere))), "");
}

TEST(PaintFaults, TooLittleContrast) {
  PaintedSphere pale;
  pale.dark = 0.55, pale.light = 0.7, pale.grain = 0.02;
  ExpectOne(Faults(PaintSphere(pale)), "flat", {"lightness", "lights lighter"});
  // Of several lights only the brightest must have the whole range, and together they may.
  PaintFaultContext one_of_many;
  one_of_many.several = true, one_of_many.brightest = false, one_of_many.tonal_range = 60.0;
  EXPECT_EQ(Codes(Faults(PaintSphere(pale), one_of_many)), "");
  pale.light = 0.58;
  ExpectOne(Faults(PaintSphere(pale), one_of_many), "flat", {"in this light"});
}

TEST(PaintFaults, Light) {
  PaintedSphere drawn = Clean();
  drawn.grain = 0.0;
  const Picture bare = PaintSphere(drawn);
  PaintedSphere mirrored;
  mirrored.azimuth = 40.0;
  PaintFaultContext kit;
  kit.knows_guides = true;
  ExpectOne(Faults(PaintSphere(mirrored), kit, &bare), "other-light", {"azimuth 3", "azimuth -", "mirror"});
  EXPECT_EQ(ExpectOne(Faults(PaintSphere(mirrored), {}, &bare), "other-light", {"nothing if that is wanted"}).weight,
            PaintFault::Weight::kRemark);
  mirrored.azimuth = -10.0;
  EXPECT_EQ(Codes(Faults(PaintSphere(mirrored), kit, &bare)), "") << "painters are no instruments";
  // Light and dark without form.
  Picture patches(512, 512);
  for (int i = 0; i < 512 * 512; ++i)
    SetGrey(patches, i % 512, i / 512, 0.2 + 0.6 * UnitFloat(Hash(i % 512 / 9, i / 512 / 9)));
  ExpectOne(Faults(patches), "no-light", {"do not follow the form"});
}

TEST(PaintFaults, RegularPatterns) {
  constexpr double kTurn = 6.283185307179586;
  const auto with = [](const std::function<double(double, double)>& factor) {
    PaintedSphere sphere;
    sphere.reach = 2.0;
    Picture picture = PaintSphere(sphere);
    Overlay(picture, factor);
    return Faults(picture);
  };
  const auto checker = [](double x, double y) { return (int(x / 12) + int(y / 12)) % 2 ? 1.0 : 0.7; };
  const auto dots = [](double x, double y) {
    return std::hypot(std::fmod(x, 14.0) - 7.0, std::fmod(y, 14.0) - 7.0) < 4.0 ? 0.6 : 1.0;
  };
  const auto hatching = [kTurn](double x, double y) {
    return std::cos(kTurn * (0.8 * x + 0.6 * y) / 9.0) > 0.3 ? 0.6 : 1.0;
  };
  const auto weave = [kTurn](double x, double y) {
    return 1.0 + 0.25 * std::cos(kTurn * x / 8.0) * std::cos(kTurn * y / 8.0);
  };
  for (const auto& grid : {std::function<double(double, double)>(checker), {dots}, {weave}}) {
    ExpectOne(with(grid), "regular-pattern", {"dots, squares or weave", "around x=", "halftone"});
  }
  ExpectOne(with(hatching), "regular-pattern", {"even lines", "every 9.", "by hand"});
  // The same lines, but drawn: uneven distances, and breaks.
  const auto drawn = [](double x, double y) {
    const double across = 0.8 * x + 0.6 * y, along = 0.8 * y - 0.6 * x;
    double tone = 1.0;
    for (int i = int(across / 9) - 2; i <= int(across / 9) + 2; ++i) {
      const double at = 9.0 * (i + 0.9 * (UnitFloat(Hash(i, int(along / 60 + 50 + Hash(i) % 7))) - 0.5));
      tone -= 0.4 * std::exp(-0.5 * (across - at) * (across - at) / 2.0);
    }
    return std::max(0.3, tone);
  };
  EXPECT_EQ(Codes(with(drawn)), "");
  EXPECT_EQ(Codes(with([](double, double) { return 1.0; })), "");
}

}  // namespace
}  // namespace scumble
