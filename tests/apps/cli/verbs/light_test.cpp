// Styles for several lights, from the template to the check: an artist's steps on the command line.
#include <string>
#include <vector>

#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

class CliStyleLight : public CliTest {
 protected:
  // A painting in one grey, 0 … 255, with a few strokes.
  void WriteGrey(const std::string& name, int size, int grey) {
    std::filesystem::create_directories(At(name).parent_path());
    Picture picture(size, size);
    for (int i = 0; i < size * size; ++i) {
      std::uint16_t* pixel = picture.At(i % size, i / size);
      for (int c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint16_t>((grey + i % 5) * 257);
      pixel[3] = 65535;
    }
    ASSERT_TRUE(WritePicture(At(name), picture));
  }
  // Two exemplars, light and dark, with these luminances.
  void WriteTwo(const std::string& light, const std::string& dark) {
    WriteGrey("style/light.png", 32, 220);
    WriteGrey("style/dark.png", 32, 40);
    const auto entry = [](const std::string& image, const std::string& luminance) {
      return "[[exemplar]]\nimage = \"" + image + "\"\n" + (luminance.empty() ? "" : "luminance = " + luminance + "\n");
    };
    WriteText("style/style.toml",
              "[transfer]\nreference_height = 0\n" + entry("light.png", light) + entry("dark.png", dark));
  }
};

TEST_F(CliStyleLight, LuminancesAreShownWithWhereTheyComeFrom) {
  WriteTwo("0.75", "");
  for (const char* verb : {"check", "info"}) {
    const Arguments arguments =
        verb == std::string("info") ? Arguments{"info", "style"} : Arguments{"styles", "check", "style"};
    const std::string out = RunOk(arguments).out;
    EXPECT_TRUE(Contains(out, "luminance 0.75, given")) << out;
    // (40 … 44) / 255 in sRGB is 0.0232 in linear light on average.
    EXPECT_TRUE(Contains(out, "luminance 0.023")) << out;
    EXPECT_TRUE(Contains(out, "measured from its paint")) << out;
  }
  EXPECT_EQ(RunOk({"styles", "check", "style", "--json"}).Json()["exemplars"].size(), 2u);
  RunOk({"sphere", "--size", "32", "-o", "kit", "--light", "0,0", "--light", "60,10", "-q"});
  WriteGrey("kit/lit.png", 32, 200);
  WriteGrey("kit/lit-2.png", 32, 100);
  const std::string out = RunOk({"info", "kit"}).out;
  EXPECT_TRUE(Contains(out, "measured from its guides")) << out;
}

TEST_F(CliStyleLight, LightsThatAreTheWrongWayRoundOrEqual) {
  WriteTwo("0.8", "0.1");
  EXPECT_FALSE(Contains(RunOk({"styles", "check", "style"}).err, "luminance")) << "all is well";
  EXPECT_FALSE(Contains(RunOk({"styles", "check", "style"}).err, "more light"));
  WriteTwo("0.1", "0.8");
  const std::string opposite = RunOk({"styles", "check", "style"}).err;
  EXPECT_TRUE(Contains(
      opposite, "style/dark.png: it is for more light than style/light.png (0.8 and 0.1), and its paint is darker"))
      << opposite;
  WriteTwo("0.4", "0.4");
  const std::string equal = RunOk({"styles", "check", "style"}).err;
  EXPECT_TRUE(Contains(
      equal, "style/dark.png: it has the luminance 0.4 as style/light.png has, which stands first and is taken"))
      << equal;
  // And so it is: nothing of the second is in the picture.
  RunOk({"stylize", Scene("suzanne.glb"), "--size", "48x27", "--style", "style", "-o", "p.png", "-q"});
  const Expected<Picture> picture = ReadPicture(At("p.png"));
  ASSERT_TRUE(picture);
  for (std::size_t i = 0; i < picture->rgba.size(); i += 4) {
    if (picture->rgba[i + 3] < 65535) continue;
    ASSERT_GE(picture->rgba[i], 219 * 257) << i / 4;
  }
}

TEST_F(CliStyleLight, LuminanceByOption) {
  WriteTwo("0.8", "0.1");
  const Arguments stylize = {"stylize", Scene("suzanne.glb"), "--size", "48x27",  "--style",
                             "style",   "--exposure",         "0",      "--json", "-o",
                             "p.png"};
  const auto luminances = [&](const Arguments& sets) {
    return RunOk(With(stylize, sets)).Json()["styles"][0]["luminances"].dump();
  };
  EXPECT_EQ(luminances({"--set", "exemplar.1.luminance=0.5"}), "[0.5,0.10000000149011612]");
  EXPECT_EQ(luminances({"--set", "exemplar.1.luminance=2", "--set", "exemplar.2.luminance=0.25"}), "[2.0,0.25]");
  const auto refused = [&](const std::string& set, const std::vector<std::string>& words) {
    ExpectError(With(stylize, {"--set", set}), 2, words);
  };
  refused("exemplar.luminance=3", {"--set exemplar.luminance", "exemplar.1.luminance to exemplar.2.luminance"});
  refused("exemplar.3.luminance=3", {"exemplars 1 to 2"});
  refused("exemplar.0.luminance=3", {"exemplars 1 to 2"});
  refused("exemplar.x.luminance=3", {"exemplars 1 to 2"});
  refused("exemplar.1.image=a.png", {"image and guides are set in style.toml"});
  refused("exemplar.1.luminance=-1", {"a number, 0 or more"});
  refused("exemplar.1.luminance=lots", {"a number, 0 or more"});
  EXPECT_TRUE(Contains(RunOk({"styles", "--keys"}).out, "--set exemplar.1.luminance=0.8"));
}

// docs/style.md's five steps.
TEST_F(CliStyleLight, FromTheTemplateToTwoLights) {
  const Arguments sphere = {"sphere", "--size", "64", "-o", "mine", "-q"};
  RunOk(sphere);
  WriteGrey("mine/lit.png", 80, 200);
  const std::string first = Bytes("mine/style.toml"), painted = Bytes("mine/lit.png"),
                    guides = Bytes("mine/guides.exr");
  const CommandResult second = RunOk(With(sphere, {"--light", "120,-10", "--name", "shade"}));
  for (const char* file : {"mine/shade-template.png", "mine/shade-guides.exr", "mine/style.toml"}) {
    EXPECT_TRUE(Contains(second.out, file)) << second.out;
  }
  EXPECT_EQ(Bytes("mine/style.toml").rfind(first, 0), 0u) << "what the artist wrote stays as it is";
  ExpectError({"styles", "check", "mine"}, 3,
              {"shade.png is not there yet", "mine/shade-template.png", "[[exemplar]]"});
  WriteGrey("mine/shade.png", 80, 60);
  const std::string shade = Bytes("mine/shade.png");
  const CommandResult check = RunOk({"styles", "check", "mine"});
  EXPECT_TRUE(Contains(check.out, "mine/shade.png: luminance")) << check.out;
  EXPECT_FALSE(Contains(check.err, "luminance")) << check.err;
  const nlohmann::json json =
      RunOk({"stylize", Scene("suzanne.glb"), "--size", "48x27", "--style", "mine", "-o", "p.png", "--json", "-q"})
          .Json();
  EXPECT_EQ(json["styles"][0]["exemplars"], 2);
  // Once more changes nothing; another size or light is refused before anything is written.
  EXPECT_FALSE(Contains(RunOk(With(sphere, {"--light", "120,-10", "--name", "shade"})).out, "style.toml"));
  ExpectError(With(sphere, {"--light", "10,10"}), 4, {"mine/template.png", "--name"});
  for (const char* drawn : {"mine/template.png", "mine/template.ora"}) std::filesystem::remove(At(drawn));
  ExpectError({"sphere", "--size", "32", "-o", "mine"}, 4, {"mine/guides.exr is of 64²", "mine/lit.png", "--size 64"});
  EXPECT_EQ(Bytes("mine/guides.exr"), guides);
  EXPECT_EQ(Bytes("mine/lit.png"), painted);
  EXPECT_EQ(Bytes("mine/shade.png"), shade);
  // A painting over the template itself is safe too.
  WriteGrey("mine/shade-template.png", 80, 10);
  ExpectError(With(sphere, {"--light", "120,-10", "--name", "shade"}), 4, {"mine/shade-template.png", "painting"});
}

TEST_F(CliStyleLight, NamesOfLights) {
  const Arguments sphere = {"sphere", "--size", "16", "-o", "kit", "-q"};
  RunOk(With(sphere, {"--light", "0,0", "--name", "day", "--light", "0,60", "--name", "night"}));
  for (const char* file : {"kit/day-template.png", "kit/night-guides.exr", "kit/HOWTO.txt"})
    EXPECT_TRUE(Exists(file)) << file;
  EXPECT_TRUE(Contains(Bytes("kit/style.toml"), "image = \"night.png\""));
  for (const char* name : {"", "a/b", "template", "x-template", "-x", "a.b"}) {
    const std::string option = "--name=" + std::string(name);
    EXPECT_EQ(Run(With(sphere, {option})).code, 2) << name;
  }
  ExpectError(With(sphere, {"--name", "a", "--name", "b"}), 2, {"2 --name for 1 --light"});
  ExpectError(With(sphere, {"--light", "0,0", "--light", "1,1", "--name", "a", "--name", "a"}), 2, {"twice"});
  // A style has four lights at most.
  RunOk(With(sphere, {"--light", "0,10", "--name", "three"}));
  RunOk(With(sphere, {"--light", "0,20", "--name", "four"}));
  ExpectError(With(sphere, {"--light", "0,30", "--name", "five"}), 4,
              {"kit/style.toml would list 5 lights", "up to 4"});
  EXPECT_FALSE(Exists("kit/five-template.png"));
}

}  // namespace
}  // namespace scumble
