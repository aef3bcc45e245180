// The accuracy of `scumble sphere --rectify` against truth: scans with a known camera over tilt and noise,
// blur and size, as the tables of docs/scanning.md.
//
//   rectify_bench [FOLDER]     keeps the scans and their truth in FOLDER, to test other programs
//
// Each cell is the worst of three scans, turned differently: true error / reported error, in % of the sphere's
// diameter; in brackets how many marks were found, where it is not all; a dash where a scan is refused.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/style/rectify.h"
#include "tests/support/scan_fixtures.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

struct Keeper {
  fs::path folder;
  int count = 0;

  void Keep(const Picture& picture, const Scan& scan) {
    if (folder.empty()) return;
    const std::string name = std::to_string(1000 + count++);
    if (!WritePicture(folder / (name + ".png"), picture)) std::exit(4);
    std::ofstream truth(folder / (name + ".txt"));
    const ScanCamera camera(scan);
    truth << camera.SpherePixels() << "\n";
    for (int i = 0; i <= 20; ++i) {
      for (int j = 0; j <= 20; ++j) {
        const glm::dvec2 at(i / 20.0, j / 20.0), p = camera.ToPicture(at);
        if (glm::length(at - 0.5) <= 0.5) truth << at.x << " " << at.y << " " << p.x << " " << p.y << "\n";
      }
    }
  }
};

void Cell(Scan scan, Keeper& keeper) {
  double error = 0, reported = 0;
  std::size_t marks = kFiducialCount;
  bool refused = false;
  for (int k = 0; k < 3; ++k) {
    scan.rotation = 20 + 115 * k, scan.towards = 50 * k, scan.seed = k;
    const Picture picture = TakeScan(CharcoalSheet(), scan);
    keeper.Keep(picture, scan);
    RectifyOptions options;
    options.size = 16;
    const auto done = RectifyScan(picture, "scan", options);
    if (!done) {
      refused = true;
      std::fprintf(stderr, "%s\n", done.error().message.c_str());
      continue;
    }
    error = std::max(error, TrueError(done->map, scan)), reported = std::max(reported, done->report.error);
    marks = std::min(marks, done->report.found.size());
  }
  if (refused)
    std::printf(" – |");
  else if (marks < std::size_t(kFiducialCount))
    std::printf(" %.3f / %.3f (%zu) |", 100 * error, 100 * reported, marks);
  else
    std::printf(" %.3f / %.3f |", 100 * error, 100 * reported);
  std::fflush(stdout);
}

void Run(Keeper keeper) {
  Scan usual;
  usual.width = 1000, usual.height = 800, usual.fill = 0.62, usual.blur = 0.7, usual.jpeg_quality = 80,
  usual.gradient = 0.3;
  std::printf("| tilt | no noise | noise 4 | noise 8 | noise 16 |\n|---|---|---|---|---|\n");
  for (const double tilt : {0, 10, 20, 30, 40}) {
    std::printf("| %.0f° |", tilt);
    for (const double noise : {0.0, 4.0, 8.0, 16.0}) {
      Scan scan = usual;
      scan.tilt = tilt, scan.noise = noise;
      Cell(scan, keeper);
    }
    std::printf("\n");
  }
  std::printf("\n| blur, pixels | no noise | noise 8 |\n|---|---|---|\n");
  for (const double blur : {1.0, 2.0, 3.0, 4.0}) {
    std::printf("| %.0f |", blur);
    for (const double noise : {0.0, 8.0}) {
      Scan scan = usual;
      scan.blur = blur, scan.noise = noise, scan.tilt = 10;
      Cell(scan, keeper);
    }
    std::printf("\n");
  }
  std::printf("\n| sphere, pixels | no noise | noise 8 |\n|---|---|---|\n");
  for (const double sphere : {210, 300, 500}) {
    std::printf("| %.0f |", sphere);
    for (const double noise : {0.0, 8.0}) {
      Scan scan = usual;
      scan.fill = sphere * 1.25 / usual.height, scan.noise = noise, scan.tilt = 10;
      Cell(scan, keeper);
    }
    std::printf("\n");
  }
}

}  // namespace
}  // namespace scumble

int main(int argc, char** argv) {
  scumble::Run({argc > 1 ? argv[1] : "", 0});
  return 0;
}
