// scumble sphere: sizes on paper, the template's files, and refusals.
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

class CliSphere : public CliTest {
 protected:
  // The pixels across of a kit that was just written, by its guides' size.
  int SizeOf(const Arguments& more) {
    const Arguments sphere = {"sphere", "-o", "kit", "--json", "-q"};
    std::filesystem::remove_all(At("kit"));
    return RunOk(With(sphere, more)).Json().value("size", 0);
  }
};

TEST_F(CliSphere, SaysWhatEachFileIsFor) {
  const CommandResult kit = RunOk({"sphere", "--size", "128", "-o", "kit"});
  EXPECT_EQ(kit.out,
            "kit/template.png\nkit/template.ora\nkit/template.pdf\nkit/guides.exr\nkit/style.toml\nkit/HOWTO.txt\n");
  for (const char* part :
       {"template.ora (layers: Krita, GIMP, MyPaint) or template.png", "save it as lit.png", "template.pdf at 100%",
        "a sphere of 10.8 mm on A4", "10.8 mm across, small for a brush", "at 600 dpi or more"}) {
    EXPECT_NE(kit.err.find(part), std::string::npos) << part << "\n" << kit.err;
  }
  const std::string howto = Bytes("kit/HOWTO.txt");
  for (const char* part : {"any painting program", "Krita, GIMP and MyPaint", "600 dpi or more", "--rectify",
                           "the upper left", "--size 128"}) {
    EXPECT_NE(howto.find(part), std::string::npos) << part << "\n" << howto;
  }
}

TEST_F(CliSphere, APageWithoutMarksIsForLookingAt) {
  const CommandResult kit = RunOk({"sphere", "--size", "64", "-o", "kit"});
  EXPECT_TRUE(Contains(kit.err, "template.pdf is for looking at: only spheres of 128 pixels or more")) << kit.err;
  EXPECT_FALSE(Contains(kit.err, "at 100%")) << kit.err;
}

TEST_F(CliSphere, SizeOnPaper) {
  EXPECT_EQ(SizeOf({"--print-size", "10mm", "--dpi", "254"}), 100);
  EXPECT_EQ(SizeOf({"--print-size", "1cm", "--dpi", "254"}), 100);
  EXPECT_EQ(SizeOf({"--print-size", "0.5in", "--dpi", "100"}), 50);
  EXPECT_EQ(SizeOf({"--print-size", "1in"}), 300);
  EXPECT_EQ(SizeOf({"--size", "64"}), 64);
  const auto refused = [&](const Arguments& more, const std::vector<std::string>& words) {
    std::filesystem::remove_all(At("kit"));
    ExpectError(With({"sphere", "-o", "kit"}, more), 2, words);
    EXPECT_FALSE(Exists("kit")) << "nothing is begun";
  };
  refused({"--print-size", "10mm", "--size", "100"}, {"--print-size", "--size"});
  refused({"--print-size", "10"}, {"--print-size '10'", "150mm, 15cm or 6in"});
  refused({"--print-size", "1mm"}, {"--print-size 1mm at 300 dpi is 12 pixels", "16 to 8192", "--dpi"});
  refused({"--print-size", "2000mm"}, {"23622 pixels"});
  refused({"--dpi", "10"}, {"--dpi", "72", "2400"});
  refused({"--page", "a5"}, {"--page a5", "a4, letter, a3 or fit"});
  refused({"--only", "jpg"}, {"--only jpg", "png, ora or pdf"});
  refused({"--print-size", "200mm", "--page", "a4"},
          {"a sphere of 200 mm with its margin is 250", "A4 paper (210 × 297 mm)", "the largest sphere on it is 155.",
           "--page fit"});
}

TEST_F(CliSphere, PagesByName) {
  const auto page = [&](const Arguments& more) {
    std::filesystem::remove_all(At("kit"));
    return RunOk(With({"sphere", "--size", "64", "-o", "kit", "--json", "-q"}, more)).Json()["page"];
  };
  EXPECT_EQ(page({})["name"], "A4");
  EXPECT_EQ(page({"--page", "letter"})["height_mm"], 279.4);
  EXPECT_EQ(page({"--page", "a3"})["width_mm"], 297.0);
  EXPECT_EQ(page({"--page", "fit"})["name"], "fit");
  EXPECT_TRUE(page({"--only", "png"}).is_null()) << "no page without a PDF";
}

TEST_F(CliSphere, OnlySomeFiles) {
  RunOk({"sphere", "--size", "32", "-o", "kit", "--only", "png,pdf", "-q"});
  EXPECT_TRUE(Exists("kit/template.png") && Exists("kit/template.pdf") && Exists("kit/guides.exr"));
  EXPECT_FALSE(Exists("kit/template.ora"));
  const CommandResult layers = RunOk({"sphere", "--size", "32", "-o", "kit", "--only", "ora", "--name", "shade"});
  EXPECT_TRUE(Exists("kit/shade-template.ora"));
  EXPECT_FALSE(Exists("kit/shade-template.png"));
  EXPECT_EQ(layers.err.find("print"), std::string::npos) << layers.err;
  // What does not fit the paper is no obstacle where there is no paper.
  RunOk({"sphere", "--size", "32", "-o", "other", "--only", "png", "--page", "a4", "--dpi", "72", "-q"});
}

TEST_F(CliSphere, NamesMayHoldSpaces) {
  RunOk({"sphere", "--size", "128", "-o", "kit", "--name", "back light", "-q"});
  EXPECT_TRUE(Exists("kit/back light-template.png"));
  EXPECT_NE(Bytes("kit/style.toml").find("image = \"back light.png\""), std::string::npos);
  EXPECT_NE(Bytes("kit/HOWTO.txt").find("-o 'back light.png'"), std::string::npos);
  WritePainted("kit/back light.png", 128, 128);
  RunOk({"styles", "check", "kit", "-q"});
  for (const char* bad : {" light", "light ", "back/light", "back'light", "a template"}) {
    ExpectError({"sphere", "--size", "32", "-o", "other", "--name", bad}, 2, {bad, "spaces between them"});
  }
}

// Without a template in pixels only the guides record the light of an exemplar.
TEST_F(CliSphere, GuidesOfAnotherLightDoNotReplaceThoseOfAPainting) {
  const Arguments sphere = {"sphere", "--size", "128", "--only", "pdf", "-q", "-o", "kit"};
  RunOk(With(sphere, {"--light", "10,20"}));
  RunOk(sphere);
  const std::string guides = Bytes("kit/guides.exr");
  WritePainted("kit/lit.png", 128, 128);
  for (const char* light : {"90,0", "-39.8,40", "180,0"}) {
    ExpectError(With(sphere, {std::string("--light=") + light}), 4,
                {"kit/guides.exr has another light", "belongs to kit/lit.png", "--light", "--name"});
  }
  EXPECT_EQ(Bytes("kit/guides.exr"), guides);
  RunOk(With(sphere, {"--light", "90,0", "--name", "shade"}));
  RunOk(With(sphere, {"--aa", "4"}));
  RunOk(With(sphere, {"--light=-40,40"}));
  EXPECT_EQ(Bytes("kit/guides.exr"), guides) << "the same again";
}

TEST_F(CliSphere, PaperThatIsOfLittleUse) {
  ExpectError({"sphere", "--size", "127", "--only", "pdf", "-o", "kit"}, 2, {"127 pixels", "--rectify", "--size 128"});
  EXPECT_FALSE(Exists("kit"));
  EXPECT_NE(RunOk({"sphere", "--size", "128", "--only", "pdf", "-o", "kit"}).Warning().find("10.8 mm"),
            std::string::npos);
  EXPECT_EQ(RunOk({"sphere", "--size", "237", "--only", "pdf", "-o", "large"}).Warning(), "") << "20.07 mm";
  EXPECT_NE(RunOk({"sphere", "--size", "32", "--only", "png", "--page", "a3", "-o", "png"}).Warning().find("--page is"),
            std::string::npos);
  EXPECT_EQ(RunOk({"sphere", "--size", "32", "--only", "png", "-o", "png"}).Warning(), "");
  RunOk({"sphere", "--size", "64", "-o", "small", "-q"});
  EXPECT_EQ(Bytes("small/HOWTO.txt").find("scumble sphere --rectify"), std::string::npos);
}

TEST_F(CliSphere, ThePaintingMayStayInItsLayers) {
  RunOk({"sphere", "--size", "64", "-o", "kit", "--only", "ora", "-q"});
  ExpectError({"styles", "check", "kit"}, 3, {"kit/lit.png is not there yet", "kit/template.ora"});
  std::filesystem::copy_file(At("kit/template.ora"), At("kit/lit.ora"));
  ExpectError({"styles", "check", "kit"}, 3, {"kit/lit.png is not there, and kit/lit.ora is", "image = \"lit.ora\""});
  WriteText("kit/style.toml", "[[exemplar]]\nimage = \"lit.ora\"\nguides = \"guides.exr\"\n");
  RunOk({"styles", "check", "kit"});
  RunOk({"stylize", Scene("suzanne.glb"), "--size", "48x27", "--style", "kit", "-o", "layers.png", "-q"});
  RunOk({"sphere", "--size", "64", "-o", "flat", "-q"});
  std::filesystem::copy_file(At("flat/template.png"), At("flat/lit.png"));
  RunOk({"stylize", Scene("suzanne.glb"), "--size", "48x27", "--style", "flat", "-o", "flat.png", "-q"});
  EXPECT_TRUE(Pixels("layers.png") == Pixels("flat.png"));
}

}  // namespace
}  // namespace scumble
