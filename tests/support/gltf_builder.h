// Builds small glTF files for the tests of the loaders.
#pragma once

#include <gmock/gmock.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "guidegen/load_scene.h"
#include "tests/support/temporary_folder.h"

namespace scumble {

// A folder of its own for every test, removed behind it.
class LoaderTest : public ::testing::Test {
 protected:
  std::filesystem::path Path(const std::string& name) const { return folder_ / name; }

  std::filesystem::path Write(const std::string& name, std::span<const unsigned char> bytes) const {
    std::ofstream stream(Path(name), std::ios::binary);
    stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return Path(name);
  }
  std::filesystem::path Write(const std::string& name, const std::string& text) const {
    return Write(name, std::span(reinterpret_cast<const unsigned char*>(text.data()), text.size()));
  }

 private:
  TemporaryFolder folder_;
};

constexpr int kByte = 5120, kUbyte = 5121, kShort = 5122, kUshort = 5123, kUint = 5125, kFloat = 5126;

// `json` is open to be changed at will before the file is written.
struct GltfBuilder {
  nlohmann::json json = {
      {"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", nlohmann::json::array()}}}}};
  std::vector<unsigned char> bin;

  template <class T>
  int View(const std::vector<T>& values, int stride = 0) {
    while (bin.size() % 4 != 0) bin.push_back(0);
    const std::size_t offset = bin.size(), bytes = values.size() * sizeof(T);
    bin.resize(offset + bytes);
    if (bytes > 0) std::memcpy(bin.data() + offset, values.data(), bytes);
    nlohmann::json view = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}};
    if (stride > 0) view["byteStride"] = stride;
    return Append("bufferViews", view);
  }

  int Append(const std::string& list, const nlohmann::json& item) {
    json[list].push_back(item);
    return static_cast<int>(json[list].size()) - 1;
  }

  int Accessor(int view, int component_type, std::size_t count, const std::string& type, std::size_t offset = 0) {
    return Append("accessors", {{"bufferView", view},
                                {"byteOffset", offset},
                                {"componentType", component_type},
                                {"count", count},
                                {"type", type}});
  }

  int Floats(const std::vector<float>& values, int components) {
    const char* types[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    return Accessor(View(values), kFloat, values.size() / std::size_t(components), types[components]);
  }
  int Indices(const std::vector<std::uint16_t>& values) {
    return Accessor(View(values), kUshort, values.size(), "SCALAR");
  }

  // Column by column, 16 numbers each.
  int Matrices(const std::vector<float>& values) { return Accessor(View(values), kFloat, values.size() / 16, "MAT4"); }

  // Adds a channel to animation 0, which is made if there is none. `path` is "translation", "weights", …
  void Animate(int node, const std::string& path, const std::vector<float>& times, const std::vector<float>& values,
               const std::string& interpolation = "LINEAR") {
    if (!json.contains("animations")) {
      Append("animations", {{"channels", nlohmann::json::array()}, {"samplers", nlohmann::json::array()}});
    }
    const int components = path == "rotation" ? 4 : path == "weights" ? 1 : 3;
    const int input = Floats(times, 1), output = Floats(values, components);
    nlohmann::json& animation = json["animations"][0];
    animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
  }

  int Mesh(const nlohmann::json& primitives) { return Append("meshes", {{"primitives", primitives}}); }

  // A node at the root of the first scene.
  int Root(const nlohmann::json& node) {
    const int index = Append("nodes", node);
    json["scenes"][0]["nodes"].push_back(index);
    return index;
  }

  // A unit right triangle in the plane z = 0, facing +Z, and a node that shows it.
  int Triangle(const std::string& node_name = "Tri") {
    const int position = Floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
    const int index = Indices({0, 1, 2});
    const int mesh = Mesh({{{"attributes", {{"POSITION", position}}}, {"indices", index}}});
    return Root({{"name", node_name}, {"mesh", mesh}});
  }

  std::vector<unsigned char> Glb() const {
    nlohmann::json with_buffer = json;
    std::vector<unsigned char> data = bin;
    while (data.size() % 4 != 0) data.push_back(0);
    if (!data.empty()) with_buffer["buffers"] = {{{"byteLength", data.size()}}};
    std::string text = with_buffer.dump();
    while (text.size() % 4 != 0) text.push_back(' ');
    std::vector<unsigned char> glb;
    const auto put = [&](std::uint32_t value) {
      for (int i = 0; i < 4; ++i) glb.push_back(static_cast<unsigned char>(value >> (8 * i)));
    };
    put(0x46546C67);
    put(2);
    put(static_cast<std::uint32_t>(20 + text.size() + (data.empty() ? 0 : 8 + data.size())));
    put(static_cast<std::uint32_t>(text.size()));
    put(0x4E4F534A);
    glb.insert(glb.end(), text.begin(), text.end());
    if (data.empty()) return glb;
    put(static_cast<std::uint32_t>(data.size()));
    put(0x004E4942);
    glb.insert(glb.end(), data.begin(), data.end());
    return glb;
  }
};

// For scene files that must be refused.
class RefusedScenes : public LoaderTest {
 protected:
  // The error, which names the file and is no longer than a screen.
  std::string Refusal(const std::filesystem::path& path) {
    const Expected<Scene> scene = LoadScene(path);
    EXPECT_FALSE(scene.ok());
    if (scene) return "";
    EXPECT_EQ(scene.error().kind, ErrorKind::kInput);
    EXPECT_THAT(scene.error().message, ::testing::HasSubstr(path.filename().string()));
    EXPECT_LT(scene.error().message.size(), 1000u);
    return scene.error().message;
  }
  std::string Refusal(const GltfBuilder& builder) { return Refusal(Write("scene.glb", builder.Glb())); }
};

}  // namespace scumble
