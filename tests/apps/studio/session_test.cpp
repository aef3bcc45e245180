// The calls of apps/studio/api.md without sockets: what they answer, and what they write.
#include "apps/studio/session/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "core/io/picture/open_raster.h"
#include "core/io/picture_file.h"
#include "core/style/style_file.h"
#include "pipeline/workspace.h"
#include "tests/support/temporary_folder.h"
#include "transfer/field/source_field.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

const std::string kSource = SCUMBLE_SOURCE_DIR;
constexpr int kWidth = 96, kHeight = 54;

std::string TextOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void Write(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

Picture PictureOf(const std::string& bytes) {
  const auto picture = DecodePicture(std::as_bytes(std::span(bytes)), "answer");
  EXPECT_TRUE(picture.ok());
  return picture ? *picture : Picture();
}

std::string PngOf(const Picture& picture) {
  const auto bytes = EncodePng(picture);
  return {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
}

Picture Filled(int width, int height, std::uint16_t red, std::uint16_t alpha) {
  Picture picture(width, height);
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) picture.rgba[i] = red, picture.rgba[i + 3] = alpha;
  return picture;
}

// A small painting of its own in a style folder with comments, and a session on it.
class SessionTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder / "mine" / "art");
    painting = folder / "mine" / "art" / "lit.png";
    ASSERT_TRUE(WritePicture(painting, Ball(40000)).ok());
    Write(
        folder / "mine" / "style.toml",
        "# mine\nname = \"mine\"\n\n[transfer]\nthreshold = 0.2  # coarse\n\n[[exemplar]]\nimage = \"art/lit.png\"\n");
    Open({(folder / "mine").string()});
  }

  // A sphere with a gradient, so that each place has its own colour.
  static Picture Ball(std::uint16_t blue) {
    Picture ball(64, 64);
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        if (std::hypot(x - 31.5, y - 31.5) > 32) continue;
        std::uint16_t* at = ball.At(x, y);
        at[0] = std::uint16_t(x * 1000), at[1] = std::uint16_t(y * 1000), at[2] = blue, at[3] = 65535;
      }
    }
    return ball;
  }

  void Open(const std::vector<std::string>& styles) {
    session.reset();
    options.scene.scene = kSource + "/scenes/ball.glb", options.scene.size = {kWidth, kHeight};
    options.styles = styles, options.save_to = folder.path();
    context.data_roots = {kSource};
    auto opened = Session::Open(options, context, events);
    ASSERT_TRUE(opened.ok()) << opened.error().message;
    session = std::move(*opened);
  }

  HttpResponse Call(const std::string& method, const std::string& path, const json& body = nullptr,
                    std::map<std::string, std::string> query = {}) {
    return session->Handle({method, path, std::move(query), "application/json", "", body.is_null() ? "" : body.dump()});
  }
  json State() { return json::parse(Call("GET", "/api/state").body); }
  HttpResponse Frame(const std::string& format = "png", const std::string& quality = "final") {
    return Call("GET", "/api/frame", nullptr, {{"quality", quality}, {"format", format}});
  }

  // The data of the next event of this name.
  json Await(const std::string& name) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20 * SCUMBLE_TESTS_SLOWER);
    while (std::chrono::steady_clock::now() < end) {
      const auto event = events.After(heard, std::chrono::milliseconds(200));
      if (!event) continue;
      heard = event->id;
      if (event->name == name) return json::parse(event->data);
    }
    ADD_FAILURE() << "there was no event '" << name << "'";
    return {};
  }

  TemporaryFolder folder;
  fs::path painting;
  EventHub events;
  std::uint64_t heard = 0;
  StudioOptions options;
  RunContext context;
  std::unique_ptr<Session> session;
};

TEST_F(SessionTest, APatchIsAllOrNothing) {
  const json before = State();
  EXPECT_EQ(before["scene"], "ball");
  EXPECT_EQ(before["style"], "mine");
  EXPECT_EQ(before["exemplars"][0]["width"], 64);
  EXPECT_EQ(Call("PATCH", "/api/state", {{"seed", 7}, {"size", "large"}}).status, 400);
  EXPECT_EQ(Call("PATCH", "/api/state", {{"seed", 7}, {"style", "no such"}}).status, 404);
  EXPECT_EQ(Call("PATCH", "/api/state", {{"seed", 7}, {"path", "/etc"}}).status, 400);
  EXPECT_EQ(Call("PATCH", "/api/state", {{"keys", {{"transfer.levels", 99}}}}).status, 400);
  EXPECT_EQ(Call("PATCH", "/api/state", {{"keys", {{"transfer.paper", "/etc/passwd"}}}}).status, 400);
  EXPECT_EQ(Call("PATCH", "/api/state", json::array()).status, 400);
  EXPECT_EQ(State(), before);
  EXPECT_EQ(Call("PATCH", "/api/state", {{"seed", 7}, {"keys", {{"transfer.levels", 5}}}}).status, 200);
  EXPECT_EQ(State()["seed"], 7);
  EXPECT_EQ(State()["keys"], json({{"transfer.levels", 5}}));
  EXPECT_EQ(Call("PATCH", "/api/state", {{"keys", {{"transfer.levels", nullptr}}}}).status, 200);
  EXPECT_EQ(State()["keys"], json::object());
  EXPECT_EQ(Call("GET", "/api/nothing").status, 404);
}

TEST_F(SessionTest, FinalsAreWhatTheCommandMakes) {
  ASSERT_EQ(Call("PATCH", "/api/state",
                 {{"view", {{"azimuth", 33.25}, {"elevation", -10}, {"right", 0.1}, {"up", 0.05}}},
                  {"keys", {{"transfer.threshold", 0.3}}},
                  {"assignments", json::array({{{"name", State()["objects"][0]}, {"style", "ink"}}})},
                  {"light", {{"azimuth", 20}, {"elevation", 30}}}})
                .status,
            200);
  const HttpResponse exported = Call("POST", "/api/export", {{"what", "picture"}, {"format", "png"}});
  ASSERT_EQ(exported.status, 200) << exported.body;
  std::string command = json::parse(Call("POST", "/api/export", {{"what", "command"}}).body)["command"];
  const std::string file = (folder / "cli.png").string();
  command.replace(0, std::string("scumble").size(), SCUMBLE_BINARY);
  command.replace(command.find("picture.png"), std::string("picture.png").size(), file);
  ASSERT_EQ(std::system((command + " --quiet > /dev/null").c_str()), 0) << command;
  EXPECT_EQ(exported.body, TextOf(file));
  EXPECT_EQ(PictureOf(Frame().body).rgba, ReadPicture(file)->rgba);
}

TEST_F(SessionTest, AKnownPictureIsNotSentAgain) {
  const HttpResponse first = Frame();
  ASSERT_EQ(first.status, 200) << first.body;
  HttpRequest request{"GET", "/api/frame", {{"quality", "final"}, {"format", "png"}}, "", first.headers[0].second, ""};
  EXPECT_EQ(session->Handle(request).status, 304);
  ASSERT_EQ(Call("PATCH", "/api/state", {{"seed", 3}}).status, 200);
  EXPECT_EQ(session->Handle(request).status, 200);
  const HttpResponse draft = Frame("jpeg", "draft");
  EXPECT_EQ(draft.status, 200) << draft.body;
  EXPECT_EQ(draft.content_type, "image/jpeg");
  EXPECT_EQ(Frame("gif").status, 400);
  EXPECT_EQ(Frame("rgba").body.size(), std::size_t(kWidth) * kHeight * 4);
}

TEST_F(SessionTest, PicksAndMasksAreTheSourceFields) {
  Workspace workspace(context);
  PictureRequest picture;
  picture.keep_field = true;
  StyleRequest style;
  style.style = (folder / "mine").string();
  const auto painted = workspace.Paint(options.scene, style, picture);
  ASSERT_TRUE(painted.ok()) << painted.error().message;
  const SourceField& field = *painted->field;
  const int x = kWidth / 2, y = kHeight / 2;
  const std::size_t at = std::size_t(y) * kWidth + x;
  const json pick =
      json::parse(Call("GET", "/api/pick", nullptr, {{"x", std::to_string(x)}, {"y", std::to_string(y)}}).body);
  ASSERT_TRUE(pick["covered"]);
  EXPECT_EQ(pick["level"], int(field.level[at]));
  const double scale = 64.0 / painted->field_styles[0].width;
  EXPECT_NEAR(pick["source"][0], (field.x[at] + 0.5) * scale, 1e-9);
  EXPECT_NEAR(pick["source"][1], (field.y[at] + 0.5) * scale, 1e-9);

  const Picture chunk =
      PictureOf(Call("GET", "/api/chunk", nullptr, {{"x", std::to_string(x)}, {"y", std::to_string(y)}}).body);
  std::size_t area = 0;
  for (std::size_t i = 0; i < chunk.rgba.size() / 4; ++i) {
    if (chunk.rgba[4 * i + 3] == 0) continue;
    ++area;
    EXPECT_EQ(field.x[i] - field.x[at], int(i % kWidth) - x);
    EXPECT_EQ(field.y[i] - field.y[at], int(i / kWidth) - y);
  }
  EXPECT_EQ(pick["chunk"]["area"], area);
  EXPECT_GT(chunk.At(x, y)[3], 0);

  const Picture fed = PictureOf(Call("GET", "/api/fed", nullptr, {{"x", "30"}, {"y", "34"}, {"radius", "6"}}).body);
  for (std::size_t i = 0; i < field.x.size(); ++i) {
    const bool inside =
        field.level[i] >= 0 && std::hypot((field.x[i] + 0.5) * scale - 30, (field.y[i] + 0.5) * scale - 34) <= 6.0;
    ASSERT_EQ(fed.rgba[4 * i + 3] > 0, inside) << i;
  }
  EXPECT_EQ(Call("GET", "/api/pick", nullptr, {{"x", "1"}}).status, 400);
  const HttpResponse outside = Call("GET", "/api/pick", nullptr, {{"x", "-5"}, {"y", "99999"}});
  EXPECT_FALSE(json::parse(outside.body)["covered"]);
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

}  // namespace
}  // namespace scumble
