// `scumble sphere --rectify`: from a photograph in the kit's folder to a style.
#include "core/io/atomic_file.h"
#include "core/io/open_raster.h"
#include "tests/support/cli_harness.h"
#include "tests/support/scan_fixtures.h"

namespace scumble {
namespace {

class RectifyCliTest : public CliTest {
 protected:
  void WriteScan(const std::string& name, const Scan& scan = {}, int bits = 8) {
    PictureWriteOptions options;
    options.bits = bits;
    const Status written = WritePicture(At(name), TakeScan(CharcoalSheet(), scan), options);
    ASSERT_TRUE(written) << written.error().message;
  }
};

TEST_F(RectifyCliTest, FromAPhotographToAStyle) {
  Scan scan;
  scan.rotation = 90, scan.tilt = 12, scan.fill = 0.7, scan.noise = 2, scan.gradient = 0.3, scan.cast = {1.0, 0.9, 0.7},
  scan.covered = {5};
  WriteScan("photo.jpg", scan);
  RunOk({"sphere", "--size", "256", "-q", "-o", "kit"});
  const CommandResult result = RunOk({"sphere", "--rectify", "photo.jpg", "-o", "kit/lit.png"});
  for (const char* part : {"kit/lit.png\n", "11 of 12; not seen: right side, lower", "error 0.0", "of its 256 pixels",
                           "° clockwise, tilted about 1", "warm, the paper is 1.00 : 0.89 : 0.70", "falls off by ",
                           "covers 100% of the sphere"}) {
    EXPECT_TRUE(Contains(result.out, part)) << "lacks '" << part << "'\n" << result.out;
  }
  EXPECT_EQ(result.Warning(), "");
  const auto lit = ReadPicture(At("kit/lit.png"));
  ASSERT_TRUE(lit);
  EXPECT_EQ(lit->width, 256 + 64) << "the size of the kit's sphere, with its margin";
  WriteGuideFile("scene.exr", Ball(80));
  RunOk({"transfer", "scene.exr", "--style", "kit", "-q", "-o", "picture.png"});

  RunOk({"sphere", "--rectify", "photo.jpg", "--square", "--size", "200", "-q", "-o", "alone.png"});
  EXPECT_EQ(ReadPicture(At("alone.png"))->width, 200);
  RunOk({"transfer", "scene.exr", "--style", "alone.png", "-q", "-o", "other.png"});

  const CommandResult wrong = RunOk({"sphere", "--rectify", "photo.jpg", "--size", "200", "-q", "-o", "kit/lit.png"});
  EXPECT_TRUE(Contains(wrong.Warning(), "take --size 256")) << wrong.err;
}

TEST_F(RectifyCliTest, TheReportAsJson) {
  Scan scan;
  scan.gradient = 0.2, scan.barrel = 0.03;
  WriteScan("scan.png", scan);
  const auto json = RunOk({"sphere", "--rectify", "scan.png", "--size", "128", "-o", "lit.png", "--json"}).Json();
  ASSERT_TRUE(json.is_object());
  EXPECT_EQ(json["file"], "lit.png");
  EXPECT_EQ(json["size"], 128);
  EXPECT_EQ(json["marks"]["found"].size(), 12u);
  EXPECT_EQ(json["marks"]["missing"].size(), 0u);
  EXPECT_LT(json["registration_error_percent"].get<double>(), 0.3);
  EXPECT_NEAR(json["registration_error_pixels"].get<double>(), 1.28 * json["registration_error_percent"].get<double>(),
              1e-9);
  EXPECT_LT(json["lens_percent"].get<double>(), -2);
  EXPECT_GT(json["uneven_percent"].get<double>(), 10);
  EXPECT_EQ(json["white_balance"], true);
  EXPECT_EQ(json["paper"].size(), 3u);
  const std::string balanced = Pixels("lit.png");
  const auto raw =
      RunOk({"sphere", "--rectify", "scan.png", "--size", "128", "--no-white-balance", "-o", "lit.png", "--json"})
          .Json();
  EXPECT_EQ(raw["white_balance"], false);
  EXPECT_NE(Pixels("lit.png"), balanced);
}

TEST_F(RectifyCliTest, ScansOfAnyKind) {
  WriteScan("scan.tif", {}, 16);
  RunOk({"sphere", "--rectify", "scan.tif", "--size", "64", "-q", "-o", "deep.png"});
  EXPECT_EQ(InspectPicture(At("deep.png"))->bits, 16) << "as the scan";
  WriteScan("scan.png");
  RunOk({"sphere", "--rectify", "scan.png", "--size", "64", "-q", "-o", "shallow.png"});
  EXPECT_EQ(InspectPicture(At("shallow.png"))->bits, 8);
  // A sheet cut out of its surroundings: transparent pixels count as white.
  Picture cut = CharcoalSheet();
  for (std::size_t i = 0; i < cut.rgba.size(); i += 4) {
    if (cut.rgba[i] == 65535) cut.rgba[i] = cut.rgba[i + 1] = cut.rgba[i + 2] = cut.rgba[i + 3] = 0;
  }
  ASSERT_TRUE(WritePicture(At("cut.png"), cut));
  const auto json = RunOk({"sphere", "--rectify", "cut.png", "--size", "64", "-o", "lit.png", "--json"}).Json();
  EXPECT_EQ(json["marks"]["found"].size(), 12u);
}

TEST_F(RectifyCliTest, TheSizeIsThatOfTheLightsOwnGuides) {
  WriteScan("scan.png");
  RunOk({"sphere", "--size", "128", "--only", "png", "-q", "-o", "kit"});
  for (const auto& [name, size] : {std::pair{"shade", 160}, {"lit-evening", 192}}) {
    const std::string picture = std::string("kit/") + name + ".png";
    EXPECT_EQ(RunOk({"sphere", "--rectify", "scan.png", "-o", picture, "--json"}).Json()["size"], 128);
    std::filesystem::remove(At(picture));
    RunOk({"sphere", "--size", std::to_string(size), "--only", "png", "--name", name, "-q", "-o", "kit"});
    EXPECT_EQ(RunOk({"sphere", "--rectify", "scan.png", "-o", picture, "--json"}).Json()["size"], size);
    std::filesystem::remove(At(picture));
  }
}

TEST_F(RectifyCliTest, ScansInAFileOfLayers) {
  const Picture scan = TakeScan(CharcoalSheet(), {});
  const auto layers = EncodeOpenRaster({}, scan, 0, "scan.ora");
  ASSERT_TRUE(layers && WriteFileAtomically(At("scan.ora"), *layers));
  WriteScan("scan.png");
  RunOk({"sphere", "--rectify", "scan.ora", "--size", "64", "-q", "-o", "layers.png"});
  RunOk({"sphere", "--rectify", "scan.png", "--size", "64", "-q", "-o", "flat.png"});
  EXPECT_TRUE(Pixels("layers.png") == Pixels("flat.png"));
}

TEST_F(RectifyCliTest, WarnsOfPaperThatIsNotFlat) {
  Scan scan;
  scan.curl = 0.03;
  WriteScan("curled.png", scan);
  const CommandResult result = RunOk({"sphere", "--rectify", "curled.png", "--size", "64", "-o", "lit.png"});
  EXPECT_TRUE(Contains(result.Warning(), "flatter")) << result.out << result.err;
  EXPECT_TRUE(Contains(result.Warning(), "from its place is at the ")) << result.err;
  WriteScan("flat.png");
  EXPECT_EQ(RunOk({"sphere", "--rectify", "flat.png", "--size", "64", "-o", "lit.png"}).Warning(), "");
}

TEST_F(RectifyCliTest, MistakesAreNamedAndNothingIsWritten) {
  WriteScan("scan.jpg");
  WritePainted("blank.png", 300, 300);
  WriteText("lit.png", "an older painting");
  ExpectError({"sphere", "--rectify", "blank.png", "-o", "lit.png"}, 3,
              {"blank.png (300×300 pixels)", "none of the template's 12"});
  const std::string whole = Bytes("scan.jpg");
  WriteText("half.jpg", whole.substr(0, whole.size() / 2));
  ExpectError({"sphere", "--rectify", "half.jpg", "-o", "lit.png"}, 3, {"half.jpg", "ends before its picture does"});
  WriteText("words.jpg", "no picture at all");
  ExpectError({"sphere", "--rectify", "words.jpg", "-o", "lit.png"}, 3, {"words.jpg"});
  ExpectError({"sphere", "--rectify", "nowhere.jpg", "-o", "lit.png"}, 3, {"nowhere.jpg"});
  EXPECT_EQ(Bytes("lit.png"), "an older painting");
  ExpectError({"sphere", "--rectify", "scan.jpg", "-o", "scan.jpg"}, 2, {"would overwrite the scan"});
  RunOk({"sphere", "--size", "32", "-q", "-o", "kit"});
  const std::string unpainted = Bytes("kit/template.png");
  ExpectError({"sphere", "--rectify", "scan.jpg", "-o", "kit/template.png"}, 2, {"save it as kit/lit.png"});
  ExpectError({"sphere", "--rectify", "scan.jpg", "-o", "shade-template.png"}, 2, {"save it as shade.png"});
  ExpectError({"sphere", "--rectify", "scan.jpg", "-o", "kit"}, 2, {"-o is the picture: kit/lit.png"});
  EXPECT_EQ(Bytes("kit/template.png"), unpainted);
  ExpectError({"sphere", "--rectify", "scan.jpg", "-o", "lit.gif"}, 2, {"lit.gif", ".png"});
  ExpectError({"sphere", "--rectify", "scan.jpg", "-o", "nowhere/lit.png"}, 4, {"nowhere"});
  ExpectError({"sphere", "--rectify", "scan.jpg"}, 2, {"--output is required"});
  ExpectError({"sphere", "--rectify", "", "-o", "lit.png"}, 2, {"--rectify"});
  ExpectError({"sphere", "--rectify", "scan.jpg", "--light", "0,0", "-o", "lit.png"}, 2, {"leave --light out"});
  ExpectError({"sphere", "--rectify", "scan.jpg", "--aa", "4", "-o", "lit.png"}, 2, {"leave --aa out"});
  ExpectError({"sphere", "--square", "-o", "kit"}, 2, {"--square requires --rectify"});
  ExpectError({"sphere", "--no-white-balance", "-o", "kit"}, 2, {"--no-white-balance requires --rectify"});
  EXPECT_EQ(Bytes("scan.jpg"), whole);
  EXPECT_EQ(Bytes("lit.png"), "an older painting");
}

}  // namespace
}  // namespace scumble
