// Every kind of light over diffuse, glossy and textured surfaces, and other difficult light paths, against Cycles:
// `scumble crosscheck` on the scenes of tests/blender/matrix/make_matrix.py, by its built-in limits.
#include <cstdlib>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

class CyclesMatrixTest : public CliTest {
 protected:
  using Setup = std::tuple<std::string, int, int>;  // size, samples, bounces

  // The scenes by what makes them one run.
  std::map<Setup, std::vector<std::string>> Make(const std::string& only = "") {
    const std::string log = At("log").string();
    const std::string command = std::string("blender -b -noaudio --factory-startup -P ") + SCUMBLE_SOURCE_DIR +
                                "/tests/blender/matrix/make_matrix.py -- --output " + Work().string() +
                                (only.empty() ? "" : " --only " + only) + " > " + log + " 2>&1";
    EXPECT_EQ(std::system(command.c_str()), 0) << Bytes("log");
    matrix_ = nlohmann::json::parse(std::ifstream(At("matrix.json")), nullptr, false);
    std::map<Setup, std::vector<std::string>> runs;
    if (!matrix_.is_object()) return runs;
    for (const auto& [name, scene] : matrix_.items()) {
      runs[{scene["size"].get<std::string>(), scene["samples"].get<int>(), scene["bounces"].get<int>()}].push_back(
          name);
    }
    return runs;
  }

  // The one of that layer; null where there is none.
  static nlohmann::json OfLayer(const nlohmann::json& list, const std::string& layer) {
    for (const nlohmann::json& item : list) {
      if (item["layer"] == layer) return item;
    }
    return {};
  }

  void ExpectAgrees(const std::string& name, const nlohmann::json& report) const {
    SCOPED_TRACE(name);
    EXPECT_TRUE(report["passed"].get<bool>()) << report.dump(1);
    EXPECT_GT(report["compared"].get<int>(), 1000);
    EXPECT_EQ(report["skipped"].size(), 0u) << report["skipped"];
    // A scene whose light never arrives would agree with everything.
    for (const nlohmann::json& layer : matrix_[name]["layers"]) {
      const nlohmann::json noise = OfLayer(report["noise"], "lpe." + layer.get<std::string>());
      ASSERT_TRUE(noise.is_object()) << layer;
      EXPECT_FALSE(noise["no_such_light"].get<bool>()) << layer;
    }
    // Only Principled surfaces are not compared as authored.
    EXPECT_EQ(report["warnings"].size(), name == "principled" ? 1u : 0u) << report["warnings"];
    EXPECT_EQ(report["unsupported"].size(), 0u) << report["unsupported"];
  }

  static double Figure(const nlohmann::json& report, const std::string& layer, const std::string& name) {
    for (const nlohmann::json& figure : report["figures"]) {
      if (figure["layer"] == layer && figure["name"] == name) return figure["value"];
    }
    ADD_FAILURE() << "no figure " << layer << " " << name << "\n" << report.dump(1);
    return 1e9;
  }

  nlohmann::json matrix_;
};

TEST_F(CyclesMatrixTest, EverySceneAgrees) {
  const auto runs = Make();
  ASSERT_FALSE(runs.empty()) << "make_matrix.py wrote no matrix.json";
  for (const auto& [setup, names] : runs) {
    const auto& [size, samples, bounces] = setup;
    // Minutes: longer than the harness lets a command run.
    std::string command = "cd " + Work().string() + " && " SCUMBLE_BINARY " crosscheck --json --quiet --size " + size +
                          " --samples " + std::to_string(samples) + " --max-bounces " + std::to_string(bounces);
    for (const std::string& name : names) command += " " + name + ".blend";
    EXPECT_EQ(std::system((command + " > reports.json 2> message").c_str()), 0) << Bytes("message");
    const nlohmann::json reports = nlohmann::json::parse(std::ifstream(At("reports.json")), nullptr, false);
    ASSERT_EQ(reports.size(), names.size()) << Bytes("message");
    for (std::size_t i = 0; i < names.size(); ++i) ExpectAgrees(names[i], reports[i]);
  }
}

// The straight pieces of ribbons are cut into triangles by Embree, so that ours differ by a little everywhere; at the
// rims of round hair, floats of two spaces choose between this strand and the next.
TEST_F(CyclesMatrixTest, HairAgrees) {
  Make("hair,hair_round");
  for (const std::string name : {"hair", "hair_round"}) {
    SCOPED_TRACE(name);
    const std::string command = "cd " + Work().string() +
                                " && " SCUMBLE_BINARY " crosscheck --json --quiet --size 160x90 --samples 16 " + name +
                                ".blend > reports.json 2> message";
    std::system(command.c_str());  // 1: outside the built-in limits
    nlohmann::json report = nlohmann::json::parse(std::ifstream(At("reports.json")), nullptr, false);
    if (report.is_array()) report = report.at(0);
    ASSERT_TRUE(report.is_object()) << Bytes("message");
    EXPECT_GT(report["compared"].get<int>(), 5000);
    EXPECT_EQ(report["warnings"].size() + report["unsupported"].size(), 0u) << report.dump(1);
    EXPECT_EQ(Figure(report, "A", "differing"), 0.0);
    EXPECT_EQ(Figure(report, "object", "differing"), 0.0);
    EXPECT_LT(Figure(report, "normal", "99% within"), name == "hair" ? 0.3 : 0.01);
    // A strand's radius is 0.01 of its depth. At ties Cycles itself takes one strand or the other from run to run.
    EXPECT_LT(Figure(report, "depth", "99.9% within"), 2e-3);
    EXPECT_LT(Figure(report, "albedo", "mean difference"), 0.002);
    EXPECT_LT(Figure(report, "lpe.LDE", "mean difference"), 0.5);
  }
}

}  // namespace
}  // namespace scumble
