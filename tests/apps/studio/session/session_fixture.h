// A session without sockets, on a small style of its own, and what its tests share.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "apps/studio/session/session.h"
#include "core/io/picture_file.h"
#include "tests/support/temporary_folder.h"

namespace scumble {

namespace fs = std::filesystem;
using nlohmann::json;

inline const std::string kSource = SCUMBLE_SOURCE_DIR;
inline constexpr int kWidth = 96, kHeight = 54;

inline std::string TextOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void Write(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

inline Picture PictureOf(const std::string& bytes) {
  const auto picture = DecodePicture(std::as_bytes(std::span(bytes)), "answer");
  EXPECT_TRUE(picture.ok());
  return picture ? *picture : Picture();
}

inline std::string PngOf(const Picture& picture) {
  const auto bytes = EncodePng(picture);
  return {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
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

  void Open(const std::vector<std::string>& styles, const fs::path& scene = kSource + "/scenes/ball.glb") {
    session.reset();
    options.scene.scene = scene.string(), options.scene.size = {kWidth, kHeight};
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

  // Whether it holds within 20 seconds.
  bool Comes(const std::function<bool()>& holds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20 * SCUMBLE_TESTS_SLOWER);
    while (!holds()) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return true;
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

}  // namespace scumble
