// Inputs at the limits: the smallest and the largest exemplar, spheres in pictures that are not square, lights in any
// order, names that a scene lacks.
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

class CliInputs : public CliTest {
 protected:
  Picture Read(const std::string& name) const {
    const auto picture = ReadPicture(At(name));
    EXPECT_TRUE(picture) << (picture ? "" : picture.error().message);
    return picture ? *picture : Picture(1, 1);
  }
};

// Every option has something to do in 16 pixels, and nothing bare shows.
TEST_F(CliInputs, TheSmallestExemplar) {
  WritePainted("tiny.png", 16, 16);
  GuideSet guides = Ball(96);
  for (const Layer layer : {Layer::kAlbedo, Layer::kShadow}) guides.Add(layer);
  for (float& value : guides.Plane(Layer::kAlbedo, 1)) value = 0.5f;
  WriteGuideFile("ball.exr", guides);
  for (const Arguments& more :
       {Arguments{}, Arguments{"--set", "transfer.reference_height=0"},
        Arguments{"--set", "transfer.reference_height=0", "--set", "transfer.blend_radius=8", "--set",
                  "transfer.colorize=1", "--set", "transfer.colorize_mode=oklab", "--set", "transfer.variety=20",
                  "--set", "transfer.edge=exemplar", "--set", "transfer.shadow=paint"}}) {
    RunOk(With({"transfer", "ball.exr", "--style", "tiny.png", "-o", "out.png"}, more));
    const Picture picture = Read("out.png");
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      if (!(guides.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
      ASSERT_EQ(picture.rgba[4 * i + 3], 65535) << i % 96 << ", " << i / 96;
    }
  }
  RunOk({"styles", "check", "tiny.png"});
}

// 67 million pixels: red encodes the column and green the row, in 256 steps, so that a sphere shows its own place.
TEST_F(CliInputs, TheLargestExemplar) {
  constexpr int kSide = 8192;
  std::string ppm = "P6\n8192 8192\n255\n";
  ppm.reserve(ppm.size() + 3 * std::size_t(kSide) * kSide);
  for (int y = 0; y < kSide; y += 32) {
    std::string row;
    for (int x = 0; x < kSide; ++x) row += static_cast<char>(x / 32), row += static_cast<char>(y / 32), row += '\x40';
    for (int i = 0; i < 32; ++i) ppm += row;
  }
  WriteText("huge.ppm", ppm);
  WriteGuideFile("ball.exr", Ball(64));
  CommandSettings patient;
  patient.patience_seconds = 300;
  const CommandResult result =
      Run({"transfer", "ball.exr", "--style", "huge.ppm", "--set", "transfer.method=litsphere", "--set",
           "transfer.blend_radius=0", "--set", "transfer.reference_height=0", "-o", "out.png"},
          patient);
  ASSERT_EQ(result.code, 0) << result.err;
  const Picture picture = Read("out.png");
  for (const auto& [x, y] : {std::pair{32, 32}, {10, 30}, {50, 20}, {30, 55}}) {
    EXPECT_NEAR(picture.At(x, y)[0] / 257.0, (x + 0.5) * 4, 4.0) << x << ", " << y;
    EXPECT_NEAR(picture.At(x, y)[1] / 257.0, (y + 0.5) * 4, 4.0) << x << ", " << y;
  }
}

// A sphere off the middle of a wide or tall exemplar, placed by its guides: stylising these guides reproduces the
// exemplar on its usable part.
TEST_F(CliInputs, ASphereInAPictureThatIsNotSquare) {
  for (const auto& [width, height] : {std::pair{150, 90}, {90, 150}}) {
    GuideSet guides(width, height);
    for (const LayerInfo& info : AllLayers()) {
      if (AlwaysWritten().Has(info.layer)) guides.Add(info.layer);
    }
    const int left = 17, top = 5, size = 76;
    const GuideSet ball = Ball(size);
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        for (const LayerInfo& info : AllLayers()) {
          if (!guides.Has(info.layer)) continue;
          for (int c = 0; c < ChannelCount(info.layer); ++c) {
            guides.Plane(info.layer, c)[guides.Index(left + x, top + y)] = ball.Plane(info.layer, c)[ball.Index(x, y)];
          }
        }
      }
    }
    WritePainted("style/wide.png", width, height);
    WriteGuideFile("style/wide.exr", guides);
    WriteText("style/style.toml",
              "[transfer]\nreference_height = 0\nnearest = \"tree\"\n[[exemplar]]\nimage = \"wide.png\"\nguides = "
              "\"wide.exr\"\n");
    WriteGuideFile("target.exr", guides);
    const CommandResult result =
        RunOk({"transfer", "target.exr", "--style", "style", "--bits", "16", "--json", "-o", "out.png"});
    EXPECT_EQ(result.Json()["exemplar_width"], width);
    EXPECT_EQ(result.Json()["exemplar_height"], height);
    EXPECT_EQ(result.Json()["exemplar_size"], 150);
    const Picture picture = Read("out.png"), painted = Read("style/wide.png");
    int same = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const double r = std::hypot(x + 0.5 - left - size / 2.0, y + 0.5 - top - size / 2.0);
        if (r > size / 2.0 - 4.0) continue;
        ASSERT_EQ(picture.At(x, y)[0], painted.At(x, y)[0]) << x << ", " << y;
        ++same;
      }
    }
    EXPECT_GT(same, 3000);
    // Every extension works on it too.
    RunOk({"styles", "check", "style"});
    for (const char* set :
         {"transfer.shadow=paint", "transfer.variety=10", "transfer.scale=0.4", "transfer.blend_radius=8"}) {
      RunOk({"stylize", Scene("suzanne.glb"), "--size", "64x36", "--style", "style", "--set", set, "-o", "more.png"});
    }
    RunOk({"stylize", Scene("suzanne.glb"), "--size", "64x36", "--style", "style", "--set", "transfer.shadow=paint",
           "--assign", "Plinth=catcher", "-o", "more.png"});
    // Only a sphere that fills the picture has a painted edge to go on with.
    ExpectError({"transfer", "target.exr", "--style", "style", "--set", "transfer.edge=exemplar", "-o", "out.png"}, 2,
                {"transfer.edge", "wide.png", "exact"});
    // Without its guides the same picture is refused.
    WritePainted("alone.png", width, height);
    ExpectError({"transfer", "target.exr", "--style", "alone.png", "-o", "out.png"}, 3,
                {"alone.png", "square", "guides"});
  }
}

class CliLights : public CliInputs {
 protected:
  // Three paintings, each in a grey of its own, in the order of `names`; those in `lights` have that luminance.
  void WriteLights(const std::vector<std::pair<std::string, double>>& lights) {
    std::string text = "[transfer]\nreference_height = 0\nlevels = 4\nluminance_weight = 2\n";
    for (const auto& [name, luminance] : lights) {
      Picture picture = Painted(64, 64);
      for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
        for (int c = 0; c < 3; ++c)
          picture.rgba[i + c] = static_cast<std::uint16_t>(picture.rgba[i + c] / (name == "light"  ? 1
                                                                                  : name == "half" ? 2
                                                                                                   : 5));
      }
      std::filesystem::create_directories(At("style"));
      ASSERT_TRUE(WritePicture(At("style/" + name + ".png"), picture));
      text += "[[exemplar]]\nimage = \"" + name + ".png\"\nluminance = " + std::to_string(luminance) + "\n";
    }
    WriteText("style/style.toml", text);
  }
  CommandResult Paint(const std::string& output) {
    return RunOk({"stylize", Scene("suzanne.glb"), "--size", "96x54", "--style", "style", "-o", output});
  }
};

TEST_F(CliLights, InAnyOrder) {
  WriteLights({{"light", 0.83}, {"half", 0.31}, {"dark", 0.07}});
  EXPECT_FALSE(Contains(Paint("down.png").err, "warning"));
  WriteLights({{"half", 0.31}, {"dark", 0.07}, {"light", 0.83}});
  EXPECT_FALSE(Contains(Paint("mixed.png").err, "warning"));
  EXPECT_TRUE(Pixels("down.png") == Pixels("mixed.png"));
}

TEST_F(CliLights, EqualOnesAreSaidAndTheFirstIsUsed) {
  WriteLights({{"light", 0.8}, {"dark", 0.1}});
  const CommandResult two = Paint("two.png");
  EXPECT_FALSE(Contains(two.err, "warning")) << two.err;
  WriteLights({{"light", 0.8}, {"dark", 0.1}, {"half", 0.8}});
  const CommandResult three = Paint("three.png");
  for (const char* words :
       {"style/half.png has the luminance 0.8 as style/light.png has", "give each [[exemplar]] its own"}) {
    EXPECT_TRUE(Contains(three.err, words)) << three.err;
  }
  EXPECT_TRUE(Pixels("two.png") == Pixels("three.png"));
  EXPECT_TRUE(Contains(RunOk({"styles", "check", "style"}).err, "style/half.png: it has the luminance 0.8"));
  // All alike: as if there were no light.
  WriteLights({{"half", 0.4}, {"light", 0.4}});
  Paint("alike.png");
  WriteLights({{"half", 0.4}});
  Paint("alone.png");
  EXPECT_TRUE(Pixels("alike.png") == Pixels("alone.png"));
}

// Scenes change, and one style sheet serves many: names that are missing are reported and do no harm.
TEST_F(CliInputs, NamesThatTheSceneHasNot) {
  WriteStyle("style");
  WritePainted("other.png", 64, 64);
  const Arguments stylize = {"stylize", Scene("suzanne.glb"), "--size", "64x36", "--style", "style"};
  RunOk(With(stylize, {"-o", "plain.png"}));
  const CommandResult result = RunOk(With(stylize, {"--assign", "Balll=other.png", "--assign", "Tree*=rendered",
                                                    "--assign", "Bal*=other.png", "-o", "out.png"}));
  EXPECT_TRUE(Contains(result.err,
                       "warning: --assign Balll=other.png: the scene has no such object or material; its objects are "))
      << result.err;
  EXPECT_TRUE(Contains(result.err, "Plinth")) << result.err;
  EXPECT_TRUE(Contains(result.err, "warning: --assign Tree*=rendered: ")) << result.err;
  EXPECT_FALSE(Contains(result.err, "warning: --assign Bal*")) << result.err;
  EXPECT_FALSE(Pixels("out.png") == Pixels("plain.png"));
  RunOk(With(stylize, {"--assign", "Balll=other.png", "-o", "none.png"}));
  EXPECT_TRUE(Pixels("none.png") == Pixels("plain.png")) << "nothing is assigned, nothing changes";
}

}  // namespace
}  // namespace scumble
