// The calls of apps/studio/api.md that write files, and files that others write.
#include <gmock/gmock.h>

#include <atomic>

#include "apps/studio/session/lane.h"
#include "core/io/file/zip_archive.h"
#include "core/io/open_raster.h"
#include "core/style/style_file.h"
#include "tests/apps/studio/session_fixture.h"

namespace scumble {
namespace {

using testing::HasSubstr;

std::string AsText(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// As Krita writes it, as far as it matters: the merged picture in a zip archive.
std::string KraOf(const Picture& picture) {
  const std::string type = "application/x-krita";
  const auto bytes = std::as_bytes(std::span(type));
  const std::vector<ZipEntry> entries = {{"mimetype", {bytes.begin(), bytes.end()}},
                                         {"mergedimage.png", *EncodePng(picture), true}};
  return AsText(*EncodeZip(entries, "a.kra"));
}

std::string OraOf(const Picture& picture) {
  const std::vector<RasterLayer> layers = {{"paint", *EncodePng(picture)}};
  return AsText(*EncodeOpenRaster(layers, picture, 0, "layers"));
}

// A flat file of red, green, blue and transparency, 8 bits each, as they are.
std::string PsdOf(const Picture& picture) {
  const auto big = [](std::uint32_t number, int bytes) {
    std::string text;
    for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(number >> (8 * i));
    return text;
  };
  std::string text = "8BPS" + big(1, 2) + big(0, 6) + big(4, 2) + big(std::uint32_t(picture.height), 4) +
                     big(std::uint32_t(picture.width), 4) + big(8, 2) + big(3, 2) + std::string(12, '\0') + big(0, 2);
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t i = c; i < picture.rgba.size(); i += 4) text += static_cast<char>(picture.rgba[i] >> 8);
  }
  return text;
}

Picture Filled(int width, int height, std::uint16_t red, std::uint16_t alpha) {
  Picture picture(width, height);
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) picture.rgba[i] = red, picture.rgba[i + 3] = alpha;
  return picture;
}

TEST_F(SessionTest, SaveChangesOneLine) {
  const fs::path toml = folder / "mine" / "style.toml";
  ASSERT_EQ(Call("PATCH", "/api/state", {{"keys", {{"transfer.threshold", 0.5}}}}).status, 200);
  ASSERT_EQ(Call("POST", "/api/save", json::object()).status, 200);
  EXPECT_EQ(TextOf(toml),
            "# mine\nname = \"mine\"\n\n[transfer]\nthreshold = 0.5  # coarse\n\n[[exemplar]]\n"
            "image = \"art/lit.png\"\n");
  EXPECT_EQ(State()["keys"], json::object());
  EXPECT_EQ(State()["file_keys"]["transfer.threshold"], 0.5);
  ASSERT_EQ(Call("PATCH", "/api/state", {{"style", "oil"}}).status, 200);
  EXPECT_EQ(Call("POST", "/api/save", json::object()).status, 403);
}

TEST_F(SessionTest, SavesAreListedForTheUndoOfAllPages) {
  EXPECT_EQ(State()["saves"], json::array());
  ASSERT_EQ(Call("PATCH", "/api/state", {{"keys", {{"transfer.threshold", 0.5}}}}).status, 200);
  const HttpResponse saved = Call("POST", "/api/save", json::object());
  ASSERT_EQ(saved.status, 200);
  const json first = {{"number", 1},
                      {"style", "mine"},
                      {"from", "mine"},
                      {"keys", {{"transfer.threshold", 0.5}}},
                      {"before", {{"transfer.threshold", 0.2}}},
                      {"had_frames", false}};
  EXPECT_EQ(json::parse(saved.body)["saves"], json::array({first}));
  EXPECT_EQ(State()["saves"], json::array({first}));
  for (int i = 2; i <= 25; ++i) {
    ASSERT_EQ(Call("PATCH", "/api/state", {{"keys", {{"transfer.threshold", i / 100.0}}}}).status, 200);
    ASSERT_EQ(Call("POST", "/api/save", json::object()).status, 200);
  }
  const json saves = State()["saves"];
  EXPECT_EQ(saves.size(), 20u);
  EXPECT_EQ(saves.back()["number"], 25);
  EXPECT_EQ(saves.back()["before"], json({{"transfer.threshold", 0.24}}));
}

// One value would take the place of all.
TEST_F(SessionTest, SaveKeepsKeyFrames) {
  const fs::path toml = folder / "mine" / "style.toml";
  const std::string text = "[transfer]\nthreshold = [[1, 0.25], [5, 0.75]]\n\n[[exemplar]]\nimage = \"art/lit.png\"\n";
  Write(toml, text);
  Open({(folder / "mine").string()}, kSource + "/scenes/toys.glb");
  const auto in_file = [&](int frame) {
    EXPECT_EQ(Call("PATCH", "/api/state", {{"frame", frame}}).status, 200);
    return State()["file_keys"]["transfer.threshold"].get<double>();
  };
  EXPECT_EQ(in_file(0), 0.25);
  EXPECT_EQ(in_file(3), 0.5);
  EXPECT_EQ(State()["key_frames"], json({{"transfer.threshold", "[[1, 0.25], [5, 0.75]]"}}));
  ASSERT_EQ(Call("PATCH", "/api/state", {{"keys", {{"transfer.threshold", 0.25}}}}).status, 200);
  const HttpResponse refused = Call("POST", "/api/save", json::object());
  EXPECT_EQ(refused.status, 403);
  EXPECT_THAT(refused.body, testing::AllOf(HasSubstr("[[1, 0.25], [5, 0.75]]"), HasSubstr("as a new one")));
  EXPECT_EQ(TextOf(toml), text);
  EXPECT_EQ(Call("POST", "/api/save-as", {{"name", "other"}}).status, 200);
  EXPECT_EQ(State()["key_frames"], json::object());
  const json last = State()["saves"].back();
  EXPECT_EQ(json({last["from"], last["style"], last["had_frames"]}), json({"mine", "other", true}));
}

TEST_F(SessionTest, SaveAsMakesAWholeStyle) {
  ASSERT_EQ(Call("PATCH", "/api/state", {{"keys", {{"transfer.threshold", 0.5}}}}).status, 200);
  for (const char* name : {"", "../x", ".x", "a/b", "mine"}) {
    EXPECT_EQ(Call("POST", "/api/save-as", {{"name", name}}).status, 400) << name;
  }
  ASSERT_EQ(Call("POST", "/api/save-as", {{"name", "other"}}).status, 200);
  EXPECT_EQ(State()["style"], "other");
  EXPECT_EQ(Frame().status, 200);
  const auto copy = LoadStyle(folder / "other");
  ASSERT_TRUE(copy.ok()) << copy.error().message;
  EXPECT_FLOAT_EQ(copy->transfer.threshold, 0.5f);
  EXPECT_EQ(copy->name, "other");
  EXPECT_EQ(TextOf(folder / "other" / "art" / "lit.png"), TextOf(painting));
}

TEST_F(SessionTest, StrokesGoIntoThePainting) {
  const json target = json::parse(Call("GET", "/api/paintable").body);
  ASSERT_TRUE(target["ok"]) << target;
  Picture strokes(64, 64);
  std::fill_n(strokes.At(32, 20), 1, std::uint16_t(65535)), strokes.At(32, 20)[3] = 65535;
  const auto paint = [&](const std::string& stamp) {
    return session->Handle(
        {"POST", "/api/paint", {{"exemplar", "0"}, {"stamp", stamp}}, "image/png", "", PngOf(strokes)});
  };
  const std::string before = TextOf(painting);
  EXPECT_EQ(paint("0123").status, 409);
  EXPECT_EQ(TextOf(painting), before);
  EXPECT_EQ(paint(target["stamp"]).status, 200);
  Picture expected = Ball(40000);
  expected = PictureOf(PngOf(expected));
  PutOver(expected, strokes);
  EXPECT_EQ(ReadPicture(painting)->rgba, expected.rgba);
  EXPECT_EQ(paint(target["stamp"]).status, 409);  // it is another file now
  strokes = Picture(32, 32);
  EXPECT_EQ(paint(json::parse(Call("GET", "/api/paintable").body)["stamp"]).status, 403);
}

TEST_F(SessionTest, StrokesAreALayerOfOpenRaster) {
  const fs::path file = folder / "layers.ora";
  const Picture base = Filled(64, 64, 20046, 65535);
  const std::vector<RasterLayer> layers = {{"paint", *EncodePng(base)}};
  const auto bytes = EncodeOpenRaster(layers, base, 0, "layers");
  Write(file, {reinterpret_cast<const char*>(bytes->data()), bytes->size()});
  Picture strokes(64, 64);
  for (const int x : {3, 4}) {
    strokes.At(x, 5)[0] = 65535, strokes.At(x, 5)[3] = 65535;
    const auto with = WithStrokes(file, "Scumble", strokes);
    ASSERT_TRUE(with.ok()) << with.error().message;
    Write(file, {reinterpret_cast<const char*>(with->data()), with->size()});
    strokes = Picture(64, 64);
  }
  const auto merged = ReadPicture(file);
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_EQ(merged->At(3, 5)[0], 65535);
  EXPECT_EQ(merged->At(4, 5)[0], 65535);
  EXPECT_EQ(merged->At(5, 5)[0], base.At(5, 5)[0]);
}

TEST_F(SessionTest, SavesAreSeenAndBrokenFilesAreTold) {
  ASSERT_EQ(Frame().status, 200);
  const std::string first = Frame().body;
  ASSERT_TRUE(WritePicture(folder / "new.png", Ball(1000)).ok());
  fs::rename(folder / "new.png", painting);
  EXPECT_EQ(Await("state")["why"], "files");
  const std::string second = Frame().body;
  EXPECT_NE(second, first);

  const std::string whole = TextOf(painting);
  Write(painting, whole.substr(0, whole.size() / 2));
  EXPECT_THAT(Await("problem")["message"].get<std::string>(), HasSubstr("lit.png"));
  EXPECT_EQ(Frame().status, 422);
  EXPECT_FALSE(State()["problem"].is_null());
  Write(painting, whole);
  EXPECT_TRUE(Await("problem").is_null());
  EXPECT_EQ(Frame().body, second);

  fs::rename(folder / "mine", folder / "away");
  EXPECT_FALSE(Await("problem").is_null());
  fs::rename(folder / "away", folder / "mine");
  EXPECT_TRUE(Await("problem").is_null());
  EXPECT_EQ(Frame().body, second);
}

TEST_F(SessionTest, AStyleThatIsBrokenAtFirstIsSeenOnceItIsMended) {
  const std::string whole = TextOf(painting);
  Write(painting, whole.substr(0, whole.size() / 2));
  EXPECT_EQ(Frame().status, 422);
  Write(folder / "mine" / "style.toml", TextOf(folder / "mine" / "style.toml") + "# later\n");
  Write(painting, whole);
  EXPECT_EQ(Await("state")["why"], "files");
  EXPECT_EQ(Frame().status, 200);
}

// Every kind of file that painting programs save, by rename and in place.
TEST_F(SessionTest, EveryKindOfPaintingIsSeenWhenItIsSaved) {
  const auto exr = [&](const Picture& picture) {
    EXPECT_TRUE(WritePicture(folder / "any.exr", picture).ok());
    return TextOf(folder / "any.exr");
  };
  const std::map<std::string, std::function<std::string(const Picture&)>> kinds = {
      {"lit.kra", KraOf}, {"lit.ora", OraOf}, {"lit.psd", PsdOf}, {"lit.exr", exr}, {"lit.png", PngOf}};
  for (const auto& [name, encode] : kinds) {
    SCOPED_TRACE(name);
    const fs::path style = folder / ("style of " + name), file = style / name;
    fs::create_directories(style);
    Write(style / "style.toml", "[[exemplar]]\nimage = \"" + name + "\"\n");
    Write(file, encode(Ball(40000)));
    Open({style.string()});
    const HttpResponse first = Frame();
    ASSERT_EQ(first.status, 200) << first.body;
    Write(folder / "new", encode(Ball(1000)));
    fs::rename(folder / "new", file);
    EXPECT_TRUE(Comes([&] { return Frame().body != first.body; }));
    EXPECT_EQ(Frame().status, 200);
    Write(file, encode(Ball(40000)));  // in place
    EXPECT_TRUE(Comes([&] { return Frame().body == first.body; }));
  }
}

TEST_F(SessionTest, StrokesGoIntoAnOpenRasterOfTheStyle) {
  const fs::path style = folder / "layered", file = style / "lit.ora";
  fs::create_directories(style);
  Write(style / "style.toml", "[[exemplar]]\nimage = \"lit.ora\"\n");
  Write(file, OraOf(Ball(40000)));
  Open({style.string()});
  const json target = json::parse(Call("GET", "/api/paintable").body);
  ASSERT_TRUE(target["ok"]) << target;
  EXPECT_TRUE(target["layer"]);
  Picture strokes(64, 64);
  strokes.At(30, 30)[1] = strokes.At(30, 30)[3] = 65535;
  const auto put = session->Handle(
      {"POST", "/api/paint", {{"exemplar", "0"}, {"stamp", target["stamp"]}}, "image/png", "", PngOf(strokes)});
  ASSERT_EQ(put.status, 200) << put.body;
  const auto merged = ReadPicture(file);
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  Picture expected = PictureOf(PngOf(Ball(40000)));
  PutOver(expected, strokes);
  EXPECT_EQ(merged->rgba, expected.rgba);
  const auto zip = ZipReader::Open(file);
  ASSERT_TRUE(zip.ok());
  const auto stack = zip->Read("stack.xml", 1 << 16);
  ASSERT_TRUE(stack.ok());
  EXPECT_THAT(AsText(*stack), testing::AllOf(HasSubstr("\"paint\""), HasSubstr("\"Scumble\"")));
}

// The sentence is the command line's.
TEST_F(SessionTest, AStyleWithoutItsPaintingIsTold) {
  fs::remove(painting);
  const HttpResponse none = Frame();
  EXPECT_EQ(none.status, 422);
  const json told = json::parse(none.body)["error"]["message"];
  EXPECT_THAT(told.get<std::string>(), HasSubstr("lit.png"));
  const auto read = LoadStyle(folder / "mine");
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(told, read.error().message);
}

// Also a painting in a folder below, long after the style was tried in vain.
TEST_F(SessionTest, APaintingThatAppearsIsSeen) {
  const std::string whole = TextOf(painting);
  fs::remove(painting);
  Open({(folder / "mine").string()});
  EXPECT_EQ(Frame().status, 422);
  Write(folder / "mine" / "art" / "other.png", whole);  // not the one, but it is tried
  EXPECT_FALSE(Await("problem").is_null());
  EXPECT_FALSE(State()["problem"].is_null());
  Write(folder / "mine" / "art" / "new.png", whole);
  fs::rename(folder / "mine" / "art" / "new.png", painting);
  EXPECT_TRUE(Comes([&] { return Frame().status == 200; }));
  EXPECT_TRUE(State()["problem"].is_null());
}

TEST_F(SessionTest, AnotherStyleEndsTheProblem) {
  ASSERT_EQ(Frame().status, 200);
  Write(painting, "no picture");
  EXPECT_FALSE(Await("problem").is_null());
  ASSERT_EQ(Call("PATCH", "/api/state", {{"style", "ink"}}).status, 200);
  EXPECT_EQ(Frame().status, 200);
  EXPECT_TRUE(State()["problem"].is_null());
}

// The files may be whole the next time, though nothing else has changed.
TEST_F(SessionTest, ALaneKeepsNoError) {
  Lane lane(context);
  PictureJob job;
  job.key = "one", job.scene = options.scene, job.style.style = (folder / "mine").string();
  fs::rename(painting, folder / "away.png");
  EXPECT_FALSE(lane.Paint(job).ok());
  fs::rename(folder / "away.png", painting);
  const auto painted = lane.Paint(job);
  ASSERT_TRUE(painted.ok()) << painted.error().message;
  EXPECT_EQ(*lane.Paint(job), *painted) << "a picture is kept";
}

// Two pages that show different pictures of one state would otherwise cancel each other for ever.
TEST_F(SessionTest, ALaneLetsOtherClientsPicturesEnd) {
  for (const std::string second : {"another page", "this page"}) {
    std::atomic<int> begun = 0;
    context.on_progress = [&](const std::string&) -> Progress {
      // While the first one is painted, the second one is asked for.
      if (begun++ == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
      return [](double) { return true; };
    };
    Lane lane(context);
    PictureJob job;
    job.key = "picture", job.scene = options.scene, job.style.style = (folder / "mine").string();
    PictureJob other = job;
    other.key = "chunks", other.picture.show = FindExplanation("chunks");
    bool first_is_painted = false;
    std::thread first([&] { first_is_painted = lane.Paint(job, "this page").ok(); });
    EXPECT_TRUE(Comes([&] { return begun > 0; }));
    EXPECT_TRUE(lane.Paint(other, second).ok());
    first.join();
    EXPECT_EQ(first_is_painted, second == "another page");
  }
}

}  // namespace
}  // namespace scumble
