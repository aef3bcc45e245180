// Runs the program as its users do: with arguments, in a folder of its own, and checks its results.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "core/image/hash.h"
#include "core/io/guide_file.h"
#include "core/io/picture_file.h"
#include "tests/support/temporary_folder.h"

namespace scumble {

struct CommandResult {
  int code = -1;  // exit code; 128 + the signal's number where one ended the program
  std::string out;
  std::string err;

  // What stands behind "scumble: error: ". Libraries below may have talked before it.
  std::string Error() const { return LineBehind("scumble: error: "); }
  std::string Warning() const { return LineBehind("scumble: warning: "); }
  // Null where the whole of stdout is not one JSON value.
  nlohmann::json Json() const {
    nlohmann::json json = nlohmann::json::parse(out, nullptr, false);
    return json.is_discarded() ? nlohmann::json() : json;
  }

 private:
  std::string LineBehind(const std::string& start) const {
    for (std::size_t begin = 0; begin < err.size();) {
      const std::size_t end = std::min(err.find('\n', begin), err.size());
      if (err.compare(begin, start.size(), start) == 0) {
        return err.substr(begin + start.size(), end - begin - start.size());
      }
      begin = end + 1;
    }
    return {};
  }
};

// What differs from a plain run.
struct CommandSettings {
  std::string stdout_file;  // instead of being captured, standard output goes there
  bool close_stdout = false;
  long file_size_limit = 0;  // bytes that a file may grow to, as on a full disk; 0: no limit
  std::string program = SCUMBLE_BINARY;
  unsigned patience_seconds = 60;  // then the program is taken to hang
};

class CliTest : public testing::Test {
 protected:
  using Arguments = std::vector<std::string>;

  CliTest() {
    std::filesystem::create_directory(Work());
    ::setenv("XDG_CACHE_HOME", Cache().c_str(), 1);  // commands leave nothing in the user's own
  }

  std::filesystem::path Cache() const { return folder_ / "cache"; }

  // The folder that commands run in; what they print is kept outside it.
  std::filesystem::path Work() const { return folder_ / "work"; }
  std::filesystem::path At(const std::string& name) const { return Work() / name; }

  // Copies the program to a folder, its module of formats beside it, and gives what runs the copy.
  CommandSettings CopyProgram(const std::string& folder) {
    namespace fs = std::filesystem;
    const fs::path program = SCUMBLE_BINARY, module = "libscumble_formats.so";
    fs::create_directories(At(folder));
    fs::copy_file(program, At(folder) / "scumble");
    fs::create_symlink(program.parent_path() / module, At(folder) / module);
    CommandSettings settings;
    settings.program = (At(folder) / "scumble").string();
    return settings;
  }

  CommandResult Run(const Arguments& arguments, const CommandSettings& settings = {}) {
    return Finish(Start(arguments, settings), settings);
  }

  // Starts it; Finish, with the same settings, waits for its end.
  pid_t Start(const Arguments& arguments, const CommandSettings& settings = {}) {
    const std::string out = OutputFile(settings);
    const std::string err = ErrorFile(), work = Work().string();
    std::vector<char*> argv{const_cast<char*>(settings.program.c_str())};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    const pid_t child = ::fork();
    if (child == 0) Become(argv, out, err, work, settings);
    return child;
  }
  CommandResult Finish(pid_t child, const CommandSettings& settings = {}) {
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    CommandResult result;
    result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    if (settings.stdout_file.empty() && !settings.close_stdout) result.out = ReadAll(OutputFile(settings));
    result.err = ReadAll(ErrorFile());
    return result;
  }

  static bool Contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }

  // Runs, expects success, and returns the result.
  CommandResult RunOk(const Arguments& arguments) {
    CommandResult result = Run(arguments);
    EXPECT_EQ(result.code, 0) << Joined(arguments) << "\n" << result.err;
    return result;
  }

  // Expects the exit code, nothing on stdout, and an error whose first line holds all of `parts`.
  CommandResult ExpectError(const Arguments& arguments, int code, const std::vector<std::string>& parts,
                            const CommandSettings& settings = {}) {
    CommandResult result = Run(arguments, settings);
    const std::string error = result.Error();
    EXPECT_EQ(result.code, code) << Joined(arguments) << "\n" << result.err;
    EXPECT_EQ(result.out, "") << Joined(arguments);
    EXPECT_NE(error, "") << Joined(arguments) << "\n" << result.err;
    for (const std::string& part : parts) {
      EXPECT_NE(error.find(part), std::string::npos) << Joined(arguments) << "\nlacks '" << part << "': " << error;
    }
    return result;
  }

  void WriteText(const std::string& name, const std::string& text) {
    std::filesystem::create_directories(At(name).parent_path());
    std::ofstream stream(At(name), std::ios::binary);
    stream << text;
    ASSERT_TRUE(stream.flush()) << name;
  }

  std::string Bytes(const std::string& name) const { return ReadAll(At(name).string()); }
  // The pixels of a picture or a guide file, without the header's record of how it was made.
  std::string Pixels(const std::string& name) const {
    const Expected<Picture> picture = ReadPicture(At(name));
    EXPECT_TRUE(picture.ok()) << name << (picture.ok() ? "" : ": " + picture.error().message);
    if (!picture.ok()) return {};
    return std::to_string(picture->width) + BytesOf(picture->rgba);
  }
  std::string Layers(const std::string& name) const {
    const Expected<GuideSet> guides = ReadGuides(At(name), {});
    EXPECT_TRUE(guides.ok()) << name << (guides.ok() ? "" : ": " + guides.error().message);
    if (!guides.ok()) return {};
    std::string all = guides->layers().ToString();
    for (const LayerInfo& info : AllLayers()) {
      for (std::size_t c = 0; guides->Has(info.layer) && c < info.channels.size(); ++c) {
        all += BytesOf(guides->Plane(info.layer, static_cast<int>(c)));
      }
    }
    return all;
  }
  template <class Values>
  static std::string BytesOf(const Values& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0])};
  }
  bool Exists(const std::string& name) const { return std::filesystem::exists(At(name)); }

  // A picture that fits no other one by chance: shaded like a lit sphere, with strokes all over it.
  static Picture Painted(int width, int height) {
    Picture picture(width, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        std::uint16_t* pixel = picture.At(x, y);
        const int shade = 20000 + 30000 * (width - x + height - y) / (width + height);
        for (int c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint16_t>(shade + Hash(x / 3, y / 2, c) % 12000);
        pixel[3] = 65535;
      }
    }
    return picture;
  }
  void WritePainted(const std::string& name, int width, int height) {
    std::filesystem::create_directories(At(name).parent_path());
    const Status written = WritePicture(At(name), Painted(width, height));
    ASSERT_TRUE(written) << written.error().message;
  }

  // A style folder whose lengths are plain pixels, so that small pictures show chunks and votes too.
  void WriteStyle(const std::string& folder) {
    WritePainted(folder + "/lit.png", 64, 64);
    WriteText(folder + "/style.toml",
              "name = \"test\"\n[transfer]\nreference_height = 0\nlevels = 4\n[[exemplar]]\nimage = \"lit.png\"\n");
  }

  // The guides of a sphere that touches the picture's sides, made without any renderer.
  static GuideSet Ball(int size) {
    GuideSet guides(size, size);
    for (const LayerInfo& info : AllLayers()) {
      if (AlwaysWritten().Has(info.layer)) guides.Add(info.layer);
    }
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const float u = (2.0f * x + 1.0f) / size - 1.0f, v = 1.0f - (2.0f * y + 1.0f) / size, r2 = u * u + v * v;
        if (r2 >= 1.0f) continue;
        const std::size_t i = guides.Index(x, y);
        const float w = std::sqrt(1.0f - r2);
        guides.Plane(Layer::kCoverage)[i] = 1.0f;
        guides.Plane(Layer::kNormal, 0)[i] = u;
        guides.Plane(Layer::kNormal, 1)[i] = v;
        guides.Plane(Layer::kNormal, 2)[i] = w;
        guides.Plane(Layer::kDepth)[i] = 2.0f - w;
        guides.Plane(Layer::kObject)[i] = guides.Plane(Layer::kMaterial)[i] = 1.0f;
      }
    }
    return guides;
  }
  void WriteGuideFile(const std::string& name, const GuideSet& guides) {
    const Status written = WriteGuides(At(name), guides);
    ASSERT_TRUE(written) << written.error().message;
  }

  static std::string Scene(const std::string& name) { return std::string(SCUMBLE_SOURCE_DIR) + "/scenes/" + name; }

  // One triangle, facing +Z, two metres wide, and a camera that looks at it, or away from it.
  static std::string TriangleGltf(bool looks_away) {
    const std::string turn = looks_away ? R"("rotation":[0,1,0,0],)" : "";
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
"nodes":[{"name":"Sheet","mesh":0},{"name":"Front","camera":0,)" +
           turn +
           R"("translation":[0,0,4]}],
"cameras":[{"type":"perspective","perspective":{"yfov":0.7,"znear":0.1}}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[-1,-1,0],"max":[1,1,0]}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,)"
           R"(AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAAAAAAAAgD8AAAAA"}]})";
  }
  static std::string TriangleObj() { return "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n"; }
  static std::string TrianglePly() {
    return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 1\nproperty list uchar int vertex_indices\nend_header\n-1 -1 0\n1 -1 0\n0 1 0\n3 0 1 2\n";
  }

  static std::string Joined(const Arguments& arguments) {
    std::string text = "scumble";
    for (const std::string& argument : arguments) text += " " + argument;
    return text;
  }
  static Arguments With(Arguments arguments, const Arguments& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  static std::string ReadAll(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

 private:
  std::string OutputFile(const CommandSettings& settings) const {
    return settings.stdout_file.empty() ? (folder_ / "stdout").string() : settings.stdout_file;
  }
  std::string ErrorFile() const { return (folder_ / "stderr").string(); }

  // In the child: only calls that are safe between fork and exec.
  [[noreturn]] static void Become(const std::vector<char*>& argv, const std::string& out, const std::string& err,
                                  const std::string& work, const CommandSettings& settings) {
    ::alarm(SCUMBLE_TESTS_SLOWER * settings.patience_seconds);
    const int in_file = ::open("/dev/null", O_RDONLY);
    const int out_file = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    const int err_file = ::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (in_file < 0 || out_file < 0 || err_file < 0 || ::chdir(work.c_str()) != 0) ::_exit(125);
    ::dup2(in_file, 0), ::dup2(out_file, 1), ::dup2(err_file, 2);
    for (const int file : {in_file, out_file, err_file}) {
      if (file > 2) ::close(file);
    }
    if (settings.close_stdout) ::close(1);
    if (settings.file_size_limit > 0) {
      const rlimit limit{static_cast<rlim_t>(settings.file_size_limit), static_cast<rlim_t>(settings.file_size_limit)};
      ::setrlimit(RLIMIT_FSIZE, &limit);
      std::signal(SIGXFSZ, SIG_IGN);  // the write fails with an error number, as on a full disk
    }
    ::execv(argv.front(), argv.data());
    ::_exit(126);
  }

  TemporaryFolder folder_;
};

}  // namespace scumble
