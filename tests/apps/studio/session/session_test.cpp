// The calls of apps/studio/api.md without sockets: the state, and pictures of it.
#include <cmath>
#include <cstdlib>

#include "apps/studio/session/state.h"
#include "pipeline/workspace.h"
#include "tests/apps/studio/session/session_fixture.h"
#include "transfer/source_field.h"

namespace scumble {
namespace {

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
                  {"light", {{"azimuth", 20}, {"elevation", 30}}},
                  {"finish", {{"name", "comic"}, {"lines", 0.8}}}})
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

TEST_F(SessionTest, AViewWinsOverTheCamera) {
  const std::string camera = State()["cameras"][0];
  ASSERT_EQ(Call("PATCH", "/api/state", {{"camera", camera}}).status, 200);
  const std::string before = Frame().body;
  ASSERT_EQ(Call("PATCH", "/api/state", {{"view", {{"azimuth", 70}, {"elevation", 10}}}}).status, 200);
  const HttpResponse orbited = Frame();
  ASSERT_EQ(orbited.status, 200) << orbited.body;
  EXPECT_NE(orbited.body, before);
  EXPECT_EQ(Frame("jpeg", "draft").status, 200);
  const std::string command = json::parse(Call("POST", "/api/export", {{"what", "command"}}).body)["command"];
  EXPECT_EQ(command.find("--camera"), command.npos) << command;
  ASSERT_EQ(Call("PATCH", "/api/state", {{"view", nullptr}}).status, 200);
  EXPECT_EQ(State()["camera"], camera);
  EXPECT_EQ(PictureOf(Frame().body).rgba, PictureOf(before).rgba);
}

// A later --set without a style's name would win over the style's own.
TEST_F(SessionTest, WhatABudgetChoseStandsBeforeTheKeys) {
  PictureJob job;
  job.style.style = "oil", job.style.sets = *ParseStyleOverrides({"oil:transfer.blend_radius=64"});
  const std::string command = CommandOf(job, {"--set", "transfer.blend_radius=0"});
  EXPECT_LT(command.find(" transfer.blend_radius=0"), command.find("oil:transfer.blend_radius=64")) << command;
}

TEST_F(SessionTest, FinishIsChosenAndItsDialsAreTurned) {
  const std::string before = Frame().body;
  bool is_listed = false;
  const json finishes = State()["finishes"];
  for (const json& finish : finishes) is_listed = is_listed || finish["name"] == "comic";
  EXPECT_TRUE(is_listed);
  EXPECT_EQ(State()["finish"], nullptr);
  ASSERT_EQ(Call("PATCH", "/api/state", {{"finish", {{"name", "outline"}}}}).status, 200);
  EXPECT_EQ(State()["finish"],
            json({{"name", "outline"}, {"lines", 0.5}, {"detail", 0.5}, {"light", 0.5}, {"depth", 0.5}}));
  const std::string lines = Frame().body;
  EXPECT_NE(lines, before);
  ASSERT_EQ(Call("PATCH", "/api/state", {{"finish", {{"name", "outline"}, {"lines", 0}}}}).status, 200);
  EXPECT_EQ(PictureOf(Frame().body).rgba, PictureOf(before).rgba);
  EXPECT_EQ(Call("PATCH", "/api/state", {{"finish", {{"name", "no such"}}}}).status, 404);
  EXPECT_EQ(Call("PATCH", "/api/state", {{"finish", "outline"}}).status, 400);
  EXPECT_EQ(Call("PATCH", "/api/state", {{"finish", {{"name", "outline"}, {"lines", 2}}}}).status, 400);
  ASSERT_EQ(Call("PATCH", "/api/state", {{"finish", nullptr}}).status, 200);
  EXPECT_EQ(State()["finish"], nullptr);
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

TEST_F(SessionTest, DraftsAreHalfAsLarge) {
  const auto size_of = [](const HttpResponse& answer) -> std::string {
    for (const auto& [name, value] : answer.headers) {
      if (name == "X-Scumble-Size") return value;
    }
    return "none";
  };
  EXPECT_EQ(size_of(Frame()), "96x54");
  EXPECT_EQ(size_of(Frame("jpeg", "draft")), "48x27");
}

TEST_F(SessionTest, ShowPicturesAreTheProgramsOwn) {
  for (const std::string& show : ExplanationNames()) {
    Workspace workspace(context);
    PictureRequest picture;
    picture.show = FindExplanation(show);
    StyleRequest style;
    style.style = (folder / "mine").string();
    const auto painted = workspace.Paint(options.scene, style, picture);
    const HttpResponse shown =
        Call("GET", "/api/frame", nullptr, {{"quality", "final"}, {"format", "png"}, {"show", show}});
    ASSERT_EQ(painted.ok(), shown.status == 200) << show << shown.body;
    if (!painted) continue;
    EXPECT_TRUE(In8Bits(PictureOf(shown.body)) == In8Bits(painted->picture)) << show;
  }
  EXPECT_EQ(Call("GET", "/api/frame", nullptr, {{"show", "nothing"}}).status, 400);
}

TEST_F(SessionTest, AnAnimationBeginsAtItsFirstFrame) {
  EXPECT_EQ(State()["frame"], nullptr) << "nothing moves";
  ASSERT_EQ(Call("PATCH", "/api/state", {{"scene", "toys"}}).status, 200);
  EXPECT_EQ(State()["frame"], 0);
  const std::string command = json::parse(Call("POST", "/api/export", {{"what", "command"}}).body)["command"];
  EXPECT_NE(command.find("--frame 0"), command.npos) << command;
  const std::string begun = Frame().body;
  ASSERT_EQ(Call("PATCH", "/api/state", {{"frame", 0}}).status, 200);
  EXPECT_EQ(Frame().body, begun);
}

TEST_F(SessionTest, AFrameOfAnAnimationIsTheCommandLines) {
  ASSERT_EQ(Call("PATCH", "/api/state", {{"scene", "toys"}, {"frame", 13}}).status, 200) << State();
  const HttpResponse exported = Call("POST", "/api/export", {{"what", "picture"}, {"format", "png"}});
  ASSERT_EQ(exported.status, 200) << exported.body;
  Workspace workspace(context);
  SceneRequest scene = options.scene;
  scene.scene = kSource + "/scenes/toys.glb";
  PictureRequest picture;
  picture.frame = 13;
  StyleRequest style;
  style.style = (folder / "mine").string();
  const auto painted = workspace.Paint(scene, style, picture);
  ASSERT_TRUE(painted.ok()) << painted.error().message;
  EXPECT_TRUE(In8Bits(PictureOf(exported.body)) == In8Bits(painted->picture));
  EXPECT_EQ(State()["animation"]["first"], 0);
}

TEST_F(SessionTest, AnUnknownCameraIsToldAndTheNextIsSeen) {
  ASSERT_EQ(Call("PATCH", "/api/state", {{"camera", "no such"}}).status, 200);
  const HttpResponse none = Frame();
  EXPECT_EQ(none.status, 422);
  EXPECT_NE(none.body.find("no such"), none.body.npos) << none.body;
  ASSERT_EQ(Call("PATCH", "/api/state", {{"camera", nullptr}}).status, 200);
  EXPECT_EQ(Frame().status, 200);
}

// The same settings, another painting: what a browser kept of the run before is old.
TEST_F(SessionTest, AnotherRunHasOtherTags) {
  const auto tag_of = [](const HttpResponse& answer) { return answer.headers.at(0).second; };
  const std::string first = tag_of(Frame());
  ASSERT_TRUE(WritePicture(painting, Ball(1000)).ok());
  Open(options.styles);
  EXPECT_NE(tag_of(Frame()), first);
}

TEST_F(SessionTest, NamesWithSignsOfTheCommandLineStayNames) {
  const fs::path style = folder / "d=Öl:bild";
  fs::copy(folder / "mine", style, fs::copy_options::recursive);
  Open({style.string()});
  ASSERT_EQ(Call("PATCH", "/api/state",
                 {{"keys", {{"transfer.threshold", 0.4}}},
                  {"assignments", json::array({{{"name", "no such"}, {"style", "ink"}}})}})
                .status,
            200);
  const HttpResponse painted = Frame();
  EXPECT_EQ(painted.status, 200) << painted.body;
}

}  // namespace
}  // namespace scumble
