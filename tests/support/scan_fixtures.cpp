#include "tests/support/scan_fixtures.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/image/check.h"
#include "core/image/color.h"
#include "core/image/hash.h"
#include "core/io/picture_file.h"
#include "core/style/fiducials.h"
#include "core/style/sphere_kit.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

// Linear light of the sheet, white beyond the template, a brown desk beyond the sheet.
glm::dvec3 SheetLight(const Picture& sheet, glm::dvec2 at, const std::vector<int>& covered) {
  const int side = sheet.width;
  const double size = side / (1 + 2 * kFiducialMargin);
  for (const int id : covered) {
    const Fiducial& mark = Fiducials()[std::size_t(id)];
    const glm::dvec2 from = at - glm::dvec2(mark.left + 0.04, mark.top + 0.05);
    if (glm::length(from) < 0.09) return {0.45, 0.25, 0.18};
  }
  if (std::max(std::abs(at.x - 0.5), std::abs(at.y - 0.5)) > 0.72) {
    return glm::dvec3(0.16, 0.09, 0.04) * (1 + 0.3 * std::sin(40 * at.y + 3 * std::sin(7 * at.x)));
  }
  const glm::dvec2 p = (at + kFiducialMargin) * size - 0.5;
  const int x = int(std::floor(p.x)), y = int(std::floor(p.y));
  glm::dvec3 light(0.0);
  for (int k = 0; k < 4; ++k) {
    const int i = x + k % 2, j = y + k / 2;
    const double weight = (k % 2 ? p.x - x : 1 - p.x + x) * (k / 2 ? p.y - y : 1 - p.y + y);
    const bool inside = i >= 0 && j >= 0 && i < side && j < side;
    for (int c = 0; c < 3; ++c) light[c] += weight * (inside ? Srgb16ToLinear(sheet.At(i, j)[c]) : 1.0f);
  }
  return light;
}

void BlurLight(std::vector<glm::dvec3>& light, int width, int height, double deviation) {
  const int reach = int(std::ceil(3 * deviation));
  std::vector<double> weights;
  for (int i = -reach; i <= reach; ++i) weights.push_back(std::exp(-0.5 * i * i / (deviation * deviation)));
  for (const bool across : {true, false}) {
    const std::vector<glm::dvec3> old = light;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        glm::dvec3 sum(0.0);
        double all = 0;
        for (int i = -reach; i <= reach; ++i) {
          const int u = std::clamp(across ? x + i : x, 0, width - 1), v = std::clamp(across ? y : y + i, 0, height - 1);
          sum += weights[std::size_t(i + reach)] * old[std::size_t(v) * width + u],
              all += weights[std::size_t(i + reach)];
        }
        light[std::size_t(y) * width + x] = sum / all;
      }
    }
  }
}

// A sum of four uniform numbers less their mean, of variance 1: as good as a Gaussian here.
double Gaussian(int seed, std::size_t i) {
  double sum = -2;
  const auto bits = Hash(seed, i);
  for (int k = 0; k < 4; ++k) sum += double(bits >> (16 * k) & 65535) / 65536;
  return sum * std::sqrt(3.0);
}

}  // namespace

Picture PaintedTemplate(const Picture& paint) {
  const int size = paint.width, margin = TemplateMargin(size);
  Picture sheet(size + 2 * margin, size + 2 * margin);
  std::fill(sheet.rgba.begin(), sheet.rgba.end(), 65535);
  DrawFiducials(sheet, size, margin);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double u = (x + 0.5) / size - 0.5, v = (y + 0.5) / size - 0.5;
      const double ragged = 0.52 + 0.012 * std::sin(9 * std::atan2(v, u)) + 0.006 * std::sin(31 * std::atan2(v, u));
      if (std::hypot(u, v) < ragged) std::copy_n(paint.At(x, y), 3, sheet.At(x + margin, y + margin));
    }
  }
  return sheet;
}

const Picture& CharcoalSheet() {
  static const Picture sheet = [] {
    const auto paint = ReadPicture(SCUMBLE_SOURCE_DIR "/exemplars/charcoal/lit.png");
    SCUMBLE_CHECK(paint.ok());
    return PaintedTemplate(*paint);
  }();
  return sheet;
}

ScanCamera::ScanCamera(const Scan& scan) : scan_(scan), middle_(scan.width / 2.0, scan.height / 2.0) {
  const double radians = std::acos(-1.0) / 180, a = scan.rotation * radians, t = scan.tilt * radians,
               d = scan.towards * radians;
  const auto about = [](glm::dvec3 axis, double angle) {  // Rodrigues
    const glm::dmat3 k(0, axis.z, -axis.y, -axis.z, 0, axis.x, axis.y, -axis.x, 0);
    return glm::dmat3(1.0) + std::sin(angle) * k + (1 - std::cos(angle)) * k * k;
  };
  turn_ = about({0, 0, 1}, a) * about({std::cos(d), std::sin(d), 0}, t);
  focal_ = 0.75 * std::max(scan.width, scan.height);
  distance_ = focal_ / (scan.fill * std::min(scan.width, scan.height) / 1.25);
}

glm::dvec2 ScanCamera::ToPicture(glm::dvec2 on_sheet) const {
  glm::dvec3 p(on_sheet - 0.5, 0.0);
  p.z = scan_.curl * std::sin(4 * p.x + 1);
  if (scan_.mirrored) p.x = -p.x;
  p = turn_ * p;
  const glm::dvec2 straight = focal_ * glm::dvec2(p) / (p.z + distance_) + glm::dvec2(scan_.shift_x, scan_.shift_y);
  const double r2 = glm::dot(straight, straight) / glm::dot(middle_, middle_);
  return middle_ + straight * (1.0 - scan_.barrel * r2 * (0.9 + 0.1 * r2));
}

glm::dvec2 ScanCamera::ToSheet(glm::dvec2 in_picture, glm::dvec2 guess) const {
  glm::dvec2 at = guess;
  for (int i = 0; i < 8; ++i) {
    const double h = 1e-4;
    const glm::dvec2 here = ToPicture(at), off = in_picture - here;
    if (std::abs(off.x) + std::abs(off.y) < 1e-6) break;
    const glm::dvec2 dx = (ToPicture(at + glm::dvec2(h, 0)) - here) / h,
                     dy = (ToPicture(at + glm::dvec2(0, h)) - here) / h;
    at += glm::inverse(glm::dmat2(dx, dy)) * off;
  }
  return at;
}

Picture TakeScan(const Picture& sheet, const Scan& scan) {
  const ScanCamera camera(scan);
  std::vector<glm::dvec3> light(std::size_t(scan.width) * scan.height);
  constexpr int kPoints = 2;
  for (int y = 0; y < scan.height; ++y) {
    glm::dvec2 guess(0.5, 0.5);
    for (int x = 0; x < scan.width; ++x) {
      glm::dvec3 sum(0.0);
      for (int k = 0; k < kPoints * kPoints; ++k) {
        const glm::dvec2 p(x + (k % kPoints + 0.5) / kPoints, y + (k / kPoints + 0.5) / kPoints);
        guess = camera.ToSheet(p, guess);
        sum += SheetLight(sheet, guess, scan.covered) / double(kPoints * kPoints);
      }
      light[std::size_t(y) * scan.width + x] = sum;
    }
  }
  if (scan.blur > 0) BlurLight(light, scan.width, scan.height, scan.blur);
  Picture picture(scan.width, scan.height);
  for (int y = 0; y < scan.height; ++y) {
    for (int x = 0; x < scan.width; ++x) {
      const std::size_t i = std::size_t(y) * scan.width + x;
      const double lamp = 0.85 * (1 - scan.gradient * x / scan.width);
      for (int c = 0; c < 3; ++c) {
        const double seen = (light[i][c] * (1 - scan.glare) + scan.glare) * lamp * scan.cast[std::size_t(c)];
        const double encoded =
            Srgb16FromLinear(float(seen)) / 257.0 + scan.noise * Gaussian(scan.seed, 3 * i + std::size_t(c));
        picture.rgba[4 * i + std::size_t(c)] =
            static_cast<std::uint16_t>(257 * std::lround(std::clamp(encoded, 0.0, 255.0)));
      }
      picture.rgba[4 * i + 3] = 65535;
    }
  }
  if (scan.jpeg_quality == 0) return picture;
  const TemporaryFolder folder;
  PictureWriteOptions options;
  options.jpeg_quality = scan.jpeg_quality;
  SCUMBLE_CHECK(WritePicture(folder / "scan.jpg", picture, options).ok());
  const auto read = ReadPicture(folder / "scan.jpg");
  SCUMBLE_CHECK(read.ok());
  return *read;
}

double TrueError(const TemplateMap& map, const Scan& scan) {
  const ScanCamera camera(scan);
  double worst = 0;
  for (int i = 0; i <= 20; ++i) {
    for (int j = 0; j <= 20; ++j) {
      const glm::dvec2 at(i / 20.0, j / 20.0);
      if (glm::length(at - 0.5) <= 0.5) worst = std::max(worst, glm::length(map.ToPicture(at) - camera.ToPicture(at)));
    }
  }
  return worst / camera.SpherePixels();
}

}  // namespace scumble
