// One pass alone, and files of layers: --show finish:NAME and --layers-out.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "core/io/file/zip_archive.h"
#include "core/io/open_raster.h"
#include "core/io/picture_file.h"
#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

constexpr const char* kToyScene = SCUMBLE_SOURCE_DIR "/scenes/toys.glb";

// A layer of an .ora file.
struct ReadLayer {
  std::string name;
  bool visible = true, atop = false;
  Picture picture;
};

class CliFinishLayers : public CliTest {
 protected:
  // A style of one colour, on paper if it says so.
  void WritePlainStyle(const std::string& folder, const std::string& more = "") {
    std::filesystem::create_directories(At(folder));
    Picture picture(32, 32);
    for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
      picture.rgba[i] = 60000, picture.rgba[i + 1] = 40000, picture.rgba[i + 2] = 20000, picture.rgba[i + 3] = 65535;
    }
    ASSERT_TRUE(WritePicture(At(folder + "/lit.png"), picture));
    WriteText(folder + "/style.toml", more + "[[exemplar]]\nimage = \"lit.png\"\nfills = true\n");
  }

  static Arguments With(Arguments arguments, const Arguments& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  Picture Read(const std::string& name) {
    const Expected<Picture> picture = ReadPicture(At(name));
    EXPECT_TRUE(picture) << name;
    return picture ? *picture : Picture();
  }

  static std::string TextOf(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  // From the lowest. A file that is no OpenRaster is a failure.
  std::vector<ReadLayer> LayersIn(const std::string& name) {
    const std::string whole = Bytes(name);
    // The local header of a zip file's first entry: no packing, no extra field, the name, the content.
    EXPECT_EQ(whole.substr(8, 2), std::string(2, '\0')) << "mimetype is stored";
    EXPECT_EQ(whole.substr(30, 24), "mimetypeimage/openraster");
    const auto zip = ZipReader::Open(At(name));
    EXPECT_TRUE(zip) << name;
    if (!zip) return {};
    EXPECT_TRUE(zip->Has("mergedimage.png") && zip->Has("Thumbnails/thumbnail.png"));
    const std::string stack = TextOf(*zip->Read("stack.xml", 1 << 20));
    const std::regex layer(R"re(<layer name="([^"]*)" src="([^"]*)" x="0" y="0" opacity="1.00" )re"
                           R"re(visibility="(\w*)" composite-op="([^"]*)"/>)re");
    std::vector<ReadLayer> layers;
    for (std::sregex_iterator one(stack.begin(), stack.end(), layer), end; one != end; ++one) {
      const auto png = zip->Read((*one)[2], 1 << 24);
      EXPECT_TRUE(png) << (*one)[2];
      if (!png) continue;
      layers.push_back({(*one)[1], (*one)[3] == "visible", (*one)[4] == "svg:src-atop",
                        *DecodePicture(*png, std::string((*one)[2]))});
    }
    std::reverse(layers.begin(), layers.end());
    return layers;
  }

  static std::vector<std::string> NamesOf(const std::vector<ReadLayer>& layers) {
    std::vector<std::string> names;
    for (const ReadLayer& layer : layers) names.push_back((layer.visible ? "" : "hidden ") + layer.name);
    return names;
  }

  // The visible layers over one another, against the merged picture: the largest difference in steps of 1 / 255.
  double ErrorOf(const std::string& name) {
    const Picture merged = *ReadMergedLayers(At(name));
    std::vector<double> flat(merged.rgba.size(), 0.0);
    for (const ReadLayer& layer : LayersIn(name)) {
      if (!layer.visible) continue;
      EXPECT_EQ(layer.picture.rgba.size(), merged.rgba.size());
      for (std::size_t i = 0; i < flat.size(); i += 4) {
        const double share = layer.picture.rgba[i + 3] / 65535.0,
                     rest = (layer.atop ? 1.0 : flat[i + 3]) * (1.0 - share);
        if (!(share > 0.0) || (layer.atop && !(flat[i + 3] > 0.0))) continue;
        for (std::size_t c = i; c < i + 3; ++c)
          flat[c] = (layer.picture.rgba[c] / 65535.0 * share + flat[c] * rest) / (share + rest);
        if (!layer.atop) flat[i + 3] = share + rest;
      }
    }
    double error = 0.0;
    for (std::size_t i = 0; i < flat.size(); ++i) {
      const double weight = i % 4 == 3 ? 1.0 : merged.rgba[i / 4 * 4 + 3] / 65535.0;
      error = std::max(error, 255.0 * weight * std::abs(flat[i] - merged.rgba[i] / 65535.0));
    }
    return error;
  }
};

TEST_F(CliFinishLayers, MakeThePicture) {
  WritePlainStyle("open");
  WritePlainStyle("paper", "[transfer]\npaper = \"#8090a0\"\n");
  WriteText(
      "look.toml",
      "[[finish]]\neffect = \"tones\"\n[[finish]]\neffect = \"shadows\"\n[[finish]]\neffect = \"hatch\"\n[[finish]]\n"
      "effect = \"edges\"\ncolor = \"paint\"\n[[finish]]\neffect = \"outline\"\nname = \"ink\"\nwobble = 2\n");
  const Arguments look{"--size", "160x120", "--aa", "2", "--finish", "look.toml"};
  for (const std::string style : {"open", "paper"}) {
    const Arguments run = With({"stylize", kToyScene, "--style", style}, look);
    RunOk(With(run, {"-o", "plain.png"}));
    const nlohmann::json json = RunOk(With(run, {"-o", "p.png", "--layers-out", "l.ora", "--json"})).Json();
    EXPECT_EQ(json["layers_output"], "l.ora");
    EXPECT_EQ(Read("p.png").rgba, Read("plain.png").rgba) << "as without layers";
    EXPECT_EQ(ReadMergedLayers(At("l.ora"))->rgba, Read("plain.png").rgba);
    EXPECT_LE(ErrorOf("l.ora"), 1.0);
    std::vector<std::string> names = NamesOf(LayersIn("l.ora"));
    if (style == "paper") {
      EXPECT_EQ(names.front(), "paper");
      names.erase(names.begin());
    }
    EXPECT_EQ(names, (std::vector<std::string>{"hidden paint", "hidden tones", "shadows", "hatch", "edges", "ink"}));
    EXPECT_EQ(json["layers"].size(), style == "paper" ? 7u : 6u);
  }
  // From guides, and after the transfer.
  RunOk({"guidegen", kToyScene, "--size", "160x120", "--aa", "2", "--layers", "luminance,shadow", "-o", "g.exr"});
  RunOk({"transfer", "g.exr", "--style", "open", "--finish", "look.toml", "-o", "t.png", "--layers-out", "t.ora"});
  RunOk({"transfer", "g.exr", "--style", "open", "-o", "bare.png", "--bits", "16"});
  RunOk({"finish", "bare.png", "g.exr", "--finish", "look.toml", "-o", "f.png", "--layers-out", "f.ora"});
  EXPECT_LE(ErrorOf("t.ora"), 1.0);
  EXPECT_LE(ErrorOf("f.ora"), 1.0);
  EXPECT_EQ(NamesOf(LayersIn("f.ora")).front(), "hidden picture");
  EXPECT_EQ(LayersIn("f.ora").back().picture.rgba, LayersIn("t.ora").back().picture.rgba);
}

TEST_F(CliFinishLayers, OnePassIsShownAlone) {
  WritePlainStyle("paper", "[transfer]\npaper = \"#8090a0\"\n");
  const Arguments run{"stylize", kToyScene, "--style", "paper", "--size", "96x64", "--bits", "16"};
  const Arguments look{"--finish", "shadows", "--finish", "outline"};
  RunOk(With(With(run, look), {"-o", "ink.png", "--show", "finish:outline", "--layers-out", "l.ora"}));
  RunOk(With(With(run, look), {"-o", "shade.png", "--show", "finish:shadows"}));
  RunOk(With(run, {"--finish", "shadows", "--set", "transfer.paper=", "-o", "open.png"}));
  EXPECT_EQ(Read("shade.png").rgba, Read("open.png").rgba) << "the picture after it, without paper";
  // Lines alone are those that lie on nothing.
  RunOk({"guidegen", kToyScene, "--size", "96x64", "-o", "g.exr"});
  ASSERT_TRUE(WritePicture(At("nothing.png"), Picture(96, 64)));
  RunOk({"finish", "nothing.png", "g.exr", "--finish", "outline", "--bits", "16", "-o", "lines.png"});
  EXPECT_EQ(Read("ink.png").rgba, Read("lines.png").rgba);
  EXPECT_LE(ErrorOf("l.ora"), 1.0) << "the layers are of the picture, whatever is shown";
  ASSERT_TRUE(WritePicture(At("p.png"), Read("open.png")));
  RunOk({"finish", "p.png", "g.exr", "--finish", "outline", "--bits", "16", "-o", "f.png", "--show", "finish:outline"});
  EXPECT_EQ(Read("f.png").rgba, Read("lines.png").rgba);
  ExpectError(With(With(run, look), {"-o", "x.png", "--show", "finish:outlin"}), 2,
              {"--show finish:outlin", "there are shadows, outline", "did you mean outline?"});
  ExpectError(With(run, {"-o", "x.png", "--show", "finish:outline"}), 2, {"there is no finish"});
  ExpectError({"finish", "p.png", "--finish", "tones", "-o", "x.png", "--show", "finish:tone"}, 2,
              {"there are tones", "did you mean tones?"});
  ExpectError({"finish", "p.png", "--finish", "tones", "-o", "x.png", "--show", "chunks"}, 2, {"finish:NAME"});
  ExpectError(With(run, {"-o", "x.png", "--show", "chunk"}), 2, {"sources, chunks", "finish:NAME"});
  EXPECT_FALSE(Exists("x.png"));
}

TEST_F(CliFinishLayers, GoWithSequences) {
  WritePlainStyle("plain");
  const Arguments run{"stylize",  kToyScene, "--style", "plain",      "--size", "64x48",    "--frames",    "1-3",
                      "--finish", "outline", "-o",      "p.####.png", "--json", "--resume", "--layers-out"};
  const auto kept = [&](const nlohmann::json& json) { return json["kept"].get<int>(); };
  const nlohmann::json first = RunOk(With(run, {"l.####.ora"})).Json();
  EXPECT_EQ(kept(first), 0);
  EXPECT_EQ(first["frames"][2]["layers_output"], "l.0003.ora");
  EXPECT_LE(ErrorOf("l.0002.ora"), 1.0);
  EXPECT_EQ(ReadMergedLayers(At("l.0003.ora"))->rgba, Read("p.0003.png").rgba);
  const std::string before = Bytes("l.0002.ora");
  std::filesystem::remove(At("l.0002.ora"));
  WriteText("l.0003.ora", "broken");
  const CommandResult resumed = RunOk(With(run, {"l.####.ora"}));
  EXPECT_EQ(kept(resumed.Json()), 1) << "a frame without its layers is made again";
  EXPECT_TRUE(Contains(resumed.err, "cannot read l.0002.ora: there is no such file: made again")) << resumed.err;
  EXPECT_EQ(Bytes("l.0002.ora"), before);
  EXPECT_EQ(kept(RunOk(With(run, {"l.####.ora"})).Json()), 3);
  // Pictures that were made anew without their layers.
  const Arguments wide = With(run, {"l.####.ora", "--set", "finish.outline.width=9"});
  Arguments bare = wide;
  bare.erase(std::find(bare.begin(), bare.end(), "--layers-out"), std::find(bare.begin(), bare.end(), "--set"));
  EXPECT_EQ(kept(RunOk(bare).Json()), 0);
  EXPECT_EQ(kept(RunOk(wide).Json()), 0) << "the layers are those of thin lines";
  EXPECT_EQ(ReadMergedLayers(At("l.0002.ora"))->rgba, Read("p.0002.png").rgba);
  ExpectError(With(run, {"l.ora"}), 2, {"--layers-out l.ora is one file for 3 frames", "l.####.ora"});
  RunOk({"guidegen", kToyScene, "--size", "64x48", "--frames", "1-2", "-o", "g.####.exr"});
  RunOk({"finish", "p.####.png", "g.####.exr", "--frames", "1-2", "--finish", "outline", "-o", "f.####.png",
         "--layers-out", "f.####.ora"});
  EXPECT_LE(ErrorOf("f.0002.ora"), 1.0);
  const Arguments again{"finish", "p.####.png", "g.####.exr",   "--frames",   "1-2",      "--finish", "outline",
                        "-o",     "f.####.png", "--layers-out", "f.####.ora", "--resume", "--json"};
  EXPECT_EQ(kept(RunOk(again).Json()), 2);
  std::filesystem::remove(At("f.0001.ora"));
  EXPECT_EQ(kept(RunOk(again).Json()), 1);
}

TEST_F(CliFinishLayers, SayWhatIsWrong) {
  WritePlainStyle("plain");
  const Arguments run{"stylize", kToyScene, "--style", "plain", "--size", "64x48", "-o", "x.png"};
  ExpectError(With(run, {"--layers-out", "l.ora"}), 2, {"no finishing effects", "give --finish"});
  ExpectError(With(run, {"--layers-out", "l.psd", "--finish", "outline"}), 2, {"--layers-out l.psd", ".ora"});
  ExpectError(With(run, {"--layers-out", "none/l.ora", "--finish", "outline"}), 4, {"none"});
  ExpectError(With(run, {"--layers-out", "l.ora", "--finish", "outline", "--upsample", "2", "--upscale"}), 2,
              {"--upscale with --layers-out"});
  std::filesystem::copy_file(At("plain/lit.png"), At("over.ora"));
  ExpectError(With(run, {"--layers-out", "over.ora", "--over", "over.ora", "--finish", "outline"}), 2,
              {"--layers-out over.ora would overwrite the picture of --over"});
  ExpectError({"stylize", kToyScene, "--style", "plain", "--finish", "outline", "--explain", "--layers-out", "l.ora"},
              2, {"give -o FILE"});
  ASSERT_TRUE(WritePicture(At("p.png"), Picture(32, 32)));
  ExpectError({"finish", "p.png", "--finish", "none", "-o", "x.png", "--layers-out", "l.ora"}, 2,
              {"no finishing effects"});
  EXPECT_FALSE(Exists("x.png") || Exists("l.ora"));
}

}  // namespace
}  // namespace scumble
