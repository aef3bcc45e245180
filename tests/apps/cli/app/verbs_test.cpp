// The program's commands: their output, their files, and their exit codes.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

using CliVerbs = CliTest;
using CliUsage = CliTest;

const std::vector<std::string> kVerbs = {"sphere",  "guidegen",   "transfer", "stylize",
                                         "compare", "crosscheck", "info",     "styles"};

TEST_F(CliUsage, HelpNamesEveryVerbAndExitCode) {
  const CommandResult verb = RunOk({"help"}), option = RunOk({"--help"}), letter = RunOk({"-h"});
  EXPECT_EQ(verb.out, option.out);
  EXPECT_EQ(verb.out, letter.out);
  EXPECT_EQ(verb.err, "");
  for (const std::string& name : kVerbs) EXPECT_TRUE(Contains(verb.out, "\n  " + name + " ")) << name;
  EXPECT_TRUE(Contains(verb.out, "0 ok · 1 compared and differs · 2 usage · 3 unreadable or invalid input · 4 cannot"));
  EXPECT_TRUE(Contains(verb.out, "5 not built in · 6 internal error"));
}

TEST_F(CliUsage, VersionIsOneLine) { EXPECT_EQ(RunOk({"--version"}).out, "scumble 0.1.0\n"); }

// The help of every command needs options and defaults, no parser's jargon, no long lines.
TEST_F(CliUsage, EveryVerbHasHelp) {
  for (const std::string& verb : kVerbs) {
    const CommandResult help = RunOk({verb, "--help"});
    EXPECT_TRUE(Contains(help.out, "Usage: scumble " + verb)) << help.out;
    for (const char* option : {"--quiet", "--json", "--threads N = 0", "Exit codes: 0 ok"}) {
      EXPECT_TRUE(Contains(help.out, option)) << verb << " lacks " << option;
    }
    for (const char* jargon : {"TEXT", "INT", "UINT", "FLOAT", "SUBCOMMAND", "{false}", "{true}"}) {
      EXPECT_FALSE(Contains(help.out, jargon)) << verb << " says " << jargon;
    }
    EXPECT_EQ(Contains(help.out, "--set "), Contains(help.out, "--set [NAME:]KEY=VALUE ")) << verb;
    for (std::size_t begin = 0; begin < help.out.size();) {
      const std::size_t end = help.out.find('\n', begin);
      EXPECT_LE(end - begin, 130u) << help.out.substr(begin, end - begin);  // bytes; a few signs take two
      begin = end + 1;
    }
  }
  EXPECT_EQ(RunOk({"help", "sphere"}).out, RunOk({"sphere", "-h"}).out);
  EXPECT_EQ(RunOk({"help", "styles", "tune"}).out, RunOk({"styles", "tune", "-h"}).out);
  ExpectError({"help", "bogus"}, 2, {"there is no command 'bogus'", "scumble help"});
  ExpectError({"help", "styles", "bogus"}, 2, {"there is no command 'styles bogus'", "scumble help"});
}

TEST_F(CliUsage, VerbsThatAreNone) {
  ExpectError(
      {}, 2,
      {"no command given: expected one of sphere, guidegen, transfer, stylize, compare, crosscheck, tradeoff, info, "
       "styles"});
  ExpectError({"bogus"}, 2, {"unknown command 'bogus': expected one of sphere, guidegen"});
  ExpectError({""}, 2, {"expected one of sphere"});
  ExpectError({"--bogus"}, 2, {"unknown option --bogus: options follow the command"});
  ExpectError({"--quiet", "styles"}, 2, {"unknown option --quiet before the command", "as in scumble styles --quiet"});
}

// The unknown option is named even where required ones are missing too: it is what was mistyped.
TEST_F(CliUsage, UnknownOptionsAreNamed) {
  for (const std::string& verb : kVerbs) {
    const CommandResult result = ExpectError({verb, "--bogus"}, 2, {"scumble " + verb + " has no option --bogus"});
    EXPECT_TRUE(Contains(result.err, "\nscumble " + verb + " --help lists what there is\n")) << result.err;
  }
  ExpectError({"styles", "check", "--bogus"}, 2, {"scumble styles check has no option --bogus"});
  ExpectError({"styles", "bogus"}, 2, {"scumble styles does not take the argument 'bogus'"});
}

TEST_F(CliUsage, MissingArgumentsAreNamed) {
  ExpectError({"sphere"}, 2, {"--output is required"});
  ExpectError({"guidegen"}, 2, {"scene_file is required"});
  ExpectError({"guidegen", Scene("suzanne.glb")}, 2, {"-o FILE is required", "--explain"});
  ExpectError({"transfer"}, 2, {"is required"});
  ExpectError({"transfer", "g.exr", "-o", "p.png"}, 2, {"--style is required"});
  ExpectError({"stylize", "s.glb", "--style", "x"}, 2, {"-o FILE is required"});
  ExpectError({"compare", "a.png"}, 2, {"b is required"});
  ExpectError({"info"}, 2, {"file is required"});
  ExpectError({"styles", "check"}, 2, {"style is required"});
}

TEST_F(CliUsage, NumbersOutOfRange) {
  ExpectError({"sphere", "--size", "8", "-o", "k"}, 2, {"--size: Value 8 not in range", "16", "8192"});
  ExpectError({"sphere", "--light", "1", "-o", "k"}, 2, {"--light 1: expected 2 numbers with commas between"});
  ExpectError({"sphere", "--light", "1,100", "-o", "k"}, 2, {"--light 1,100: elevation must be -90 to 90"});
  ExpectError({"info", "--threads", "-1", "x"}, 2, {"--threads: Value -1 not in range", "0", "1024"});
  ExpectError({"guidegen", "--aa", "17", "x", "-o", "g.exr"}, 2, {"--aa: Value 17 not in range", "1", "16"});
  ExpectError({"guidegen", "--normal-frame", "up", "x", "-o", "g.exr"}, 2, {"--normal-frame: up not in {camera,eye}"});
  const Arguments transfer = {"transfer", "g.exr", "--style", "s", "-o", "p.png"};
  ExpectError(With(transfer, {"--bits", "12"}), 2, {"--bits: 12 not in {8,16,32}"});
  ExpectError(With(transfer, {"--repeat", "0"}), 2, {"--repeat: Value 0 not in range", "1", "10000"});
  ExpectError(With(transfer, {"--png-level", "10"}), 2, {"--png-level: Value 10 not in range", "0", "9"});
  ExpectError(With(transfer, {"--seed", "-1"}), 2, {"--seed: -1 is negative"});
  ExpectError(With(transfer, {"--seed", "99999999999999999999"}), 2, {"too large: expected less than 2^64"});
  ExpectError(With(transfer, {"--seed", "x"}), 2, {"expected a number: --seed = x"});
  ExpectError(With(transfer, {"--frame", "1.5"}), 2, {"expected a whole number: --frame = 1.5"});
}

TEST_F(CliUsage, SizesAndViews) {
  const std::string scene = Scene("suzanne.glb");
  for (const char* size : {"0x10", "10x", "axb", "99999999x1", "-5x3", ""}) {
    ExpectError({"guidegen", scene, "--size", size, "-o", "g.exr"}, 2,
                {"--size " + std::string(size) + ": expected WIDTHxHEIGHT, as in 1920x1080, each 1 to 32768"});
  }
  // Refused before any memory is asked for.
  ExpectError({"guidegen", scene, "--size", "32768", "-o", "g.exr"}, 2, {"--size 32768: expected at most 268435456"});
  for (const char* view : {"30", "nan,10", "1,2,3,4,5,6,7", "1,,2"}) {
    ExpectError({"guidegen", scene, "--view", view, "-o", "g.exr"}, 2,
                {"--view " + std::string(view) + ": expected 2 to 6 numbers with commas between"});
  }
  ExpectError({"guidegen", scene, "--view", "0,0,1e30", "-o", "g.exr"}, 2, {"expected numbers from -1e9 to 1e9"});
  ExpectError({"guidegen", scene, "--view", "30,100", "-o", "g.exr"}, 2, {"elevation must be -90 to 90"});
  ExpectError({"guidegen", scene, "--view", "1,2,3,4", "-o", "g.exr"}, 2, {"RIGHT needs UP"});
  ExpectError({"guidegen", scene, "--view", "1,2,3,4,5,180", "-o", "g.exr"}, 2, {"fov must be 0 to below 180"});
  ExpectError({"guidegen", scene, "--light", "1,91", "-o", "g.exr"}, 2, {"--light 1,91: elevation must be -90 to 90"});
  ExpectError({"guidegen", scene, "--view", "30,10,-4", "-o", "g.exr"}, 2, {"distance must be 0 or more"});
  EXPECT_FALSE(Exists("g.exr"));
}

TEST_F(CliVerbs, EverySampleSceneBecomesAPicture) {
  WriteStyle("style");
  int scenes = 0;
  for (const auto& entry : fs::directory_iterator(std::string(SCUMBLE_SOURCE_DIR) + "/scenes")) {
    if (entry.path().extension() != ".glb") continue;
    ++scenes;
    const std::string scene = entry.path().string();
    EXPECT_GT(RunOk({"info", scene, "--json"}).Json()["triangles"], 0);
    const CommandResult result = RunOk({"stylize", scene, "--size", "96x54", "--style", "style", "-o", "p.png"});
    EXPECT_EQ(result.out.substr(0, 7), "p.png  ");
    EXPECT_FALSE(Contains(result.err, "\r")) << "a progress bar is for terminals only";
    const Expected<Picture> picture = ReadPicture(At("p.png"));
    ASSERT_TRUE(picture) << picture.error().message;
    EXPECT_EQ(picture->width, 96);
    EXPECT_EQ(picture->height, 54);
    std::size_t covered = 0;
    for (std::size_t i = 3; i < picture->rgba.size(); i += 4) covered += picture->rgba[i] > 0;
    EXPECT_GT(covered, picture->rgba.size() / 4 / 20) << scene;
  }
  EXPECT_GT(scenes, 0);
}

TEST_F(CliVerbs, ViewsAreSaidAndSeen) {
  const std::string scene = Scene("suzanne.glb");
  const CommandResult spaced = RunOk({"guidegen", scene, "--size", "48x27", "--view", "-30,20", "-o", "a.exr"});
  EXPECT_EQ(spaced.err, "seen from azimuth -30°, elevation 20°, framed whole\n");
  const CommandResult equals = RunOk({"guidegen", scene, "--size", "48x27", "--view=-30,20,4", "-o", "b.exr"});
  EXPECT_EQ(equals.err, "seen from azimuth -30°, elevation 20°, 4 m away\n");
  RunOk({"guidegen", scene, "--size", "48x27", "--view=0,-90", "-q", "-o", "c.exr"});
  EXPECT_EQ(Run({"compare", "a.exr", "b.exr", "--layer", "normal"}).code, 1);
  EXPECT_EQ(Run({"compare", "a.exr", "c.exr", "--layer", "normal"}).code, 1);
}

TEST_F(CliVerbs, CamerasByName) {
  const std::string scene = Scene("suzanne.glb");
  const nlohmann::json info = RunOk({"info", scene, "--json"}).Json();
  ASSERT_FALSE(info["cameras"].empty());
  const std::string camera = info["cameras"][0];
  RunOk({"guidegen", scene, "--size", "32x18", "--camera", camera, "-o", "named.exr"});
  RunOk({"guidegen", scene, "--size", "32x18", "-o", "first.exr"});
  EXPECT_TRUE(Layers("named.exr") == Layers("first.exr"));
  ExpectError({"guidegen", scene, "--camera", "bogus", "-o", "g.exr"}, 2, {scene, "no camera 'bogus'", camera});
  ExpectError({"guidegen", scene, "--camera", camera, "--view", "1,2", "-o", "g.exr"}, 2, {"give one of them"});
}

TEST_F(CliVerbs, SphereKitIsAStyleOncePainted) {
  RunOk({"sphere", "--size", "64", "-o", "kit"});
  ExpectError({"styles", "check", "kit"}, 3, {"kit/lit.png", "paint over kit/template.png"});
  fs::copy_file(At("kit/template.png"), At("kit/lit.png"));
  EXPECT_TRUE(Contains(RunOk({"styles", "check", "kit"}).out, "usable"));
  RunOk({"stylize", Scene("suzanne.glb"), "--size", "96x54", "--style", "kit", "-o", "folder.png"});
  RunOk({"stylize", Scene("suzanne.glb"), "--size", "96x54", "--style", "kit/style.toml", "-o", "file.png"});
  EXPECT_EQ(Bytes("folder.png"), Bytes("file.png"));
  // The artist's own settings survive making the kit again.
  WriteText("kit/style.toml", "name = \"mine\"\n[[exemplar]]\nimage = \"lit.png\"\nguides = \"guides.exr\"\n");
  EXPECT_FALSE(Contains(RunOk({"sphere", "--size", "64", "-o", "kit", "-q"}).out, "style.toml"));
  EXPECT_TRUE(Contains(RunOk({"info", "kit"}).out, "mine"));
}

TEST_F(CliVerbs, SphereInSeveralLights) {
  const Arguments sphere = {"sphere", "--size", "32", "--light", "-40,40", "--light=30,20", "-o", "kit", "--json"};
  const nlohmann::json json = RunOk(sphere).Json();
  ASSERT_EQ(json["files"].size(), 10u);
  for (const auto& file : json["files"]) EXPECT_TRUE(Exists(file)) << file;
  EXPECT_NE(Bytes("kit/template.png"), Bytes("kit/template-2.png"));
}

TEST_F(CliVerbs, GuidegenWritesTheLayersAskedFor) {
  RunOk({"guidegen", Scene("stilllife.glb"), "--size", "64x36", "--layers", "position,albedo,luminance,shadow", "-o",
         "g.exr"});
  const nlohmann::json info = RunOk({"info", "g.exr", "--json"}).Json();
  EXPECT_EQ(info["layers"], "A, normal, depth, object, material, position, albedo, luminance, shadow");
  EXPECT_EQ(info["width"], 64);
  EXPECT_EQ(info["height"], 36);
  EXPECT_FALSE(info["objects"].empty());
  ExpectError({"guidegen", Scene("stilllife.glb"), "--layers", "bogus", "-o", "x.exr"}, 2, {"'bogus'", "position"});
  EXPECT_FALSE(Exists("x.exr"));
  ExpectError({"guidegen", Scene("stilllife.glb"), "--size", "16", "--layers", "motion", "-o", "x.exr"}, 2,
              {"motion", "--frame N"});
  ExpectError({"guidegen", Scene("stilllife.glb"), "--size", "16", "--isa", "bogus", "-o", "x.exr"}, 2,
              {"bogus", "sse2, sse4.2, avx, avx2, avx512"});
  ExpectError({"guidegen", Scene("stilllife.glb"), "--size", "16", "--compression", "dwaa", "-o", "x.exr"}, 2,
              {"'dwaa'", "none, rle, zips, zip, piz", "lossy"});
  EXPECT_FALSE(Exists("x.exr"));
}

TEST_F(CliVerbs, HalfRoundsColoursAndNothingElse) {
  const Arguments guidegen = {"guidegen", Scene("stilllife.glb"), "--size", "64x36", "--layers", "position,luminance"};
  RunOk(With(guidegen, {"-o", "float.exr"}));
  RunOk(With(guidegen, {"--half", "-o", "half.exr"}));
  RunOk({"compare", "float.exr", "half.exr", "--layer", "normal", "--layer", "depth", "--layer", "position", "--layer",
         "object", "--layer", "material", "-fail", "0"});
  EXPECT_EQ(Run({"compare", "float.exr", "half.exr", "--layer", "luminance", "-fail", "0"}).code, 1);
  RunOk({"compare", "float.exr", "half.exr", "--layer", "luminance", "-fail", "0.001", "-failrelative", "0.0005"});
}

TEST_F(CliVerbs, PlanOfAStyleOfNormalsKnowsNoLight) {
  WriteStyle("style");
  const Arguments explain = {"guidegen", Scene("stilllife.glb"), "--style", "style", "--explain"};
  const CommandResult plan = RunOk(explain);
  for (const char* layer : {"A ", "normal ", "depth ", "primary ray"}) EXPECT_TRUE(Contains(plan.out, layer)) << layer;
  for (const char* absent : {"light", "luminance", "albedo", "shadow"})
    EXPECT_FALSE(Contains(plan.out, absent)) << absent;
  const nlohmann::json json = RunOk(With(explain, {"--json"})).Json();
  ASSERT_EQ(json["plan"].size(), 6u);
  EXPECT_EQ(json["plan"][5]["cost"], "none of 1 decoded") << "a texture is colour";
  EXPECT_FALSE(json.contains("output"));
  EXPECT_TRUE(Contains(RunOk(With(explain, {"--layers", "shadow"})).out, "shadow ray"));
  const Arguments stylize = {
      "stylize", Scene("stilllife.glb"), "--size", "32x18", "--style", "style", "--explain", "-o", "p.png"};
  const std::string layers = plan.out.substr(0, plan.out.find("memory "));  // to which painting adds
  EXPECT_EQ(RunOk(stylize).out.substr(0, layers.size()), layers);
  EXPECT_EQ(RunOk(With(stylize, {"--json"})).Json()["plan"], json["plan"]);
}

TEST_F(CliVerbs, InfoShowsWhatAStyleChanges) {
  WriteStyle("style");
  WriteText(
      "style/style.toml",
      "[transfer]\nhybrid = 16\nthreshold = [[1, 0.1], [24, 0.3]]\nblend_radius = 1\nguide_weights.luminance = 2\n"
      "[[exemplar]]\nimage = \"lit.png\"\nguides = \"guides.exr\"\n[[finish]]\neffect = \"outline\"\nwidth = 3.5\n");
  ASSERT_EQ(Run({"sphere", "--size", "64", "--only", "png", "-o", "kit", "-q"}).code, 0);
  std::filesystem::copy_file(At("kit/guides.exr"), At("style/guides.exr"));
  WritePainted("style/lit.png", 64, 64);
  const nlohmann::json info = RunOk({"info", "style", "--json"}).Json();
  EXPECT_EQ(info["settings"],
            nlohmann::json::parse(R"({"transfer.hybrid": 16.0, "transfer.guide_weights.luminance": 2.0,
                                                        "transfer.threshold": [[1, 0.1], [24, 0.3]]})"));
  EXPECT_EQ(info["finish"], nlohmann::json::parse(R"(["outline width=3.5"])"));
  const std::string toon = RunOk({"info", "toon"}).out;
  EXPECT_TRUE(Contains(toon, "method     toon\nsettings   the defaults\nfinish     toon\nexemplars  none\n")) << toon;
}

TEST_F(CliVerbs, EveryVerbSpeaksJson) {
  WriteStyle("style");
  const std::string scene = Scene("suzanne.glb");
  const auto json = [&](const Arguments& arguments) {
    const CommandResult result = RunOk(With(arguments, {"--json"}));
    EXPECT_TRUE(result.Json().is_structured()) << Joined(arguments) << "\n" << result.out;
    return result.Json();
  };
  EXPECT_EQ(json({"sphere", "--size", "16", "-o", "kit"})["files"].size(), 6u);
  EXPECT_EQ(json({"guidegen", scene, "--size", "32x18", "-o", "g.exr"})["output"], "g.exr");
  const auto transfer = json({"transfer", "g.exr", "--style", "style", "-o", "p.png"});
  EXPECT_EQ(transfer["width"], 32);
  EXPECT_EQ(transfer["style"], "test");
  EXPECT_GT(transfer["covered_pixels"], 0);
  EXPECT_GE(transfer["ms"]["match"]["median"], 0.0);
  EXPECT_EQ(json({"stylize", scene, "--size", "32x18", "--style", "style", "-o", "p.png"})["height"], 18);
  EXPECT_EQ(json({"compare", "p.png", "p.png"})["verdict"], "equal");
  EXPECT_EQ(json({"info", "g.exr"})["kind"], "guides");
  EXPECT_EQ(json({"info", scene})["kind"], "scene");
  EXPECT_EQ(json({"info", "style"})["kind"], "style");
  EXPECT_TRUE(json({"styles"}).is_array());
  EXPECT_GE(json({"styles", "--keys"}).size(), 20u);
  for (const auto& key : json({"styles", "--keys"})) {
    for (const char* field : {"name", "default", "help", "kind", "group", "needs_preparing"}) {
      EXPECT_TRUE(key.contains(field)) << key << " " << field;
    }
  }
  EXPECT_EQ(json({"styles", "check", "style"})["size"], 64);
}

TEST_F(CliVerbs, InfoTellsWhatAScenesAuthorWants) {
  const auto node = [](const std::string& name, const std::string& extras) {
    return R"({"name": ")" + name + R"(", "mesh": 0, "extras": {"scumble": {)" + extras + "}}}";
  };
  const std::string lamp = R"("lamp": {"type": "AREA", "energy": 1, "color": [1, 1, 1], "shape": "SQUARE", "size": 1,
                              "size_y": 1})";
  WriteText("a.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1, 2, 3]}],
      "buffers": [{"byteLength": 36, "uri": "a.bin"}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [)" +
                          node("Pot", R"("style": "oil", "pass_index": 4)") + "," + node("Lid", R"("pass_index": 2)") +
                          "," + node("Table", R"("pass_index": 0)") + R"(, {"name": "Panel", "extras": {"scumble": {)" +
                          lamp + "}}}]}");
  const float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  WriteText("a.bin", std::string(reinterpret_cast<const char*>(corners), sizeof(corners)));
  const nlohmann::json json = RunOk({"info", "a.gltf", "--json"}).Json();
  EXPECT_EQ(json["objects"], (nlohmann::json{"Pot", "Lid", "Table"}));
  EXPECT_EQ(json["styles"], (nlohmann::json{{"Pot", "oil"}}));
  EXPECT_EQ(json["pass_indices"], (nlohmann::json{{"Pot", 4}, {"Lid", 2}}));
  EXPECT_EQ(json["lights"], (nlohmann::json{"Panel (area)"}));
  const std::string text = RunOk({"info", "a.gltf"}).out;
  EXPECT_TRUE(Contains(text, "styles        Pot: oil\n")) << text;
  EXPECT_TRUE(Contains(text, "pass_indices  Pot: 4, Lid: 2\n")) << text;
  // Without assignments, nothing is listed.
  const nlohmann::json plain = RunOk({"info", Scene("suzanne.glb"), "--json"}).Json();
  EXPECT_FALSE(plain.contains("styles"));
  EXPECT_FALSE(plain.contains("pass_indices"));
}

// Names come from other people's files and folders, and may hold anything but a zero byte.
TEST_F(CliVerbs, JsonStandsNamesThatAreNoUtf8) {
  WriteText("tri\xff.obj", "o sheet\xfe\n" + TriangleObj());
  EXPECT_TRUE(RunOk({"info", "tri\xff.obj", "--json"}).Json().is_object());
  EXPECT_TRUE(RunOk({"guidegen", "tri\xff.obj", "--size", "8", "-q", "-o", "g\xff.exr", "--json"}).Json().is_object());
  EXPECT_TRUE(RunOk({"info", "g\xff.exr", "--json"}).Json().is_object());
}

TEST_F(CliVerbs, QuietSilencesTalkOnly) {
  WriteStyle("style");
  WriteText("tri.obj", TriangleObj());  // no camera: that it is framed is worth a word
  const std::vector<Arguments> commands = {
      {"sphere", "--size", "16", "-o", "kit"},
      {"guidegen", "tri.obj", "--size", "16", "--layers", "luminance", "-o", "g.exr"},
      {"stylize", "tri.obj", "--size", "16", "--style", "style", "-o", "p.png"},
      {"compare", "p.png", "p.png", "-o", "heat.png"}};
  for (const Arguments& command : commands) {
    const CommandResult loud = RunOk(command), quiet = RunOk(With(command, {"--quiet"}));
    EXPECT_NE(loud.err, "") << Joined(command);
    EXPECT_EQ(quiet.err, "") << Joined(command);
    EXPECT_NE(quiet.out, "") << Joined(command);
  }
  ExpectError({"info", "missing.exr", "-q"}, 3, {"missing.exr"});
}

// A copy of the program with styles beside it, as a build tree and as an installation have them.
TEST_F(CliVerbs, BundledStylesByName) {
  for (const std::string styles : {"build/exemplars", "prefix/share/scumble/exemplars"}) {
    const std::string root = styles.substr(0, styles.find('/'));
    WriteStyle(styles + "/beta");
    WriteStyle(styles + "/alpha");
    const CommandSettings installed = CopyProgram(root + "/bin");
    const CommandResult list = Run({"styles"}, installed);
    EXPECT_EQ(list.code, 0) << list.err;
    EXPECT_LT(list.out.find("alpha"), list.out.find("beta"));
    EXPECT_EQ(Run({"styles", "check", "alpha"}, installed).code, 0);
    EXPECT_EQ(Run({"info", "beta"}, installed).code, 0);
    const CommandResult unknown = Run({"info", "gamma"}, installed);
    EXPECT_EQ(unknown.code, 3);
    EXPECT_EQ(unknown.Error(),
              "there is no style 'gamma': expected a file, a folder, or one of the bundled styles alpha, beta, or toon "
              "or render, which need no painting");
    // One style that is broken is named, and does not hide the others.
    fs::remove(At(styles + "/alpha/lit.png"));
    const CommandResult broken = Run({"styles"}, installed);
    EXPECT_EQ(broken.code, 3);
    EXPECT_TRUE(Contains(broken.out, "beta"));
    EXPECT_TRUE(Contains(broken.Warning(), "alpha"));
  }
}

TEST_F(CliVerbs, StyleKeysListEveryDefault) {
  const std::string keys = RunOk({"styles", "--keys"}).out;
  for (const char* key :
       {"transfer.method", "transfer.threshold", "transfer.levels", "transfer.jitter_fps", "transfer.blend_radius",
        "transfer.scale", "transfer.rim", "transfer.paper", "exemplar.image"}) {
    EXPECT_TRUE(Contains(keys, std::string("\n") + key)) << key;
  }
}

TEST_F(CliVerbs, StyleCheckWarnsOfFlatAndHoledPaint) {
  Picture flat(32, 32);
  for (std::size_t i = 0; i < flat.rgba.size(); ++i) flat.rgba[i] = i % 4 == 3 ? 65535 : 30000;
  ASSERT_TRUE(WritePicture(At("flat.png"), flat));
  EXPECT_TRUE(Contains(RunOk({"styles", "check", "flat.png"}).err, "flat.png: light and dark differ by 0%"));
  Picture holed = Painted(32, 32);
  holed.At(16, 16)[3] = 0;
  ASSERT_TRUE(WritePicture(At("holed.png"), holed));
  EXPECT_TRUE(Contains(RunOk({"styles", "check", "holed.png"}).err, "is transparent"));
}

// A dark triangle and, a metre before it, one that shines on it.
std::string GlowGltf() {
  return R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1]}],
      "buffers": [{"byteLength": 36, "uri": "glow.bin"}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
      "materials": [{"doubleSided": true, "emissiveFactor": [1, 1, 1]}, {"doubleSided": true}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]},
                 {"primitives": [{"attributes": {"POSITION": 0}, "material": 1}]}],
      "nodes": [{"name": "glow", "mesh": 0, "translation": [0, 0, 1]}, {"name": "dark", "mesh": 1}]})";
}

std::string GlowCorners() {
  const float corners[] = {0, 0, 0, 2, 0, 0, 0, 2, 0};
  return std::string(reinterpret_cast<const char*>(corners), sizeof(corners));
}

TEST_F(CliVerbs, ATimeBudgetSaysWhatRepeatsIt) {
  WriteText("glow.gltf", GlowGltf());
  WriteText("glow.bin", GlowCorners());
  const Arguments guidegen = {"guidegen", "glow.gltf", "--view", "60,10", "--size", "16", "-o", "g.exr"};
  const Arguments hasty = With(guidegen, {"--layers", "lpe.full", "--time-budget", "1e-9"});
  EXPECT_TRUE(Contains(RunOk(hasty).out, "; repeat with --samples 1\n"));
  EXPECT_EQ(RunOk(With(hasty, {"--json"})).Json()["samples"], 1);
  const std::string noisy = RunOk(With(guidegen, {"--layers", "lpe.full", "--noise", "10"})).out;
  EXPECT_TRUE(Contains(noisy, "; noise 0.")) << noisy;
  EXPECT_TRUE(Contains(noisy, "; repeat with --samples 16\n")) << noisy;
  const std::string capped = RunOk(With(guidegen, {"--layers", "lpe.full", "--noise", "1e-6", "--samples", "4"})).out;
  EXPECT_TRUE(Contains(capped, "; repeat with --samples 4\n")) << capped;
  for (const char* option : {"--noise", "--time-budget"}) {
    ExpectError(With(guidegen, {"--layers", "shadow", option, "1"}), 2,
                {"is for lpe.* layers; luminance and shadow under lights with extent take samples of their own"});
  }
  const std::string exact = RunOk(With(guidegen, {"--layers", "lpe.LSE", "--max-bounces", "0", "--noise", "1"})).out;
  EXPECT_TRUE(Contains(exact, "--samples")) << exact;
  const std::string none = RunOk(With(guidegen, {"--noise", "1"})).out;
  EXPECT_TRUE(Contains(none, "; free of noise, no samples\n")) << none;
}

// Left out, --samples is for each pixel to choose; a number is the number, the default one too.
TEST_F(CliVerbs, PixelsChooseTheirSamplesUnlessTheyAreGiven) {
  const Arguments guidegen = {"guidegen", Scene("ball.glb"), "--size", "64", "--layers", "luminance,shadow"};
  const auto shadow_rays = [&](const Arguments& more) {
    return RunOk(With(With(guidegen, more), {"-o", "g.exr", "--json"})).Json()["rays"]["shadow"].get<int>();
  };
  const int chosen = shadow_rays({"--threads", "1"});
  const std::string bytes = Bytes("g.exr");
  EXPECT_EQ(shadow_rays({"--threads", "3"}), chosen);
  EXPECT_EQ(Bytes("g.exr"), bytes) << "threads decide nothing";
  EXPECT_TRUE(Contains(bytes, "samples 4-64;")) << "the header has what was asked for";
  EXPECT_TRUE(Contains(RunOk(With(guidegen, {"--explain"})).out, "4 to 64 samples per covered pixel"));
  const int many = shadow_rays({"--samples", "64"});
  EXPECT_LT(3 * chosen, many);
  EXPECT_TRUE(Contains(Bytes("g.exr"), "samples 64;"));
  EXPECT_EQ(shadow_rays({"--samples", "64", "--threads", "3"}), many);
  EXPECT_TRUE(Contains(RunOk(With(guidegen, {"--samples", "64", "--explain"})).out, " 64 samples per covered pixel"));
  EXPECT_GT(shadow_rays({"--samples", "4"}), 0);
  EXPECT_LE(shadow_rays({"--samples", "4"}), chosen);
  // --resume takes neither for the other.
  const Arguments frames = With(guidegen, {"--frames", "1-2", "--resume", "--json", "-o", "s.#.exr"});
  EXPECT_EQ(RunOk(frames).Json()["kept"], 0);
  EXPECT_EQ(RunOk(With(frames, {"--samples", "64"})).Json()["kept"], 0);
  EXPECT_EQ(RunOk(With(frames, {"--samples", "64"})).Json()["kept"], 2);
  EXPECT_EQ(RunOk(frames).Json()["kept"], 0);
  EXPECT_EQ(RunOk(frames).Json()["kept"], 2);
}

TEST_F(CliVerbs, SeedsOfGuidesDecideAndRepeat) {
  WriteText("glow.gltf", GlowGltf());
  WriteText("glow.bin", GlowCorners());
  const Arguments scene = {"glow.gltf", "--view", "60,10", "--size", "64"};
  const auto guides = [&](const Arguments& more) {
    const Arguments what = {"--layers", "luminance", "--compression", "none", "-o", "g.exr"};
    RunOk(With(With(With({"guidegen"}, scene), what), more));
    return Bytes("g.exr");
  };
  const std::string zero = guides({"--samples", "4"}), five = guides({"--samples", "4", "--seed", "5"});
  EXPECT_EQ(guides({"--samples", "4", "--seed", "0"}), zero);
  EXPECT_EQ(guides({"--samples", "4", "--seed", "5"}), five);
  EXPECT_NE(five, zero);
  EXPECT_EQ(RunOk({"info", "g.exr", "--json"}).Json()["scumble:seed"], "5");
  ExpectError(With({"guidegen"}, {"glow.gltf", "--seed", "-1", "-o", "g.exr"}), 2, {"--seed: -1 is negative"});
  // One number feeds both steps of stylize.
  WriteStyle("style");
  const Arguments rest = {"--style", "style", "--seed", "5"};
  RunOk(With(With(With({"stylize"}, scene), rest), {"-o", "once.png"}));
  RunOk(With(With(With({"guidegen"}, scene), rest), {"-o", "g.exr"}));
  RunOk(With(With({"transfer", "g.exr"}, rest), {"-o", "twice.png"}));
  EXPECT_EQ(Bytes("once.png"), Bytes("twice.png"));
}

// A meadow of thousands does not fill the screen; a program gets all names.
TEST_F(CliVerbs, InfoTellsTheFirstOfManyNames) {
  std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 50; ++i) obj += "o Blade" + std::to_string(i) + "\nf 1 2 3\n";
  WriteText("meadow.obj", obj);
  const std::string text = RunOk({"info", "meadow.obj"}).out;
  EXPECT_THAT(text, ::testing::HasSubstr("Blade39 and 10 more: --json lists them all\n"));
  EXPECT_EQ(text.find("Blade40"), std::string::npos);
  EXPECT_EQ(RunOk({"info", "meadow.obj", "--json"}).Json()["objects"].size(), 50u);
}

}  // namespace
}  // namespace scumble
